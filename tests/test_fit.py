"""Fits of measured friction: exact on exact data, honest about what data do not say, and never silent about convergence."""

import itertools
import json
import math
import pickle
import re

import numpy as np
import pytest
from command_line import call, fit_settings
from fit_data import EXAMPLES, TRUE, exact, measured, noisy

import stribeck as sb
from stribeck import FitSettings
from stribeck.surfaces import SelfAffine, persson_law

FREE = ("boundary_friction", "roughness", "modulus", "beta", "alpha", "viscosity", "load", "radius")
START = TRUE.replace(boundary_friction=0.3, roughness="2 um", modulus="1.5 MPa")
NEAR = START.replace(modulus=TRUE.modulus)
MEASURED, CASE = EXAMPLES / "pdms_measured.csv", EXAMPLES / "pdms_fit.toml"


@pytest.fixture(scope="module")
def fitted():
    """Return the fit of one noisy curve to friction coefficient, roughness and modulus."""
    return sb.fit(noisy(7, rows=25), START, free=["boundary_friction", "roughness", "modulus"])


def with_settings(tmp_path, contact=TRUE, **settings):
    """Return a case with fit settings, as one read from a file."""
    return sb.Case(path=tmp_path / "case.toml", contact=contact, fit=FitSettings(**settings))


# --- derivatives and exact data ---


@pytest.mark.quick
def test_data_without_noise_give_the_true_inputs_from_far_away():
    speeds, friction = exact(rows=12)
    far = TRUE.replace(boundary_friction=0.1, roughness="5 um", modulus="0.5 MPa", beta=0.2)
    found = sb.fit(
        measured(speeds, friction), far, free=["boundary_friction", "roughness", "modulus", "beta"], intervals=False
    )
    assert found.converged
    for each in found.inputs:
        assert each.value == pytest.approx(getattr(TRUE, each.name), rel=1e-4)
    assert found.friction == pytest.approx(friction, rel=1e-6)


def test_the_fitted_friction_is_that_of_the_solver(fitted):
    rows = [0, 12, 24]
    solved = [sb.solve(fitted.contact.replace(speed=float(fitted.data.values[i]))).friction().total for i in rows]
    assert fitted.friction[rows] == pytest.approx(solved, rel=1e-6)
    assert fitted.model_error < 1e-5
    assert fitted.solver_shift < 0.01


def test_a_fit_survives_pickling_with_its_band(fitted):
    again = pickle.loads(pickle.dumps(fitted))
    assert again == fitted and again.data == fitted.data
    np.testing.assert_allclose(again.band(0, [0.003, 0.03]), fitted.band(0, [0.003, 0.03]), rtol=1e-6)


def test_order_of_rows_and_repeated_speeds_do_not_matter(tmp_path):
    data = noisy(3, rows=8)
    lines = [f"{u},{m}" for u, m in zip(data.values, data.friction, strict=True)] * 2
    order = np.random.default_rng(4).permutation(16)
    (tmp_path / "lab.csv").write_text("speed [m/s],friction\n" + "\n".join(lines[i] for i in order))
    twice, once = (sb.fit(each, TRUE, intervals=False) for each in (tmp_path / "lab.csv", data))
    assert list(twice.to_si().values()) == pytest.approx(list(once.to_si().values()), rel=1e-5)
    widths = [each["roughness"].standard_error for each in (twice, once)]
    assert widths[0] == pytest.approx(widths[1] * math.sqrt(6 / 14), rel=1e-3)


# --- intervals ---


def test_an_end_of_an_interval_is_where_the_best_fit_of_the_other_inputs_is_worse_by_the_quantile(fitted):
    from scipy.stats import t

    def misfit(found):
        return float(np.sum(np.log(fitted.data.friction / found.friction) ** 2)) / fitted.noise**2

    names = [each.name for each in fitted.inputs]
    for name, level, which in (("boundary_friction", 0.682689492137086, 0), ("roughness", 0.95, 1)):
        quantile = t.ppf(0.5 + level / 2, len(fitted.data) - 3)
        end = (fitted[name].interval_95 if level == 0.95 else fitted[name].interval_68)[which]
        others = [each for each in names if each != name]
        held = sb.fit(fitted.data, fitted.contact.replace(**{name: end}), free=others, intervals=False)
        assert math.sqrt(misfit(held) - misfit(fitted)) == pytest.approx(quantile, abs=0.02)


