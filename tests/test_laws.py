"""Any contact law: its derivatives, what the equations make of it, user's laws, and the law in every part of the package."""

import math
import pickle
from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from command_line import case_text
from fit_data import TRUE
from scipy.integrate import quad_vec

import stribeck as sb
from stribeck.numerics.dual import with_slope

GreenwoodTripp, TableLaw = sb.contact_laws.GreenwoodTripp, sb.contact_laws.TableLaw

EXPONENTIAL = sb.contact_laws.FunctionLaw(lambda s: -s, lowest=-math.inf)
"""The exponential law by the way of any other."""


@cache
def laws():
    s = np.linspace(0.05, 6.0, 40)
    return {
        "persson": sb.surfaces.persson_law(sb.surfaces.SelfAffine(h_rms=1e-6, q0=1e4, q1=1e9, hurst=0.8)),
        "greenwood-williamson": sb.contact_laws.GreenwoodWilliamson(),
        "greenwood-tripp": GreenwoodTripp(),
        "table": TableLaw(s, np.exp(-s) + 0.3 * np.exp(-3 * s)),
        "function": sb.contact_laws.FunctionLaw(lambda s: -s - np.log(s)),
    }


# --- derivatives ---


@pytest.mark.quick
def test_the_slope_of_a_shape_is_its_derivative(subtests):
    s = np.concatenate([np.linspace(0.06, 5.9, 50), [8.0, 30.0]])
    step = 1e-4 * s
    for name, shape in laws().items():
        with subtests.test(name):
            difference = (shape.log_pressure(s + step) - shape.log_pressure(s - step)) / (2 * step)
            slope = with_slope(shape.log_pressure, s)[1]
            assert np.abs(slope / difference - 1).max() < 1e-6
            assert (slope < 0).all()


# --- limits ---


def test_the_exponential_law_by_the_way_of_others_is_the_exponential_law(subtests):
    for groups in [sb.Groups(1e-5, 0.1, 1e-3), sb.Groups(0.0, 2.0, 0.02), sb.Groups(1e-3, 3.0, 0.03)]:
        with subtests.test(groups=groups):
            one, other = (sb.solve(groups, rtol=1e-9, law=law) for law in (None, EXPONENTIAL))
            for name in ("contact_load_share", "central_gap", "minimum_gap", "offset", "flux_gap"):
                assert getattr(other, name) == pytest.approx(getattr(one, name), rel=3e-9, nan_ok=True), name
            assert (one.law, other.law) == ("exponential", "function")


@pytest.mark.quick
def test_a_table_of_persson_goes_where_persson_goes():
    persson = laws()["persson"]
    s = np.geomspace(1e-3, 12, 200)
    table = TableLaw(s, np.exp(persson.log_pressure(s)))
    groups = sb.Groups(1e-6, 3.0, 0.03)
    assert sb.solve(groups, law=table).central_gap == pytest.approx(sb.solve(groups, law=persson).central_gap, rel=1e-5)


@pytest.mark.quick
def test_under_perssons_law_the_gap_is_positive_at_rest_at_any_load(subtests):
    for load in [0.1, 1.0, 10.0, 100.0]:
        with subtests.test(load=load):
            s = sb.solve(sb.Groups(0.0, load, 0.01 * load), law=laws()["persson"])
            assert s.minimum_gap > 0
            assert s.contact_load_share == pytest.approx(1.0, abs=1e-9)
            if load > 1:
                assert sb.solve(sb.Groups(0.0, load, 0.01 * load)).minimum_gap < 0


def test_at_rest_no_pressure_is_lost_where_gaps_are_negative():
    # States at rest are found by a shift, which is no part of the answer: a law shifted by hand gives the same, shifted.
    law = GreenwoodTripp()
    shifted = sb.contact_laws.FunctionLaw(lambda s: law.log_pressure(s - 4.0), lowest=-math.inf)
    groups = sb.Groups(0.0, 5.0, 0.05)
    one, other = (sb.solve(groups, rtol=1e-8, law=each) for each in (law, shifted))
    assert one.central_gap < 0 < other.central_gap
    assert one.central_gap + 4.0 * 0.01 == pytest.approx(other.central_gap, rel=1e-7)
    peak = float(one.profile([0.0]).contact_pressure[0])
    by_law = math.exp(float(law.log_pressure(np.array([one.central_separation]))[0])) / math.sqrt(5.0)
    assert peak == pytest.approx(by_law, rel=1e-5)


