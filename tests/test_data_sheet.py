"""Inputs as data sheets have them: what is made of them, what is said, and what errors of the inputs make of the state."""

import json
import math

import pytest
from command_line import EXAMPLES, call, case_text
from fit_data import TRUE

import stribeck as sb
from stribeck.regimes.margins import RegimeMargins

SHEET = {
    "modulus": None,
    "shore_a": "70",
    "load": None,
    "force": '"15.4 N"',
    "width": '"20 mm"',
    "viscosity": None,
    "kinematic_viscosity": '"46 cSt"',
    "density": '"870 kg/m^3"',
    "speed": None,
    "rotational_speed": '"300 rpm"',
    "shaft_diameter": '"30 mm"',
    "roughness": None,
    "ra": '"0.4 um"',
}


@pytest.fixture
def sheet(tmp_path):
    path = tmp_path / "sheet.toml"
    path.write_text(case_text(SHEET))
    return path


# --- conversions ---


@pytest.mark.quick
def test_a_data_sheet_becomes_a_contact(sheet):
    case = sb.load_case(sheet)
    contact = case.contact
    assert contact.modulus == pytest.approx(5.52e6 / 0.75, rel=1e-3)  # Gent, and incompressible
    assert contact.load == pytest.approx(770)
    assert contact.viscosity == pytest.approx(0.04002)
    assert contact.speed == pytest.approx(300 / 60 * math.pi * 0.03)
    assert contact.roughness == pytest.approx(0.4e-6 * math.sqrt(math.pi / 2))
    assert len(case.conversions) == 5
    assert case.conversions[0].startswith("youngs_modulus = 5.521 MPa from shore_a = 70: E = 0.0981") and "Gent 1958" in str(
        case.conversions
    )
    assert case.errors == {"modulus": pytest.approx(0.3), "roughness": pytest.approx(0.1)}
    assert case.conversions[0].endswith("poisson_ratio = 0.5 assumed.")
    sheet.write_text(case_text(SHEET | {"poisson_ratio": "0.5"}))
    assert "assumed" not in sb.load_case(sheet).conversions[0]


@pytest.mark.quick
def test_turns_per_minute_are_rpm_however_they_are_written_and_a_bare_rate_is_none(subtests):
    """As in files of rigs; 1/min once counted radians, 6.3 times slower."""
    kept = {"shaft_diameter": "30 mm", "speed": None}
    for text in (
        "1500 rpm",
        "1500 1/min",
        "1500/min",
        "1500 min^-1",
        "1500 min-1",
        "1500 min⁻¹",
        "1500 U/min",
        "1500 rev/min",
        "25 rev/s",
    ):
        with subtests.test(text=text):
            assert TRUE.replace(**kept, rotational_speed=text).speed == pytest.approx(25 * math.pi * 0.03, rel=1e-12)
    for text in ("25 1/s", "25 Hz", "0.025 kHz", "90000 1/h", "25 cps"):
        with (
            subtests.test(text=text),
            pytest.raises(sb.InputError, match="may mean turns or radians; write it in rpm or rad/s"),
        ):
            TRUE.replace(**kept, rotational_speed=text)


def test_shore_d_is_that_of_its_source():
    modulus = TRUE.replace(shore_d=40).modulus
    assert math.log10(0.75 * modulus / 1e6) == pytest.approx(0.0235 * 90 - 0.6403)


@pytest.mark.quick
def test_python_takes_a_data_sheet_too():
    kept = {
        name: getattr(TRUE, name) for name in ("radius", "load", "viscosity", "speed", "alpha", "beta", "boundary_friction")
    }
    contact = sb.LineContact(shore_a=70, rq="1 um", **kept)
    assert contact.roughness == 1e-6 and 7e6 < contact.modulus < 8e6
    with pytest.raises(sb.InputError, match="are both given"):
        sb.LineContact(shore_a=70, youngs_modulus="2 MPa", poisson_ratio=0.5, rq="1 um", **kept)
    with pytest.raises(sb.InputError, match="has an error, for which there is no place here"):
        TRUE.replace(roughness="1.0 +- 0.2 um")