@pytest.mark.slow
def test_an_end_of_an_interval_is_right_where_other_inputs_reach_their_bounds(tmp_path):
    """A plateau alone: roughness and modulus go anywhere together.  The falls foretold beyond bounds opened the lower end."""
    from scipy.stats import t

    bounds = {"roughness": (3e-7, 3e-6), "modulus": (1e6, 1e7)}
    data = noisy(7, noise=0.03, low=1e-5, high=3e-4, rows=12)
    found = sb.fit(data, with_settings(tmp_path, bounds=bounds), free=["boundary_friction", "roughness", "modulus"])
    for end in found["boundary_friction"].interval_95:
        case = with_settings(tmp_path, TRUE.replace(boundary_friction=end), bounds=bounds)
        held = sb.fit(data, case, free=["roughness", "modulus"], intervals=False)
        rise = sum(held.residuals**2 * held.noise**2 - found.residuals**2 * found.noise**2) / found.noise**2
        assert math.sqrt(rise) == pytest.approx(t.ppf(0.975, len(data) - 3), abs=0.03)


def test_an_end_of_an_interval_is_right_where_nothing_changes_beside_the_fit():
    """A film alone, which only a high roughness pierces.  Solved states led the fit down to the bound, and its end too."""
    from scipy.stats import t

    data, start = noisy(4, low=0.06, high=1.0, rows=6), TRUE.replace(modulus="3 MPa", roughness="0.8 um")
    found = sb.fit(data, start, free=["roughness", "modulus"])
    assert found.outcome is sb.results.FitOutcome.CONVERGED and found.undetermined
    end = found["roughness"].interval_95[1]
    held = sb.fit(data, start.replace(roughness=end), free=["modulus"], intervals=False)
    rise = sum(held.residuals**2 * held.noise**2 - found.residuals**2 * found.noise**2) / found.noise**2
    assert math.sqrt(rise) == pytest.approx(t.ppf(0.975, len(data) - 2), abs=0.03)


def test_intervals_of_nearly_linear_inputs_are_those_of_the_covariance(fitted):
    from scipy.stats import t

    each = fitted["boundary_friction"]
    half = t.ppf(0.975, len(fitted.data) - 3) * each.standard_error
    assert np.log(each.interval_95) == pytest.approx(
        [math.log(each.value) - half, math.log(each.value) + half], abs=0.02 * half
    )


def test_given_errors_set_the_width_and_are_tested(tmp_path):
    speeds, friction = exact(rows=8)
    sigma = 0.03 * friction
    noise = np.random.default_rng(5).standard_normal(8)

    def found(error, case=TRUE):
        return sb.fit(measured(speeds, friction + sigma * noise, error), case, free=["roughness"], intervals=False)

    right, small, large = (found(sigma * factor) for factor in (1, 1 / 3, 5))
    assert 0.01 < right.quality.chi_squared_probability < 0.99
    assert right.quality.messages == () and math.isnan(right.noise)
    scatter = math.sqrt(right.quality.chi_squared / right.quality.degrees_of_freedom)  # of the data, not of their errors
    assert small["roughness"].standard_error == pytest.approx(scatter * right["roughness"].standard_error, rel=0.05)
    assert "too small by a factor" in small.quality.messages[0] and "too large by a factor" in large.quality.messages[0]
    relative = found(None, with_settings(tmp_path, relative_error=0.03))
    assert relative["roughness"].standard_error == pytest.approx(right["roughness"].standard_error, rel=0.05)


def test_a_relative_error_beside_an_absolute_one_is_of_the_fitted_friction(tmp_path):
    """Of measured friction it would favour the lower of two rows and lower the fit by 2 %."""
    speeds, friction = exact(rows=12)
    rows = measured(np.repeat(speeds, 2), np.outer(friction, [1.1, 0.9]).ravel())
    case = with_settings(tmp_path, relative_error=0.1, absolute_error=1e-3)
    found = sb.fit(rows, case, free=["boundary_friction", "roughness"], intervals=False)
    assert [each.value for each in found.inputs] == pytest.approx([TRUE.boundary_friction, TRUE.roughness], rel=1e-4)


