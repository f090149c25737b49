"""Checks: each verdict turns where its limit says, outputs begin with what is outside, and the exit code stays 0."""

import json
import math
import re

import numpy as np
import pytest
from command_line import EXAMPLES, FEW, PDMS, call, case_text
from fit_data import TRUE

import stribeck as sb
from stribeck.cases.case import FACTS, fact_values
from stribeck.checks.subject import Subject, speed_of_film
from stribeck.checks.table import ROWS, checks_of, checks_of_curve, checks_of_solution
from stribeck.contact_laws import FiniteSurface
from stribeck.numerics.dual import with_slope
from stribeck.surfaces import SelfAffine, persson_law

STEEL = sb.LineContact(
    radius="10 mm",
    youngs_modulus="210 GPa",
    poisson_ratio=0.3,
    load="1 kN/m",
    viscosity="40 mPa*s",
    speed="1 m/s",
    roughness="0.3 um",
    alpha=2.0,
    beta=0.02,
    boundary_friction=0.12,
)
ORDER = ["fine", "doubtful", "outside"]


def verdicts(contact, effort="contact", **facts):
    """Return the verdicts by name."""
    return {each.name: each.verdict for each in checks_of(Subject(contact, facts), effort)}


@pytest.mark.quick
def test_a_soft_contact_is_fine_and_steel_is_outside():
    assert set(verdicts(TRUE).values()) == {"fine"}
    found = checks_of(Subject(STEEL), "contact")
    assert found["stiffness"].verdict == "outside" and not found.applies
    assert found.first_line.startswith("Outside the range of the model: ") and "metal" in found.first_line
    assert checks_of(Subject(TRUE), "contact").first_line == ""


@pytest.mark.quick
def test_a_verdict_turns_at_its_limits(subtests):
    for name, fact, values in [
        ("Hertz pressure", "pressure_coefficient", (0.09, 0.11, 1.1)),
        ("layer a/thickness", "layer_thickness", (1 / 0.29, 1 / 0.31, 1 / 1.1)),
        ("loss tangent", "loss_tangent", (0.09, 0.11, 0.31)),
        ("viscous heating", "thermal_thinning", (0.09, 0.11, 1.1)),
        ("rms slope of the roughness", "rms_slope", (0.29, 0.31, 1.1)),
    ]:
        with subtests.test(name=name, fact=fact, values=values):
            scale = {
                "pressure_coefficient": 1 / TRUE.hertz.pressure,
                "layer_thickness": TRUE.hertz.half_width,
                "loss_tangent": 1.0,
                "rms_slope": 1.0,
                "thermal_thinning": 8 * 0.15 / (TRUE.viscosity * TRUE.speed**2),
            }[fact]
            for value, verdict in zip(values, ORDER, strict=True):
                found = checks_of(Subject(TRUE, {fact: value * scale}), "contact")[name]
                assert found.verdict == verdict, value
                ratio = found.limit / found.value if found.at_least else found.value / found.limit
                assert (ratio <= 1 + 1e-12) == (verdict == "fine")


@pytest.mark.quick
def test_only_what_slides_heats_the_film_and_shears_it_faster_than_its_flow():
    found = [checks_of(Subject(TRUE.replace(slide_to_roll=ratio)), "state") for ratio in (2, 0.5, -6)]
    slides, rolls, against = ([each[name].value for name in ("viscous heating", "shear rate")] for each in found)
    assert rolls == pytest.approx([slides[0] / 16, slides[1]])
    assert against == pytest.approx([9 * slides[0], 3 * slides[1]], rel=1e-3)


@pytest.mark.quick
def test_a_limit_says_on_which_side_of_it_values_are_fine():
    centre = "contact law at the centre"
    found = checks_of(Subject(TRUE), "state")
    assert (found["Hertz pressure"].texts[1], found["film against molecules"].texts[1]) == ("up to 5 MPa", "from 10 nm")
    limits = [
        checks_of(Subject(TRUE.replace(load=load, speed=speed)), "state")[centre] for load, speed in ((2000, 0), (30, 1))
    ]
    assert [each.texts[1] for each in limits] == ["from 0.4 h_rms", "always"]
    assert [each.verdict for each in limits] == ["outside", "fine"]