@pytest.mark.quick
def test_a_motion_to_and_fro_counts_with_its_mean_speed_and_its_stroke_is_checked(tmp_path):
    path = tmp_path / "case.toml"
    path.write_text(case_text({"speed": None, "stroke": '"50 mm"', "frequency": '"2 Hz"'}))
    case = sb.load_case(path)
    assert case.contact.speed == pytest.approx(2 * 0.05 * 2)  # twice the stroke in half a second
    assert case.facts == {"stroke": 0.05}
    path.write_text(case_text({"speed": None, "stroke": '"50 mm"', "frequency": '"2 Hz"'}, check={"stroke": '"20 mm"'}))
    assert sb.load_case(path).facts == {"stroke": 0.02}  # what is said wins


@pytest.mark.quick
def test_what_cannot_be_converted_is_named_alone(subtests, tmp_path_factory):
    for changes, sentence in [
        ({"width": None}, "width is missing beside force = '15.4 N'; add a length, for example width = "),
        ({"load": '"770 N/m"'}, "load = '770 N/m' and force = '15.4 N' and width = '20 mm' are both given"),
        ({"rotational_speed": '"5 Hz"'}, "may mean turns or radians; write it in rpm or rad/s"),
        ({"ra": '"0.4 +- x um"'}, "cannot be read; write it as '1.0 +- 0.2 um'"),
        ({"ra": '"0.4 +- 4 um"'}, "has an error of 1000 %"),
        ({"ra": '{ value = "0.4 um" }'}, "must be a table of value and error"),
        ({"rpm": '"3 rpm"'}, "rpm = '3 rpm' is not a known key; give rotational_speed"),
        ({"shore": "70"}, "shore = 70 is not a known key; write shore_a = 70"),
    ]:
        with subtests.test(changes=changes, sentence=sentence):
            tmp_path = tmp_path_factory.mktemp("case")
            path = tmp_path / "case.toml"
            path.write_text(case_text(SHEET | changes))
            with pytest.raises(sb.InputError) as problem:
                sb.load_case(path)
            assert sentence in str(problem.value) and len(str(problem.value).splitlines()) == 1


@pytest.mark.quick
def test_every_form_of_an_input_is_taken_in_its_place_and_said_where_it_has_a_formula(tmp_path):
    path = tmp_path / "case.toml"
    for form in sb.LineContact.INPUTS.forms:
        assert bool(form.formula) == bool(form.source)
        own = (
            {name: None for name in (form.of, sb.LineContact.INPUTS.stands_for[form.inputs[0].name])} if not form.joins else {}
        )
        given = own | {each.name: each.example for each in form.inputs}
        if form.geometry == "point":
            given |= {"geometry": '"point"'}
        if "youngs_modulus" in form.uses:
            given |= {"modulus": None, "youngs_modulus": '"5 MPa"', "poisson_ratio": "0.5"}
        path.write_text(case_text(given))
        case = sb.load_case(path)
        assert len(case.conversions) == bool(form.formula) and case.contact.modulus > 0


@pytest.mark.quick
def test_ra_is_the_height_of_a_surface_with_a_spectrum_too(tmp_path):
    """Persson's law takes its height from [surface], where a data sheet's Ra has no place."""
    path = tmp_path / "seal.toml"
    surface = {"hurst": "0.8", "longest_wavelength": '"150 um"', "shortest_wavelength": '"1.5 um"'}
    contact = {"roughness": None, "alpha": None, "beta": None, "ra": '"0.8 +- 0.1 um"', "law": '"persson"'}
    path.write_text(case_text(contact, surface=surface))
    case = sb.load_case(path)
    assert case.contact.roughness == pytest.approx(0.8e-6 * math.sqrt(math.pi / 2), rel=1e-6)
    assert case.contact.law.name == "persson" and case.errors["roughness"] > 0.1


# --- values with an error ---


def test_small_errors_propagate_by_the_exact_derivatives():
    found = sb.propagate(TRUE, {"viscosity": 0.01, "boundary_friction": "0.007", "radius": "1 %"}, transitions=False)
    inputs = {name: getattr(TRUE, name) for name in ("viscosity", "boundary_friction", "radius")}
    ends = [
        [sb.solve(TRUE.replace(**{name: value * math.exp(step)})) for step in (-0.01, 0.01)] for name, value in inputs.items()
    ]
    sigma = math.hypot(*(math.log(above.friction().total / below.friction().total) / 2 for below, above in ends))
    low, high = found["friction"].interval_68
    assert math.log(high / low) / 2 == pytest.approx(sigma, rel=0.03)
    assert sum(found.contributions.values()) == pytest.approx(1)
    assert found.regimes == {"boundary": 0, "mixed": 1, "hydrodynamic": 0}
    assert found["friction"].value == pytest.approx(sb.solve(TRUE).friction().total, rel=1e-4)