def test_a_prior_adds_its_information(tmp_path):
    data = noisy(8, low=0.02, rows=10)

    def fit_with_prior(value, factor):
        priors = {"boundary_friction": {"value": value, "factor": factor}}
        settings = fit_settings({"free": ["boundary_friction", "roughness"], "priors": priors})
        return sb.fit(data, sb.Case(path=tmp_path / "case.toml", contact=TRUE, fit=settings), intervals=False)

    alone = sb.fit(data, TRUE, free=["boundary_friction", "roughness"], intervals=False)
    held = fit_with_prior(0.7, 1.05)
    assert held.converged
    assert alone["boundary_friction"].standard_error > 0.3
    assert held["boundary_friction"].standard_error == pytest.approx(math.log(1.05), rel=0.05)
    assert held["roughness"].standard_error < 0.5 * alone["roughness"].standard_error
    assert fit_with_prior(1.4, 1.001)["boundary_friction"].value == pytest.approx(1.4, rel=1e-3)


def test_an_input_at_its_bound_is_said(tmp_path):
    case = with_settings(tmp_path, bounds={"roughness": (5e-7, 9e-7)}, contact=TRUE.replace(roughness=8e-7))
    found = sb.fit(noisy(7), case)
    each = found["roughness"]
    assert found.converged and each.at_bound and each.value == pytest.approx(9e-7, rel=1e-3)
    assert any("roughness ended at its bound 900 nm: the data would move it further" in note for note in found.notes)
    assert math.isnan(each.standard_error)
    said = json.loads(json.dumps(found.to_dict(), allow_nan=False))
    assert found.outcome is sb.results.FitOutcome.AT_BOUND and said["outcome"] == "AT_BOUND"
    assert said["inputs"][[one["name"] for one in said["inputs"]].index("roughness")]["standard_error"] is None


def test_a_boundary_friction_that_no_contact_has_is_named():
    speeds, friction = exact(contact=TRUE.replace(boundary_friction=3.4), rows=8)
    found = sb.fit(measured(speeds, friction), TRUE, free=["boundary_friction"], intervals=False)
    assert found["boundary_friction"].value == pytest.approx(3.4, rel=1e-3)
    assert found.outcome is sb.results.FitOutcome.IMPLAUSIBLE and found.to_dict()["outcome"] == "IMPLAUSIBLE"
    assert any("boundary_friction 3.4 is larger than that of any known contact" in note for note in found.notes)
    assert "The fit ended at an implausible boundary friction" in str(found)


# --- several curves ---


def test_curves_share_inputs_or_have_their_own(tmp_path):
    rough = TRUE.replace(roughness="2 um")
    (u, first), (_, second) = exact(rows=8), exact(rough, rows=8)
    noise = np.exp(0.02 * np.random.default_rng(6).standard_normal(16))
    data = measured(
        np.tile(u, 2), np.append(first, second) * noise, curve=[0] * 8 + [1] * 8, curves=("a", "b"), inputs=({}, {})
    )
    case = with_settings(tmp_path, free=("boundary_friction", "roughness"), per_curve=("roughness",))
    found = sb.fit(data, case, intervals=False)
    assert [each.label for each in found.inputs] == ["boundary_friction", "roughness (a)", "roughness (b)"]
    assert found["roughness (a)"].value == pytest.approx(1e-6, rel=0.05)
    assert found["roughness (b)"].value == pytest.approx(2e-6, rel=0.05)
    assert found.contacts[1].roughness == found["roughness (b)"].value
    assert found.quality.messages == ()
    shared = sb.fit(data, with_settings(tmp_path), intervals=False)
    assert any("structure" in message for message in shared.quality.messages)