def test_the_virial_of_the_line_holds_for_every_law(subtests):
    """theory.md Eq. (7) before the exponential law is put in: int x**2 p = pi/8 + int P dx with P' = -p, P(inf) = 0."""
    for name, shape in laws().items():
        with subtests.test(name):
            s = sb.solve(sb.Groups(0.0, 0.4, 0.4 * 0.05), law=shape, rtol=1e-9, on_failure="return")
            inner = np.abs(s.mesh.nodes) < 3
            x, w, p = s.mesh.nodes[inner], s.mesh.weights[inner], s.nodal_pressures()[0][inner]

            def pressure(above, gaps=(s.nodal_gap + s.gap_shift)[inner], shape=shape):
                return np.exp(shape.log_pressure((gaps + above) / 0.05)) / math.sqrt(0.4)

            integral, _ = quad_vec(pressure, 0, 40 * 0.05, epsrel=1e-10)
            assert w @ (x**2 * p) == pytest.approx(math.pi / 8 + w @ integral, rel=1e-6)


# --- the law in every part ---


def test_a_contact_and_its_groups_carry_the_law_through_copies():
    contact = TRUE.replace(law=GreenwoodTripp(), alpha=1.0)
    assert contact.groups.law == contact.replace(load=3.0).groups.law == GreenwoodTripp()
    assert contact != TRUE
    assert contact.groups != TRUE.groups
    assert pickle.loads(pickle.dumps(contact)) == contact
    assert "GreenwoodTripp()" in repr(contact.groups)
    assert "law" not in repr(TRUE.groups)


@pytest.mark.quick
def test_what_is_no_law_is_refused(subtests):
    for law in ["persson ", 3, GreenwoodTripp]:
        with subtests.test(law=law), pytest.raises(sb.InputError, match="^law = "):
            sb.solve(sb.Groups(1e-3, 0.1, 1e-3), law=law)


def test_a_curve_follows_any_law_and_names_it(subtests):
    for name, shape in laws().items():
        with subtests.test(name):
            curve = sb.stribeck_curve(load=0.3, roughness=0.006, speed=(1e-2, 1.0), points=3, law=shape, beta=0.05)
            assert curve.outcome.ok and len(curve) == 3
            assert curve.law is shape
            middle = sb.solve(curve.solutions[1].groups, rtol=1e-8)
            assert middle.law == shape.name
            assert curve.friction[1] == pytest.approx(middle.friction(1.0, 0.05).total, rel=1e-5)
            assert curve.minimum is not None
            data = curve.to_dataset()
            assert data.attrs["contact_law"] == shape.name
            assert {f"contact_law_{each}" for each in shape.parameters} <= set(data.attrs)


def test_a_phase_diagram_is_made_with_a_law():
    found = sb.phase_diagram(load=0.3, roughness=0.003, speed=[0.0, 1e-6, 1e-2], law=laws()["persson"])
    assert found.attrs["contact_law"] == "persson"
    assert (found["outcome"] == "CONVERGED").all()
    assert np.isnan(found["formula_speed_at_half_fluid"]).all()
    speed = float(found["speed_at_half_fluid"][0, 0])
    state = sb.solve(sb.Groups(speed, 0.3, 0.003, law=laws()["persson"]))
    assert state.fluid_load_share == pytest.approx(0.5, abs=1e-5)


def test_atlas_and_formulas_refuse_another_law_in_one_sentence():
    groups = sb.Groups(1e-5, 0.1, 1e-4, law=sb.contact_laws.GreenwoodWilliamson())
    with pytest.raises(
        sb.InputError, match="exponential and persson contact law, not of greenwood-williamson; use the solver"
    ):
        sb.atlas.friction(groups)
    with pytest.raises(sb.InputError, match="and persson contact law, not of greenwood-williamson"):
        sb.stribeck_curve(groups, speed=(1e-5, 1e-3), points=3, method="atlas")
    with pytest.raises(sb.InputError, match="exponential contact law, not for greenwood-williamson; use solve"):
        sb.asymptotics.boundary.gap(groups, 0.0)
    smooth = sb.asymptotics.hydrodynamic.friction
    assert smooth(groups) == smooth(replace(groups, law=None))


# --- real contact ---