def test_correlated_errors_propagate_by_the_exact_derivatives():
    errors = {"modulus": 0.02, "viscosity": 0.01, "load": 0.01}

    def width(correlation, names=tuple(errors)):
        tied = {"modulus": {"load": correlation}} if correlation else {}
        found = sb.propagate(TRUE, sb.results.StandardErrors({name: errors[name] for name in names}, tied))
        assert sum(found.contributions.values()) == pytest.approx(1)
        assert ("with their correlations" in str(found)) == bool(correlation)
        return {each.name: math.log(each.interval_68[1] / each.interval_68[0]) / 2 for each in found.spreads}

    def slopes(of):
        ends = ([of(TRUE.replace(**{name: getattr(TRUE, name) * math.exp(s)})) for s in (-0.01, 0.01)] for name in errors)
        return [math.log(above / below) / 0.02 * errors[name] for name, (below, above) in zip(errors, ends, strict=True)]

    def minimum(contact):
        return sb.stribeck_curve(contact, speed=("1 mm/s", "1 m/s"), points=3, rtol=1e-5).minimum.speed

    along, against = width(0.8), width(-0.8)
    for name, of in (("friction", lambda each: sb.solve(each).friction().total), ("minimum of friction", minimum)):
        modulus, viscosity, load = slopes(of)
        for sign, found in ((0.8, along), (-0.8, against)):
            expected = modulus**2 + viscosity**2 + load**2 + 2 * sign * modulus * load
            assert found[name] ** 2 == pytest.approx(expected, rel=0.05)


@pytest.mark.quick
def test_numbers_that_follow_from_one_hardness_are_correlated_and_what_no_correlation_can_be_is_refused(tmp_path, subtests):
    path = tmp_path / "seal.toml"
    ring = {"modulus": None, "shore_a": "70", "load": None, "squeeze": "0.1", "sealed_pressure": '"1 MPa"'}
    path.write_text(case_text(ring | {"sealed_pressure": None}))
    errors = sb.load_case(path).errors
    assert errors.correlations == {frozenset(("modulus", "load")): pytest.approx(0.3 / math.hypot(0.3, 0.1))}
    path.write_text(case_text(ring))  # most of the load is that of the pressure, which acts on less width of a stiffer ring
    assert [*sb.load_case(path).errors.correlations.values()] == [pytest.approx(-0.095, abs=2e-3)]  # of 400 000 random rings
    own = {"alpha": '"2 +- 1 %"', "beta": '"0.06 +- 1 %"', "roughness": '"1 um +- 1 %"'}
    for table, words in (
        ({"alpha": "{ radius = 0.5 }"}, "'radius' has no error that could be correlated; known are "),
        ({"alpha": "{ beta = 1.0 }"}, "alpha and beta = 1.0; it must be between -1 and 1"),
        ({"alpha": "0.5"}, "alpha = 0.5; it must be a table"),
        ({"alhpa": "{}"}, "'alhpa' has no error that could be correlated"),
        ({"alpha": "{ beta = 0.9, roughness = -0.9 }", "beta": "{ roughness = 0.9 }"}, "contradict one another"),
        ({"alpha": "{ beta = 0.9 }", "beta": "{ alpha = -0.9 }"}, "beta and alpha have two correlations"),
    ):
        path.write_text(case_text(own, correlations=table))
        with subtests.test(words=words), pytest.raises(sb.InputError, match=f"\\[correlations\\] .*{words}"):
            sb.load_case(path)
    path.write_text(case_text(own, correlations={"alpha": "{ beta = 0.9 }"}))
    case = sb.load_case(path)
    assert (case.errors | {"load": 0.1}).correlations == case.errors.correlations
    assert case.errors == dict(case.errors) and case.errors != sb.results.StandardErrors(dict(case.errors))
    assert not (case.errors | {"beta": 0.1}).correlations
    for same in ({"load": 0.1} | case.errors, case.errors.copy(), sb.results.StandardErrors(case.errors)):
        assert same.correlations == case.errors.correlations
    same |= {"beta": 0.1}
    assert not same.correlations
    same = case.errors.copy()
    del same["beta"]
    assert not sb.propagate(case.contact, same, transitions=False).errors.correlations
    path.write_text("correlations = false\n" + case_text(own))
    with pytest.raises(sb.InputError, match="correlations = False; it must be a table"):
        sb.load_case(path)
    shape = {"h_rms": '"1 um +- 20 %"', "hurst": 0.8, "longest_wavelength": '"30 um"', "shortest_wavelength": '"1 um"'}
    path.write_text(case_text(own, surface=shape | {"shape_only": "true"}))
    assert sb.load_case(path).errors["roughness"] == pytest.approx(0.01)  # that of the height, not of its shape