@pytest.mark.quick
def test_an_input_far_from_all_contacts_is_named_with_its_usual_range():
    found = checks_of(Subject(TRUE.replace(roughness="10 mm", boundary_friction=2.9)), "contact")["inputs"]
    assert found.verdict == "doubtful" and found.value == pytest.approx(100)
    assert "roughness 10 mm, usually 1 nm to 100 µm" in found.sentence and "dry friction" not in found.sentence
    small = checks_of(Subject(TRUE.replace(modulus="27 Pa")), "contact")["inputs"]
    assert small.verdict == "doubtful" and "modulus 27 Pa, usually" in small.sentence
    usual = checks_of(Subject(TRUE.replace(speed=0.0, roughness=0.0)), "contact")["inputs"]
    assert (usual.verdict, usual.value) == ("fine", 1)
    for name in ("wiper_blade", "contact_lens", "lip_seal"):
        assert verdicts(sb.load_case(EXAMPLES / f"{name}.toml").contact)["inputs"] == "fine", name


@pytest.mark.quick
def test_the_doubt_about_a_wide_contact_names_the_thickness_of_a_layer_until_it_is_given():
    lens = sb.load_case(EXAMPLES / "contact_lens.toml").contact
    lens = lens.replace(load="20 mN")
    assert "layer_thickness in [solid]" in checks_of(Subject(lens), "contact")["contact width a/R"].sentence
    layered = checks_of(Subject(lens.replace(solid=sb.solids.Layer("0.1 mm"))), "contact")["contact width a/R"].sentence
    assert layered.startswith("The contact is wide") and "layer_thickness" not in layered


def test_a_layer_that_a_body_lies_on_is_part_of_the_model_whatever_else_the_body_does(subtests):
    """That of a viscoelastic body was judged as one that is left out: outside the range of the model."""
    layer = sb.solids.Layer(0.8 * TRUE.hertz.half_width)
    for body in (layer, sb.solids.StandardLinearSolid("10 ms", 3.0, layer), sb.solids.TwoBodies(layer)):
        with subtests.test(body.name):
            contact = TRUE.replace(solid=body)
            found = checks_of(Subject(contact, {"layer_thickness": 2e-3}), "contact")["layer a/thickness"]
            assert found.verdict == "fine" and "part of the model" in found.sentence
            assert found.value == pytest.approx(1.25)
            wide = contact.replace(modulus=1e-2 * TRUE.modulus)
            assert "layer_thickness" not in checks_of(Subject(wide), "contact")["contact width a/R"].sentence


@pytest.mark.quick
def test_the_rms_slope_is_that_of_the_spectrum_behind_the_law():
    spectrum = SelfAffine(h_rms=1e-6, q0=1e5, q1=1e7, hurst=0.8)
    law = persson_law(spectrum)
    exponential = sb.contact_laws.exponential.SpectralExponential(law.area_slope)
    for shape in (law, exponential):
        contact = TRUE.replace(law=shape, **law.coefficients)
        found = checks_of(Subject(contact), "contact")["rms slope of the roughness"]
        assert found.value == pytest.approx(law.rms_slope, rel=1e-12) and found.verdict == "doubtful"
        pressure = contact.modulus * 1e-4
        area = law.area_fraction_at(pressure / (law.beta * contact.modulus))
        assert pressure / area == pytest.approx(contact.modulus * math.sqrt(math.pi / 8) * law.rms_slope, rel=1e-3)
    assert verdicts(TRUE.replace(roughness=0.0))["rms slope of the roughness"] == "fine"
    assert "rms slope of the roughness" not in verdicts(TRUE)


def test_the_film_is_checked_against_supply_molecules_and_thinning():
    state = sb.solve(TRUE, rtol=1e-4)
    minimum, flux = (value * TRUE.hertz.indentation for value in (state.minimum_gap, state.flux_gap))

    def verdict(name, **facts):
        return checks_of(Subject(TRUE, facts, solved=state), "state")[name].verdict

    rate = TRUE.speed / minimum
    assert [verdict("shear rate", thinning_rate=rate * f) for f in (1.1, 0.9, 0.09)] == ORDER
    for viscosity, usual, size in ((TRUE.viscosity, 1e6, 1e-9), (1e-3, 1e9, 3e-10)):  # water thins a thousand times later
        for factor, expected in ((0.9, "fine"), (1.1, "doubtful"), (100, "doubtful")):
            contact = TRUE.replace(viscosity=viscosity, speed=factor * usual * minimum)
            assert checks_of(Subject(contact, solved=state), "state")["shear rate"].verdict == expected
        found = checks_of(Subject(TRUE.replace(viscosity=viscosity), solved=state), "state")["film against molecules"]
        assert found.limit == pytest.approx(10 * size)
    assert [verdict("supply h*/(2 supply)", supply_film=flux * f) for f in (1.1, 0.9, 0.4)] == ORDER
    assert [verdict("film against molecules", molecular_size=minimum / f) for f in (11, 9, 2)] == ORDER


