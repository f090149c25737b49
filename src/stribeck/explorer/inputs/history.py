"""Undo and redo: the inputs at which a page has rested, in order."""

from __future__ import annotations

from stribeck.explorer.inputs.inputs import Inputs

MAX_STEPS = 100  # Steps of undo that are kept.


class History:
    """What a page has shown at rest, and where in it the page is."""

    def __init__(self, start: Inputs) -> None:
        self.states = [start]
        self.place = 0

    def rest(self, now: Inputs) -> None:
        """Take inputs that have come to rest; what was undone before is then gone, unless these are the same."""
        if now == self.states[self.place]:
            return
        self.states = [*self.states[: self.place + 1], now][-MAX_STEPS:]
        self.place = len(self.states) - 1

    def step(self, way: int, now: Inputs) -> Inputs | None:
        """Return the inputs one step back or forth, or None if there are none."""
        self.rest(now)
        if not 0 <= self.place + way < len(self.states):
            return None
        self.place += way
        return self.states[self.place]

    @property
    def steps(self) -> dict[str, bool]:
        """Whether there is something to undo and to redo."""
        return {"undo": self.place > 0, "redo": self.place < len(self.states) - 1}
