"""Odd values end in a result, an outcome or one sentence: never in an exception from the depths, and in bounded time."""

import inspect
import math
import re

import numpy as np
import pytest
from command_line import PDMS, call
from fit_data import TRUE as CONTACT

import stribeck as sb
from stribeck import asymptotics

NO_NUMBERS = [
    *(None, True, "1", "x", "", b"1", [], {}, {"a": 1}, 1j, object(), math.nan, math.inf, -math.inf, -1.0, 10**400),
    *(np.bool_(True), np.array([]), np.array(["a"]), [[1], [1, 2]], [1e-3, math.nan]),
]
GROUPS = sb.Groups(1e-4, 0.1, 1e-4)


def says_why(error):
    """Tell whether a message is one sentence or a few, and none of the depths."""
    return re.fullmatch(r"[^\n]{20,600}[.]", str(error)) and "signs" not in str(error)


def answered(call, *given, **named):
    """Return the sentence with which a call refuses its input, or what else came of it."""
    try:
        found = call(*given, **named)
    except sb.InputError as error:
        return str(error) if says_why(error) else f"no sentence: {error}"
    except Exception as error:  # whatever comes from the depths is a fault of its own
        return f"{type(error).__name__}: {error}"
    return f"was taken and gave {found!r:.40}"


def faults(pattern, cases):
    """Return what each labelled call answers whose sentence does not match the pattern."""
    answers = ((label, answered(*call)) for label, *call in cases)
    return [f"{label!r:.60}: {answer}" for label, answer in answers if not re.search(pattern, answer)]


# --- groups ---

STATE = {"speed": 1e-4, "load": 0.1, "roughness": 1e-4}
NO_GROUPS = [*NO_NUMBERS, -1e-300, "1 m/s", [1.0, -1.0], np.longdouble("1e4000")]


def test_a_group_that_is_no_number_or_beyond_every_contact_is_refused_by_its_name():
    # No states at all are an array as any other.
    values = [value for value in NO_GROUPS if not (isinstance(value, list | np.ndarray) and len(value) == 0)]
    for name in STATE:
        assert not faults(f"^{name} ", [(value, lambda value=value: sb.Groups(**STATE | {name: value})) for value in values])
        far = (1e-301, 1e301, np.array([0.1, 1e-320]))
        calls = [(value, lambda value=value: sb.Groups(**STATE | {name: value})) for value in far]
        assert not faults(f"^{name} .* from 1e-300 to 1e[+]300; check the units", calls)


def test_the_relative_roughness_has_that_range_too_and_pairs_of_arrays_are_judged_as_pairs():
    with pytest.raises(sb.InputError, match="relative roughness has the value 1e-310"):
        sb.Groups(1.0, 1e150, 1e-160)
    with pytest.raises(sb.InputError, match="has the value 1e[+]305"):
        sb.Groups(1.0, np.array([1.0, 1e-155]), np.array([0.0, 1e150]))
    sb.Groups(1.0, np.array([1e-150, 1e100]), np.array([1e-150, 1e100]))


def test_the_ends_of_the_range_are_in_it_also_as_exponentials_of_logarithms():
    for value in (1e-300, 1e300):
        assert sb.Groups(value, 1.0, 0.0).speed == value
        found = math.exp(math.log(value))
        assert sb.Groups(found, 1.0, 0.0).speed == found


# --- states ---


@pytest.mark.filterwarnings("error")
def test_a_state_far_from_any_contact_ends_in_a_result_or_in_words(subtests):
    for state in [
        *((1e200, 1e-3, 1e-4), (1e30, 1e-2, 1e-5), (1e-200, 1e-8, 1e92), (1.0, 1e-12, 1e30)),
        *((1e200, 1e100, 0.0), (0.0, 1.0, 1e-200), (1e200, 1e-200, 1e-200)),
    ]:
        with subtests.test(state=state):
            try:
                solution = sb.solve(sb.Groups(*state))
            except sb.SolveError as error:
                assert not error.outcome.ok
                assert says_why(error) and "The solver has not been tested for" in str(error)
            else:
                assert solution.outcome.ok and math.isfinite(solution.central_gap)
    for state in ((1e-200, 1e-3, 1e-6), (1e6, 1e60, 0.0), (1e14, 1e-8, 1e-11)):  # which did converge
        assert sb.solve(sb.Groups(*state)).outcome.ok


