"""The picture of a curve says what the printed text and the checks say: verdict, interval by errors, doubtful stretch."""

import math
import re
from statistics import NormalDist

import numpy as np
import pytest
from command_line import HEAVY, PDMS, call, case_text
from matplotlib.figure import Figure

import stribeck as sb

ERROR = 0.2
SIGMA = math.sqrt(math.log1p(ERROR**2))
"""Relative error of the dry friction below, and that of its logarithm: where asperities carry all, it is friction's too."""


@pytest.fixture
def drawn(monkeypatch):
    """Return the figures that are written, as they are."""
    figures, write = [], Figure.savefig
    monkeypatch.setattr(
        Figure, "savefig", lambda self, *given, **options: [figures.append(self), write(self, *given, **options)]
    )
    return figures


@pytest.fixture
def case(tmp_path):
    path = tmp_path / "case.toml"
    path.write_text(case_text({"boundary_friction": f'"0.7 +- {100 * ERROR:g} %"', "speed": '"1 um/s"'}))
    return path


def caption(figure):
    return " ".join(text.get_text() for text in reversed(figure.texts))


def hatched(axes):
    return [each for each in axes.collections if each.get_label() == "contact law outside its range"]


def normal_width(label, low, high):
    """Return the width of an interval in standard errors of its logarithm, over that which the label's probability has."""
    (per_cent,) = re.findall(r"([\d.]+) %", label)
    whole = 2 * NormalDist().inv_cdf(0.5 + float(per_cent) / 200)
    return math.log(high / low) / SIGMA / whole


def test_picture_and_text_of_the_command_have_the_interval_of_the_errors(case, drawn, capsys, tmp_path):
    options = "--over", "roughness", "--range", "2 um", "4 um"
    answer = call(capsys, "curve", case, *options, "--points", 3, "--rtol", "1e-3", "-v", "--plot", tmp_path / "curve.png")
    assert answer.code == 0, answer.err
    [band] = [each for each in drawn[0].axes[0].collections if "by errors of the inputs" in each.get_label()]
    heights = band.get_paths()[0].vertices[:, 1]
    assert normal_width(band.get_label(), heights.min(), heights.max()) == pytest.approx(1, abs=0.05)
    head, low, high = re.search(
        r"with errors of the inputs +value +(\S+ %).*?friction coefficient, balanced +\S+ +(\S+) to (\S+)",
        answer.out,
        re.DOTALL,
    ).groups()
    assert normal_width(head, float(low), float(high)) == pytest.approx(1, abs=0.05)
    assert drawn[0].axes[0].get_ylim()[1] > heights.max()


def test_picture_and_text_of_the_command_say_what_check_says(drawn, capsys, tmp_path):
    options = ("--range", "0.4 m/s", "0.6 m/s", "--points", 2, "--rtol", "1e-2")
    [sentence] = [line for line in call(capsys, "check", HEAVY).out.splitlines() if "he model" in line][:1]
    for i, extra in enumerate([(), ("--no-notes",)]):
        answer = call(capsys, "curve", HEAVY, *options, "--plot", tmp_path / f"curve{i}.png", *extra)
        assert sentence.split(":")[0] in answer.out
        assert (sentence in caption(drawn[i])) == (not extra)


def test_a_curve_off_the_atlas_is_hatched_where_the_solved_one_is(subtests):
    for speeds, points in [(("1 mm/s", "1 m/s"), 12), (("0.1 mm/s", "3 mm/s"), 3)]:
        with subtests.test(speeds=speeds):
            contact = sb.load_case(PDMS).contact
            solved = sb.stribeck_curve(contact, speed=speeds, points=points, rtol=1e-3)
            read = sb.stribeck_curve(contact, speed=speeds, points=points, method="atlas")
            strips = [hatched(each.plot().axes[0]) for each in (solved, read)]
            assert len(strips[0]) == len(strips[1])
            np.testing.assert_array_equal(solved.law_in_doubt, read.law_in_doubt)
            assert bool(strips[0]) == solved.law_in_doubt.any()


def test_groups_are_judged_by_the_coefficients_that_are_given():
    options = {"load": 0.1, "roughness": 3e-3, "speed": (0.05, 1.0), "points": 12, "beta": 0.06}
    for method in ("solver", "atlas"):
        few, many = (
            sb.stribeck_curve(method=method, boundary_friction=dry, **options).law_in_doubt.sum() for dry in (1e-4, 1.0)
        )
        assert few < many
