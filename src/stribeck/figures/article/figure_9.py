"""Figure 9: asperities that reach through the film: friction around its minimum, and film and friction at the minimum."""

from __future__ import annotations

import numpy as np

from stribeck._types import Array, Flags
from stribeck.asymptotics import mixed, transitions
from stribeck.asymptotics.constants import FILM_CONSTANT
from stribeck.contacts.groups import Groups
from stribeck.curves.landmarks import Landmark
from stribeck.figures.article.mixed_panels import MAX_FILM_RATIO, MAX_KAPPA, MIN_FILM_RATIO, draw
from stribeck.figures.article.stribeck_cases import (
    CASES,
    LOADS,
    REPORTED_LAMBDA,
    give_cases,
    give_reports,
    over,
    solved_cases,
)
from stribeck.figures.job import FigureJob
from stribeck.figures.style import Dataset
from stribeck.quantities.outcome import Outcome
from stribeck.solver.solve_error import SolveError

__all__ = ["compute", "draw"]

TITLE = "Hydrodynamic-to-mixed lubrication transition"
CLAIM = (
    "the formula for friction matches the numbers closely around the minimum and over much of the mixed regime; Lambda "
    "at the minimum is not constant but grows as roughness falls, and its expansion matches remarkably well; minimum friction "
    "compares well with its formula."
)
SIZE = 13.0, 7.6

SPEED_RANGE = 1e-8, 1e3  # Speed groups of the curves.
# Relative roughnesses at which minima are solved, 1e-5 to 1e-1 in half decades.
KAPPAS = tuple(10.0 ** (exponent / 2) for exponent in range(-10, -1))
STEPS = len(CASES) + len(LOADS) * len(KAPPAS)

SPEED_WINDOW = 0.5, 2.0  # Speeds over the predicted minimum between which the minimum is sought.

WEAKENING_RANGE = 1e-9, 0.49  # Values of k over which Lambda is compared with the reported ranges.

# Laws of Lambda at the minimum: by Lambert's W, its expansion, and ours.
LAMBDA_FORMS: tuple[transitions.Form, ...] = ("exact", "expansion", "uniform")


def compute(work: FigureJob) -> Dataset:
    """Solve the curves and their minima, and compare them with the formulas."""
    curves = solved_cases(work, SPEED_RANGE, points=67)
    friction, _ = give_cases(work, curves)
    laws = {
        "law_large": np.array([mixed.friction.function(curve.groups, film="large") for curve in curves]),
        "law_uniform": np.array([mixed.friction.function(curve.groups, film="uniform") for curve in curves]),
    }
    relative = np.array([[roughness / load] for load, roughness in CASES])
    film = FILM_CONSTANT * over(curves, "values") ** 0.6 / relative
    kappa, loads = np.array(KAPPAS), np.array(LOADS)[:, None]
    at = Groups(1.0, loads, loads * kappa)
    expected = np.asarray(transitions.speed_at_minimum.function(at))
    found = [[_minimum(work, LOADS[i], KAPPAS[j], speed) for j, speed in enumerate(row)] for i, row in enumerate(expected)]
    speeds = np.array([[mark.value for mark in row] for row in found])
    ratio = np.array([[mark.solution.central_separation for mark in row] for row in found])
    lowest = np.array([[mark.friction for mark in row] for row in found])
    film_ratio = FILM_CONSTANT * speeds**0.6 / kappa
    ratios: dict[str, Array] = {
        form: np.asarray(transitions.separation_at_minimum.function(at, form=form)) for form in LAMBDA_FORMS
    }
    minima = {
        "friction_exact": np.asarray(transitions.friction_at_minimum.function(at, form="exact")),
        "friction_leading": np.asarray(transitions.friction_at_minimum.function(at, form="leading")),
        "friction_printed": np.asarray(transitions.friction_at_minimum.function(at, printed=True)),
        "friction_uniform": np.asarray(transitions.friction_at_minimum.function(at)),
    }
    numbers = np.geomspace(*WEAKENING_RANGE, 121)
    # At load 1, beta = mu_0 = 1 the number k stands for the roughness alone.
    alone = (numbers / float(transitions.weakening_number(Groups(1.0, 1.0, 1.0)))) ** 1.5
    against = transitions.separation_at_minimum.function(Groups(1.0, 1.0, alone), form="exact")
    errors = {f"{name.removeprefix('law_')}_error": law / friction - 1 for name, law in laws.items()}
    near = (film > MIN_FILM_RATIO) & (film < MAX_FILM_RATIO) & (relative <= MAX_KAPPA)
    finding = _finding(errors, near, ratio, ratios, lowest, minima)
    work.along(
        minimum_load=(LOADS, "load group"),
        kappa=(KAPPAS, "relative roughness h_rms/F"),
        k=(numbers, "k = 2/(9 c^(5/3)) beta h_rms^(2/3) F^(1/3)/mu_0"),
    )
    work.give(
        ("case", "speed"),
        law_large=(laws["law_large"], "friction by the formula of the paper, film of slow speed"),
        law_uniform=(laws["law_uniform"], "friction by our formula for any film"),
        large_error=(errors["large_error"], "relative error of law_large against the solver"),
        uniform_error=(errors["uniform_error"], "relative error of law_uniform against the solver"),
        film_ratio=(film, "film ratio c lambda^(3/5)/kappa"),
    )
    film_words = "c lambda^(3/5)/kappa at the minimum of friction, solved: the paper's Lambda"
    work.give(
        ("minimum_load", "kappa"),
        minimum_roughness=(at.roughness, "roughness group h_rms"),
        speed_at_minimum=(speeds, "speed group of minimum friction, solved"),
        separation=(ratio, "central gap over h_rms/alpha at the minimum of friction, solved"),
        film_ratio_at_minimum=(film_ratio, film_words),
        minimum_friction=(lowest, "minimum friction coefficient, solved"),
        number=(transitions.weakening_number(at), "k of the solved minima"),
        **{f"lambda_{form}": (value, f"Lambda at the minimum, {form}") for form, value in ratios.items()},
        **{name: (value, f"minimum friction, {name.split('_')[1]}") for name, value in minima.items()},
    )
    work.give("k", lambda_of_number=(against, "Lambda at the minimum by Lambert's W"))
    give_reports(work)
    return work.dataset(finding, reports="; ".join(REPORTED_LAMBDA))