def test_a_short_stroke_is_no_row_of_steady_states():
    def found(half_widths):
        return checks_of(Subject(TRUE, {"stroke": half_widths * TRUE.hertz.half_width}), "contact")["stroke over a"]

    assert [found(length).verdict for length in (1001, 999, 99)] == ORDER
    assert "is not its friction" in found(40).sentence
    assert found(40).value == pytest.approx(40)
    assert "stroke over a" not in verdicts(TRUE)  # unknown: the speed may be steady
    with pytest.raises(sb.InputError, match="stroke"):
        sb.check(TRUE, stroke="-5 mm")


def test_negative_gaps_are_outside_and_gaps_beyond_the_law_doubtful():
    heavy = checks_of(Subject(TRUE.replace(load=600.0, speed="1 um/s")), "state")["contact law at the centre"]
    assert heavy.verdict == "outside" and heavy.value < 0.1 and heavy.limit == 0.4
    thin = checks_of(Subject(TRUE.replace(speed="20 mm/s")), "state")["contact law at the centre"]
    assert thin.verdict == "doubtful" and thin.value > thin.limit == 2


def test_the_tail_of_the_law_moves_the_minimum_of_the_demo_by_a_fifth():
    found = sb.check(sb.load_case(PDMS).contact)
    tail = found["tail of the contact law"]
    assert tail.verdict == "fine" and 0.2 < tail.value < 0.3 and tail.error == tail.value
    assert "at the minimum of friction, speed -19 % and friction -16 %" in tail.sentence
    assert found["contact law at the minimum"].value == pytest.approx(3.55, abs=0.01)
    doubts = "The model applies, with doubts about contact law at the minimum. Largest error stated: 26 %"
    assert found.applies and found.headline.startswith(doubts)
    assert "stribeck check" not in str(found)
    gaussian = TRUE.replace(alpha=1.0, law=sb.contact_laws.GreenwoodTripp())  # its tail is its own
    assert "tail of the contact law" not in verdicts(gaussian, "tail")


@pytest.mark.quick
def test_the_finite_surface_has_the_pressures_of_the_simulation():
    law = persson_law(SelfAffine(h_rms=6e-6, q0=1e4, q1=1e6, hurst=0.8))
    finite = FiniteSurface(law.alpha, law)
    rows = sb.contact_laws.TableLaw.read(EXAMPLES / "gfmd_mean_gap.csv")
    for gap, pressure in list(zip(rows.separation, rows.pressure, strict=True))[-2:]:
        assert law.beta * np.exp(finite.log_pressure(law.alpha * gap)) == pytest.approx(pressure, rel=0.02)
        assert law.beta * np.exp(law.log_pressure(law.alpha * gap)) > 1.4 * pressure
    s = np.linspace(-1, 9, 41)
    for shape in (FiniteSurface(2.0), FiniteSurface(2.0, law)):
        inside = s[s > 0] if shape.base else s
        step = 1e-5
        differences = (shape.log_pressure(inside + step) - shape.log_pressure(inside - step)) / (2 * step)
        assert with_slope(shape.log_pressure, inside)[1] == pytest.approx(differences, rel=1e-6, abs=1e-6)
    with pytest.raises(sb.InputError, match="a tail of its own"):
        FiniteSurface(2.0, sb.contact_laws.GreenwoodTripp())
    with pytest.raises(sb.InputError, match="positive number"):
        FiniteSurface(0)


