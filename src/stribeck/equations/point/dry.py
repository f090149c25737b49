"""The dry contact of a ball: its pressure depends on the radius alone, so that it is a problem of one dimension.

Any contact law has its dry state; that of a law that is soft enough starts the iteration of lubricated contacts.
"""

from dataclasses import dataclass

import numpy as np

from stribeck._types import Array
from stribeck.contact_laws.law import ContactLaw
from stribeck.equations.damping import longest_step
from stribeck.equations.point.mesh_choice import gaps_at
from stribeck.equations.point.system import LOAD, Operators
from stribeck.numerics.dual import with_slope
from stribeck.numerics.newton import Dense, StepControl, root_find
from stribeck.numerics.settings import MAX_STEPS
from stribeck.quantities.outcome import Outcome


@dataclass(frozen=True, eq=False)
class DryContact:
    """Gap and contact pressure by ring, the offset, how Newton's iteration ended and its steps."""

    gap: Array
    pressure: Array
    offset: float
    outcome: Outcome
    steps: int


def hertz_gap(r: Array) -> Array:
    """Return the gap of the dry smooth contact [u_Hz], zero up to r = 1."""
    s = np.maximum(r, 1.0)
    return np.asarray(((s * s - 2.0) * np.arccos(1.0 / s) + np.sqrt(s * s - 1.0)) / np.pi)


def dry_contact(operators: Operators, law: ContactLaw, tolerance: float = 1e-12) -> DryContact:
    """Return the dry contact under a law that has a positive gap at rest."""
    mesh = operators.mesh
    r, deflection, n = mesh.radii, operators.deflection[0], mesh.rings
    weights, decay = operators.load_row, float(np.max(law.decay_length))

    def function(y: Array) -> Array:
        p = law.pressure(y[:n])
        return np.append(y[:n] - y[n] - operators.parabola - deflection @ p, weights @ p - LOAD)

    def jacobian(y: Array) -> Array:
        slope = with_slope(law.pressure, y[:n])[1]
        matrix = np.zeros((n + 1, n + 1))
        matrix[:n, :n] = np.eye(n) - deflection * slope
        matrix[:n, n] = -1.0
        matrix[n, :n] = weights * slope
        return matrix

    def fraction(y: Array, dy: Array) -> float:
        return longest_step(law, y[:n], dy[:n])

    def size(y: Array, dy: Array) -> float:
        return float(np.abs(dy[:n] / y[:n]).max())

    edge = min(1.0, decay) ** (1.0 / 3.0)
    hertz = np.maximum(np.sqrt(np.maximum(1.0 - r * r, 0.0)), edge)
    start = np.append(
        hertz_gap(r) + np.maximum(gaps_at(law, np.log(hertz) - 0.5 * np.log1p(decay)), 1e-3 * decay), decay - 1.0
    )
    problem = Dense(function, jacobian, fraction, size)
    root = root_find(problem, start, StepControl(tolerance, MAX_STEPS))
    outcome = Outcome.CONVERGED if root.outcome is Outcome.ROUNDING else root.outcome
    return DryContact(root.x[:n], law.pressure(root.x[:n]), float(root.x[n]), outcome, root.steps)