# --- curves ---

BAD_RANGES = [
    *((1e-3, 1e-3), (1e-2, 1e-3), (1e-3, math.nan), (1e-3, math.inf), (0.0, 1.0), (-1.0, 1.0), [], [1e-3], np.array([])),
    *(np.array(["a"]), [[1e-3, 1e-2]], [[1], [1, 2]], (1e-310, 1.0), (1e-3, 1e305), "x", {"a": 1}, (1e-3, None)),
]


def test_a_range_that_is_none_is_refused_by_its_name_or_asked_for():
    for over in STATE:
        calls = [(value, lambda value=value: sb.stribeck_curve(**STATE | {over: value}, points=3)) for value in BAD_RANGES]
        assert not faults(over, calls)
    for load, roughness in [(1e-100, 1e100), (1e-200, 1.0)]:
        with pytest.raises(sb.SolveError, match="give a range of speeds"):
            sb.stribeck_curve(load=load, roughness=roughness)


# --- choices, coefficients, positions ---


def test_a_choice_that_is_none_of_the_words_is_refused():
    state = sb.solve(GROUPS)
    asks = {
        "friction": lambda value: state.friction(definition=value),
        "solve": lambda value: sb.solve(GROUPS, on_failure=value),
        "curve": lambda value: sb.stribeck_curve(load=0.1, roughness=1e-4, speed=(1e-4, 1e-3), points=2, method=value),
        "formula": lambda value: asymptotics.uniform.friction(GROUPS, definition=value),
    }
    calls = [(name, ask, value) for name, ask in asks.items() for value in (None, 1, "x", np.array([]), [], math.nan)]
    assert not faults("must be", calls)


def test_a_coefficient_that_is_no_number_is_refused_by_every_law_of_friction():
    for name in ("boundary_friction", "beta"):
        for law in (asymptotics.uniform.friction, asymptotics.mixed.friction, asymptotics.transitions.speed_at_minimum):
            calls = [(value, lambda value=value, law=law: law(GROUPS, **{name: value})) for value in NO_NUMBERS]
            assert not faults(f"^{name} = ", calls), law.name


def test_positions_and_shares_that_are_no_numbers_are_refused():
    values = ("x", "", {}, 1j, object(), [[1], [1, 2]], np.array(["a"]), 10**400)
    dry, share = sb.Groups(0.0, 0.1, 1e-7), asymptotics.load_sharing.speed_at_fluid_share
    calls = [("pressure", asymptotics.hertz.pressure, dry, value) for value in (*values, None)]
    calls += [("share", share, GROUPS, value) for value in (*values, None)]
    calls += [("profile", sb.solve(GROUPS).profile, value) for value in values]
    assert not faults("not made of real numbers", calls)


def test_a_formula_asks_for_groups():
    values = (0.1, None, "x", (1.0, 1.0, 1.0), sb.Groups)
    calls = [((formula.name, value), formula, value) for formula in asymptotics.FORMULAS for value in values]
    assert not faults(r"^groups = .*give Groups\(speed, load, roughness\)", calls)


# --- public functions given arguments of a wrong kind ---

ODD = (
    *(None, True, "1 mm", "typo", float("nan"), float("inf"), 0, -1.0, np.float64(0.5), np.array(0.5)),
    *([], {}, object(), 1j, b"x"),
)
"""What people and programs pass by mistake."""

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
    "Groups(speed, load, roughness); give the contact of the case, case.contact.": lambda: sb.solve(sb.load_case(PDMS)),
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
    assert sb.solve(CONTACT, rtol=np.float32(1e-3)).outcome.ok
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
