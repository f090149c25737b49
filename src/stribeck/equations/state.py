"""Discrete states: the unknowns on a mesh, and Newton's iteration that finds them.

A state knows its groups, its equations and the Newton iteration that made it.  Between meshes the logarithm of the
gap over ``scale**2 + x**2``, which is smooth and bounded on the whole line, and the fluid pressure are interpolated.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from stribeck._types import Array, Numbers
from stribeck.contacts.groups import contact_law
from stribeck.contacts.line import Groups
from stribeck.equations.gap import minimum_gap
from stribeck.equations.guess import Guess
from stribeck.equations.line import Equations, Operators
from stribeck.equations.on_mesh.film import slopes_in_film
from stribeck.fluids.fluid import Fall, Film, Slopes
from stribeck.numerics.newton import Inverse, Root, StepControl, root_find
from stribeck.numerics.panels import Mesh
from stribeck.quantities.outcome import Outcome

WANDERING = (Outcome.STEP_LIMIT, Outcome.STALLED, Outcome.SINGULAR, Outcome.NOT_FINITE)
"""Ends of Newton's iteration after which one of monotone steps is tried for a fluid that thins."""

FULL_STEPS = 25
"""Steps after which it is: most films take less than 20, and what takes longer goes to and fro."""

CHORD = 0.25
"""Contraction of the steps above which a kept factorisation is given up."""

BETWEEN = 3
"""Places over nodes at which the lowest pressure is sought."""

MOST_SUCTION = 0.5
"""Suction over pressure up to which a film that ends at ambient pressure counts as one; of a full film both are alike."""

PREDICTION_GOAL = 0.5
"""Relative error of the predicted gap at which the step of a path is kept."""


@dataclass(frozen=True, eq=False)
class StackedStates:
    """States that share a mesh, as observables and error estimates take them.

    Attributes
    ----------
    equations : Equations
        Theirs; speed and law hold columns where there are several states.
    y : ndarray, shape (rows, N + 2)
        The unknowns of each.
    load : float or ndarray
        Load group; a column of them where there are several states.
    correction : callable
        Returns the changes that remove residuals, shape (..., rows, N + 2), to first order: -J^-1 of each.
    """

    equations: Equations
    y: Array
    load: Numbers
    correction: Callable[[Array], Array]

    @cached_property
    def slopes(self) -> Slopes:
        """The derivatives of the pressure gradient at the nodes."""
        equations, at = self.equations, self.equations.layout
        pressure = self.y[:, at.pressure] if equations.film.uses_pressure else None
        return slopes_in_film(
            equations.film, equations.operators.integral, self.y[:, at.gap], pressure, self.y[:, at.flux_gap]
        )


@dataclass(frozen=True, eq=False)
class State:
    """A solution of the discrete equations, or the last iterate towards one.

    Attributes
    ----------
    groups : Groups
        Scalar groups.
    equations : Equations
        The discrete problem.
    y : ndarray
        Gap at the nodes, offset, flux gap.
    root : Root
        The Newton iteration that ended here.
    prediction_error : float
        Largest relative change of the gap from its guess.
    """

    groups: Groups
    equations: Equations
    y: Array
    root: Root
    prediction_error: float

    @property
    def mesh(self) -> Mesh:
        """The mesh of the state."""
        return self.equations.operators.mesh

    @property
    def gap(self) -> Array:
        """Gap at the nodes [u_Hz]."""
        return self.y[self.equations.layout.gap]

    @property
    def offset(self) -> float:
        """Offset z0 [u_Hz]."""
        return float(self.y[self.equations.layout.offset.start])

    @property
    def flux_gap(self) -> float:
        """Flux gap h* [u_Hz]."""
        return float(self.y[self.equations.layout.flux_gap.start])

    @property
    def exit(self) -> float:
        """Exit of the film, from which x is measured; zero without one [a]."""
        layout = self.equations.layout
        return float(self.y[layout.exit.start]) if self.equations.operators.has_exit else 0.0

    @property
    def dilation(self) -> float:
        """Dilation of the frame; one if the film does not begin anew."""
        layout = self.equations.layout
        return float(self.y[layout.dilation.start]) if self.equations.operators.has_reformation else 1.0

    @property
    def restart(self) -> float:
        """Coordinate of the mesh at which the film begins anew; infinite if it does not."""
        return self.mesh.restart

    @cached_property
    def minimum_position(self) -> float:
        """Where the gap is at its minimum, between the nodes: the lowest node may be on the panel beside."""
        return minimum_gap(self.mesh, self.gap)[0]

    @property
    def outcome(self) -> Outcome:
        """Outcome of the Newton iteration; one stopped by rounding counts as converged, its error is estimated.

        A film that ends at ambient pressure and sucks before has been taken past its end: it is none.
        """
        found = Outcome.CONVERGED if self.root.outcome is Outcome.ROUNDING else self.root.outcome
        return Outcome.STALLED if found.ok and self._sucks else found

    @cached_property
    def _sucks(self) -> bool:
        """Whether a film that ends at ambient pressure sucks before."""
        operators = self.equations.operators
        if not operators.has_exit or operators.has_reformation:
            return False
        return bool(-self.fluid_pressure.min() > MOST_SUCTION * self.fluid_pressure.max())

    def corrected(self) -> State:
        """Return the state after one more Newton step, with the inverse of the Jacobian where that began."""
        inverse = self.equations.inverse(self.y)
        y = self.y + self.equations.units(self.y) * inverse(self.equations.residual(self.y))
        return replace(self, y=y, root=replace(self.root, x=y, inverse=inverse))

    def without_inverse(self) -> State:
        """Return the state without Newton's last inverse, which is as large as an operator and serves only its neighbour."""
        return replace(self, root=replace(self.root, inverse=None))

    @property
    def stacked(self) -> StackedStates:
        """The state as the only one of its mesh."""
        inverse = self.root.inverse
        assert inverse is not None
        units = self.equations.units(self.y)
        return StackedStates(self.equations, self.y[None], float(self.groups.load), lambda r: units * inverse(r))

    @property
    def effort(self) -> float:
        """What :func:`continuation.march` steers by: 4 where the cubic prediction was as good as wanted."""
        return 4.0 + 0.5 * math.log2(max(self.prediction_error, 1e-9) / PREDICTION_GOAL)

    @cached_property
    def _log_gap(self) -> Array:
        return np.log(self.gap)

    @cached_property
    def shape(self) -> Array:
        """Logarithm of the gap over ``scale**2 + x**2`` at the nodes: what the panels interpolate."""
        return np.log(self.gap / self.mesh.far)

    @cached_property
    def fluid_pressure(self) -> Array:
        """Fluid pressure at the nodes [p_Hz]."""
        return self.equations.fluid_pressure(self.y)

    @property
    def lowest_pressure(self) -> float:
        """Lowest fluid pressure, also between the nodes [p_Hz]."""
        return float(self.mesh.to_order(self.fluid_pressure, BETWEEN * self.mesh.order).min())

    @cached_property
    def _nodal(self) -> Array:
        """Nodal fields of this state as a guess for others: :attr:`shape` and fluid pressure."""
        return np.stack([self.shape, self.fluid_pressure])

    @cached_property
    def _on_other_mesh(self) -> dict[Mesh, Array]:
        return {}

    def log_gap(self, mesh: Mesh) -> Array:
        """Return the logarithm of the gap at the nodes of ``mesh``; that on the mesh last asked for is kept."""
        if mesh is self.mesh:
            return self._log_gap
        if mesh not in self._on_other_mesh:
            shape = self.mesh.interpolate(self.shape, mesh.nodes)
            self._on_other_mesh.clear()
            self._on_other_mesh[mesh] = shape + np.log(self.mesh.scale**2 + mesh.nodes**2)
        return self._on_other_mesh[mesh]

    def fields(self, x: Array) -> Array:
        """Return the logarithm of the gap and the fluid pressure at ``x``."""
        found = self.mesh.interpolate(self._nodal, x)
        found[0] += np.log(self.mesh.scale**2 + x * x)
        return found

    def known_on(self, x: Array) -> Array:
        """Return the lengths of the panels at ``x``."""
        return self.mesh.lengths_at(x)


