"""Discrete states: the unknowns on one mesh, and Newton's iteration that finds them.

A state knows its groups, its equations and the Newton iteration that made it.  Between meshes travel the logarithm of the
gap over ``scale**2 + x**2``, which is smooth and bounded on the whole line, and the fluid pressure.
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
from stribeck.equations.guess import Guess
from stribeck.equations.line import Equations, Operators
from stribeck.numerics.newton import Inverse, Root, StepControl, root_find
from stribeck.numerics.panels import Mesh
from stribeck.quantities.outcome import Outcome

CHORD = 0.25
"""Contraction above which a kept factorisation is given up."""

PREDICTION_GOAL = 0.5
"""Relative error of the predicted gap at which the step of a path is kept."""


@dataclass(frozen=True, eq=False)
class Rows:
    """States that share a mesh, as observables and error estimates want them.

    Attributes
    ----------
    equations : Equations
        Theirs; speed and law hold columns where there are several states.
    y : ndarray, shape (rows, N + 2)
        The unknowns of each.
    load : float or ndarray
        Load group; a column of them where there are several states.
    correction : callable
        What removes residuals, shape (..., rows, N + 2), to first order, -J^-1 of each.
    """

    equations: Equations
    y: Array
    load: Numbers
    correction: Callable[[Array], Array]


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
        return self.y[self.equations.layout["gap"]]

    @property
    def offset(self) -> float:
        """Offset z0 [u_Hz]."""
        return float(self.y[self.equations.layout.index("offset")])

    @property
    def flux_gap(self) -> float:
        """Flux gap h* [u_Hz]."""
        return float(self.y[self.equations.layout.index("flux_gap")])

    @property
    def exit(self) -> float:
        """Exit of the film, from which x is measured; zero without one [a]."""
        layout = self.equations.layout
        return float(self.y[layout.index("exit")]) if "exit" in layout else 0.0

    @property
    def least_position(self) -> float:
        """The node where the gap is least."""
        return float(self.mesh.nodes[np.argmin(self.gap)])

    @property
    def outcome(self) -> Outcome:
        """Outcome of the Newton iteration; one stopped by rounding counts as converged, its error is estimated."""
        return Outcome.CONVERGED if self.root.outcome is Outcome.ROUNDING else self.root.outcome

    def without_inverse(self) -> State:
        """Return the state without Newton's last inverse, which is as large as an operator and serves only its neighbour."""
        return replace(self, root=replace(self.root, inverse=None))

    @property
    def rows(self) -> Rows:
        """The state as the only one of its mesh."""
        inverse = self.root.inverse
        assert inverse is not None
        units = self.equations.units(self.y)
        return Rows(self.equations, self.y[None], float(self.groups.load), lambda r: units * inverse(r))

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
    def _nodal(self) -> Array:
        """Nodal fields of the guess that this state is for others: :attr:`shape` and fluid pressure."""
        return np.stack([self.shape, self.equations.pressures(self.y)[1]])

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


def unknowns_on(operators: Operators, guess: Guess) -> Array:
    """Return the unknowns of a guess on the mesh of ``operators``."""
    mesh, layout = operators.mesh, operators.layout
    values: dict[str, float | Array] = {
        "gap": np.exp(guess.log_gap(mesh)),
        "offset": guess.offset,
        "flux_gap": guess.flux_gap,
    }
    if "exit" in layout:
        values["exit"] = guess.exit
    if "pressure" in layout:
        values["pressure"] = guess.fields(mesh.nodes)[1]
    return layout.stacked(**values)


def inverse_on(operators: Operators, state: State) -> Inverse:
    """Return the inverse of the Jacobian at a state, put on the mesh of ``operators``, in units of the unknowns."""
    equations = Equations(operators, float(state.groups.speed), contact_law(state.groups), state.flux_gap**2)
    return equations.inverse(unknowns_on(operators, state))


def solve_state(
    groups: Groups,
    operators: Operators,
    guess: Guess,
    tolerance: float,
    max_steps: int = 40,
    kept: Inverse | None = None,
) -> State:
    """Return the state of the discrete equations on the mesh of ``operators`` nearest to ``guess``.

    ``kept`` is the inverse of a neighbour on the same mesh, to be used for as long as it makes the steps contract.
    """
    equations = Equations(operators, float(groups.speed), contact_law(groups), guess.flux_gap**2)
    start = unknowns_on(operators, guess)
    root = root_find(equations, start, StepControl(tolerance, max_steps, CHORD), kept)
    gap = operators.layout["gap"]
    error = float(np.abs(start[gap] / root.x[gap] - 1).max())
    return State(groups, equations, root.x, root, error)
