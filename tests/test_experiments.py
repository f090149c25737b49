"""What to measure next is what shrinks the intervals most for its cost; the law that made the data is the one preferred."""

import json
import math

import numpy as np
import pytest
from command_line import EXAMPLES, call, case_text, fit_settings
from fit_data import TRUE, exact, measured, noisy

import stribeck as sb


@pytest.fixture(scope="module")
def found():
    return sb.fit(noisy(11, rows=12), TRUE, free=["boundary_friction", "roughness"], intervals=False)


def test_the_first_run_is_the_best_of_all_that_were_tried(found):
    plan = sb.next_runs(found, 2)
    best = max(plan.scanned, key=lambda run: run.gain / run.cost)
    first = plan.runs[0]
    assert (first.speed, first.load) == (best.speed, best.load)
    assert first.gain == pytest.approx(best.gain)
    errors = [plan.before, *(run.errors for run in plan.runs)]
    for before, after in zip(errors, errors[1:], strict=False):
        assert all(after[name] <= before[name] * (1 + 1e-9) for name in before)
        assert math.prod(after.values()) < math.prod(before.values())
    assert plan.noise == found.noise


def test_dry_friction_is_measured_slowly_and_the_errors_come_true(found):
    alone = sb.fit(noisy(11, rows=12), TRUE, free=["boundary_friction"], intervals=False)
    plan = sb.next_runs(alone, 1, speeds=["0.05 mm/s", "0.2 m/s"], loads=[TRUE.load])
    [run] = plan.runs
    assert run.speed == pytest.approx(5e-5)
    # Half the logarithm of the determinant of the information, of one input.
    gain = math.log(plan.before["boundary_friction"] / run.errors["boundary_friction"])
    assert run.gain == pytest.approx(gain, rel=1e-6)
    data = noisy(11, rows=12)
    friction = np.append(data.friction, run.friction)
    rows = measured(np.append(data.values, run.speed), friction, error=friction * alone.noise)
    again = sb.fit(rows, TRUE, free=["boundary_friction"], intervals=False)
    assert again["boundary_friction"].standard_error == pytest.approx(run.errors["boundary_friction"], rel=0.05)


def settled(tmp_path, **settings):
    """Return a case with settings of its fit."""
    return sb.Case(path=tmp_path / "case.toml", contact=TRUE, fit=fit_settings(settings))


def test_a_plan_begins_from_the_errors_of_the_fit_and_takes_a_run_to_be_as_accurate_as_its_rows(tmp_path, subtests):
    data = noisy(11, rows=12)
    too_small = measured(data.values, data.friction, error=0.005 * data.friction)  # the noise is 4 %
    one_off = measured(data.values, np.where(np.arange(12) == 3, 2, 1) * data.friction)
    for rows, settings, noise in (
        (too_small, {}, (0.02, 0.08)),
        (data, {"relative_error": 0.1}, (0.1 - 1e-9, 0.1 + 1e-9)),
        (one_off, {"robust": True}, (0.02, 0.08)),
    ):
        with subtests.test(settings=settings):
            known = sb.fit(rows, settled(tmp_path, **settings), free=["boundary_friction", "roughness"], intervals=False)
            plan = sb.next_runs(known, 1, speeds=["1 mm/s"], loads=[TRUE.load])
            assert plan.before == pytest.approx({each.label: each.standard_error for each in known.inputs}, rel=0.01)
            assert noise[0] < plan.noise < noise[1]


def test_a_sample_with_an_input_of_its_own_is_a_run_worth_measuring(tmp_path):
    speeds, friction = exact(rows=8)
    _, rough = exact(TRUE.replace(roughness="1.4 um"), rows=8)
    both = np.append(friction, rough[:3]) * np.exp(0.02 * np.random.default_rng(0).standard_normal(11))
    data = measured(np.append(speeds, speeds[:3]), both, curve=[0] * 8 + [1] * 3, curves=("smooth", "rough"), inputs=({}, {}))
    own = settled(tmp_path, free=["boundary_friction", "roughness"], per_curve=["roughness"])
    plan = sb.next_runs(sb.fit(data, own, intervals=False), 1)
    [run] = plan.runs  # the sample of three slow rows
    assert run.curve == "rough" and run.errors["roughness (rough)"] < 0.5 * plan.before["roughness (rough)"]
    assert {each.curve for each in plan.scanned} == {"smooth", "rough"}
    assert "1    rough  " in str(plan)
    assert "smooth, " in plan.plot().legends[0].get_texts()[0].get_text()


