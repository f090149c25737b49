"""The work of one worker of a sweep: a chain of states, and the row of numbers that each becomes."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from stribeck._types import Array
from stribeck.batches.chain import Ended, solve_in_order
from stribeck.contacts.contact import Contact
from stribeck.contacts.geometries import CONTACTS
from stribeck.contacts.groups import Groups, Physics
from stribeck.contacts.parts import BASE_PARTS, Parts
from stribeck.solver.solve_error import describe
from stribeck.sweeps.columns import ERROR, failed_row, row_of

__all__ = ["Chain", "solve_chain"]

OnRow = Callable[[int, Array, str], object]


@dataclass(frozen=True)
class Chain:
    """States to solve one after the other, in a form that travels to other processes."""

    rows: tuple[int, ...]  # Numbers of the states in the sweep
    groups: tuple[tuple[float, float, float], ...]  # Speed, load and roughness group of each
    inputs: dict[str, tuple[float, ...]]
    si: bool  # Whether the inputs are in SI units
    rtol: float  # Relative tolerance of each state
    physics: Physics  # Contact law and geometry of all, and the model of the first
    parts: Parts = BASE_PARTS  # Fluid, cavitation, flow factors, solid and motion of all contacts

    def contact(self, i: int) -> Contact | None:
        """Return the contact of the i-th state, where it has one."""
        if not self.si:
            return None
        kind = CONTACTS[self.physics["geometry"]]
        kept = {name: self.inputs[name][i] for name in kind.INPUTS.names if name in self.inputs}
        return kind.of_kept(kept if self.parts is BASE_PARTS else {**kept, "parts": self.parts}, self.physics["law"])

    def coefficients(self, i: int) -> tuple[float, float]:
        """Return boundary_friction and beta of the i-th state."""
        return self.inputs["boundary_friction"][i], self.inputs["beta"][i]

    def row(self, i: int, ended: Ended) -> tuple[Array, str]:
        """Return the numbers that a sweep keeps of the i-th state, and the notes on it."""
        if ended.solution is None:
            return failed_row(self.contact(i), self.physics, ERROR if ended.fault else ended.outcome.name, ended.message)
        values, text = row_of(ended.solution, *self.coefficients(i))
        return values, text if ended.outcome.ok else f"{describe(Groups(*self.groups[i], **self.physics))}: {text}"


def solve_chain(chain: Chain, on_row: OnRow) -> None:
    """Solve the states of a chain in their order."""

    def on_state(i: int, ended: Ended) -> None:
        on_row(chain.rows[i], *chain.row(i, ended))

    solve_in_order(np.array(chain.groups), chain.physics, chain.rtol, on_state, chain.contact)