def test_the_probability_of_a_regime_is_that_of_its_speed():
    """Only the viscosity is uncertain, so that the regime ends where speed times viscosity does."""
    curve = sb.stribeck_curve(TRUE, points=21, rtol=1e-4)
    [end] = [mark.value for mark in curve.transitions if "10 %" in mark.name]
    found = sb.propagate(TRUE.replace(speed=end / math.exp(0.1)), {"viscosity": 0.2}, transitions=False)
    sigma = math.sqrt(math.log1p(0.04))
    assert found.regimes["hydrodynamic"] == pytest.approx(0.5 * math.erfc(0.1 / sigma / math.sqrt(2)), abs=0.01)


@pytest.mark.slow
def test_transitions_move_with_the_inputs():
    found = sb.propagate(TRUE, {"viscosity": 0.2})
    spread = found["minimum of friction"]
    factor = math.exp(1.96 * math.sqrt(math.log1p(0.04)))
    assert spread.interval_95 == (
        pytest.approx(spread.value / factor, rel=1e-3),
        pytest.approx(spread.value * factor, rel=1e-3),
    )
    assert spread.value == pytest.approx(0.0276, rel=1e-2)
    # Less beta, and asperities lose the load at far lower speeds; more, and at somewhat higher ones.
    seal = sb.load_case(EXAMPLES / "lip_seal.toml").contact
    name, sigma = "fluid carries 5 % of the load", math.sqrt(math.log1p(0.04))
    spread = sb.propagate(seal, {"beta": 0.2})[name]
    for end, factor in zip(spread.interval_68, (math.exp(-sigma), math.exp(sigma)), strict=True):
        curve = sb.stribeck_curve(seal.replace(beta=seal.beta * factor), points=21, rtol=1e-3)
        assert end == pytest.approx(next(mark.value for mark in curve.transitions if mark.name == name), rel=1e-2)
    assert spread.value / spread.interval_68[0] > 1.5 * spread.interval_68[1] / spread.value


def test_with_perssons_law_beta_follows_the_roughness():
    seal = sb.load_case(EXAMPLES / "rod_seal.toml").contact
    tied, apart = (
        sb.propagate(seal, {"roughness": 0.1} | more, transitions=False)["friction"].interval_68
        for more in ({}, {"beta": 1e-6})
    )
    assert math.log(tied[1] / tied[0]) > 1.1 * math.log(apart[1] / apart[0])


@pytest.mark.quick
def test_an_error_of_the_height_of_a_surface_is_one_of_beta_too_under_any_law(tmp_path):
    def case_of(height):
        own = dict.fromkeys(("alpha", "beta", "roughness")) | {"modulus": '"3 MPa +- 2 %"', "speed": '"20 mm/s"'}
        shape = {"h_rms": f'"{height}"', "hurst": 0.8, "longest_wavelength": '"30 um"', "shortest_wavelength": '"1 um"'}
        tied = {"correlations": {"modulus": "{ roughness = -0.6 }"}} if "+-" in height else {}
        (tmp_path / "case.toml").write_text(case_text(own, surface=shape, **tied))
        return sb.load_case(tmp_path / "case.toml")

    case = case_of("1 um +- 2 %")
    stiff = case.contact.replace(modulus=case.contact.modulus * 1.02)
    contacts = (case_of("1.02 um").contact, stiff, case.contact)
    higher, stiffer, here = (math.log(sb.solve(each).friction().total) for each in contacts)
    of_height, of_modulus = higher - here, stiffer - here
    expected = of_height**2 + of_modulus**2 - 1.2 * of_height * of_modulus
    low, high = sb.propagate(case.contact, case.errors, transitions=False)["friction"].interval_68
    assert (math.log(high / low) / 2) ** 2 == pytest.approx(expected, rel=0.05)


