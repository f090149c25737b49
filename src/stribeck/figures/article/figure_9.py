"""Figure 9: asperities that reach through the film: friction around its minimum, and film and friction at the minimum."""

from typing import Any

import numpy as np

from stribeck.asymptotics import mixed, transitions
from stribeck.asymptotics.constants import FILM_CONSTANT
from stribeck.contacts.groups import Groups
from stribeck.figures import style
from stribeck.figures.article.stribeck_cases import CASES, LOADS, REPORTED, draw_reports, drawn_cases, over, solve_cases
from stribeck.figures.job import FigureJob, furthest
from stribeck.figures.style import Dataset, Panels
from stribeck.quantities.outcome import Outcome
from stribeck.solver.solve_error import SolveError

# Relative roughnesses at which minima are solved, 1e-5 to 1e-1 in half decades.
KAPPAS = tuple(10.0 ** (exponent / 2) for exponent in range(-10, -1))
STEPS = len(CASES) + len(LOADS) * len(KAPPAS)
SPEED_WINDOW = 0.5, 2.0  # Speeds over the predicted minimum between which the minimum is sought.

# Laws of Lambda at the minimum: by Lambert's W, its expansion, and ours.
LAMBDA_FORMS: tuple[transitions.Form, ...] = ("exact", "expansion", "uniform")

# Film ratios and relative roughness for which the formulas for friction are compared.
MIN_FILM_RATIO, MAX_FILM_RATIO = 3.0, 20.0
MAX_KAPPA = 0.1

# Label and dashes of each law of Lambda at the minimum.
LAMBDA_STYLES = {
    "lambda_exact": (r"Lambert's $W$", style.DASHED),
    "lambda_expansion": ("its expansion", style.DOTTED),
    "lambda_uniform": ("ours", "-"),
}
# Label and dashes of the friction at the minimum by each law.
FRICTION_STYLES = {
    "friction_exact": (r"with Lambert's $W$", style.DASHED),
    "friction_leading": (r"$\Lambda = -\ln k$, power $+2/3$", style.DOTTED),
    "friction_printed": (r"as printed, power $-2/3$", (0, (1, 3))),
    "friction_uniform": ("ours", "-"),
}

DATA_MISSING = (
    "The paper draws data of Bongaerts 2007 here, which are\n"
    "not public to us: bars show the ranges that it quotes,\nat no roughness in particular."
)


def compute(work: FigureJob) -> Dataset:
    """Solve the curves and their minima, and compare them with the formulas."""
    curves, data = solve_cases(work, (1e-8, 1e3), points=67)
    vars(data).update(REPORTED)
    relative = np.array([[roughness / load] for load, roughness in CASES])
    data.film_ratio = FILM_CONSTANT * over(curves, "values") ** 0.6 / relative
    near = (data.film_ratio > MIN_FILM_RATIO) & (data.film_ratio < MAX_FILM_RATIO) & (relative <= MAX_KAPPA)
    data.law_large = np.array([mixed.friction.function(curve.groups, film="large") for curve in curves])
    data.law_uniform = np.array([mixed.friction.function(curve.groups, film="uniform") for curve in curves])
    data.large_error, data.uniform_error = data.law_large / data.friction - 1, data.law_uniform / data.friction - 1
    data.worst_large, data.worst_uniform = furthest(data.large_error[near]), furthest(data.uniform_error[near])
    data.smoothest = furthest(data.large_error[0][near[0]])
    data.minimum_load, data.kappa = LOADS, KAPPAS
    at = Groups(1.0, np.array(LOADS)[:, None], np.array(LOADS)[:, None] * np.array(KAPPAS))
    data.minimum_roughness, data.number = at.roughness, transitions.weakening_number(at)
    expected = np.asarray(transitions.speed_at_minimum.function(at))
    rows = np.broadcast_arrays(at.load, at.roughness, expected)
    found = [[_minimum(work, *each) for each in zip(*row, strict=True)] for row in zip(*rows, strict=True)]
    data.speed_at_minimum, data.separation, data.minimum_friction = np.moveaxis(np.array(found), 2, 0)
    data.film_ratio_at_minimum = FILM_CONSTANT * data.speed_at_minimum**0.6 / np.array(KAPPAS)
    for form in LAMBDA_FORMS:
        law = transitions.separation_at_minimum.function(at, form=form)
        off = np.abs(law / data.separation - 1).max(axis=0)
        vars(data).update({f"lambda_{form}": law, f"off_{form}": off})
    data.friction_exact = transitions.friction_at_minimum.function(at, form="exact")
    data.friction_leading = transitions.friction_at_minimum.function(at, form="leading")
    data.friction_printed = transitions.friction_at_minimum.function(at, printed=True)
    data.friction_uniform = transitions.friction_at_minimum.function(at)
    exact, printed, ours = (
        law / data.minimum_friction for law in (data.friction_exact, data.friction_printed, data.friction_uniform)
    )
    data.k = np.geomspace(1e-9, 0.49, 121)
    # At load 1, beta = mu_0 = 1 the number k stands for the roughness alone.
    alone = (data.k / float(transitions.weakening_number(Groups(1.0, 1.0, 1.0)))) ** 1.5
    data.lambda_of_number = transitions.separation_at_minimum.function(Groups(1.0, 1.0, alone), form="exact")
    data.least_lambda, data.largest_lambda = data.separation.min(), data.separation.max()
    data.ratio_exact, data.least_printed, data.largest_printed = exact.min(axis=0), printed.min(), printed.max()
    data.ours, data.off_ours = furthest(ours.ravel() - 1), data.off_uniform.max()
    return work.dataset(data)