def test_the_speed_of_a_film_of_a_ball_has_the_viscosity_at_its_rate():
    ball = sb.load_case(EXAMPLES / "pdms_ball.toml").contact
    fluid = sb.fluids.Carreau("1 ms", 0.4)
    speeds = [speed_of_film(each, 3.0) for each in (ball, ball.replace(fluid=fluid))]
    rate = 1e-3 * speeds[1] / (3.0 * ball.roughness)
    assert rate > 10
    assert math.isclose(speeds[1] * (1 + rate**2) ** -0.3, speeds[0], rel_tol=1e-6)


def test_a_curve_without_minimum_and_transition_leaves_the_tail_unchecked_and_says_so():
    contact = sb.load_case(PDMS).contact
    curve = sb.stribeck_curve(contact, speed=("1 nm/s", "2 nm/s"), points=3, rtol=1e-3)
    found = checks_of(Subject(contact, traced=curve))
    assert any(said.startswith("tail of the contact law: friction has no minimum") for said in found.unchecked)


def test_the_checks_of_a_curve_know_the_facts_and_those_over_loads_the_largest():
    curve = sb.stribeck_curve(TRUE, load=("10 N/m", "100 N/m"), points=3, rtol=1e-3)
    found, without = checks_of_curve(curve, {"layer_thickness": 2e-3}), checks_of_curve(curve)
    assert found["Hertz pressure"].value == pytest.approx(TRUE.replace(load=100.0).hertz.pressure)
    names = [{each.name for each in checks.checks} for checks in (found, without)]
    assert names[0] - names[1] == {"layer a/thickness"}


def test_steel_is_said_to_be_outside_before_any_number(tmp_path, capsys):
    case = tmp_path / "lip.toml"
    case.write_text(case_text({name: repr(value) for name, value in STEEL.inputs()}))
    for tokens in (("check", case), ("solve", case), ("curve", case, *FEW[:-1], "2")):
        answer = call(capsys, *tokens)
        assert (answer.code, answer.err) == (0, "")
        assert answer.out.startswith("Outside the range of the model"), tokens
        found = json.loads(call(capsys, *tokens, "--json").out)
        assert found["applies"] is False and answer.out.count("is that of metal") == 1
        assert {each["verdict"] for each in found["checks"]} >= {"fine", "outside"}
        keys = "name value limit verdict sentence unit at_least condition error notable"
        assert set(found["checks"][0]) == set(keys.split())
    assert json.loads(call(capsys, "solve", PDMS, "--json").out)["applies"] is True


@pytest.mark.quick
def test_facts_come_from_the_table_check_and_are_refused_if_impossible(tmp_path):
    case = tmp_path / "case.toml"
    case.write_text(case_text(check={"pressure_coefficient": '"20 1/GPa"', "layer_thickness": '"2 mm"'}))
    assert sb.load_case(case).facts == {"pressure_coefficient": pytest.approx(2e-8), "layer_thickness": 0.002}
    case.write_text(case_text(check={"layer_thickness": '"2 kg"', "layer": "3"}))
    with pytest.raises(sb.InputError, match=r"\[check\] layer_thickness = '2 kg' is a mass") as problem:
        sb.load_case(case)
    assert "[check] layer = 3 is not a known key" in str(problem.value)
    with pytest.raises(sb.InputError, match="did you mean loss_tangent"):
        sb.check(TRUE, loss_tangens=0.1)
    with pytest.raises(sb.InputError, match="give a LineContact"):
        sb.check("case.toml")


def test_every_fact_is_used_and_every_row_says_what_it_misses():
    names = set(FACTS)
    assert {row.missing for row in ROWS if row.missing} <= names
    asked = set()

    class Listening(Subject):
        def fact(self, name):
            asked.add(name)
            return super().fact(name)

    found = checks_of(Listening(TRUE), "state")
    assert asked == names
    assert list(found.missing) == [row.name for row in ROWS if row.missing]
    assert all(each.sentence.endswith(".") and (math.isfinite(each.value) or each.value > 0) for each in found)
    assert "<table>" in found._repr_html_()