@pytest.mark.quick
def test_errors_that_say_nothing_are_refused():
    for errors, sentence in (
        ({"rough": 0.1}, "no input of a contact"),
        ({"entrainment_speed": "1 mm/s"}, "give the error of speed, which follows from it"),
        ({"roughness": 0}, "must be a number such as 0.2"),
        ({"roughness": "x %"}, "is not a number of per cent"),
    ):
        with pytest.raises(sb.InputError, match=sentence):
            sb.propagate(TRUE, errors)
    with pytest.raises(sb.InputError, match="which is zero"):
        sb.propagate(TRUE.replace(roughness=0), {"roughness": 0.1})


@pytest.fixture
def no_margins(monkeypatch):
    """Take the ways to other regimes away, which take longest."""
    monkeypatch.setattr("stribeck.regimes.overview.regime_margins", lambda *_, **__: RegimeMargins("mixed", (), ()))


@pytest.mark.usefixtures("no_margins")
def test_regimes_prints_conversions_and_the_probability_of_each_regime(tmp_path, capsys):
    path = tmp_path / "case.toml"
    path.write_text(case_text({"roughness": None, "ra": '{ value = "0.8 um", error = "0.2 um" }', "speed": '"20 mm/s"'}))
    answer = call(capsys, "regimes", path, "-v")
    assert answer.code == 0
    assert "Converted: roughness = 1.003 µm from ra = '0.8 um +- 0.2 um'" in answer.out
    assert "Probability of each regime by the errors of roughness: boundary 0 %, mixed" in answer.out
    found = json.loads(call(capsys, "regimes", path, "--json").out)
    assert sum(found["uncertainty"]["regime_probabilities"].values()) == pytest.approx(1)
    assert len(found["conversions"]) == 1
    assert "Converted:" in call(capsys, "solve", path, "-v").out


def test_errors_of_a_contact_on_a_layer_move_the_layer_in_hertz_units_too():
    contact = TRUE.replace(solid=sb.solids.Layer("0.3 mm", 0.5), speed="10 mm/s")
    error = 0.3
    found = sb.propagate(contact, {"modulus": error}, transitions=False)
    reach = math.exp(1.96 * math.sqrt(math.log1p(error**2)))
    for name, function in (
        ("central_film_thickness", lambda each: sb.solve(each, rtol=1e-5).central_gap * each.hertz.indentation),
        ("friction", lambda each: sb.solve(each, rtol=1e-5).friction().total),
    ):
        ends = sorted(function(contact.replace(modulus=contact.modulus * factor)) for factor in (1 / reach, reach))
        assert found[name].interval_95 == pytest.approx(ends, rel=0.03)
    assert found.contributions == {"modulus": 1.0}


def test_errors_of_a_ball_whose_film_breaks_are_about_its_own_friction():
    """The drag behind such a ball is that of its own far film."""
    ball = {"radius": "5 mm", "modulus": "2 MPa", "load": "10 mN", "viscosity": "20 mPa s", "speed": "10 mm/s"}
    surface = {"roughness": "0.2 um", "alpha": 2.0, "beta": 0.05, "boundary_friction": 0.7}
    contact = sb.PointContact(**ball, **surface, cavitation="exit")
    state = sb.solve(contact, rtol=1e-3)
    found = sb.propagate(contact, {"boundary_friction": 1e-3}, definition="published", transitions=False)
    assert found["friction"].value == pytest.approx(state.friction(definition="published").total, rel=2e-3)