def _minimum(work: FigureJob, load: float, kappa: float, speed: float) -> Landmark:
    low, high = SPEED_WINDOW
    found = work.curve(load=load, roughness=kappa * load, speed=(low * speed, high * speed), points=5).minimum
    if found is None:
        where = f"load {load:g}, relative roughness {kappa:g}, speed {low * speed:.3g} to {high * speed:.3g}"
        raise SolveError(Outcome.PATH_LOST, None, f"No minimum of friction was found at {where}.")
    return found


def _finding(
    errors: dict[str, Array], near: Flags, ratio: Array, ratios: dict[str, Array], lowest: Array, minima: dict[str, Array]
) -> str:
    worst = {name: 100 * np.abs(error[near]).max() for name, error in errors.items()}
    smoothest = 100 * np.abs(errors["large_error"][0][near[0]]).max()
    exact, expansion, ours = (100 * np.abs(ratios[form] / ratio - 1).max(axis=0) for form in LAMBDA_FORMS)
    corrected, printed, best = (minima[f"friction_{form}"] / lowest for form in ("exact", "printed", "uniform"))
    finding = (
        f"for film ratios {MIN_FILM_RATIO:g} to {MAX_FILM_RATIO:g} and kappa up to {MAX_KAPPA:g} the paper's friction "
        "is up to "
        f"{worst['large_error']:.0f} % off ({smoothest:.0f} % at kappa = {KAPPAS[2]:g}), ours {worst['uniform_error']:.0f} %. "
        f"Lambda grows from {ratio.min():.1f} to {ratio.max():.1f}; Lambert's W is within {exact[0]:.1f} % of it at kappa = "
        f"{KAPPAS[0]:g}, {exact[4]:.0f} % at {KAPPAS[4]:g} and {exact[-1]:.0f} % at {KAPPAS[-1]:g}, its expansion within "
        f"{expansion[0]:.1f}, {expansion[4]:.0f} and {expansion[-1]:.0f} %, ours within {ours.max():.0f} %. Minimum friction "
        f"by formula is {corrected[:, 0].min():.2f} of the solved at kappa = {KAPPAS[0]:g} and {corrected[:, 4].min():.2f} "
        f"at {KAPPAS[4]:g}; with the printed power -2/3 it is {printed.min():.2f} to {printed.max():.2f} of it, and ours "
        f"within {100 * np.abs(best - 1).max():.1g} %."
    )
    return finding