@pytest.mark.slow
def test_the_errors_of_a_run_on_a_surface_whose_beta_follows_from_the_roughness_come_true(tmp_path):
    path = tmp_path / "case.toml"
    surface = {"h_rms": '"1 um"', "q0": '"1e4 1/m"', "q1": '"1e7 1/m"', "hurst": 0.8}
    tables = {"surface": surface, "fit": {"relative_error": 0.03}, "solver": {"rtol": 1e-3}}
    path.write_text(case_text({"roughness": None, "alpha": None, "beta": None}, **tables))
    case = sb.load_case(path)
    speeds = np.array([2e-4, 3e-3, 0.02])
    friction = sb.stribeck_curve(case.contact, speed=speeds, rtol=1e-3).friction
    known = sb.fit(measured(speeds, friction), case, intervals=False)
    [run] = sb.next_runs(known, 1, speeds=["0.3 mm/s"], loads=[case.contact.load]).runs
    rows = measured(np.append(speeds, run.speed), np.append(friction, run.friction))
    for each in sb.fit(rows, case, intervals=False).inputs:
        assert run.errors[each.name] == pytest.approx(each.standard_error, rel=0.01)


def test_another_load_costs_more(found):
    dear = sb.next_runs(found, 1, cost={"load": 1e6})
    assert dear.runs[0].load == pytest.approx(TRUE.load)
    with pytest.raises(sb.InputError, match="cost = "):
        sb.next_runs(found, 1, cost={"lode": 1})
    with pytest.raises(sb.InputError, match="count = 0"):
        sb.next_runs(found, 0)
    with pytest.raises(sb.InputError, match="speeds be positive"):
        sb.next_runs(found, 1, speeds=[0])


def test_the_command_prints_a_table_and_draws(tmp_path, capsys):
    picture, data, case = (tmp_path / name for name in ("next.png", "data.csv", "case.toml"))
    data.write_text("speed (mm/s),friction\n0.1,0.69\n0.2,0.68\n1,0.56\n5,0.2\n")
    speeds = "--speeds", "1 mm/s", "0.1"  # in SI units
    case.write_text(case_text({}, fit={"free": '["boundary_friction"]'}))
    tokens = "next", data, case, "--count", "2", *speeds
    answer = call(capsys, *tokens, "--plot", picture)
    assert (answer.code, answer.err) == (0, "")
    assert "standard errors after it" in answer.out and picture.stat().st_size > 5000
    planned = json.loads(call(capsys, *tokens, "--json").out)
    runs = planned["runs"]
    assert set(runs[0]) - {"errors"} == set(planned["units"])
    assert [planned["units"][name] for name in ("speed", "load", "viscosity")] == ["m/s", "N/m", "Pa s"]
    assert len(runs) == 2 and {run["speed"] for run in runs} <= {1e-3, 0.1}
    compared = call(capsys, "compare", data, case, "--models", "cavitation", "--free", "boundary_friction", "--json",
        "--plot", tmp_path / "laws.png", "--out", tmp_path / "laws.csv")  # fmt: skip
    laws = json.loads(compared.out)["laws"]
    assert json.loads(compared.out)["units"]["boundary_friction"] == "1"
    assert compared.code == 0 and all(set(each["values"]) == {"boundary_friction"} for each in laws)
    lines = (tmp_path / "laws.csv").read_text().splitlines()
    assert (tmp_path / "laws.png").stat().st_size > 5000 and sum(each["name"] in "".join(lines) for each in laws) == 2
    assert "stiffness" in call(capsys, "compare", data, case, "--free", "stiffness").err
    assert "must end" in call(capsys, "compare", data, case, "--out", "laws.txt").err
    assert "CASE is missing" in call(capsys, "next", "measured.csv").err
    assert "DATA is missing" in call(capsys, "compare").err