def fall_of(film: Film, speed: float) -> Fall:
    """Return how the pressure of a film falls off at a speed group: as an even power unless the film says otherwise."""
    told = getattr(film, "fall", None)
    return Fall() if told is None else told(speed)


def is_thinning(film: Film) -> bool:
    """Return whether the viscosity falls with the rate: the pressure gradient may then turn sharply where the flow does."""
    return hasattr(film, "fall")


def is_rough(film: Film) -> bool:
    """Return whether roughness hinders the flow: the pressure gradient then turns where the last paths of the flow close."""
    return not getattr(film, "is_smooth", True)


def closed_gap(film: Film) -> float | None:
    """Return the mean gap at which roughness closes the last path of the flow; None if it never does."""
    return None if getattr(film, "is_plain", False) else getattr(film, "closed_at", None)


def jump_of(film: Film) -> Callable[[Array, Array | None], Array | None] | None:
    """Return what tells by how much the pressure gradient jumps between each node and the next one; None if it never does."""
    return None if getattr(film, "is_plain", False) else getattr(film, "jump", None)


def unknowns_of(equations: Equations, guess: Guess) -> Array:
    """Return the unknowns of a guess on the mesh of ``equations``."""
    if isinstance(guess, State) and guess.equations.operators is equations.operators:
        return guess.y.copy()
    mesh, at = equations.operators.mesh, equations.layout
    same = guess.restart == mesh.restart
    nodes = mesh.nodes if same else mesh.nodes * (guess.restart / mesh.restart)
    y = np.empty(at.size)
    y[at.gap] = np.exp(guess.log_gap(mesh) if same else guess.fields(nodes)[0])
    y[at.offset], y[at.flux_gap], y[at.exit] = guess.offset, guess.flux_gap, guess.exit
    y[at.dilation] = guess.dilation if same else guess.dilation * guess.restart / mesh.restart
    if at.pressure.start < at.pressure.stop:
        fields = guess.fields(nodes)
        y[at.pressure] = fields[1] if len(fields) == 2 else 0.0
    return y


def solve_state(
    groups: Groups,
    operators: Operators,
    guess: Guess,
    tolerance: float,
    max_steps: int = 40,
    kept: Inverse | None = None,
) -> State:
    """Return the state of the discrete equations on the mesh of ``operators`` nearest to ``guess``.

    ``kept`` is the inverse of a neighbour on the same mesh, used while the steps contract with it.
    """
    equations = Equations(operators, float(groups.speed), contact_law(groups), guess.flux_gap**2)
    start = unknowns_of(equations, guess)
    thins, control = is_thinning(equations.film), StepControl(tolerance, max_steps, CHORD)
    full = replace(control, max_steps=min(max_steps, FULL_STEPS)) if thins else control
    root = root_find(equations, start, full, kept)
    if thins and root.outcome in WANDERING:
        spent = root.steps
        root = root_find(equations, start, replace(control, monotone=True))
        root = replace(root, steps=spent + root.steps)
    gap = equations.layout.gap
    with np.errstate(all="ignore"):  # a root that was not found need not be finite
        error = float(np.abs(start[gap] / root.x[gap] - 1).max())
    return State(groups, equations, root.x, root, error)