def test_what_fluid_cavitation_and_solid_solve_counts_as_fine():
    hot = TRUE.replace(modulus="2 GPa", load="20 kN/m")
    assert verdicts(hot, "contact")["Hertz pressure"] == "doubtful"
    stiffens = hot.replace(fluid=sb.fluids.Barus("20 1/GPa"))
    found = checks_of(Subject(stiffens), "contact")["Hertz pressure"]
    assert found.verdict == "fine" and "is modelled (newtonian + barus)" in found.sentence
    assert Subject(stiffens).fact("pressure_coefficient") == pytest.approx(2e-8)
    layered = TRUE.replace(solid=sb.solids.Layer("0.2 mm", 0.49))
    layer = checks_of(Subject(layered), "contact")["layer a/thickness"]
    assert layer.value == pytest.approx(layered.hertz.half_width / 2e-4) and layer.verdict == "fine"
    breaks = TRUE.replace(cavitation="exit", speed="1 m/s")
    assert "Cavitation is modelled (exit)." in checks_of(Subject(breaks), "state")["suction"].sentence
    thins = TRUE.replace(fluid=sb.fluids.Carreau("1 ms", 0.7))
    assert "Thinning is modelled (carreau)" in checks_of(Subject(thins), "state")["shear rate"].sentence


def test_all_doubts_of_the_answer_stand_in_full_where_everything_is_printed(subtests, capsys, tmp_path):
    """They stood shortened in the answer, and not at all with -v, which left out what is no note of the state."""
    path = tmp_path / "case.toml"
    path.write_text(case_text(check={"loss_tangent": "0.2", "layer_thickness": '"0.5 mm"'}))
    doubtful = [
        each.sentence for each in checks_of(Subject(TRUE, {"loss_tangent": 0.2, "layer_thickness": 5e-4}), "contact").said
    ]
    assert len(doubtful) == 2
    for command in (("solve",), ("curve", *FEW), ("regimes",)):
        with subtests.test(command=command[0]):
            said = call(capsys, command[0], path, *command[1:], "-v").out
            assert [f"Doubtful: {sentence}" for sentence in doubtful] == re.findall(
                r"^Doubtful: The (?:con|loss).*$", said, re.M
            )


# --- inputs, adhesion, pores, the law apart ---


def test_a_slip_of_a_unit_is_said_by_every_command(capsys, tmp_path):
    path = tmp_path / "case.toml"
    path.write_text(case_text({"slide_to_roll": "50.0"}))
    for command, *options in (["solve"], ["curve", *FEW[:-1], "2"], ["check"]):
        answer = call(capsys, command, path, *options)
        assert "slide-to-roll ratio 50 (50 % is 0.5)" in " ".join((answer.out + answer.err).split()), command


def test_unusual_numbers_beside_groups_are_said_too(capsys):
    answer = call(capsys, "solve", "--groups", "1e-5", "0.1", "1e-4", "--boundary-friction", "70", "--slide-to-roll", "50")
    assert answer.code == 0 and "dry friction coefficient 70" in answer.err and "slide-to-roll ratio 50" in answer.err
    assert call(capsys, "solve", "--groups", "1e-5", "0.1", "1e-4", "--boundary-friction", "0.7").err == ""


GEL = sb.PointContact(
    radius="7.5 mm",
    modulus="10 kPa",
    load="5 mN",
    viscosity="1 mPa*s",
    speed="1 mm/s",
    roughness="0.1 um",
    alpha=2.0,
    beta=0.01,
    boundary_friction=0.1,
)


def quick(contact, **facts):
    return checks_of(Subject(contact, fact_values(facts)), "contact")


def test_what_the_model_leaves_out_of_gels_is_named_unless_it_is_given():
    found = quick(GEL)
    assert found.headline.startswith("The model applies if adhesion is small and no liquid flows in pores")
    assert found.applies and {"adhesion", "pores"} <= {each.name for each in found.with_verdict("doubtful")}
    assert "adhesion" not in {each.name for each in quick(TRUE)}
    known = quick(GEL, work_of_adhesion="1e-6 J/m^2", diffusivity="1e-3 m^2/s")
    assert (known["adhesion"].verdict, known["pores"].verdict) == ("fine", "fine")