@pytest.mark.quick
def test_what_no_solver_knows_is_printed_as_a_bound():
    def spread(*numbers, dimension="number"):
        return sb.results.Spread("share", "share", numbers[0], numbers[0], numbers[1:], numbers[1:], dimension)

    assert spread(3e-10, 4.8e-13, 8.9e-8).texts == ("< 1e-06", "< 1e-06")
    assert spread(3e-10, 4.8e-13, 2e-3).texts == ("< 1e-06", "< 1e-06 to 0.002")
    assert spread(3e-10, 1e-10, 1e-9, dimension="length").texts == ("300 pm", "100 pm to 1 nm")
    shares = {"roughness": 0.99, "beta": 0.0099, "load": 1e-4}
    found = sb.results.Uncertainty(TRUE, {}, (), {"mixed": 1 - 5e-5, "hydrodynamic": 5e-5}, shares, "atlas")
    assert found.probabilities == "mixed 100 %, hydrodynamic < 0.1 %"
    assert found.sources == ("Sources of the variance of friction: roughness 99 %, contact-law beta 0.99 %.",)


LAYER = {"solid": sb.solids.Layer("0.3 mm", 0.5)}
THINNING = {"fluid": sb.fluids.Carreau("1 ms", 0.5)}


def test_errors_of_numbers_of_fluid_and_solid_propagate(subtests):
    for parts, name, error in [
        (LAYER, "layer_thickness", 0.3),
        (THINNING, "exponent", 0.1),
    ]:
        with subtests.test(parts=parts, name=name, error=error):
            contact = TRUE.replace(speed="10 mm/s", **parts)
            found = sb.propagate(contact, {name: error}, transitions=False)
            assert found.contributions == {name: pytest.approx(1)}
            reach = math.exp(1.96 * math.sqrt(math.log1p(error**2)))
            ends = [
                sb.solve(contact.replace(**{name: getattr(contact, name) * each}), rtol=1e-5) for each in (1 / reach, reach)
            ]
            assert found["friction"].interval_95 == pytest.approx(sorted(each.friction().total for each in ends), rel=0.03)


def test_a_pressure_coefficient_of_a_ball_has_a_share_in_the_variance():
    ball = sb.PointContact.from_groups(
        sb.Groups(1e-2, 1e-2, 5e-4, geometry="point"), radius=0.01, modulus=1e6, viscosity=0.1, alpha=2.0, beta=0.1,
        boundary_friction=0.8, slide_to_roll=0.6,
    ).replace(fluid=sb.fluids.Barus("500 1/GPa"))  # fmt: skip
    found = sb.propagate(ball, {"pressure_coefficient": "20 %", "roughness": 1e-4}, transitions=False)
    assert found.contributions["pressure_coefficient"] > 1e-3
    assert "pressure coefficient of the viscosity" in str(found)


@pytest.mark.quick
def test_errors_that_numbers_of_a_law_cannot_have_are_refused():
    with pytest.raises(sb.InputError, match="this contact has none: it belongs to .fluid. with model = .carreau"):
        sb.propagate(TRUE, {"relaxation_time": 0.1})
    with pytest.raises(sb.InputError, match="the error of exponent = 0.8 is too large"):
        sb.propagate(TRUE.replace(fluid=sb.fluids.Carreau("1 ms", 0.8)), {"exponent": 0.2})


@pytest.mark.quick
def test_a_case_takes_errors_of_numbers_of_fluid_and_solid(tmp_path):
    path = tmp_path / "case.toml"
    parts = '[fluid]\nmodel = "carreau"\nrelaxation_time = "1 ms +- 0.2 ms"\nexponent = "0.5 +- 10 %"\n[solid]\n'
    path.write_text(case_text({}) + "\n" + parts + 'layer_thickness = { value = "2 mm", error = "5 %" }\n')
    case = sb.load_case(path)
    assert case.errors == pytest.approx({"relaxation_time": 0.2, "exponent": 0.1, "layer_thickness": 0.05})
    assert (case.contact.relaxation_time, case.contact.exponent, case.contact.layer_thickness) == (1e-3, 0.5, 2e-3)
    path.write_text(case_text({}) + "\n" + parts.replace("0.2 ms", "x ms") + 'layer_thickness = "2 mm"\n')
    with pytest.raises(sb.InputError, match=r"\[fluid\] .*relaxation_time"):
        sb.load_case(path)


