"""How a solve ended, as a sentence."""

from enum import Enum


class Outcome(Enum):
    """How a solve ended, as a sentence; :attr:`ok` is whether the result can be trusted."""

    CONVERGED = "Converged."
    STEP_LIMIT = "Newton's iteration reached its step limit at this state; try values nearby, or a larger rtol."
    SINGULAR = "The equations do not determine this state, or hardly do; try values nearby."
    NOT_FINITE = "The equations are not finite near this state; try values nearby, or a larger rtol."
    STALLED = "Newton's iteration makes no progress at this state; try values nearby, or a larger rtol."
    REFINEMENT_LIMIT = "Mesh refinement reached its limit before the tolerance was met; ask for a larger rtol."
    MESH_LIMIT = (
        "The mesh that resolves this state takes more memory than a solve may use; "
        "ask for a larger speed, roughness or rtol: films and edges that are less thin."
    )
    ROUNDING = (
        "Double precision keeps the error of this state above the requested rtol; "
        "ask for a larger rtol, or use the value with its error estimate."
    )
    PATH_LOST = "The path from known states to this one was lost; the points before it are kept; try values nearby."
    STATE_LIMIT = (
        "The curve takes more solved states than it may; the points before are kept; ask for a larger rtol or a shorter range."
    )
    INTERRUPTED = "Interrupted; the finished points are kept."

    @property
    def ok(self) -> bool:
        """True for :attr:`CONVERGED` only."""
        return self is Outcome.CONVERGED