def test_a_shared_input_with_different_values_is_fitted_as_a_factor():
    thin = TRUE.replace(viscosity=5e-3)
    (u, first), (faster, second) = exact(rows=8), exact(thin, high=3.0, rows=8)
    speeds = np.append(u, faster)
    inputs = ({"viscosity": 0.04}, {"viscosity": 0.004})  # 20 % too low, both
    data = measured(speeds, np.append(first, second), curve=[0] * 8 + [1] * 8, curves=("a", "b"), inputs=inputs)
    found = sb.fit(data, TRUE, free=["boundary_friction", "viscosity"], intervals=False)
    assert found.inputs[1].label == "viscosity factor"
    assert found.inputs[1].value == pytest.approx(1.25, rel=1e-4)
    assert [contact.viscosity for contact in found.contacts] == pytest.approx([0.05, 0.005], rel=1e-4)
    again = sb.fit(data, found.contact, free=["boundary_friction", "viscosity"], intervals=False)
    assert (found.contact.viscosity, again.contact.viscosity) == pytest.approx((0.05, 0.05), rel=1e-4)


# --- what data do not say ---


def test_a_curve_without_a_plateau_cannot_give_the_dry_friction():
    found = sb.fit(noisy(2, low=0.03, high=3.0), TRUE)
    assert re.search("Warning: boundary_friction .*cannot be determined.*boundary plateau", str(found))
    [weak] = found.undetermined
    assert weak.names == ("boundary_friction",)
    assert "asperities cause at most" in weak.message and "boundary plateau" in weak.message
    assert math.isinf(found["boundary_friction"].interval_95[1])


@pytest.mark.slow  # profiles without curvature take a hundred places
def test_intervals_of_what_is_not_determined_hold_each_other_and_what_fits_as_well():
    # Six rows on the plateau: the profiles are long, and some trials end in another minimum.
    friction = [0.658816979, 0.5733061724, 0.6247827919, 0.6012751676, 0.5902146524, 0.5662682044]
    data = measured(np.geomspace(5e-5, 6.387300787e-4, 6), friction)
    found = sb.fit(data, TRUE, free=["boundary_friction", "roughness", "modulus"])
    for each in found.inputs:
        for wide, narrow, sign in zip(each.interval_95, each.interval_68, (-1, 1), strict=True):
            assert sign * wide >= sign * narrow
    with_other = sb.fit(data, TRUE.replace(boundary_friction=5.2), free=["roughness", "modulus"], intervals=False)
    assert with_other.noise < 1.05 * found.noise
    assert found["boundary_friction"].interval_95[1] > 5.2


def test_a_wide_interval_holds_the_narrow_one_where_the_profile_goes_up_and_down():
    true = TRUE.replace(modulus="2.3 MPa", roughness="1.3 um", boundary_friction=0.62)
    data = noisy(100, 0.03, contact=true, low=0.3, high=3.0, rows=8)
    for each in sb.fit(data, TRUE, free=["boundary_friction", "roughness", "modulus"]).inputs:
        assert each.interval_95[0] <= each.interval_68[0] and each.interval_68[1] <= each.interval_95[1]


def test_residuals_with_one_degree_of_freedom_have_no_order_to_judge():
    found = sb.fit(noisy(3, rows=4), NEAR, free=["boundary_friction", "roughness", "modulus"], intervals=False)
    assert found.quality.degrees_of_freedom == 1
    assert found.quality.structure_probability == 1 and not found.quality.messages


@pytest.mark.quick
def test_a_share_below_the_error_of_friction_is_said_to_be_that_at_most():
    speeds, friction = exact(low=5.0, high=50.0, rows=8)
    found = sb.fit(measured(speeds, friction), TRUE, free=["boundary_friction"], intervals=False)
    assert found["boundary_friction"].interval_95 == (0.0, math.inf)
    [weak] = found.undetermined
    share = float(re.search(r"asperities cause at most (\S+) % of the friction", weak.message)[1])
    assert 1e-7 < share < 1e-3


