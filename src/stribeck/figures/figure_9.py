"""Figure 9: asperities that reach through the film: friction around its minimum, and film and friction at the minimum."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from .._types import Array
from ..asymptotics import mixed, transitions
from ..asymptotics.constants import FILM_CONSTANT
from ..curve import Landmark
from ..parameters import Groups
from . import style
from .paper_figure import PaperFigure, Report
from .states import Work, column, dataset
from .stribeck_cases import (
    CASES,
    LOADS,
    REPORT_COLOURS,
    REPORTED,
    case_coords,
    drawn_cases,
    over,
    report_variables,
    solved_cases,
)

if TYPE_CHECKING:
    import xarray
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

SPEEDS = 1e-8, 1e3
ROUGHNESSES = tuple(10.0 ** (exponent / 2) for exponent in range(-12, -4))
"""Roughness groups at which minima are solved, 1e-6 to 3e-3 in half decades."""

WINDOW = 0.03, 3.0
"""Speeds around the predicted minimum between which it is looked for."""

NUMBERS = 1e-9, 0.49
"""Values of k over which Lambda is compared with the reported ranges."""

FORMS = {
    "exact": (r"Lambert's $W$", style.DASHED),
    "expansion": ("its expansion", style.DOTTED),
    "uniform": ("ours", "-"),
}
FRICTIONS = {
    "friction_exact": (r"with Lambert's $W$", style.DASHED),
    "friction_leading": (r"$\Lambda = -\ln k$, power $+2/3$", style.DOTTED),
    "friction_printed": (r"as printed, power $-2/3$", (0, (1, 3))),
    "friction_uniform": ("ours", "-"),
}
"""Label and dashes of each law of the minimum."""

LOAD_COLOURS = (style.FLUID, style.CONTACT)


def _compute(report: Report) -> xarray.Dataset:
    work = Work(report, steps=len(CASES) + len(LOADS) * len(ROUGHNESSES))
    curves = solved_cases(work, SPEEDS, points=67)
    friction = over(curves, "friction")
    laws = {
        "law_large": np.array([mixed.friction.function(curve.groups, film="large") for curve in curves]),
        "law_uniform": np.array([mixed.friction.function(curve.groups, film="uniform") for curve in curves]),
    }
    film = np.array([FILM_CONSTANT * curve.values**0.6 / float(curve.groups.relative_roughness[0]) for curve in curves])
    at = Groups(1.0, np.array(LOADS)[:, None], np.array(ROUGHNESSES))
    kappa = np.asarray(at.relative_roughness)
    expected = np.asarray(transitions.speed_at_minimum.function(at, form="exact"))
    found = [
        [_minimum(work, LOADS[i], ROUGHNESSES[j], speed) for j, speed in enumerate(row)] for i, row in enumerate(expected)
    ]
    speeds = np.array([[mark.value for mark in row] for row in found])
    ratio = np.array([[mark.solution.lambda_ratio for mark in row] for row in found])
    least = np.array([[mark.friction for mark in row] for row in found])
    film_ratio = FILM_CONSTANT * speeds**0.6 / kappa
    ratios = {form: np.asarray(transitions.lambda_ratio_at_minimum.function(at, form=form)) for form in FORMS}
    minima = {
        "friction_exact": transitions.friction_at_minimum.function(at, form="exact"),
        "friction_leading": transitions.friction_at_minimum.function(at, form="leading"),
        "friction_printed": transitions.friction_at_minimum.function(at, printed=True),
        "friction_uniform": transitions.friction_at_minimum.function(at),
    }
    numbers = np.geomspace(*NUMBERS, 121)
    # At load 1, beta = mu_0 = 1 the number k stands for the roughness alone.
    alone = (numbers / float(transitions.weakening_number(Groups(1.0, 1.0, 1.0)))) ** 1.5
    against = transitions.lambda_ratio_at_minimum.function(Groups(1.0, 1.0, alone), form="exact")
    near = (film > 4) & (film < 12) & (np.array([load for load, _ in CASES])[:, None] > 0)
    finding = _finding(laws, friction, near, ratio, film_ratio, ratios, least, minima)
    grid, map_ = ("case", "speed"), ("minimum_load", "minimum_roughness")
    variables = {
        "friction": column(grid, friction, "friction coefficient, definition paper"),
        "hydrodynamic_friction": column(
            grid, over(curves, "hydrodynamic_friction"), "friction of smooth surfaces, root of squares"
        ),
        "law_large": column(grid, laws["law_large"], "friction by the formula of the paper, film of slow speed"),
        "law_uniform": column(grid, laws["law_uniform"], "friction by our formula for any film"),
        "film_ratio": column(grid, film, "film ratio c lambda^(3/5)/kappa"),
        "speed_at_minimum": column(map_, speeds, "speed group of least friction, solved"),
        "lambda_ratio": column(map_, ratio, "central gap over h_rms/alpha at least friction, solved"),
        "film_ratio_at_minimum": column(
            map_, film_ratio, "c lambda^(3/5)/kappa at least friction, solved: the paper's Lambda"
        ),
        "least_friction": column(map_, least, "least friction coefficient, solved"),
        "lambda_of_number": column("k", against, "Lambda at the minimum by Lambert's W"),
    }
    variables |= {f"lambda_{form}": column(map_, value, f"Lambda at the minimum, {form}") for form, value in ratios.items()}
    variables |= {name: column(map_, value, f"least friction, {name.split('_')[1]}") for name, value in minima.items()}
    coords = case_coords() | {
        "speed": column("speed", curves[0].values, "speed group lambda"),
        "minimum_load": column("minimum_load", LOADS, "load group"),
        "minimum_roughness": column("minimum_roughness", ROUGHNESSES, "roughness group h_rms"),
        "k": column("k", numbers, "k = 2/(9 c^(5/3)) beta h_rms^(2/3) F^(1/3)/mu_0"),
    }
    reports = "; ".join(REPORTED)
    return dataset(variables | report_variables(), coords, finding=finding, reports=reports, **work.attributes)


def _minimum(work: Work, load: float, roughness: float, speed: float) -> Landmark:
    low, high = WINDOW
    found = work.curve(load=load, roughness=roughness, speed=(low * speed, high * speed), points=11).minimum
    assert found is not None, f"no minimum of friction at load {load:g}, roughness {roughness:g} near speed {speed:g}"
    return found
