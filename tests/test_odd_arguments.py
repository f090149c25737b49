"""Public functions given arguments of a wrong kind: they refuse with a sentence that names the argument, before any solve."""

import inspect
import re

import numpy as np
import pytest
from command_line import PDMS, call
from fit_data import TRUE as CONTACT

import stribeck as sb

ODD = (
    *(None, True, "1 mm", "typo", float("nan"), float("inf"), 0, -1.0, np.float64(0.5), np.array(0.5)),
    *([], {}, object(), 1j, b"x"),
)
"""What people and programs pass by mistake."""

GROUPS = sb.Groups(1e-4, 0.1, 1e-3)
SPECTRUM = sb.surfaces.SelfAffine(1e-6, 1e4, 1e6, 0.8)
SCAN = sb.surfaces.synthetic_topography(SPECTRUM, (64, 64), 1e-6, 1)

USUAL = {
    "problem": GROUPS,
    "groups": GROUPS,
    "case": CONTACT,
    "contact": CONTACT,
    "topography": SCAN,
    "roughness": SPECTRUM,
    "spectrum": SPECTRUM,
    "errors": {"load": 0.05},
}
"""Right values of arguments beside the odd one; others get text, which few take."""

MADE_BY_PEOPLE = {
    *("Groups", "LineContact", "PointContact", "GreenwoodTripp", "GreenwoodWilliamson", "FiniteSurface", "FunctionLaw"),
    *("TableLaw", "SelfAffine", "Spectrum", "Topography"),
}
SOLVES = {"solve", "stribeck_curve", "phase_diagram", "explain", "analyse", "Barus", "sweep", "solve_batch", "check"}
"""Those that would begin to solve where an odd argument is one of the right ones; a test of their own is below."""


def called():
    """Return the public functions, and the classes that people make, by name."""
    found = {}
    for module in (sb, sb.surfaces, sb.atlas, sb.fluids, sb.solids):
        for name in module.__all__:
            thing = getattr(module, name)
            if inspect.isfunction(thing) or (
                inspect.isclass(thing) and (name in MADE_BY_PEOPLE or module in (sb.fluids, sb.solids))
            ):
                found[f"{module.__name__}.{name}"] = thing
    return {name: thing for name, thing in found.items() if name.rpartition(".")[2] not in SOLVES}


def test_an_odd_argument_is_refused_in_a_sentence_or_taken_and_never_ends_in_the_depths(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    faults = []
    for name, function in called().items():
        parameters = inspect.signature(function).parameters.values()
        named = [each for each in parameters if each.kind in (each.POSITIONAL_OR_KEYWORD, each.KEYWORD_ONLY)]
        needed = [each.name for each in named if each.default is each.empty]
        for parameter in named:
            for odd in ODD:
                usual = {each: GROUPS if name.endswith("Groups") else USUAL.get(each, "1e-3") for each in needed}
                try:
                    function(**usual | {parameter.name: odd})
                except (sb.InputError, sb.SolveError) as problem:
                    if not all(re.fullmatch(r"[^\n]{20,}[.]", line) for line in str(problem).split("\n")):
                        faults.append(f"{name}({parameter.name}={odd!r}): {problem}")
                except Exception as problem:
                    faults.append(f"{name}({parameter.name}={odd!r}): {problem!r}")
    assert not faults, "\n".join(faults)


REFUSED = {
    "speed = '1 mm/s'": lambda: sb.solve_batch(GROUPS, speed="1 mm/s"),
    "on_progress = True; it must be a function": lambda: sb.solve_batch(GROUPS, on_progress=True),
    "problem = 'typo'; it must be a LineContact": lambda: sb.phase_diagram("typo"),
    "errors = None; it must be a mapping": lambda: sb.propagate(CONTACT, None),
    "errors is empty": lambda: sb.propagate(CONTACT, {}),
    "resolution = 0 is not a positive number": lambda: sb.surfaces.power_spectrum(SCAN, resolution=0),
    "path = None; it must be a path": lambda: sb.load_case(None),
    "x... cannot be looked up": lambda: sb.load_case("x" * 300 + ".toml"),
    "cannot be looked up (File name too long)": lambda: sb.surfaces.read_topography("x" * 300 + ".csv"),
    "rtol = array": lambda: sb.stribeck_curve(GROUPS, rtol=np.array([1e-3])),
    "rtol = '1e-3'; it must be a number": lambda: sb.solve(GROUPS, rtol="1e-3"),
}


def test_a_wrong_argument_is_named_with_its_value_and_what_is_allowed(subtests):
    for words, ask in REFUSED.items():
        with subtests.test(words), pytest.raises(sb.InputError, match=re.escape(words)):
            ask()


def test_a_tolerance_may_be_a_number_of_numpy_and_a_name_of_an_observable_must_be_known():
    curve = sb.stribeck_curve(GROUPS, points=3, rtol=np.float64(1e-2))
    assert curve.rtol == 1e-2 and len(curve.observable("central_gap")) == 3
    for name in ("typo", None, "groups", "_rtol", 3):
        with pytest.raises(sb.InputError, match=r"it must be the name of a number of every solution, such as "):
            curve.observable(name)
    assert sb.explain(CONTACT, rtol=np.float32(1e-3)) is not None
    grid = {"speed": [1e-5, 1e-4], "load": 0.1, "roughness": 1e-3}
    assert sb.phase_diagram(**grid, rtol=np.float64(1e-2)) is not None


LONG = "x" * 300


def test_a_name_of_300_letters_is_refused_by_every_command(subtests, capsys):
    few = ("curve", PDMS, "--points", "3")
    for tokens in [
        ("check", f"{LONG}.toml"),
        ("surface", f"{LONG}.csv"),
        ("fit", f"{LONG}.csv", PDMS),
        ("fit", PDMS, f"{LONG}.toml"),
        ("new", f"{LONG}.toml"),
        (*few, "-o", f"{LONG}.nc"),
        (*few, "--plot", f"{LONG}.png"),
        ("sweep", f"{LONG}.toml", "--out", "store"),
    ]:
        with subtests.test(tokens=tokens):
            answer = call(capsys, *tokens)
            assert answer.code in (1, 2) and "File name too long" in answer.err and "report it" not in answer.err


def test_a_number_of_5000_digits_is_refused_and_not_reported(capsys, tmp_path):
    file = tmp_path / "case.toml"
    file.write_text(PDMS.read_text().replace("[contact]", f"[contact]\nbeta = 0x{'f' * 5000}", 1))
    answer = call(capsys, "check", file)
    assert answer.code == 2 and "report it" not in answer.err
    with pytest.raises(sb.InputError, match="too long to be written"):
        sb.solve(CONTACT, rtol=1 << 20_000)