def _minimum(work: FigureJob, load: float, roughness: float, speed: float) -> tuple[float, float, float]:
    """Return speed, Lambda and friction at the minimum of friction near a speed."""
    low, high = (factor * speed for factor in SPEED_WINDOW)
    found = work.curve(load=load, roughness=roughness, speed=(low, high), points=5).minimum
    if found is None:
        where = f"load {load:g}, relative roughness {roughness / load:g}, speed {low:.3g} to {high:.3g}"
        raise SolveError(Outcome.PATH_LOST, None, f"No minimum of friction was found at {where}.")
    return found.value, found.solution.central_separation, found.friction


def draw(panels: Panels, data: Dataset) -> None:
    """Draw figure 9."""
    a, b, d, errors, c, ratios = panels.values()
    for row, look in drawn_cases(data):
        x, shown = row.hydrodynamic_friction, row.film_ratio > MIN_FILM_RATIO
        a.plot(x, row.friction, markevery=2, **look)
        a.plot(x.where(shown), row.law_large.where(shown), color=style.INK, ls=style.DASHED, lw=1.0, zorder=4)
        a.plot(x.where(shown), row.law_uniform.where(shown), color=style.MARK, ls=style.DOTTED, lw=1.6, zorder=5)
        if float(row["roughness"] / row["load"]) <= MAX_KAPPA:
            for error, dashes in ((row.large_error, style.DASHED), (row.uniform_error, "-")):
                errors.plot(row.film_ratio, 100 * error, color=look["color"], ls=dashes, lw=1.3)
    errors.axhline(0.0, color=style.GREY, lw=0.8)
    d.plot(data.k, data.lambda_of_number, color=style.INK, lw=1.6, label=r"$\Lambda^{1/3} e^{-\Lambda} = k$")
    for i, colour in enumerate((style.FLUID, style.CONTACT)):
        row = data.isel(minimum_load=i)
        x = row.minimum_roughness
        dots: dict[str, Any] = {"marker": "o", "ls": "", "color": colour, "ms": 5}
        solved = f"solved, load {float(row.minimum_load):g}"
        b.plot(x, row.separation, label=solved, **dots)
        b.plot(x, row.film_ratio_at_minimum, mfc="white", **dots)
        c.plot(x, row.minimum_friction, label=solved, **dots)
        d.plot(row.number, row.separation, label=solved, **dots | {"ms": 4})
        for axes, laws in ((b, LAMBDA_STYLES), (c, FRICTION_STYLES)):
            for name, (label, dashes) in laws.items():
                axes.plot(x, row[name], color=colour, ls=dashes, lw=1.2, label=label if i else None)
        for name, (_, dashes) in FRICTION_STYLES.items():
            ratios.plot(x, row[name] / row.minimum_friction, color=colour, ls=dashes, lw=1.2)
    b.axhline(float(data.textbook), color=style.GREY, lw=1.2, ls=style.DASHED, label="textbook, Spikes 1997")
    ratios.axhline(1.0, color=style.GREY, lw=0.8)
    draw_reports(d, data, data.k, DATA_MISSING)