def test_the_real_area_is_that_of_perssons_theory_and_only_where_a_spectrum_is_known():
    persson = laws()["persson"]
    s = sb.solve(sb.Groups(1e-6, 0.5, 5e-3), law=persson)
    w = math.sqrt(2) / persson.rms_slope
    pressure = float(s.profile([0.0]).contact_pressure[0]) * math.sqrt(0.5) * persson.beta
    assert s.central_area_fraction == pytest.approx(math.erf(w * pressure), rel=1e-5)
    assert s.area_fraction.max() == pytest.approx(s.central_area_fraction, rel=1e-2)
    assert s.area_fraction.shape == s.x.shape
    finer = sb.solve(sb.Groups(1e-6, 0.5, 5e-3), law=persson, rtol=1e-9)
    assert abs(s.central_area_fraction - finer.central_area_fraction) <= s.central_area_fraction_error
    assert s.to_dict()["central_area_fraction"] == s.central_area_fraction
    bare = sb.solve(sb.Groups(1e-6, 0.5, 5e-3))
    assert bare.area_fraction is None and math.isnan(bare.central_area_fraction)
    assert "central_area_fraction" not in bare.to_dict()


def exponential_law_of_a_surface(tmp_path):
    path = tmp_path / "case.toml"
    surface = {"h_rms": '"1 um"', "hurst": "0.8", "longest_wavelength": '"300 um"', "shortest_wavelength": '"0.3 um"'}
    path.write_text(case_text({"alpha": None, "beta": None, "roughness": None}, surface=surface))
    return sb.load_case(path).contact.law


def test_the_exponential_law_of_a_known_surface_has_an_area_and_the_same_states(tmp_path):
    groups, law = sb.Groups(1e-6, 0.1, 1e-3), exponential_law_of_a_surface(tmp_path)
    with_area, bare = sb.solve(groups, law=law), sb.solve(groups)
    assert with_area.central_gap == bare.central_gap
    assert with_area.law == "exponential"
    persson = sb.surfaces.persson_law(
        sb.surfaces.SelfAffine(h_rms=1e-6, q0=2 * math.pi / 300e-6, q1=2 * math.pi / 0.3e-6, hurst=0.8)
    )
    expected = math.erf(persson.area_slope * math.exp(-with_area.central_separation))
    assert with_area.central_area_fraction == pytest.approx(expected, rel=1e-9)
    assert sb.atlas.friction(with_area.groups) == sb.atlas.friction(groups)


def test_a_state_pressed_to_near_full_contact_says_that_no_fluid_passes():
    heavy = sb.solve(sb.Groups(0.0, 100.0, 1.0), law=laws()["persson"])
    assert any("real contact" in note and "outside its range" in note for note in heavy.notes)
    assert sb.solve(sb.Groups(1e-4, 0.1, 1e-3), law=laws()["persson"]).notes == ()


# --- tables and functions of a user ---

S = [0.0, 1.0, 2.0, 3.0, 4.0, 6.0]
P = [1.0, 0.4, 0.15, 0.05, 0.02, 0.002]


@pytest.mark.quick
def test_a_table_that_is_no_law_is_refused_with_its_row(subtests):
    for s, p, sentence in [
        (S, P[:-1], "separation has 6 rows and pressure 5"),
        (S[:3], P[:3], "has 3 rows; at least 4"),
        ([0.0, 1.0, 1.0, 3.0], P[:4], "row 3 of the contact law's table: separation 1 must exceed that of the row before, 1"),
        (S[:4], [1.0, 0.4, 0.5, 0.05], "row 3 of the contact law's table: pressure 0.5 must be below that of the row before"),
        (S[:4], [1.0, 0.4, 0.0, -1], "row 3 of the contact law's table: pressure 0 must be positive"),
        (S[:4], [1.0, math.nan, 0.1, 0.05], "row 2 of the contact law's table, 1 and nan, is not finite"),
        (S[:4], "abcd", "^pressure = 'abcd' is not made of real numbers"),
        (S[:4], [1.0, 0.5, "0.4", 0.05], "^pressure = .* is not made of real numbers"),
        (S[:4], 1.0, "^pressure = 1.0; it must be a list of numbers"),
    ]:
        with subtests.test(s=s, p=p, sentence=sentence), pytest.raises(sb.InputError, match=sentence):
            TableLaw(s, p)


@pytest.mark.quick
def test_a_table_is_met_and_falls_between_its_rows(subtests):
    for rows, degree in [(S, 5), (S[:4], 3), ([0.0, 0.1, 2.0, 2.1, 4.0, 4.1], 1)]:
        with subtests.test(rows=rows, degree=degree):
            law = TableLaw(rows, P[: len(rows)])
            assert law.degree == degree
            assert np.exp(law.log_pressure(np.array(rows))) == pytest.approx(P[: len(rows)], rel=1e-12)
            s = np.linspace(-2, 9, 2000)
            assert (with_slope(law.log_pressure, s)[1] < 0).all()
            assert (np.diff(law.log_pressure(s)) < 0).all()