def test_the_combination_that_the_data_give_is_named():
    found = sb.fit(noisy(1, rows=10), START, free=["boundary_friction", "roughness", "alpha"])
    [weak] = found.undetermined
    assert weak.names == ("roughness", "alpha") and weak.exponents == pytest.approx((1, 1))
    assert "does not change when both are multiplied by one factor" in weak.message
    assert "the data give only roughness / alpha" in weak.message
    for name in weak.names:
        assert found[name].interval_68 == (0.0, math.inf) and math.isinf(found[name].standard_error)
    # Their product is left where the case had it, and the quotient is found.
    case, fit = START, found.contact
    assert fit.roughness * fit.alpha == pytest.approx(case.roughness * case.alpha, rel=1e-6)
    alone = sb.fit(noisy(1, rows=10), START, free=["boundary_friction", "roughness"])
    assert fit.roughness / fit.alpha == pytest.approx(alone.contact.roughness / alone.contact.alpha, rel=1e-4)
    assert found["boundary_friction"].interval_95 == pytest.approx(alone["boundary_friction"].interval_95, rel=1e-2)


@pytest.mark.quick
def test_inputs_of_a_smooth_contact_that_do_not_matter_stay_where_they_were():
    smooth = TRUE.replace(roughness=0)
    found = sb.fit(
        noisy(4, contact=smooth, low=1e-2, rows=6), smooth, free=["boundary_friction", "modulus", "beta"], intervals=False
    )
    assert [weak.names for weak in found.undetermined] in (
        [("beta",), ("boundary_friction",)],
        [("boundary_friction",), ("beta",)],
    )
    # No step goes along what changes nothing: that direction is known to rounding times the size of the other steps.
    assert found["beta"].value == pytest.approx(TRUE.beta, rel=1e-9)
    assert found["boundary_friction"].value == pytest.approx(0.7, rel=1e-11)


def test_three_tied_inputs_are_told_apart_from_what_is_known():
    found = sb.fit(noisy(1, rows=8), TRUE, free=["boundary_friction", "modulus", "viscosity", "load"], intervals=False)
    tied = next(weak for weak in found.undetermined if len(weak.names) == 3)
    assert tied.names == ("modulus", "viscosity", "load")
    assert tied.exponents == pytest.approx((1, 1, 1))
    assert "modulus / viscosity and modulus / load" in tied.message
    said = [*found.notes, *(each.message for each in found.undetermined)]
    for pair in itertools.combinations(tied.names, 2):
        assert sum(all(name in sentence for name in pair) for sentence in said) == 1


def test_an_input_that_the_abscissa_holds_is_refused():
    speeds, friction = exact(rows=8)
    data = measured(speeds * 0.05 / 30, friction, abscissa="hersey_number")
    with pytest.raises(sb.InputError, match="viscosity is free, but friction was measured against Hersey number"):
        sb.fit(data, TRUE, free=["viscosity"])
    found = sb.fit(data, START, intervals=False, free=["boundary_friction", "roughness", "modulus"])
    assert found["modulus"].value == pytest.approx(TRUE.modulus, rel=1e-4)


# --- misfit, outliers, failure ---


@pytest.fixture(scope="module")
def of_asperities():
    """Return friction with 2 % of noise of a contact with Greenwood and Tripp's law, and the contact."""
    contact = TRUE.replace(law=sb.contact_laws.GreenwoodTripp(), alpha=1.0)
    return noisy(1, 0.02, contact, low=1e-5, rows=26), contact


def test_data_of_greenwood_and_tripp_do_not_pass_for_persson(of_asperities):
    data, contact = of_asperities
    law = persson_law(SelfAffine(h_rms=1e-6, q0=4e4, q1=4e7, hurst=0.8))
    persson = sb.fit(data, contact.replace(law=law, **law.coefficients), intervals=False)
    assert persson.law == "persson" and persson.converged and math.isnan(persson.solver_shift)
    assert persson.quality.structure_probability < 0.001
    assert "do not follow the model" in persson.quality.messages[0]


def test_data_of_greenwood_and_tripp_pass_for_their_own(of_asperities):
    data, contact = of_asperities
    found = sb.fit(data, contact.replace(roughness=1.5e-6), intervals=False)
    assert found.law == "greenwood-tripp" and found.quality.messages == ()
    assert found["roughness"].value == pytest.approx(1e-6, rel=0.02)
    assert found.contact.law == contact.law