@pytest.mark.usefixtures("no_margins")
def test_a_report_names_fluid_and_solid_with_their_errors_and_a_load_among_its_levers_has_its_force(tmp_path):
    """In a full film more load lowers the coefficient, and raises the force."""
    path = tmp_path / "case.toml"
    contact = {
        "load": '"30 N/m"  # scales',
        "speed": None,
        "entrainment_speed": '"0.5 m/s"# the mean',
        "alpha": "2.0 # theory",
        "viscosity": None,
        "kinematic_viscosity": '"50 cSt" # sheet',
        "density": '"1000 kg/m^3"',
    }
    others = {
        "check": {"stroke": '"20 mm" # crank', "density": "870 # another"},
        "solid": {"layer_thickness": '"2 mm +- 5 %"'},
    }
    path.write_text(case_text(contact, **others))
    sections = {each.heading: each for each in sb.write_report(path, tmp_path / "report.html").sections}
    _, value, error, _ = sections["Inputs"].table[-1]
    assert "fluid newtonian, solid bonded layer, layer thickness 2 mm" in value
    assert error == "thickness of the layer ± 5 %"
    # Comments behind a text were not seen, and a mean speed was the source of the sum of both.
    assert {row[0]: row[-1] for row in sections["Inputs"].table[1:] if row[-1]} == {
        "load": "scales",
        "contact-law alpha": "theory",
        "speed": "entrainment_speed = 0.5 m/s: the mean",
        "viscosity": "kinematic_viscosity = 50 cSt: sheet",
    }
    [said] = [friction for name, _, friction in sections["The two cheapest levers"].table if name == "load"]
    assert said == "0.244 (-20 %; the force +5 %)"


RING = {
    "viscosity": 0.04, "speed": 0.1, "roughness": 1e-6, "alpha": 2.0, "beta": 0.06, "boundary_friction": 0.3,
    "radius": 1.765e-3, "youngs_modulus": 5.5e6, "poisson_ratio": 0.5,
}  # fmt: skip


@pytest.mark.quick
def test_the_squeeze_of_an_o_ring_gives_its_load(subtests):
    """Lindley's formula at 10, 20 and 30 %: 0.0396, 0.115 and 0.242 times E d."""
    for squeeze, ratio in ((0.1, 0.0396), (0.2, 0.115), (0.3, 0.242)):
        assert sb.LineContact(**RING, squeeze=squeeze).load == pytest.approx(ratio * 5.5e6 * 3.53e-3, rel=0.01)
    for changed, words in (
        ({"squeeze": 0.4}, "between 0 and 0.3"),
        ({"squeeze": 0.1, "load": 700.0}, "give either load, or squeeze"),
        ({"squeeze": 0.1, "radius": None}, "radius is missing beside squeeze = 0.1"),
        ({"squeeze": 0.1, "youngs_modulus": None, "poisson_ratio": None, "modulus": 7e6}, "youngs_modulus is missing beside"),
    ):
        with subtests.test(words=words), pytest.raises(sb.InputError, match=words):
            sb.LineContact(**{name: value for name, value in (RING | changed).items() if value is not None})


@pytest.mark.quick
def test_a_sealed_pressure_adds_its_force_on_the_width_of_the_contact(subtests):
    alone = sb.LineContact(**RING, squeeze=0.1)
    for pressure in (0.0, 1e5, 1e6):
        pressed = sb.LineContact(**RING, squeeze=0.1, sealed_pressure=pressure)
        assert pressed.load - 2 * pressed.hertz.half_width * pressure == pytest.approx(alone.load, rel=1e-12)
    with pytest.raises(sb.InputError, match="sealed_pressure is given without load"):
        sb.LineContact(**RING, sealed_pressure=1e6)
    without = {name: value for name, value in RING.items() if name != "radius"}
    with pytest.raises(sb.InputError, match="radius is missing beside sealed_pressure"):
        shape = sb.profiles.Lip(angle_oil="20 deg", angle_air="10 deg", tip_radius="0.8 mm")
        sb.LineContact(**without, load=500, sealed_pressure=1e6, profile=shape)


SEALS = ["shaft", pytest.param("o-ring", marks=pytest.mark.slow), pytest.param("u-cup", marks=pytest.mark.slow)]


@pytest.mark.parametrize("seal", SEALS)
def test_a_new_case_of_a_seal_is_solved_and_in_no_doubt(tmp_path, seal):
    path = tmp_path / "seal.toml"
    path.write_text(sb.new_case(seal=seal))
    contact = sb.load_case(path).contact
    assert sb.check(contact).headline.startswith("The model applies: all")
    assert 0.001 < sb.solve(contact, rtol=1e-3).friction().total < 0.3


