"""A state of the point contact on one mesh, and its transfer to another."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from stribeck._types import Array
from stribeck.contact_laws.law import ContactLaw
from stribeck.contacts.groups import Model
from stribeck.equations.cavities.active_set import iterate_cavitated
from stribeck.equations.cavities.exit import CavitatedEquations
from stribeck.equations.cavities.reformation import ReformingEquations
from stribeck.equations.cavities.system import CavitatedSystem, just_above
from stribeck.equations.point.iteration import Iterated, iterate
from stribeck.equations.point.mesh_choice import MeshTooLargeError, Resolution, bytes_of, operators_of
from stribeck.equations.point.planes import plane_of
from stribeck.equations.point.system import Equations, Operators, Unknowns
from stribeck.fluids.fluid import Cavitation
from stribeck.numerics.fourier_panels import PolarMesh
from stribeck.numerics.settings import HALF_DIGITS, MAX_BYTES
from stribeck.quantities.outcome import Outcome


@dataclass(frozen=True, eq=False)
class Level:
    """A state on one mesh: its equations, the unknowns, and how Newton's iteration ended."""

    resolution: Resolution
    equations: Equations
    iterated: Iterated

    @property
    def mesh(self) -> PolarMesh:
        """The mesh."""
        return self.equations.operators.mesh

    @property
    def unknowns(self) -> Unknowns:
        """Gap, fluid pressure and offset."""
        return self.iterated.unknowns

    @property
    def outcome(self) -> Outcome:
        """How the iteration ended."""
        return self.iterated.outcome

    @property
    def breaks(self) -> bool:
        """Whether the film may break by its equations."""
        return isinstance(self.equations, CavitatedSystem)

    def relabelled(self, model: Model) -> Level:
        """Return the level relabelled with a model whose states start from it."""
        return replace(self, resolution=replace(self.resolution, model=model))

    def on(self, resolution: Resolution) -> Level:
        """Return the state on another mesh, without operators."""
        operators = Operators(resolution.mesh, resolution.model.solid)
        y = transfer(self.unknowns, self.mesh, operators.mesh, self.equations.least)
        return Level(resolution, replace(self.equations, operators=operators), replace(self.iterated, unknowns=y))

    def without_operators(self) -> Level:
        """Return the level without the operators and factors that fill the memory."""
        op = self.equations.operators
        equations = replace(self.equations, operators=Operators(op.mesh, op.solid))
        return replace(self, equations=equations, iterated=replace(self.iterated, preconditioner=None))

    @property
    def effort(self) -> float:
        """Measure by which :class:`stribeck.numerics.continuation.StepPath` chooses its steps."""
        return 0.6 * self.iterated.steps

    @property
    def contact_pressure(self) -> Array:
        """Contact pressure at the nodes [p_Hz]."""
        return np.asarray(self.equations.law.pressure(self.unknowns.gap))


def transfer(y: Unknowns, old: PolarMesh, new: PolarMesh, least: float = -math.inf) -> Unknowns:
    """Return unknowns on another mesh, with nodes cavitated where the nearest old one has the pressure ``least``."""
    # Beyond the rim of the old mesh the gap grows as r**2 and the pressure falls as r**-3.
    if old is new:
        return y
    beyond = np.maximum(1.0, new.radii / old.rim)
    fields = np.stack([np.log(y.gap / (1.0 + old.radii**2)), y.fluid])
    shape, fluid = old.transfer(new, fields)
    fluid = fluid / beyond**3
    cavitated = y.fluid <= least
    if cavitated.any():  # the series of the pressure oscillates about zero there
        ring = np.abs(np.log(new.radii[:, None] / old.radii)).argmin(axis=1)
        angle = np.abs(new.angles[:, None] - old.angles).argmin(axis=1)
        fluid = np.where(cavitated[angle][:, ring], least, np.maximum(fluid, just_above(least)))
    return Unknowns(np.exp(shape) * (1.0 + new.radii**2), fluid, y.offset)


def solve_level(
    resolution: Resolution,
    speed: float,
    law: ContactLaw,
    start: Unknowns,
    start_mesh: PolarMesh,
    tolerance: float,
    kept: Any = None,
    least_part: float = HALF_DIGITS,
) -> Level:
    """Return the state on a mesh, from unknowns on any mesh."""
    if bytes_of(resolution) > MAX_BYTES:
        raise MeshTooLargeError
    operators = operators_of(resolution)
    kind, iteration = PROBLEMS[resolution.model.cavitation]
    equations = kind(operators, speed, law, plane_of(resolution.model.film.at(speed)))
    if resolution.model.cavity_pressure:
        equations = replace(equations, least=resolution.model.cavity_pressure)
    guess = transfer(start, start_mesh, operators.mesh, equations.least)
    if kept is not None and kept.shape != guess.gap.shape:
        kept = None
    return Level(resolution, equations, iteration(equations, guess, tolerance, kept, least_part))


# The equations and the iteration that solves them, by cavitation.
PROBLEMS: dict[Cavitation, tuple[type[Equations], Callable[..., Iterated]]] = {
    Cavitation.NONE: (Equations, iterate),
    Cavitation.EXIT: (CavitatedEquations, iterate_cavitated),
    Cavitation.REFORM: (ReformingEquations, iterate_cavitated),
}


def predicted(weights: Sequence[float] | Array, levels: Sequence[Level]) -> Unknowns | None:
    """Return the weighted sum of states on the mesh of the last, None where some cavitate by other equations than others."""
    if len({type(level.equations) for level in levels}) > 1:
        return None
    return extrapolate_levels(weights, levels, levels[-1].mesh)


def extrapolate_levels(weights: Sequence[float] | Array, levels: Sequence[Level], mesh: PolarMesh) -> Unknowns:
    """Return the weighted sum of states on a mesh, in the logarithms of their gaps, the pressures and the offsets."""
    parts = [transfer(level.unknowns, level.mesh, mesh, level.equations.least) for level in levels]
    log_gap = sum(w * np.log(part.gap) for w, part in zip(weights, parts, strict=True))
    fluid = sum(w * part.fluid for w, part in zip(weights, parts, strict=True))
    offset = sum(w * part.offset for w, part in zip(weights, parts, strict=True))
    return Unknowns(np.exp(log_gap), np.asarray(fluid), float(offset))
