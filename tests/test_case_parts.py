"""The tables of a case for fluid, cavitation, flow factors and solid."""

from pathlib import Path
from tempfile import TemporaryDirectory

import pytest
from command_line import toml_of

import stribeck as sb

CONTACT = {
    "radius": "10 mm",
    "modulus": "2.1 MPa",
    "load": "50 N/m",
    "viscosity": "1 Pa*s",
    "entrainment_speed": "50 mm/s",
    "roughness": "1 um",
    "alpha": 2.0,
    "beta": 0.05,
    "boundary_friction": 0.8,
}


BALL = {"geometry": "point", "load": "50 mN"}


def case_of(contact=None, **tables):
    """Return the case of a file with these tables."""
    with TemporaryDirectory() as folder:
        path = Path(folder) / "a.toml"
        path.write_text(toml_of(contact=CONTACT if contact is None else contact, **tables))
        return sb.load_case(path)


@pytest.mark.quick
def test_the_tables_become_parts_of_the_contact():
    contact = case_of(
        CONTACT | {"slide_to_roll": 1.0},
        fluid={
            "model": "carreau",
            "relaxation_time": "1 ms",
            "exponent": 0.5,
            "infinite_viscosity": "10 mPa*s",
            "pressure_coefficient": "15 1/GPa",
            "viscosity_law": "roelands",
            "density": "dowson-higginson",
        },
        cavitation={"model": "exit"},
        solid={"layer_thickness": "2 mm", "poisson_ratio": 0.5},
    ).contact
    f = sb.fluids
    assert contact.fluid == f.Fluid(f.Carreau(1e-3, 0.5, 0.01), f.Roelands(1.5e-8), f.DowsonHigginson())
    assert contact.cavitation == "exit"
    assert contact.slide_to_roll == 1.0
    assert contact.speed == 0.1
    assert contact.solid == sb.solids.Layer(2e-3, 0.5)
    assert contact.groups.model.film.name == "carreau + roelands + dowson-higginson"


@pytest.mark.quick
def test_every_model_of_a_fluid_and_every_solid_is_read():
    fluids, solids = sb.fluids, sb.solids
    for table, fluid in [
        ({"model": "eyring", "eyring_stress": "5 MPa"}, fluids.Fluid(fluids.Eyring(5e6))),
        ({"model": "cross", "relaxation_time": 0.1, "exponent": 0.7}, fluids.Fluid(fluids.Cross(0.1, 0.7))),
        ({"model": "power-law", "relaxation_time": "1 s", "exponent": 0.7}, fluids.Fluid(fluids.PowerLaw(1.0, 0.7))),
        ({"pressure_coefficient": "15 1/GPa"}, fluids.Fluid(viscosity=fluids.Barus(1.5e-8))),
        ({}, fluids.Fluid()),
    ]:
        assert case_of(fluid=table).contact.fluid == fluid
    memory, layer = {"retardation_time": "10 ms", "modulus_ratio": 3}, {"layer_thickness": "2 mm", "poisson_ratio": 0.4}
    for table, solid in [
        (memory, solids.StandardLinearSolid(0.01, 3.0)),
        ({"relaxation_times": ["1 ms", 0.01], "moduli": [1.0, 0.5]}, solids.Prony((1e-3, 0.01), (1.0, 0.5))),
        (memory | layer, solids.StandardLinearSolid(0.01, 3.0, solids.Layer(2e-3, 0.4))),
    ]:
        contact = case_of(solid=table).contact
        assert contact.solid == solid and contact.groups.model.solid.uses_speed


@pytest.mark.quick
def test_a_preset_gives_the_viscosity_too():
    contact = {name: value for name, value in CONTACT.items() if name != "viscosity"}
    liquid = {"preset": "glycerol-water", "weight_fraction": 0.8, "temperature": "20 degC"}
    case = case_of(contact, fluid=liquid)
    assert case.contact.viscosity == sb.fluids.glycerol_water(0.8, 20).viscosity
    [said] = case.conversions
    assert said.startswith("viscosity = ") and "weight_fraction = 0.8 and temperature = '20 degC': Cheng 2008" in said
    assert case.facts == {"thinning_rate": pytest.approx(3e7 / case.contact.viscosity)}  # glycerol thins at 3e7 Pa
    assert case_of(contact, fluid=liquid, check={"thinning_rate": "5e4 1/s"}).facts == {"thinning_rate": 5e4}
    thinning = case_of(contact, fluid={"preset": "xanthan"}).contact
    assert case_of(contact, fluid={"preset": "xanthan"}).facts == {}
    assert thinning.fluid == sb.fluids.PRESETS["xanthan"]().fluid
    with pytest.raises(sb.InputError, match=r"\[fluid\] preset = 'water' and viscosity = .* are both given"):
        case_of(fluid={"preset": "water"})
    for wrong in ({"preset": "honey"}, {"preset": "water", "temperature": "2 m"}, {"preset": "water", "model": "cross"}):
        with pytest.raises(sb.InputError, match=r"\[fluid\]") as refused:
            case_of(contact, fluid=wrong)
        assert "viscosity is missing" not in str(refused.value)


@pytest.mark.quick
def test_flow_factors_take_alpha_and_roughness_of_the_contact():
    flow = case_of(flow_factors={"model": "patir-cheng", "gamma": 3}).contact.groups.model.film.flow
    assert flow.gamma == 3
    assert flow.sigma == pytest.approx(1e-6 / case_of().contact.hertz.indentation)
    assert case_of(flow_factors={"model": "effective-medium"}).contact.flow_factors == sb.fluids.EffectiveMedium()
    assert case_of(flow_factors={"model": "none"}).contact == case_of().contact