def test_adhesion_is_judged_by_the_pull_off_force_of_jkr():
    ball = GEL.replace(radius="5 mm", modulus="2.667 MPa", load="1.1781 mN")
    assert quick(ball, work_of_adhesion="50 mJ/m^2")["adhesion"].value == pytest.approx(1.0, rel=1e-4)
    # A cylinder: the largest tension of F(a) = pi E* a^2/(4 R) - (2 pi E* w a)^(1/2).
    E, R, w = TRUE.modulus, TRUE.radius, 0.05
    a = np.linspace(1e-6, 1e-3, 200_000)
    pull_off = -(math.pi * E * a**2 / (4 * R) - np.sqrt(2 * math.pi * E * w * a)).min()
    assert quick(TRUE, work_of_adhesion=w)["adhesion"].value == pytest.approx(pull_off / TRUE.load, rel=1e-6)
    assert quick(TRUE.replace(load=1e-2), work_of_adhesion=w)["adhesion"].verdict == "outside"


def test_cartilage_is_outside_for_its_pores():
    cartilage = GEL.replace(radius="3.2 mm", modulus="1 MPa", load="50 mN", speed="1 mm/s", roughness="0.5 um")
    found = quick(cartilage, permeability="1e-18 m^2")
    assert found["pores"].verdict == "outside" and not found.applies
    assert "pores" in found.headline and "liquid in the pores" in found.first_line
    by_diffusivity = quick(cartilage, diffusivity=1e-18 * 1e6 / 1e-3)["pores"]
    assert by_diffusivity.value == pytest.approx(found["pores"].value)


def test_the_model_and_the_contact_law_are_judged_apart():
    pressed = TRUE.replace(load="3 kN/m", modulus="27 MPa")
    found = checks_of(Subject(pressed), "state")
    assert {each.name for each in found.with_verdict("outside")} == {"contact law at the centre"}
    assert found.headline.startswith("The model applies, with another law") and found.applies_with_another_law
    assert not found.applies and "Persson's law" in found.first_line


def test_a_case_of_a_ball_has_the_points_and_the_tolerance_of_balls(tmp_path):
    path = tmp_path / "ball.toml"
    path.write_text(case_text({"geometry": '"point"', "load": '"1 N"'}))
    ball = sb.load_case(path)
    path.write_text(sb.new_case("point"))
    template = sb.load_case(path)
    assert (ball.curve.points, ball.rtol) == (template.curve.points, template.rtol) == (31, 1e-4)
    assert (template.law, template.contact.law.name) == ("persson", "persson")
    path.write_text(case_text())
    assert (sb.load_case(path).curve.points, sb.load_case(path).rtol) == (101, 1e-6)


# --- one source of each limit: what a note doubts, a check doubts ---

# Notes that say how a state was found or what a number means, and not that the model leaves its range.
ABOUT_NUMBERS = ("Rounding in double precision", "The gap is negative, so no fluid passes", "Speed and roughness are zero")

OUT_OF_RANGE = {
    "gap below the range of the exponential law": TRUE.replace(load=600.0, speed="1 um/s"),
    "gap above the range of the exponential law": TRUE.replace(speed="20 mm/s"),
    "asperities below their mean plane": TRUE.replace(
        alpha=1.0, beta=1e-3, law=sb.contact_laws.GreenwoodWilliamson(), load=300.0, speed=0.0
    ),
    "wide contact": TRUE.replace(modulus="100 kPa", load="500 N/m"),
    "hard contact": STEEL,
    "suction of more than an atmosphere": TRUE.replace(modulus="20 MPa", load="1 kN/m", speed="1 m/s", viscosity=0.3),
    "cavity far below ambient": TRUE.replace(
        modulus="20 MPa", load="1 kN/m", speed="1 m/s", viscosity=0.3, cavitation="reform", cavity_pressure=-1.5e5
    ),
    "surfaces nearer than the fits of flow factors": TRUE.replace(
        flow_factors=sb.fluids.PatirCheng(gamma=1.0), speed="10 um/s"
    ),
    "drag of a power law far outside": TRUE.replace(fluid=sb.fluids.PowerLaw("1 ms", 0.6), speed="50 mm/s"),
}


def without_numbers(text):
    """Return a sentence without its numbers."""
    return re.sub(r"[-+]?[0-9][-+.0-9e]*", "", text)


def undoubted(notes, checks):
    """Return the notes on the range of the model that no check in doubt repeats."""
    doubts = [without_numbers(each.sentence) for each in checks if each.verdict != "fine"]
    ranges = [note for note in notes if not note.startswith(ABOUT_NUMBERS)]
    assert ranges
    return [note for note in ranges if not any(without_numbers(note)[:40] in doubt for doubt in doubts)]


