"""The case that `stribeck fit --out` writes: it loads and has the fitted curve, whatever gives its law and its inputs."""

import json
import math

import numpy as np
import pytest
from command_line import CONTACT, call, case_text

import stribeck as sb

NOTHING = dict.fromkeys(("alpha", "beta", "roughness"))
SURFACE = {"h_rms": '"1 um"', "hurst": "0.8", "longest_wavelength": '"100 um"', "shortest_wavelength": '"1 um"'}
WAVENUMBER = np.geomspace(6e4, 6e6, 30)
DENSITY = 1e-22 * (WAVENUMBER / 6e4) ** -3.6
ASPERITIES = {"density": '"3e9 m^-2"', "radius": '"60 um"', "deviation": '"1 um"'}
SEPARATION = np.linspace(0.05, 12, 60)

PERSSON = NOTHING | {"law": '"persson"'}
CASES = {
    "exponential of a surface": (NOTHING, {"surface": SURFACE | {"beta_error": '"20 %"'}}, "roughness"),
    "Persson, Ra": (
        PERSSON | {"ra": '"0.8 um"'},
        {"surface": {key: value for key, value in SURFACE.items() if key != "h_rms"}},
        "roughness",
    ),
    "Persson, spectrum": (
        PERSSON | {"viscosity": None},
        {
            "surface": {"spectrum": '"spectrum.csv"'},
            "fluid": {"flow_curve": '"oil.csv"', "model": '"newtonian"'},
        },
        "alpha",
        "beta",
    ),
    "Persson, shape alone": ({"law": '"persson"'}, {"surface": SURFACE | {"shape_only": "true"}}, "roughness"),
    "Greenwood-Williamson, asperities": (
        NOTHING | {"law": '"greenwood-williamson"'},
        {"asperities": ASPERITIES},
        "roughness",
    ),
    "table": ({"law": '"table"'}, {"table": {"file": '"law.csv"'}}, "beta"),
    "data sheet": (
        {
            "modulus": None,
            "shore_a": "45",
            "viscosity": None,
            "kinematic_viscosity": '"55 cSt"',
            "density": '"900 kg/m^3"',
            "load": None,
            "force": '"0.6 N +- 5 %"',
            "width": '"20 mm"',
        },
        {},
        "load",
        "viscosity",
    ),
    "one body": ({"modulus": None, "youngs_modulus": '"2 MPa"', "poisson_ratio": '"0.4 +- 10 %"'}, {}, "modulus"),
    "two curved bodies": ({"radius": '"20 mm"', "radius_2": '"20 mm"'}, {}, "radius"),
    "two bodies": (
        {
            "modulus": None,
            "youngs_modulus": '"2 MPa +- 10 %"',
            "poisson_ratio": "0.5",
            "youngs_modulus_2": '"50 MPa"',
            "poisson_ratio_2": "0.3",
        },
        {},
        "modulus",
    ),
}
"""Contact, tables, and what is fitted."""


def written(folder, contact, tables):
    """Write a case with the files that it names, and friction of its contact; return both paths."""
    gaps, pressures = SEPARATION * 0.5e-6, 2.7e6 * 0.06 * np.exp(-SEPARATION - 0.01 * SEPARATION**2)
    rows = "\n".join(f"{gap},{pressure}" for gap, pressure in zip(gaps, pressures, strict=True))
    (folder / "law.csv").write_text(f"gap [m],pressure [Pa]\n{rows}\n")
    rows = "\n".join(f"{q},{density}" for q, density in zip(WAVENUMBER, DENSITY, strict=True))
    (folder / "spectrum.csv").write_text(f"wavenumber [1/m],density [m^4]\n{rows}\n")
    (folder / "oil.csv").write_text("rate [1/s],viscosity [mPa*s]\n" + "\n".join(f"{rate},50" for rate in range(1, 9)))
    case = folder / "case.toml"
    case.write_text(case_text(contact, **tables))
    contact = sb.load_case(case).contact
    speeds = np.geomspace(1e-3, 0.3, 3)
    friction = sb.solve_batch(contact, speed=speeds, rtol=1e-5).friction.total
    data = folder / "data.csv"
    data.write_text("speed (m/s),friction\n" + "\n".join(f"{u},{mu}" for u, mu in zip(speeds, friction, strict=True)))
    return case, data, speeds, friction


