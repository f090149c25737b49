"""How a solve ended, as a sentence."""

from __future__ import annotations

from enum import Enum

__all__ = ["Outcome"]


class Outcome(Enum):
    """How a solve ended, as a sentence; :attr:`ok` is whether the result can be trusted."""

    CONVERGED = "Converged."
    STEP_LIMIT = "Newton's method reached its step limit; try a closer initial guess or smaller parameter steps."
    SINGULAR = "The Jacobian is singular; the path may turn back at a fold: try smaller parameter steps."
    NOT_FINITE = "The residual or its Jacobian is not finite; try a closer initial guess."
    STALLED = "The damped Newton step became too small to make progress; try a closer initial guess."
    REFINEMENT_LIMIT = "Mesh refinement reached its limit before the tolerance was met; ask for a larger rtol."
    MESH_LIMIT = (
        "The mesh that resolves this state takes more memory than a solve may use; "
        "ask for a larger speed, roughness or rtol: films and edges that are less thin."
    )
    ROUNDING = (
        "Double precision keeps the error of this state above the requested rtol; "
        "ask for a larger rtol, or use the value with its error estimate."
    )
    PATH_LOST = (
        "The continuation path to this state was lost; "
        "the points before it are kept; try smaller steps or another starting point."
    )
    INTERRUPTED = "Interrupted; the finished points are kept."

    @property
    def ok(self) -> bool:
        """True for :attr:`CONVERGED` only."""
        return self is Outcome.CONVERGED