def test_a_plateau_that_falls_with_speed_is_noticed():
    speeds, friction = exact(rows=25)
    friction *= (speeds / speeds[0]) ** -0.05 * np.exp(0.03 * np.random.default_rng(11).standard_normal(25))
    found = sb.fit(measured(speeds, friction), TRUE, intervals=False)
    assert found.converged
    assert found.quality.structure_probability < 0.01
    assert any("structure along the speed" in message for message in found.quality.messages)


def test_outliers_do_not_steer_the_robust_fit():
    data, right = noisy(21, outliers=4, rows=25), noisy(21, rows=25)
    plain, clean = sb.fit(data, NEAR, intervals=False), sb.fit(right, NEAR, intervals=False)
    robust = sb.fit(data, NEAR, robust=True)
    assert robust.converged and robust.robust
    for each in robust.inputs:
        far = abs(math.log(each.value / clean[each.name].value)) / clean[each.name].standard_error
        assert far < 1.0
        assert each.interval_95[0] < getattr(TRUE, each.name) < each.interval_95[1]
        assert plain[each.name].standard_error > 3 * each.standard_error
    assert abs(math.log(plain["roughness"].value / 1e-6)) > 4 * clean["roughness"].standard_error
    assert robust.noise == pytest.approx(clean.noise, rel=0.5)
    [note] = [note for note in robust.notes if "four standard errors" in note]
    ratios = data.friction / right.friction
    assert re.findall(r"\d+", note) == [str(row) for row in data.rows[ratios > 1.5]]


def test_intervals_of_a_robust_fit_are_those_of_the_scatter_also_where_errors_are_given():
    speeds, friction = exact(rows=8)
    noisy_friction = friction * np.exp(0.03 * np.random.default_rng(5).standard_normal(8))
    small, large = (
        sb.fit(measured(speeds, noisy_friction, error * friction), TRUE, free=["roughness"], robust=True, intervals=False)
        for error in (0.01, 0.15)
    )
    for found, size in ((small, "too small"), (large, "too large")):
        width = math.log(found["roughness"].interval_95[1] / found["roughness"].value)
        student = 2.3646  # of seven degrees of freedom
        assert width == pytest.approx(student * found["roughness"].standard_error, rel=1e-3)
        [message] = found.quality.messages
        assert size in message and "robust fit follow from the scatter" in message
    assert large["roughness"].standard_error < 2 * small["roughness"].standard_error


def test_a_fit_that_ran_out_of_steps_says_so(monkeypatch, tmp_path, capsys):
    monkeypatch.setattr("stribeck.fits.least_squares.MOST_EVALUATIONS", 1)
    answer = call(capsys, "fit", MEASURED, CASE, "--out", tmp_path / "fitted.toml", "--json")
    found = json.loads(answer.out)
    assert answer.code == 1 and "did not converge" in answer.err and "did not converge" in found["message"]
    assert found["converged"] is False and not (tmp_path / "fitted.toml").exists()
    assert {*found["curves"][0], *found["rows"]} - {"name"} <= set(found["units"]) and found["units"]["speed"] == "m/s"


FEW = {
    "two rows": (2, ["boundary_friction"], "2 rows with speed and friction are too few to fit 1 input"),
    "as many as inputs": (
        3,
        ["boundary_friction", "roughness", "beta"],
        "3 rows with speed and friction are too few to fit 3 inputs",
    ),
}


@pytest.mark.quick
def test_too_few_rows_are_refused(subtests):
    for rows, free, sentence in FEW.values():
        with subtests.test(rows=rows, free=free, sentence=sentence):
            speeds, friction = exact()
            with pytest.raises(sb.InputError, match=sentence):
                sb.fit(measured(speeds[:rows], friction[:rows]), TRUE, free=free)


