"""Figure S1: fluid pressure and gap of slow rough contacts against their expansion in the speed, to second order."""

import numpy as np

from stribeck._types import Array
from stribeck.asymptotics import perturbation
from stribeck.contacts.groups import Groups
from stribeck.figures import style
from stribeck.figures.job import FigureJob, Numbers, furthest
from stribeck.figures.style import Dataset, Panels
from stribeck.solver.solution import Solution

LOAD = 0.1  # Load group of the profiles.
KAPPAS = (1e-3, 1e-4)  # Relative roughness: that of the panels, and one that shows what is left of the distance at slow speed.
# Fluid numbers lambda/kappa**2 of the profiles: 0.01 to 32, where the fluid carries most of the load.
FLUID_NUMBERS = tuple(10.0 ** (exponent / 2) for exponent in range(-4, 4))
STEPS = len(KAPPAS) * len(FLUID_NUMBERS)

# Panel, unit on its axis, and colour and label of each part of the expansion in the panel of distances.
PARTS = {
    "first_pressure": ("a", 1e3, style.FLUID, r"$p_f/\lambda$"),
    "first_gap": ("b", 1.0, style.GREEN, r"$\mathrm{Asym}[h]/\lambda$"),
    "second_pressure": ("c", 1e9, style.MARK, r"$\mathrm{Sym}[p_f]/\lambda^2$"),
}


def compute(work: FigureJob) -> Dataset:
    """Solve slow contacts and compare them with their expansion."""
    data = Numbers(kappa=KAPPAS, number=FLUID_NUMBERS, x=np.linspace(-1.2, 1.2, 481), load_group=LOAD)
    data.speed, core = np.array(KAPPAS)[:, None] ** 2 * np.array(FLUID_NUMBERS), np.abs(data.x) <= 0.9
    rows = list(zip(KAPPAS, data.speed.tolist(), strict=True))
    found = [[_parts(work.solve(speed, LOAD, LOAD * kappa), data.x) for speed in row] for kappa, row in rows]
    solved = np.moveaxis(np.array(found), 2, 0)
    laws = np.stack([_laws(Groups(row[0], LOAD, LOAD * kappa), data.x) for kappa, row in rows], axis=1)
    largest = furthest(laws[..., core])[..., None]
    data.distance = furthest((solved - laws[:, :, None])[..., core]) / largest
    change = furthest((solved - solved[:, :, :1])[..., core]) / largest
    for name, values, law, off, changed in zip(PARTS, solved, laws, data.distance, change, strict=True):
        of_part = {name: values[0], f"{name}_law": law[0], f"{name}_distance": off, f"{name}_change": changed}
        vars(data).update(of_part)
    data.rates = np.log(change[:, 1, 4] / change[:, 1, 3]) / np.log(FLUID_NUMBERS[4] / FLUID_NUMBERS[3])
    return work.dataset(data)


def _parts(solution: Solution, x: Array) -> Array:
    """Return p_f over the speed, the odd part of the gap over it, and the even part of p_f over its square."""
    speed, ahead, behind = float(solution.groups.speed), solution.profile(x), solution.profile(-x)
    odd, even = (ahead.gap - behind.gap) / 2, (ahead.fluid_pressure + behind.fluid_pressure) / 2
    return np.array([ahead.fluid_pressure / speed, odd / speed, even / speed**2])


def _laws(groups: Groups, x: Array) -> Array:
    """Return the formulas of the same, nan at the edge and beyond."""
    speed, near = float(groups.speed), np.abs(x) < 0.999
    gap, mirrored = (perturbation.gap_first.function(groups, places) for places in (x[near], -x[near]))
    first = perturbation.fluid_pressure_first.function(groups, x[near])
    both = perturbation.fluid_pressure_second.function(groups, x[near])
    found = np.full((len(PARTS), len(x)), np.nan)
    found[:, near] = first / speed, (gap - mirrored) / (2 * speed), (both - first) / speed**2
    return found


def draw(panels: Panels, data: Dataset) -> None:
    """Draw each part of the expansion, and how far it is from the solver."""
    axes = panels["distances"]
    for name, (panel, unit, colour, label) in PARTS.items():
        law = data[f"{name}_law"] / unit
        style.steps(panels[panel], data[name] / unit, lw=1.3, by=data.speed[0])
        style.limit(panels[panel], law, label="formula", lw=1.6)
        low, high = float(law.min()), float(law.max())
        panels[panel].set_ylim(low - 0.25 * (high - low), high + 0.2 * (high - low))
        for values, dashes, face in zip(data[f"{name}_distance"], ("-", style.DOTTED), (colour, "white"), strict=True):
            words = rf"{label}, $\kappa$ = {style.power(float(values.kappa))}"
            axes.loglog(data.number, values, "o", ls=dashes, color=colour, mfc=face, ms=5, lw=1.0, label=words)
    style.slope(axes, 0.35, 8e-4, 2.0, "2", decades=0.5)
    style.slope(axes, 0.014, 0.0012, 1.0, "1", decades=0.5)