@pytest.mark.slow
def test_the_law_that_made_the_data_is_preferred():
    gaussian = TRUE.replace(alpha=1.0, beta=0.03, law=sb.contact_laws.GreenwoodTripp())
    speeds, friction = exact(gaussian, rows=14)
    friction = friction * np.exp(0.01 * np.random.default_rng(5).standard_normal(len(speeds)))
    case = TRUE.replace(beta=0.03)
    found = sb.compare(
        measured(speeds, friction),
        case,
        laws={"exponential": None, "greenwood-tripp": sb.contact_laws.GreenwoodTripp()},
        free=("boundary_friction", "roughness"),
    )
    assert [each.name for each in found.candidates][0] == "greenwood-tripp"
    assert "The data prefer greenwood-tripp" in found.sentence
    assert found.candidates[0].weight + found.candidates[1].weight == pytest.approx(1)
    text = str(found)
    for caveat in ("which of these is nearest to the data, not that it is right", "errors of rows are independent"):
        assert caveat in text
    said = json.loads(json.dumps(found.to_dict()))
    assert said["laws"][0]["difference"] == 0 and said["units"]["roughness"] == "m"


def test_the_criterion_of_a_comparison_is_that_of_akaike_for_small_samples(found):
    s = np.linspace(0.05, 12.0, 60)
    laws = {"exponential": None, "table": sb.contact_laws.TableLaw(s, np.exp(-s) + 0.3 * np.exp(-3 * s))}
    comparison = sb.compare(found.data, TRUE, laws=laws, free=("boundary_friction", "roughness"))
    for each in comparison.candidates:
        n, free = len(each.fit.data), len(each.fit.inputs)
        k, sigma = free + 1, each.fit.noise * math.sqrt((n - free) / n)
        assert each.aicc == pytest.approx(n * math.log(sigma**2) + 2 * k + 2 * k * (k + 1) / (n - k - 1))
    first, second = comparison.candidates
    assert second.difference == pytest.approx(second.aicc - first.aicc) and first.weight + second.weight == pytest.approx(1)
    assert f"{second.name}: AICc {second.aicc:.1f}, difference" in repr(comparison)
    assert repr(comparison).splitlines()[0].endswith(comparison.sentence)


def test_a_prior_is_no_evidence_for_a_model(tmp_path):
    """Inputs that a prior holds are no rows: the criterion is that of the residuals."""
    prior = {"beta": {"value": TRUE.beta, "factor": 1.01}, "boundary_friction": {"value": 0.7, "factor": 1.01}}
    case = settled(tmp_path, free=["boundary_friction", "roughness"], priors=prior)
    data = noisy(11, rows=12)
    [each] = sb.compare(data, case, models={"own": {"free": ("beta",)}}).candidates
    square = float(np.sum(np.log(each.fit.friction / data.friction) ** 2))
    assert each.aicc == pytest.approx(12 * math.log(square / 12) + 2 * 4 + 2 * 4 * 5 / 7, abs=0.01)


@pytest.mark.slow
def test_the_finite_surface_that_is_compared_is_that_of_the_scan_of_the_contact():
    law = sb.load_case(EXAMPLES / "rod_seal.toml").contact.law
    scanned = TRUE.replace(law=law, **law.coefficients)
    found = sb.compare(measured(*exact(scanned, low=3e-3, rows=5)), scanned, free=("boundary_friction",))
    laws = [each.fit.contact.law for each in found.candidates]
    assert found.candidates[0].name == "persson" and sb.contact_laws.FiniteSurface(law.alpha, law) in laws and len(laws) == 4


def test_too_few_rows_to_judge_the_fitted_numbers_are_refused():
    rows, free = noisy(11, rows=5), ("boundary_friction", "roughness")
    found = sb.compare(rows, TRUE, models={"plain": {}, "free": {"free": ("beta",)}}, free=free)
    assert found.sentence == "Only plain could be fitted."
    assert found.failed["free"].startswith("5 rows are too few to judge 4 fitted numbers, the noise counting as one; give 6")
    with pytest.raises(
        sb.InputError, match=r"^nothing could be fitted: 5 rows .*; give 6 rows or more, or free fewer inputs\.$"
    ):
        sb.compare(rows, TRUE, models={"one": {}, "other": {"beta": 0.05}}, free=(*free, "beta"))
    for wrong in ({"laws": ["exponential"]}, {"models": ["one"]}, {"models": {"one": 3}}):
        with pytest.raises(sb.InputError, match=r"it must be a dictionary"):
            sb.compare(rows, TRUE, **wrong)