def test_bad_arguments_are_one_sentence(tmp_path, fitted):
    data = fitted.data
    for case, free, sentence in (
        (3, None, "case = 3"),
        (TRUE, [], "free is empty"),
        (TRUE, ["stiffness"], "'stiffness'"),
        (TRUE.replace(roughness=0), ["roughness"], "roughness is 0 in the case"),
        (with_settings(tmp_path, bounds={"roughness": (2e-6, 3e-6)}), ["roughness"], "outside its bounds 2 µm to 3 µm"),
    ):
        with pytest.raises(sb.InputError) as caught:
            sb.fit(data, case, free=free)
        assert sentence in str(caught.value)
    with pytest.raises(KeyError, match="fitted are"):
        fitted["colour"]


# --- posterior and outputs ---


def test_the_posterior_is_as_wide_as_the_interval_where_the_errors_given_are_too_small(tmp_path, capsys):
    data = noisy(5, noise=0.03, rows=8)
    rows = zip(data.values, data.friction, 0.01 * data.friction, strict=True)
    (tmp_path / "data.csv").write_text("speed [m/s],friction,error\n" + "\n".join(f"{u},{mu},{e}" for u, mu, e in rows))
    case = EXAMPLES / "pdms_cylinder.toml"
    answer = call(capsys, "fit", tmp_path / "data.csv", case, "--free", "roughness", "--posterior", "200", "--json")
    found = json.loads(answer.out)
    [each], drawn = found["inputs"], found["posterior"]["interval_95"]["roughness"]
    wide, narrow = (math.log(high / low) for low, high in (each["interval_95"], drawn))
    assert 0.6 < narrow / wide < 1.2


def test_the_posterior_of_a_robust_fit_is_refused(capsys):
    answer = call(capsys, "fit", MEASURED, CASE, "--robust", "--posterior", "500")
    assert answer.code == 2 and "not a likelihood" in answer.err


def test_the_band_is_the_spread_of_the_fitted_curve(fitted):
    from scipy.stats import t

    speeds = np.array([1e-3, 1e-2, 1e-1])
    friction, low, high = fitted.band(0, speeds)
    names = [each.name for each in fitted.inputs]
    moves = np.random.default_rng(9).multivariate_normal(np.zeros(3), fitted.covariance, 400)
    draws = [dict(zip(names, np.exp(move), strict=True)) for move in moves]
    contacts = [fitted.contact.replace(**{k: getattr(fitted.contact, k) * f for k, f in each.items()}) for each in draws]
    groups = np.array(
        [[(g.speed * u / each.speed, g.load, g.roughness) for u in speeds] for each in contacts for g in [each.groups]]
    )
    rubbing, viscous = sb.atlas.friction_terms(
        sb.Groups(*np.moveaxis(groups, 2, 0)), {"beta": fitted.contact.beta}, "balanced"
    )
    dry = np.array([each.boundary_friction for each in contacts])
    drawn = dry[:, None] * rubbing.reshape(-1, 3) + viscous.reshape(-1, 3)
    spread = np.log(drawn).std(axis=0)
    quantile = t.ppf(0.975, len(fitted.data) - 3)
    assert np.log(high / friction) == pytest.approx(quantile * spread, rel=0.15)
    assert low * high == pytest.approx(friction**2)


def test_errors_of_a_fit_give_its_band(fitted):
    speeds = np.array([5e-3, 1e-1])
    for speed, friction, low, high in zip(speeds, *fitted.band(0, speeds), strict=True):
        found = sb.propagate(fitted.contact.replace(speed=speed), fitted.errors, transitions=False)["friction"]
        assert found.value == pytest.approx(friction, rel=1e-3)
        assert math.log(found.interval_95[1] / found.interval_95[0]) == pytest.approx(math.log(high / low), rel=0.05)