def check_round_trip(capsys, folder, contact, tables, free):
    case, data, speeds, friction = written(folder, contact, tables)
    out = folder / "elsewhere" / "fitted.toml"
    out.parent.mkdir()
    answer = call(capsys, "fit", data, case, "--free", *free, "--out", out, "--json")
    assert answer.code == 0, answer.err
    fitted = sb.load_case(out)
    if "beta" in fitted.errors and "beta" not in free:  # it follows the height
        assert fitted.errors["beta"] == fitted.errors["roughness"]
        assert fitted.errors.correlations[frozenset(("roughness", "beta"))] > 0.999
    back = fitted.contact
    again = sb.solve_batch(back, speed=speeds, rtol=1e-5).friction.total
    np.testing.assert_allclose(again, friction, rtol=1e-4)
    for each in json.loads(answer.out)["inputs"]:
        assert math.isclose(getattr(back, each["name"]), each["value"], rel_tol=1e-8)


SHORT = ("Persson, spectrum", "data sheet", "two bodies")  # The files, the liquid and both bodies of all


@pytest.mark.parametrize("name", [pytest.param(name, marks=[] if name in SHORT else pytest.mark.slow) for name in CASES])
def test_a_fitted_case_has_the_fitted_curve_whatever_gives_its_law_and_its_inputs(capsys, tmp_path, name):
    contact, tables, *free = CASES[name]
    check_round_trip(capsys, tmp_path, contact, tables, free)


def test_a_case_that_cannot_be_written_is_refused_before_the_fit(capsys, tmp_path):
    case, data, *_ = written(tmp_path, {}, {})
    inline = ", ".join(f"{key} = {value}" for key, value in CONTACT.items())
    case.write_text(f"contact = {{{inline}}}\n")
    picture = tmp_path / "fit.png"
    answer = call(capsys, "fit", data, case, "--out", tmp_path / "fitted.toml", "--plot", picture)
    assert answer.code == 2 and "on a line of its own in [contact]" in answer.err
    assert not picture.exists() and not (tmp_path / "fitted.toml").exists()


@pytest.mark.slow
def test_a_fitted_case_has_the_errors_of_the_fit_and_what_still_holds_of_the_correlations_it_had(capsys, tmp_path, subtests):
    uncertain = {"load": '"20 N/m +- 3 %"', "radius": '"10 mm +- 2 %"'}
    surface = {"surface": SURFACE | {"h_rms": '"1 um +- 9 %"', "beta_error": '"9 %"'}}
    for name, contact, tables, tied, free in (
        ("one body", *CASES["one body"][:2], {"load": {"radius": 0.5}}, ["modulus"]),
        ("no height", NOTHING, surface, {"load": {"radius": 0.5, "beta": 0.4}}, ["roughness"]),
        ("shape alone", NOTHING, surface, {"load": {"radius": 0.5, "roughness": 0.4}}, ["roughness", "beta"]),
    ):
        with subtests.test(name=name):
            case, data, *_ = written(tmp_path, contact | uncertain, tables)
            pairs = ", ".join(f"{first}.{other} = {each}" for first, others in tied.items() for other, each in others.items())
            case.write_text(f"correlations = {{ {pairs} }}\n{case.read_text()}")
            answer = call(capsys, "fit", data, case, "--free", *free, "--out", tmp_path / "fitted.toml", "--force")
            assert answer.code == 0, answer.err
            back, found = sb.load_case(tmp_path / "fitted.toml"), sb.fit(data, case, free=free, intervals=False).errors
            assert {each: back.errors[each] for each in free} == pytest.approx({each: found[each] for each in free}, rel=1e-3)
            assert back.errors.correlations == pytest.approx(found.correlations | {frozenset(uncertain): 0.5})


