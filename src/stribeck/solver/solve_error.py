"""The error of a solve that did not reach its tolerance."""

from stribeck.contacts.groups import Groups
from stribeck.quantities.outcome import Outcome
from stribeck.solver.base_solution import BaseSolution


class SolveError(RuntimeError):
    """The solver did not reach the tolerance.

    Parameters
    ----------
    outcome : Outcome
        Why.
    solution : Solution, PointSolution or None
        What was reached, with its error estimate, if there is a state.
    message : str
        The message: the state, the outcome, the accuracy reached.
    """

    def __init__(self, outcome: Outcome, solution: BaseSolution | None, message: str) -> None:
        super().__init__(message)
        self.outcome = outcome
        self.solution = solution


def describe(groups: Groups) -> str:
    """Return the groups in words, for messages."""
    return f"speed {float(groups.speed):.6g}, load {float(groups.load):.6g}, roughness {float(groups.roughness):.6g}"