def test_the_command_writes_a_case_that_solves_a_figure_and_json_and_a_short_chain_of_the_posterior_says_so(tmp_path, capsys):
    out, plot = tmp_path / "fitted.toml", tmp_path / "fit.png"
    answer = call(capsys, "fit", MEASURED, CASE, "--out", out, "--plot", plot, "--posterior", "400", "--json")
    assert answer.code == 0 and answer.err == ""
    found = json.loads(answer.out)
    assert found["converged"] is True and found["files"] == [str(plot), str(out)]
    values = {each["name"]: each["value"] for each in found["inputs"]}
    case = sb.load_case(out)
    for name, value in values.items():
        assert getattr(case.contact, name) == pytest.approx(value, rel=1e-8)
    assert case.fit.free == ("boundary_friction", "roughness", "modulus")
    order = [[*values].index(name) for name in case.errors]
    assert case.errors.matrix == pytest.approx(np.array(found["correlation"])[np.ix_(order, order)], abs=1e-9)
    for each in found["inputs"]:  # an error is wider than the standard error, as Student's interval is
        assert 1 < math.sqrt(math.log1p(case.errors[each["name"]] ** 2)) / each["standard_error"] < 1.1
    assert sb.solve(case.contact).outcome.ok
    for each in found["inputs"]:
        low, high = each["interval_95"]
        assert low < {"boundary_friction": 0.62, "roughness": 1.3e-6, "modulus": 2.3e6}[each["name"]] < high
    known = {each["name"]: (each["values"], each["unit"]) for each in found["held"]}
    assert set(known) == set(FREE) - set(values)
    assert known["viscosity"] == ([0.05, 0.005], "Pa s")
    assert plot.stat().st_size > 20_000
    drawn = found["posterior"]
    assert not drawn["converged"] and "did not converge: ask for at least" in drawn["message"]
    for each in found["inputs"]:
        low, high = np.log(drawn["interval_68"][each["name"]]) - np.log(each["interval_68"])
        assert max(abs(low), abs(high)) < 0.3 * each["standard_error"], each["name"]
    assert call(capsys, "fit", MEASURED, CASE, "--out", out).code == 2


def test_files_in_each_others_place_are_told_with_the_right_order(tmp_path):
    for function in (sb.fit, sb.compare, sb.master_curve):
        with pytest.raises(sb.InputError) as swapped:
            function(CASE, MEASURED)
        assert str(swapped.value).endswith(f"Measured friction comes first, then the case: {MEASURED} {CASE}.")
    with pytest.raises(sb.InputError, match="missing.toml cannot be read"):
        sb.fit(CASE, tmp_path / "missing.toml")


def test_what_counts_as_known_exactly_is_said(fitted):
    held = "Held fixed: beta 0.06, alpha 2, viscosity 50 mPa*s, load 30 N/m, radius 10 mm."
    assert f"{held} Their uncertainty is not included in the errors above" in str(fitted)


def test_what_the_data_hold_does_not_count_as_known():
    speeds, friction = exact(rows=8)
    data = measured(TRUE.viscosity * speeds, friction, abscissa="speed_viscosity")
    assert sb.fit(data, TRUE, intervals=False).held == ("beta", "alpha", "modulus", "load", "radius")


MISUSE = {
    "nothing": ([], "DATA is missing"),
    "no case": (["lab.csv"], "CASE is missing"),
    "unknown input": ([MEASURED, CASE, "--free", "stiffness"], "'stiffness'"),
    "wrong ending": ([MEASURED, CASE, "--out", "fitted.json"], "must end in .toml"),
    "case as data": ([CASE, CASE], "pdms_fit.toml"),
    "no case among two": ([MEASURED, MEASURED], "CASE is missing"),
    "two cases": ([MEASURED, CASE, CASE.with_name("pdms_cylinder.toml")], "fit takes one of them"),
    "misspelt": ([MEASURED.with_name("pdms_mesured.csv"), CASE], f"did you mean {MEASURED}?"),
    "glob of nothing": (["nothing_*.csv", CASE], "nothing_*.csv matches no file"),
    "per file": ([MEASURED, CASE, "--free", "roughness", "--per-file", "beta"], "not fitted; add it to free"),
    "posterior": ([MEASURED, CASE, "--posterior", "many"], "not a whole number"),
}


def test_misuse_of_the_command_is_one_sentence(subtests, capsys):
    for tokens, sentence in MISUSE.values():
        with subtests.test(tokens=tokens, sentence=sentence):
            answer = call(capsys, "fit", *tokens)
            assert answer.code == 2 and sentence in answer.err and answer.out == ""
            assert len(answer.err.splitlines()) == 1