@pytest.mark.slow
def test_an_outlier_does_not_steer_the_comparison_of_robust_fits(tmp_path):
    """With errors given, how far the outlier lies is no evidence either."""
    case, differences = settled(tmp_path, robust=True), []
    data = noisy(11, noise=0.02, rows=12)
    for factor in (3, 30):
        friction = np.where(np.arange(12) == 5, factor, 1) * data.friction
        rows = measured(data.values, friction, error=0.02 * data.friction)
        models = {"own": {}, "smaller": {"beta": 0.8 * TRUE.beta}}
        laws = {each.name: each.aicc for each in sb.compare(rows, case, models=models).candidates}
        differences.append(laws["smaller"] - laws["own"])
    assert differences[0] == pytest.approx(differences[1], abs=1)


@pytest.fixture(scope="module")
def compared():
    torn = TRUE.replace(cavitation="exit")
    speeds, friction = exact(torn, low=3e-3, rows=8)
    friction = friction * np.exp(0.003 * np.random.default_rng(5).standard_normal(len(speeds)))
    return sb.compare(measured(speeds, friction), TRUE, models="cavitation", free=("boundary_friction", "roughness"))


def test_the_cavitation_that_made_the_data_is_preferred(compared):
    assert [each.name for each in compared.candidates] == ["exit", "full film"]
    assert compared.candidates[1].difference > 4
    best = compared.candidates[0].fit
    assert best.contact.cavitation == "exit"
    assert best["roughness"].value == pytest.approx(TRUE.roughness, rel=0.02)


def test_inputs_of_one_model_alone_count_for_it():
    speeds, friction = exact(TRUE.replace(fluid=sb.fluids.Barus("500 1/GPa")), low=3e-3, rows=6)
    models = {"plain": {}, "stiff": {"fluid": sb.fluids.Barus("300 1/GPa"), "free": ("pressure_coefficient",)}}
    friction = friction * np.exp(0.003 * np.random.default_rng(5).standard_normal(len(speeds)))
    found = sb.compare(measured(speeds, friction), TRUE, models=models, free=("boundary_friction",))
    assert {each.name: len(each.fit.inputs) for each in found.candidates} == {"plain": 1, "stiff": 2}
    assert found.failed == {}


def test_models_that_nobody_knows_are_refused():
    data = noisy(11, rows=12)
    with pytest.raises(sb.InputError, match="models = 'solid' must be 'cavitation' or 'fluid'"):
        sb.compare(data, TRUE, models="solid")
    with pytest.raises(sb.InputError, match="laws and models are both given"):
        sb.compare(data, TRUE, models="fluid", laws={})


def test_a_model_that_cannot_be_fitted_is_named_with_its_reason_beside_those_that_can():
    speeds, friction = exact(TRUE, low=3e-3, rows=6)
    models = {"plain": {}, "own": {"free": ("relaxation_time",)}}
    found = sb.compare(measured(speeds, friction), TRUE, models=models, free=("boundary_friction",))
    assert found.sentence == "Only plain could be fitted." and "relaxation_time" in found.failed["own"]
    with pytest.raises(sb.InputError, match="nothing could be fitted: .*relaxation_time"):
        sb.compare(measured(speeds, friction), TRUE, models={"own": models["own"]}, free=("boundary_friction",))


def test_data_with_known_errors_count_no_noise_among_the_inputs():
    speeds, friction = exact(TRUE, low=3e-3, rows=8)
    friction = friction * np.exp(0.01 * np.random.default_rng(3).standard_normal(8))
    found = sb.compare(measured(speeds, friction, 0.01 * friction), TRUE, models={"plain": {}}, free=("boundary_friction",))
    [each] = found.candidates
    assert each.aicc == pytest.approx(each.fit.quality.chi_squared + 2 + 4 / 6)
