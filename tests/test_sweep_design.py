"""A sweep file says which states there are; all that is wrong with one is told in sentences."""

import numpy as np
import pytest
from sweep_files import CONTACT, GRID, RANDOM, write

import stribeck as sb

VARY = """
[vary]
load = ["10 N/m", "30 N/m"]
roughness = { range = ["0.5 um", "2 um"], points = 3 }
speed = { range = ["0", "1 m/s"], points = 5, spacing = "linear" }
""".replace('"0"', "0")


def load(folder, text):
    return sb.load_sweep(write(folder, text))


def test_a_grid_holds_every_combination_the_last_axis_fastest(tmp_path):
    design = load(tmp_path, CONTACT + VARY)
    assert (design.kind, design.shape, len(design)) == ("grid", (2, 3, 5), 30)
    assert design.varied == ("load", "roughness", "speed")
    cube = {name: design.inputs[name].reshape(design.shape) for name in design.varied}
    assert cube["load"][:, 1, 1].tolist() == [10.0, 30.0]
    assert cube["roughness"][1, :, 4] == pytest.approx([0.5e-6, 1e-6, 2e-6], rel=1e-12)
    assert cube["speed"][1, 2] == pytest.approx([0, 0.25, 0.5, 0.75, 1.0])


def test_each_state_has_the_groups_of_its_contact(tmp_path):
    design = load(tmp_path, CONTACT + VARY)
    for i in (0, 7, 29):
        contact = sb.LineContact(**{name: design.inputs[name][i] for name in sb.LineContact.INPUTS.names})
        assert contact.radius == 0.01
        groups = contact.groups
        assert design.groups[i].tolist() == [groups.speed, groups.load, groups.roughness]


def test_youngs_modulus_and_poisson_ratio_may_vary(tmp_path):
    text = CONTACT.replace('modulus = "2.7 MPa"', "poisson_ratio = 0.5") + 'load = 30\nspeed = 0.1\nroughness = "1 um"\n'
    design = load(tmp_path, text + '[vary]\nyoungs_modulus = ["1 MPa", "3 MPa"]\n')
    assert design.inputs["modulus"] == pytest.approx([4e6 / 3, 4e6])
    assert design.inputs["youngs_modulus"].tolist() == [1e6, 3e6]
    assert design.inputs["poisson_ratio"].tolist() == [0.5, 0.5]


def test_groups_may_vary_with_the_coefficients_of_friction(tmp_path):
    design = load(
        tmp_path, "[groups]\nspeed = 1e-4\nload = 0.1\n[vary]\nroughness = [0, 1e-3]\nboundary_friction = [0.5, 1]\n"
    )
    assert design.contacts is None
    assert design.groups.tolist() == [[1e-4, 0.1, 0.0]] * 2 + [[1e-4, 0.1, 1e-3]] * 2
    assert design.inputs["boundary_friction"].tolist() == [0.5, 1.0, 0.5, 1.0]
    assert design.inputs["beta"].tolist() == [1.0] * 4


def test_a_list_takes_the_lists_together(tmp_path):
    design = load(
        tmp_path, '[groups]\nload = 0.1\n[design]\nkind = "list"\n[vary]\nspeed = [1e-4, 2e-4]\nroughness = [1e-3, 0]\n'
    )
    assert design.groups.tolist() == [[1e-4, 0.1, 1e-3], [2e-4, 0.1, 0.0]]


def test_a_random_design_fills_its_ranges_and_its_seed_repeats_it(subtests, tmp_path):
    for kind in ["random", "latin-hypercube", "sobol"]:
        with subtests.test(kind=kind):
            text = RANDOM.format(kind=kind, points=64)
            design, again = load(tmp_path, text), load(tmp_path, text)
            other = load(tmp_path, text.replace("20261", "20262"))
            assert np.array_equal(design.groups, again.groups)
            assert not np.array_equal(design.groups, other.groups)
            assert design.fingerprint == again.fingerprint != other.fingerprint
            for column, low, high in zip(design.groups.T, (1e-6, 0.01, 1e-4), (1.0, 0.5, 1e-2), strict=True):
                parts = np.log(column / low) / np.log(high / low)
                assert parts.min() >= 0 and parts.max() <= 1
                halves = np.histogram(parts, bins=2, range=(0, 1))[0]
                slots = np.histogram(parts, bins=64, range=(0, 1))[0]
                if kind == "random":
                    assert halves.min() > 16
                else:  # what these designs promise: each of n slots of an axis holds one point
                    assert slots.tolist() == [1] * 64


def test_a_random_design_draws_from_a_list_in_equal_parts(tmp_path):
    text = RANDOM.format(kind="sobol", points=64).replace("load = { range = [0.01, 0.5] }", "load = [0.1, 0.2, 0.3, 0.4]")
    values, counts = np.unique(load(tmp_path, text).groups[:, 1], return_counts=True)
    assert (values.tolist(), counts.tolist()) == ([0.1, 0.2, 0.3, 0.4], [16] * 4)


def test_the_fingerprint_is_that_of_the_states_and_not_of_the_comments(tmp_path):
    base = load(tmp_path, GRID)
    assert load(tmp_path, "# why\n" + GRID).fingerprint == base.fingerprint
    for changed in (
        GRID.replace("boundary_friction = 0.8", "boundary_friction = 0.9"),
        GRID.replace("17", "18"),
        GRID + "[solver]\nrtol = 1e-5\n",
    ):
        assert load(tmp_path, changed).fingerprint != base.fingerprint


GROUPS = "[groups]\nload = 0.1\nroughness = 1e-3\n"