@pytest.mark.quick
def test_a_table_that_is_flat_at_its_ends_still_falls_there():
    # The cubics that are monotone between these rows would be level at both ends, and so would all beyond.
    law = TableLaw([0.0, 1.0, 2.0, 3.0], np.exp([0.0, -0.1, -5.0, -5.1]))
    assert law.degree == 1
    assert (with_slope(law.log_pressure, [-1.0, 0.0, 3.0, 9.0])[1] < -0.05).all()


@pytest.mark.quick
def test_a_table_goes_on_straight_with_the_slope_of_its_end(subtests):
    for end in [0, -1]:
        with subtests.test(end=end):
            law = TableLaw(S, P)
            row = S[end]
            beyond = row + (np.array([-3.0, -0.5]) if end == 0 else np.array([0.5, 3.0]))
            at_row, slope = map(float, with_slope(law.log_pressure, row))
            assert law.log_pressure(beyond) == pytest.approx(at_row + slope * (beyond - row), rel=1e-12)
            assert with_slope(law.log_pressure, beyond)[1] == pytest.approx(slope, rel=1e-12)
            step = 1e-6
            inside = row + (step if end == 0 else -step)
            assert slope == pytest.approx((float(law.log_pressure(np.array(inside))) - at_row) / (inside - row), rel=1e-4)
            # The slopes of the two ends differ, so that one in the other's place is seen.
            assert abs(float(with_slope(law.log_pressure, S[0] + S[-1] - row)[1]) / slope - 1) > 0.01


def test_a_state_outside_the_rows_of_its_table_says_so():
    below = sb.solve(sb.Groups(1e-6, 0.9, 9e-3), law=TableLaw([0.5, 1, 2, 3, 9], np.exp([-0.5, -1, -2, -3, -9])))
    assert any("below the first row" in note for note in below.notes)
    short = sb.solve(sb.Groups(1e-6, 0.1, 1e-3), law=TableLaw(S[:4], P[:4]))
    assert any("still has" in note for note in short.notes)
    inside = sb.solve(sb.Groups(1e-5, 0.01, 1e-4), law=TableLaw(np.linspace(0, 12, 25), np.exp(-np.linspace(0, 12, 25))))
    assert inside.notes == ()


@pytest.mark.quick
def test_functions_that_are_no_law_are_refused(subtests):
    for f, slope, sentence in [
        (lambda s: -s, lambda s: -2 * np.ones_like(s), "^the slope of log_pressure is -2 at separation 0.001; finite differ"),
        (lambda s: s, lambda s: np.ones_like(s), "^the slope of log_pressure is 1 at separation 0.001; it must be negative"),
        (lambda s: s, None, "^the slope of log_pressure is 1 at separation 0.001; it must be negative"),
        (lambda s: np.log(5 - s), None, "^log_pressure is nan at separation 5.*; it must be finite"),
        (lambda s: "x", lambda s: -s, "^log_pressure must return a number"),
        (lambda s: -np.interp(s, [0, 200], [0, 100]), None, "^log_pressure must be written with functions of numpy"),
    ]:
        with subtests.test(f=f, slope=slope, sentence=sentence), pytest.raises(sb.InputError, match=sentence):
            sb.contact_laws.FunctionLaw(f, slope)


@pytest.mark.quick
def test_settings_of_a_law_of_functions_are_refused_by_name_and_value(subtests):
    for changed, sentence in [
        ({"name": "exponential"}, "^name = 'exponential' must be a word other than exponential, persson"),
        ({"name": None}, "^name = None must be a word"),
        ({"log_pressure": None}, "^log_pressure = None must be a function"),
        ({"log_slope": 1.0}, "^log_slope = 1.0 must be a function"),
        ({"lowest": math.nan}, "^lowest = nan"),
        ({"lowest": "0"}, "^lowest = '0'"),
        ({"checked": 1.0}, "checked = 1.0; .* two increasing positive separations"),
        ({"checked": (1.0, 2.0, 3.0)}, "checked two increasing positive separations"),
    ]:
        with subtests.test(changed=changed, sentence=sentence):
            given = {"log_pressure": lambda s: -2 * s, "log_slope": lambda s: np.full_like(s, -2.0)}
            with pytest.raises(sb.InputError, match=sentence):
                sb.contact_laws.FunctionLaw(**given | changed)


