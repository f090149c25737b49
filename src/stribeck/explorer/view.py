"""What a tab of the page shows, for its pictures and files."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from stribeck.contacts.friction import Definition
from stribeck.explorer.answer import Answer
from stribeck.explorer.curves import Curve
from stribeck.explorer.measured import Measured
from stribeck.solver.base_solution import BaseSolution

__all__ = ["View"]


@dataclass(frozen=True, eq=False)
class View:
    """What a tab shows."""

    answer: Answer  # The answer to its inputs
    pins: Sequence[tuple[str, Curve, float]] = ()  # Pinned curves: name, curve, Hersey number at 1 m/s
    measured: tuple[Measured, ...] = ()  # Measured curves
    states: Sequence[tuple[str, BaseSolution, Definition]] = ()