def test_a_store_of_groups_is_found_again_whatever_the_classes_of_their_model_are_called(tmp_path, monkeypatch):
    text = GROUPS + "[vary]\nspeed = { range = [1e-6, 1e-4], points = 2 }\n"
    base = load(tmp_path, text).fingerprint
    monkeypatch.setattr(type(sb.Groups(1e-5, 0.1, 1e-3).model), "__repr__", lambda self: "another")
    ball = load(tmp_path, text.replace("[groups]", "[groups]\ngeometry = 'point'"))
    assert load(tmp_path, text).fingerprint == base != ball.fingerprint


RANGE, KIND = "speed = {{ range = {}, points = 3 }}", '\n[design]\nkind = "{}"\n'
# What stands behind GROUPS and [vary], and what is said.
WRONG_VARY = [
    ("", "[vary] is empty; list what varies, for example: load = ['10 N/m', '30 N/m']."),
    ("speed = []", "[vary] speed = [] is empty; list its values."),
    ("speed = 3", "[vary] speed = 3 must be a list of values, or a range as in"),
    ("speed = [1, -1]", "[vary] speed = -1 must be zero or positive."),
    ('speed = ["1 m/s"]', "[vary] speed = '1 m/s' is text, but a number is expected; write a bare number without quotes"),
    ("mu0 = [1]", "[vary] 'mu0' cannot vary; write boundary_friction."),
    ("spede = [1]", "[vary] 'spede' cannot vary; did you mean speed."),
    ("speed = [1]\nload = [0.1]", "[groups] load = 0.1 also stands in [vary]; keep one of them."),
    ("speed = { range = [1, 2] }", "[vary] speed: points = None must be a whole number from 2 to"),
    (RANGE.format("[2, 1]"), "speed: range = [2, 1] must increase; write the lowest"),
    (RANGE.format("[0, 1]"), "speed: range = [0, 1] begins at zero; add spacing"),
    (RANGE.format("1"), "speed: range = 1 must be a list of two values"),
    ("speed = { range = [1, 2], points = 3, scale = 1 }", "speed has the unknown key 'scale'; known"),
    ('speed = { range = [1, 2], points = 3, spacing = "even" }', "spacing = 'even' must be 'log' or"),
    (
        RANGE.format("[1, 2]") + KIND.format("random") + "points = 4",
        "[vary] speed: points = 3 is for grids; with kind = 'random'",
    ),
    (RANGE.format("[1, 2]") + KIND.format("list"), "'points': 3} must be a list of values."),
    ("speed = [1]\n[design]\npoints = 4", "[design] points = 4 is for random, latin-hypercube, sobol;"),
    ("speed = [1]" + KIND.format("sobol"), "[design] points is missing; set how many states"),
    ("speed = [1]" + KIND.format("sobol") + "points = 100", "must be a power of two for kind = 'sobol'"),
    ("speed = [1]" + KIND.format("star"), "[design] kind = 'star' must be one of 'grid', 'list', 'random'"),
    ("speed = [1]" + KIND.format("random") + "points = 0", "points = 0 must be a whole number from 1 to"),
    ("speed = [1]\n[solver]\nrtol = 1", "[solver] rtol = 1 must be a number from 1e-11 to 1e-2"),
]
LISTS = '[groups]\nload = 0.1\n[design]\nkind = "list"\n[vary]\nspeed = [1, 2]\nroughness = [1]\n'
MANY = "speed={range=[1,2],points=2000}\nroughness={range=[1,2],points=2000}\n"
WRONG_FILES = [
    ("", "is empty; a sweep file needs at least the table [vary]."),
    (GROUPS, "the table [vary] is missing."),
    ("[groups]\nload = 0.1\n[vary]\nspeed = [1]\n", "[groups] roughness is missing; add it there or to [vary]."),
    (GROUPS + "rough = 1\n[vary]\nspeed = [1]\n", "[groups] rough = 1 is not a known key; did you mean roughness."),
    (GROUPS + "[contact]\n[vary]\nspeed = [1]\n", "the tables [contact] and [groups] are both given"),
    (LISTS, "[vary] the lists must have the same length with kind = 'list': speed has 2, roughness has 1."),
    (f"[groups]\nload = 0.1\n[vary]\n{MANY}", "[vary] makes 4000000 states; at most 1000000 are possible in one sweep."),
    (
        CONTACT + '[vary]\nload = [30]\nspeed = ["1 s"]\nroughness = [0]\n',
        "[vary] speed = '1 s' is a time; expected a speed such",
    ),
    (CONTACT + "[vary]\nload = [30]\nspeed = [1]\n", "[contact] roughness is missing; add a length, for example"),
    (CONTACT + "[vary]\nload=[1]\nspeed=[1]\nroughness=[1]\nyoungs_modulus=[1e6]\n", "give either modulus, or youngs_modulus"),
    (CONTACT + "[vary]\nload=[1e-300]\nspeed=[1e300]\nroughness=[1]\n", "the dimensionless groups of this contact"),
]


def test_what_is_wrong_is_told_in_a_sentence_that_names_the_key(subtests, tmp_path):
    cases = [*WRONG_FILES, *((f"{GROUPS}[vary]\n{text}\n", said) for text, said in WRONG_VARY)]
    for text, sentence in cases:
        with subtests.test(sentence):
            with pytest.raises(sb.InputError) as caught:
                load(tmp_path, text)
            lines = str(caught.value).splitlines()
            assert any(sentence in line for line in lines), lines
            assert all(line.startswith(str(tmp_path / "sweep.toml")) and line.endswith(".") for line in lines)


def test_all_problems_are_told_in_one_go(tmp_path):
    with pytest.raises(sb.InputError) as caught:
        load(tmp_path, '[groups]\nload = "x"\n[vary]\nspede = [1]\n[solver]\nrtol = 2\n[design]\nkind = "grid"\n')
    assert len(str(caught.value).splitlines()) == 5  # roughness and speed are missing too