BALL = sb.load_case(EXAMPLES / "pdms_ball.toml").contact

OUT_OF_RANGE_BALLS = {
    "thick film": BALL.replace(roughness=0.0, speed="30 m/s", viscosity="10 Pa*s"),
    "small disc of liquid": BALL.replace(wetted_radius=3 * BALL.hertz.half_width),
}


ALL_OUT_OF_RANGE = OUT_OF_RANGE | OUT_OF_RANGE_BALLS


def test_what_a_note_of_a_state_doubts_a_check_doubts(subtests):
    for contact in ALL_OUT_OF_RANGE.values():
        with subtests.test(contact=contact):
            state = sb.solve(contact, rtol=1e-3)
            assert undoubted(state.notes, checks_of_solution(state)) == []


def test_what_a_note_of_a_curve_doubts_its_checks_doubt():
    contact = sb.load_case(PDMS).contact
    curve = sb.stribeck_curve(contact, rtol=1e-4)
    assert undoubted(curve.minimum_notes, sb.check(contact)) == []
    part = sb.stribeck_curve(contact, speed=("1 um/s", "20 mm/s"), points=3, rtol=1e-3)
    for each in (curve, part):
        found = checks_of_curve(each)
        assert each.law_in_doubt.any() and any(check.of_law and check.verdict == "doubtful" for check in found)


# By the name of a check a contact that is outside it, with the facts that show it.
OUTSIDE = {
    "Hertz pressure": (STEEL, {}),
    "stiffness": (STEEL, {}),
    "contact width a/R": (TRUE.replace(modulus="100 kPa", load="500 N/m"), {}),
    "shape": (TRUE.replace(profile=sb.profiles.Lip(0.8, 0.8, 1e-4), load="1 kN/m"), {}),
    "adhesion": (TRUE, {"work_of_adhesion": 100.0}),
    "pores": (TRUE, {"diffusivity": 1e-9}),
    "layer a/thickness": (TRUE, {"layer_thickness": 1e-6}),
    "loss tangent": (TRUE, {"loss_tangent": 1.0}),
    "rms slope of the roughness": (TRUE, {"rms_slope": 2.0}),
    "stroke over a": (TRUE, {"stroke": 1e-3}),
    "viscous heating": (TRUE, {"thermal_thinning": 1e9}),
    "contact law at the centre": (TRUE.replace(load=600.0, speed="1 um/s"), {}),
    "shear rate": (TRUE, {"thinning_rate": 1.0}),
    "supply h*/(2 supply)": (TRUE, {"supply_film": 1e-9}),
    "film against molecules": (TRUE, {"molecular_size": 1e-3}),
    "inertia": (TRUE, {"density": 1e12}),
}
OF_STATES = list(OUTSIDE)[list(OUTSIDE).index("contact law at the centre") :]
HELP = re.compile(
    r"FEBio|Tamaas|OpenFOAM|GaPFlow|LAMMPS|\[solid\]|\[fluid\]|stribeck stroke|Persson's law|[Gg]ive the viscosity"
)


def test_a_check_that_is_outside_names_what_helps(subtests):
    state = sb.solve(TRUE, rtol=1e-4)
    for name, (contact, facts) in OUTSIDE.items():
        with subtests.test(name=name):
            effort = "state" if name in OF_STATES else "contact"
            found = checks_of(Subject(contact, facts, solved=state if contact is TRUE else None), effort)[name]
            assert found.verdict == "outside" and HELP.search(found.sentence), found.sentence
    fine = checks_of(Subject(TRUE, {"stroke": 10.0, "loss_tangent": 0.01, "layer_thickness": 1.0}), "contact")
    assert not any(HELP.search(each.sentence) for each in fine)
    doubtful = checks_of(Subject(TRUE, {"stroke": 500 * TRUE.hertz.half_width, "work_of_adhesion": 0.3}), "contact")
    assert "stribeck stroke" in doubtful["stroke over a"].sentence  # solved here
    assert doubtful["adhesion"].verdict == "doubtful" and "Tamaas" not in doubtful["adhesion"].sentence
    ball = checks_of(Subject(GEL, {"stroke": 1e-6}), "contact")["stroke over a"]
    assert "GaPFlow" in ball.sentence and "stribeck stroke" not in ball.sentence
