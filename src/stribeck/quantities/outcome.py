"""How a solve ended, as a sentence for people."""

from __future__ import annotations

from enum import Enum

__all__ = ["Outcome"]


class Outcome(Enum):
    """How a solve ended: a sentence for people; :attr:`ok` says whether the result can be trusted."""

    CONVERGED = "Converged."
    STEP_LIMIT = "Newton reached its largest number of steps; try a nearer guess or smaller parameter steps."
    SINGULAR = "The Jacobian is singular here; the path may turn back at a fold: try smaller parameter steps."
    NOT_FINITE = "The residual or its Jacobian is not finite here; try a nearer guess."
    STALLED = "The damped Newton step became too small to make progress; try a nearer guess."
    REFINEMENT_LIMIT = "Refining the mesh came to its end before the tolerance held; ask for a larger rtol."
    ROUNDING = (
        "Double precision bounds the error of this state above the asked rtol; "
        "ask for a larger rtol or use the value with its error estimate."
    )
    PATH_LOST = (
        "The continuation path to this state was lost; "
        "the points before it are kept, and smaller steps or another start may pass."
    )
    INTERRUPTED = "Interrupted before the end; the points finished until then are kept."

    @property
    def ok(self) -> bool:
        """True for :attr:`CONVERGED` only."""
        return self is Outcome.CONVERGED