class Wall:
    """A law that is soft at the separations of a state and steep right below them."""

    name, lowest = "wall", 0.0
    parameters = {}

    def log_pressure(self, s):
        return -s + 1e3 * np.maximum(0.15 - s, 0.0)

    def notes(self, separation):
        return ()


def test_a_law_that_a_user_calls_exponential_is_solved_as_it_is():
    class Steep(Wall):
        name = "exponential"

        def log_pressure(self, s):
            return -2 * s

    groups = sb.Groups(1e-4, 0.1, 1e-2)
    gap = sb.solve(groups, law=Steep()).minimum_gap
    assert gap == pytest.approx(sb.solve(sb.Groups(1e-4, 0.1, 0.5e-2)).minimum_gap, rel=1e-5)


def test_a_file_that_is_no_table_is_refused_with_its_line(subtests, tmp_path):
    for text, sentence in [
        ("", "holds no data; the first line must be 'separation, pressure'"),
        ("0, 1\n1, 0.5\n", "row 1 holds numbers, not names of columns; the first line must be"),
        ("Abstand, Druck\n0, 1\n", "the header is 'Abstand, Druck'"),
        (
            "separation, pressure\n0, 1\n1, 0.5\n2; 0.2\n3, 0.1\n",
            "row 4 has 1 cell where the header has 2: the header is separated by commas and this row by semicolons",
        ),
        ("separation, pressure\n0, 1\n1, x\n2, 0.2\n3, 0.1\n", "row 3, column 'pressure': 'x' is not a number"),
        ("separation, pressure\n0, 1\n1, 0.5, 3\n", "row 3 has 3 cells where the header has 2; use one separator"),
        ("gap [um], pressure [m]\n0, 1\n", "law.csv: column 'pressure .m.': unit = '1 m' is a length"),
        ("gap [um]; pressure [kPa]\n1,000; 9\n2,000; 8\n", "'1,000' in column 'gap .um.' may have marks between thousands"),
        ("gap [um], pressure\n0, 1\n", "the header is 'gap \\[um\\], pressure'"),
        ("separation, pressure\n0, 1\n1, 2\n2, 0.2\n3, 0.1\n", "law.csv: row 3: pressure 2 must be below"),
    ]:
        with subtests.test(text=text, sentence=sentence):
            (tmp_path / "law.csv").write_text(text)
            with pytest.raises(sb.InputError, match=sentence):
                TableLaw.read(tmp_path / "law.csv", alpha=1, beta=1, roughness=1, modulus=1)


def test_a_file_with_units_and_decimal_commas_is_the_law_without(tmp_path):
    (tmp_path / "plain.csv").write_text("# measured\nseparation, pressure\n0, 1\n1, 0.4\n2, 0.15\n4, 0.02\n")
    plain = TableLaw.read(tmp_path / "plain.csv")
    for name in ("Gap", "Separation"):
        (tmp_path / "units.csv").write_text(f"{name} (um); Pressure (kPa)\n0; 200\n0,5; 80\n1; 30\n2; 4\n")
        units = TableLaw.read(tmp_path / "units.csv", alpha=2.0, beta=0.1, roughness=1e-6, modulus=2e6)
        assert units.separation == pytest.approx(plain.separation, abs=1e-14)
        assert units.pressure == pytest.approx(plain.pressure, rel=1e-14)
    with pytest.raises(sb.InputError, match="alpha and modulus of the contact must be given"):
        TableLaw.read(tmp_path / "units.csv", beta=0.1, roughness=1e-6)
    with pytest.raises(sb.InputError, match="cannot be read"):
        TableLaw.read(tmp_path / "none.csv")


# --- what keeps Newton's iteration on the ground ---


def test_a_law_that_is_steep_right_below_a_state_is_solved():
    state = sb.solve(sb.Groups(0.05, 1.0, 0.1), law=Wall(), rtol=1e-4)
    assert state.outcome.ok and state.central_gap > 0.01


def test_formulas_and_atlas_say_for_which_laws_they_hold(tmp_path):
    for law, holds in ((None, True), (exponential_law_of_a_surface(tmp_path), True), (GreenwoodTripp(), False)):
        assert sb.asymptotics.boundary.gap.holds_for(law) is holds
        assert sb.atlas.holds_for(law) is holds
    assert sb.asymptotics.hydrodynamic.friction.holds_for(GreenwoodTripp())  # smooth contacts have no law
