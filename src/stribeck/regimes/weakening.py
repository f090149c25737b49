r"""Where the velocity-weakening branch disappears: the roughness from which friction only grows with speed.

With roughness the minimum of a Stribeck curve rises and meets the maximum before it; beyond, boundary lubrication passes to
hydrodynamic without weakening, and the two lines of transition have merged.  All of it on solved states.

Source: [BP] Conclusion, which names a minimum that exceeds boundary_friction and a branch that disappears as one; they are two
(:data:`CRITERIA`).
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Literal, get_args

import numpy as np

from stribeck.contacts.friction import Definition, check_definition, coefficients, sliding_part
from stribeck.contacts.groups import Groups, Physics
from stribeck.curves.speed_range import automatic_speed_range
from stribeck.equations.sensitivity import friction_slopes
from stribeck.numerics.newton import root_between
from stribeck.numerics.threads import one_blas_thread
from stribeck.quantities.keywords import answers_typos
from stribeck.quantities.units import InputError, show
from stribeck.solver.neighbours import Neighbours
from stribeck.solver.refinement import RefinedState
from stribeck.solver.solve import as_groups, check_rtol

__all__ = ["Weakening", "roughness_without_minimum", "weakening"]

Criterion = Literal["slope", "plateau"]

CRITERIA: tuple[Criterion, ...] = get_args(Criterion)
"""What merging means: the slope of the curve is nowhere negative, or its minimum is as high as the boundary plateau mu0."""

POINTS_PER_DECADE = 3
"""Points on which the minimum slope of a curve is looked for, before it is located."""

SPEED_TOLERANCE = 1e-3
"""Tolerance of ln(speed) at the minimum slope, on which the slope itself depends in second order."""

MINIMUM_TOLERANCE = 1e-9
"""Tolerance of ln(speed) at the minimum."""

KAPPA_RANGE = (1e-5, 1e3)
"""Relative roughness between which the merging is looked for."""

KAPPA_START = 0.3
KAPPA_STEP = 3.0


@dataclass(frozen=True)
class Weakening:
    """Whether the friction of a curve over the speed falls somewhere, and how far.

    Attributes
    ----------
    speed : float
        Speed group at which friction falls most steeply, or grows most slowly.
    slope : float
        d mu/d ln(speed) over the published viscous friction there [-]: negative where friction weakens with speed,
        1 far down on the plateau, 0.4 to 0.7 on the hydrodynamic branch.
    minimum_speed : float
        Speed group of the minimum behind it; nan where there is no weakening.
    minimum_friction : float
        Friction coefficient there [-].
    """

    speed: float
    slope: float
    minimum_speed: float = math.nan
    minimum_friction: float = math.nan

    @property
    def present(self) -> bool:
        """Whether there is a range of speeds in which friction falls."""
        return self.slope < 0


class _Slopes:
    """The normalised slope of friction along ln(speed), each value from a state solved there."""

    def __init__(self, groups: Groups, boundary_friction: float, beta: float, definition: Definition, rtol: float) -> None:
        self.groups, self.beta, self.definition = groups, beta, definition
        self.rubbing = boundary_friction * sliding_part(2 * groups.model.film.slide)
        self.neighbours = Neighbours(rtol)
        self.points: dict[float, RefinedState] = {}
        self.found: dict[float, float] = {}

    def at(self, s: float) -> Groups:
        return replace(self.groups, speed=math.exp(s))

    def __call__(self, s: float) -> float:
        if s not in self.found:
            self.points[s] = point = self.neighbours.solved(self.at(s))
            assert point.state is not None and point.values is not None
            slope = float(friction_slopes(point.state, self.rubbing, self.beta, self.definition)[0])
            # Friction of the substrate that is the slower one is negative; its size counts.
            slope *= math.copysign(1.0, self.friction(s))
            self.found[s] = slope / (self.beta * abs(point.values.viscous_published))
        return self.found[s]

    def friction(self, s: float) -> float:
        values = self.points[s].values
        assert values is not None
        return self.rubbing * values.contact_load_share + self.beta * float(getattr(values, f"viscous_{self.definition}"))


@answers_typos
@one_blas_thread
def weakening(
    groups: Groups,
    boundary_friction: float | None = None,
    beta: float | None = None,
    definition: Definition = "balanced",
    *,
    rtol: float = 1e-6,
) -> Weakening:
    r"""Return whether friction falls with speed anywhere on a Stribeck curve, by the minimum slope on solved states.

    .. math:: \min_\lambda \frac{1}{\mu_f} \frac{d\mu}{d\ln\lambda} < 0
    """
    as_groups(groups)
    rtol = check_rtol(rtol)
    boundary_friction, beta = coefficients(None, boundary_friction, beta)
    slope = _Slopes(groups, boundary_friction, beta, check_definition(definition), rtol)
    low, high = automatic_speed_range(groups, boundary_friction, beta, definition)
    count = max(8, math.ceil(POINTS_PER_DECADE * math.log10(high / low)))
    coarse = np.linspace(math.log(high), math.log(low), count).tolist()
    values = [slope(s) for s in coarse]
    # Imported here because it takes longer than the rest of the package, and few uses get here.
    from scipy.optimize import minimize_scalar

    i = min(max(1, int(np.argmin(values))), count - 2)
    minimize_scalar(slope, bounds=(coarse[i + 1], coarse[i - 1]), method="bounded", options={"xatol": SPEED_TOLERANCE})
    lowest = min(slope.found, key=lambda s: slope.found[s])
    above = [s for s in sorted(slope.found) if s > lowest and slope.found[s] > 0]
    if slope.found[lowest] >= 0 or not above:
        return Weakening(math.exp(lowest), slope.found[lowest])
    s = root_between(slope, lowest, above[0], MINIMUM_TOLERANCE)
    assert s is not None
    slope(s)
    return Weakening(math.exp(lowest), slope.found[lowest], math.exp(s), slope.friction(s))


@answers_typos
def roughness_without_minimum(
    load: float,
    boundary_friction: float | None = None,
    beta: float | None = None,
    definition: Definition = "balanced",
    *,
    criterion: Criterion = "slope",
    rtol: float = 1e-6,
    physics: Physics | None = None,
) -> float:
    r"""Return the roughness at which the solved Stribeck curve loses its minimum, and the lines of transition merge."""
    if criterion not in CRITERIA:
        raise InputError(f"criterion = {show(criterion)}; it must be 'slope' or 'plateau'.")
    rtol = check_rtol(rtol)
    boundary_friction, beta = coefficients(None, boundary_friction, beta)
    unit, _ = as_groups(Groups(1.0, load, 1.0) if physics is None else Groups(1.0, load, 1.0, **physics))
    if boundary_friction == 0:
        return 0.0

    def excess(log_kappa: float) -> float:
        groups = replace(unit, roughness=math.exp(log_kappa) / float(unit.relative_roughness))
        found = weakening(groups, boundary_friction, beta, definition, rtol=rtol)
        if criterion == "slope" or not found.present:
            return found.slope
        return abs(found.minimum_friction) / boundary_friction - 1

    return _root(excess, rtol) / float(unit.relative_roughness)


def _root(excess: Callable[[float], float], rtol: float) -> float:
    """Return the relative roughness at which ``excess``, growing with its logarithm, vanishes; nan if it is not found."""
    known = {math.log(KAPPA_START): excess(math.log(KAPPA_START))}
    (start,) = known
    step = -math.log(KAPPA_STEP) if known[start] >= 0 else math.log(KAPPA_STEP)
    low, high = map(math.log, KAPPA_RANGE)
    here = start
    while True:
        there = here + step
        if not low <= there <= high:
            return math.nan
        known[there] = excess(there)
        if (known[there] >= 0) != (known[here] >= 0):
            break
        here = there

    def remembered(s: float) -> float:
        return known[s] if s in known else excess(s)

    found = root_between(remembered, min(here, there), max(here, there), max(rtol, MINIMUM_TOLERANCE))
    return math.nan if found is None else math.exp(found)