def test_a_factor_that_curves_share_is_written_into_those_of_the_case(capsys, tmp_path):
    case, data, out = tmp_path / "case.toml", tmp_path / "data.csv", tmp_path / "fitted.toml"
    case.write_text(case_text({}) + '\n[fit.curves."b 2"]\nviscosity = "5 mPa*s"  # thin\n')
    known, speeds = sb.load_case(case).contact, np.geomspace(1e-2, 1, 3)
    rows = ["curve,speed (m/s),friction"]
    for name, viscosity in (("a", 1.25 * known.viscosity), ("b 2", 6.25e-3)):
        friction = sb.solve_batch(known.replace(viscosity=viscosity), speed=speeds).friction.total
        rows += [f"{name},{u},{mu}" for u, mu in zip(speeds, friction, strict=True)]
    data.write_text("\n".join(rows))
    assert call(capsys, "fit", data, case, "--free", "viscosity", "--out", out).code == 0
    back = sb.load_case(out)
    found = back.contact.viscosity / known.viscosity, back.fit.curves["b 2"]["viscosity"] / 5e-3
    assert found == pytest.approx((1.25, 1.25), rel=1e-4)


def test_the_roughness_of_a_surface_scales_it_as_a_whole(capsys, tmp_path):
    contact, tables = PERSSON, {"surface": SURFACE}
    case, data, *_ = written(tmp_path, contact, tables)
    found = sb.fit(data, case, free=["roughness"], intervals=False)
    known = sb.load_case(case).contact
    assert found.contact.beta / known.beta == pytest.approx(found.contact.roughness / known.roughness, rel=1e-9)
    assert any("beta follows" in note for note in found.notes) and "beta" not in found.held


def test_errors_of_a_fitted_surface_propagate_to_the_band_of_the_fit(tmp_path):
    case, data, speeds, friction = written(tmp_path, NOTHING, {"surface": SURFACE})
    rows = zip([*speeds, *speeds], [*friction * 1.02, *friction * 0.98], strict=True)
    data.write_text("speed (m/s),friction\n" + "\n".join(f"{u},{mu}" for u, mu in rows))
    found = sb.fit(data, case, free=["roughness", "modulus"], intervals=False)
    (low,), (high,) = found.band(0, speeds[1:2])[1:]
    spread = sb.propagate(found.contact.replace(speed=speeds[1]), found.errors, transitions=False)["friction"]
    assert math.log(spread.interval_95[1] / spread.interval_95[0]) == pytest.approx(math.log(high / low), rel=0.1)


@pytest.mark.slow
def test_the_preferred_model_of_several_files_is_a_case_that_solves_as_it_was_fitted(capsys, tmp_path, subtests):
    speeds = np.geomspace(3e-3, 0.3, 5)
    case, out = tmp_path / "case.toml", tmp_path / "elsewhere.toml"
    uncertain = {"load": '"20 N/m +- 3 %"', "radius": '"10 mm +- 2 %"', "roughness": '"1 um +- 9 %"', "beta": '"0.06 +- 5 %"'}
    case.write_text(case_text(uncertain, correlations={"load": "{ radius = 0.5, beta = 0.4, roughness = 0.1 }"}))
    own = sb.load_case(case).contact
    for truth, options, said in (
        ({"cavitation": "exit"}, ("--models", "cavitation"), "the case of exit"),
        ({"law": sb.contact_laws.GreenwoodTripp(), "alpha": 1.0}, (), "the case of greenwood-tripp"),
    ):
        with subtests.test(truth=truth):
            friction = sb.solve_batch(own.replace(**truth), speed=speeds).friction.total
            for name, rows in (("a.csv", slice(3)), ("b.csv", slice(3, None))):
                lines = "\n".join(f"{u},{mu}" for u, mu in zip(speeds[rows], friction[rows], strict=True))
                (tmp_path / name).write_text(f"speed (m/s),friction\n{lines}\n")
            tokens = (tmp_path / "a.csv", tmp_path / "b.csv", case, "--free", "roughness", *options)
            answer = call(capsys, "compare", *tokens, "--out", out, "--force")
            assert answer.code == 0 and said in answer.out, answer.err
            back, errors = sb.load_case(out).contact, sb.load_case(out).errors
            assert errors.keys() == uncertain.keys() and errors.correlations[frozenset(("load", "radius"))] == 0.5
            assert frozenset(("load", "roughness")) not in errors.correlations  # the roughness is fitted
            solved = sb.solve_batch(back, speed=speeds).friction.total
            np.testing.assert_allclose(solved, friction, rtol=1e-3)
            assert "# Fitted by stribeck" in out.read_text() and " to a, b." in out.read_text()