def test_a_new_case_of_a_seal_names_what_there_is():
    with pytest.raises(sb.InputError, match="seal = 'gasket'; it must be one of o-ring, u-cup, shaft"):
        sb.new_case(seal="gasket")
    with pytest.raises(sb.InputError, match="a seal is a line contact"):
        sb.new_case("point", seal="shaft")


@pytest.mark.slow
def test_the_interval_is_the_one_that_solved_samples_confirmed():
    """Read once more between all samples, with nothing to check it, the share of the asperities had 0.59 as its lower end."""
    seal = sb.load_case(EXAMPLES / "lip_seal.toml").contact.replace(speed=5e-6)
    found = sb.propagate(seal, {"beta": 0.29, "modulus": 0.33}, transitions=False)
    assert not found.notes
    assert found["contact_load_share"].interval_95[0] == pytest.approx(0.76, abs=0.06)  # of 330 samples, each solved


@pytest.mark.usefixtures("no_margins")
def test_usual_errors_stand_in_for_those_that_nobody_gives(tmp_path, capsys):
    path = tmp_path / "case.toml"
    path.write_text('uncertainty = "typical"\n' + case_text({"load": '"50 N/m +- 1 %"'}))
    case = sb.load_case(path)
    assert case.errors["load"] == pytest.approx(0.01) and case.errors["beta"] == 0.3 and "speed" not in case.errors
    assert "load" not in case.conversions[-1] and "contact-law beta 30 %" in case.conversions[-1]
    found = sb.propagate(TRUE, "typical", transitions=False)
    assert found.errors.keys() == {*case.errors} and f"errors of {len(case.errors)} inputs" in found.probability_sentence
    given = sb.propagate(TRUE, {"beta": 0.3}, transitions=False)
    assert given.errors == pytest.approx({"beta": 0.3})  # so that propagating these gives the same
    assert found["friction"].interval_95[1] > given["friction"].interval_95[1]
    spectrum = sb.surfaces.SelfAffine(h_rms=1e-6, q0=4e4, q1=4e6, hurst=0.8)
    rough = TRUE.replace(law=sb.surfaces.persson_law(spectrum))
    assert "beta" not in sb.propagate(rough, "typical", transitions=False).errors  # it follows the roughness
    path.write_text('uncertainty = "large"\n' + case_text({}))
    with pytest.raises(sb.InputError, match="uncertainty = 'large'"):
        sb.load_case(path)
    path.write_text(case_text({}))
    assert 'uncertainty = "typical" at the top' in call(capsys, "regimes", path).out


def test_films_at_rest_have_the_errors_of_their_inputs_and_friction_that_of_asperities():
    contact = TRUE.replace(speed=0.0)
    found = sb.propagate(contact, {"roughness": 0.05, "boundary_friction": 0.1}, transitions=False)
    ends = [contact.replace(roughness=contact.roughness * math.exp(end)) for end in (-0.05, 0.05)]
    low, high = (sb.solve(each).central_gap * each.hertz.indentation for each in ends)
    assert found["central_film_thickness"].interval_68 == pytest.approx((low, high), rel=0.02)
    assert found["friction"].interval_68 == pytest.approx((0.7 * math.exp(-0.1), 0.7 * math.exp(0.1)), rel=0.02)
    assert found.to_si()["friction"] == pytest.approx(TRUE.boundary_friction)
    assert found["friction"].label == "friction coefficient, balanced" and found.to_dict()["definition"] == "balanced"
    # Under an exponential law a film at rest passes through zero.
    ball = sb.PointContact.from_groups(
        sb.Groups(0.0, 0.3, 5e-4, geometry="point"), radius=5e-3, modulus=1e6, viscosity=0.01, alpha=2.0, beta=0.3,
        boundary_friction=0.5,
    )  # fmt: skip
    ends = [ball.replace(beta=ball.beta * math.exp(end * math.sqrt(math.log(2)))) for end in (-1.96, 1.96)]
    low, high = (float(sb.solve(each).central_gap) * each.hertz.indentation for each in ends)
    assert low < 0 < high
    assert sb.propagate(ball, {"beta": 1.0})["central_film_thickness"].interval_95 == pytest.approx((low, high), rel=0.05)