# Table, what stands in it, and what is said.  Values that numbers cannot have are in test_schema.py.
WRONG = [
    ("fluid", {"model": "carreau"}, r"\[fluid\] relaxation_time is missing, which model = 'carreau' needs"),
    ("fluid", {"model": "eyring", "eyring_stress": "5 MPa", "exponent": 1}, r"\[fluid\] exponent = 1 is given, but model"),
    ("fluid", {"modle": "carreau"}, r"\[fluid\] modle = 'carreau' is not a known key; did you mean model"),
    ("fluid", {"model": "eyring", "eyring_stress": "1e-300 Pa"}, r"\[fluid\] eyring_stress = 1e-300: thinning would begin"),
    ("fluid", {"pressure_coeff": 1}, r"\] pressure_coeff = 1 is not .*mean pressure_coefficient"),
    ("fluid", {"model": "eyring", "stress": 1e6}, r"\] stress = 1000000.0 is not a known key; write eyring_stress"),
    ("fluid", {"name": "water"}, r"\[fluid\] name = 'water' is not a known key; write preset"),
    ("fluid", {"model": "bingham"}, r"\[fluid\] model = 'bingham' must be one of"),
    ("fluid", {"viscosity_law": "barus"}, r"\[fluid\] pressure_coefficient is missing"),
    ("fluid", {"viscosity_law": "constant", "pressure_coefficient": 1}, r"\[fluid\] pressure_coefficient = 1 is given, but"),
    ("fluid", {"pressure_coefficient": "15 1/GPa", "reference_pressure": 1}, "but viscosity_law = 'barus' has no such"),
    ("fluid", {"pressure_coefficient": 1}, r"\[fluid\] pressure_coefficient times the Hertz pressure is [\d.e+]+; it must"),
    ("fluid", {"viscosity": 0.05}, r"viscosity = 0.05 is not a known key; it belongs in the table \[contact\]"),
    ("fluid", {"preset": "honey"}, r"\[fluid\] preset = 'honey' must be one of"),
    ("fluid", {"preset": "water", "model": "cross"}, r"\[fluid\] model = 'cross' is given, but a preset"),
    ("fluid", "water", r"fluid = 'water' must be a table, \[fluid\]"),
    ("solid", {"model": "half-space", "layer_thickness": "2 mm"}, r"\] layer_thickness = '2 mm' is given, but"),
    ("solid", {"model": "rubber"}, r"\[solid\] model = 'rubber' must be one of 'half-space', 'layer'"),
    ("solid", {"model": "prony", "layer_thickness": "2 mm"}, r"\[solid\] relaxation_times is missing, which .* needs"),
    ("solid", {"layer_thicknes": "2 mm"}, r"\] layer_thicknes = '2 mm' is not a .* did you mean layer_th"),
    ("solid", {"poisson_ratio": 0.5}, r"\[solid\] layer_thickness is missing"),
    ("solid", {"modulus_ratio": 3}, r"\[solid\] retardation_time is missing, which .* needs; add .* = \"10 ms\""),
    ("solid", {"retardation_time": "1 s", "moduli": [1]}, r"\[solid\] .* two descriptions"),
    ("solid", {"relaxation_times": "1 s", "moduli": [1]}, r"\[solid\] relaxation_times = '1 s' must be a list"),
    ("asperities", {"exponent": 3}, r"\] exponent = 3 is not a known key; known are density, radius, deviation\."),
    ("cavitation", {}, r"\[cavitation\] model is missing"),
    ("cavitation", {"model": "swift"}, "must be 'none', 'exit'"),
    ("motion", {"slide_to_roll": 1}, r"motion = .* is not a known key; write slide_to_roll in \[contact\]"),
    ("flow_factors", {"gamma": 3}, r"\[flow_factors\] model is missing"),
    ("flow_factors", {"model": "effective-medium", "gamma": 1}, r"\[flow_factors\] gamma = 1 is given"),
]


@pytest.mark.quick
def test_what_is_wrong_in_a_table_is_said_with_its_name(subtests):
    for table, given, said in WRONG:
        with subtests.test(said), pytest.raises(sb.InputError, match=said):
            case_of(**{table: given})
    with pytest.raises(sb.InputError) as problem:  # all at once
        case_of(fluid={"model": "carreau"}, flow_factors={"slip": 1}, solid={})
    named = [line.split("]")[0].split("[")[1] for line in str(problem.value).split("\n")]
    assert named == ["fluid", "flow_factors", "solid"]


@pytest.mark.quick
def test_slide_to_roll_stands_in_contact_whatever_the_geometry():
    for own in ({"geometry": "line"}, BALL):
        assert case_of(CONTACT | own | {"slide_to_roll": 0.5}).contact.slide_to_roll == 0.5
        with pytest.raises(sb.InputError, match=r"\[contact\] slide_to_roll = 500 must be between"):
            case_of(CONTACT | own | {"slide_to_roll": 500})


@pytest.mark.quick
def test_data_of_a_ball_have_its_units_without_a_table_fit_too(tmp_path):
    case = sb.load_case(Path(__file__).parents[1] / "examples" / "tongue_model.toml")
    (tmp_path / "rig.csv").write_text("mean speed [mm/s],friction,load [N]\n10,0.4,2\n20,0.3,2\n50,0.2,2\n")
    assert sb.read_measurements(tmp_path / "rig.csv", case.fit).inputs[0]["load"] == 2.0


def test_a_ball_has_the_tables_of_a_cylinder():
    torn = case_of(CONTACT | BALL, cavitation={"model": "exit"}).contact
    assert torn.cavitation == torn.groups.model.cavitation == torn.replace(load="40 mN").cavitation == "exit"
