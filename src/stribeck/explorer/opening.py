"""What a page shows when it opens: the inputs of its address, or of the start, and their answer."""

from __future__ import annotations

import threading
from collections.abc import Sequence

from stribeck.explorer.answer import Answer, Answerer
from stribeck.explorer.curves import Curve, hersey_scale
from stribeck.explorer.inputs import url
from stribeck.explorer.inputs.inputs import Inputs
from stribeck.explorer.inputs.url import Pin
from stribeck.explorer.serving.pools import OPENING, run
from stribeck.explorer.view import View
from stribeck.quantities.units import InputError
from stribeck.solver.solve_error import SolveError

__all__ = ["curves_of", "opening"]

MAX_OPENED = 4  # Answers that are kept for inputs with which pages open.
OPENED: dict[str, Answer] = {}  # Answers to the last inputs with which pages opened.
OPENED_LOCK = threading.Lock()


def answer_of(now: Inputs) -> Answer:
    """Return the answer to the inputs with which a page opens; many pages open with the same ones."""
    key = url.encode(now)
    with OPENED_LOCK:
        found = OPENED.get(key)
        if found is None:
            found = OPENED[key] = Answerer()(now)
            while len(OPENED) > MAX_OPENED:
                del OPENED[next(iter(OPENED))]
        return found


def curves_of(model: Answerer, pins: Sequence[Pin], answer: Answer) -> list[tuple[str, Curve, float]]:
    """Return the pinned curves as far as they are known, over the speeds of the axis of an answer."""
    found = []
    for pin in pins:
        curve = model.curve(pin.contact, pin.definition, answer.speeds)
        if curve is not None:
            found.append((pin.name, curve, hersey_scale(pin.contact)))
    return found


async def opening(items: list[tuple[str, str]], start: Inputs) -> tuple[url.Opened, View]:
    """Return what an address asks for and its answer, computed beside the event loop."""

    def prepare() -> tuple[url.Opened, View]:
        opened = url.decode(items, start)
        try:
            answer = answer_of(opened.inputs)
            return opened, View(answer, curves_of(Answerer(), opened.pins, answer))
        except (InputError, SolveError) as problem:
            shown = url.Opened(opened.inputs, opened.pins, {**opened.problems, "state": ("", str(problem))})
            return shown, View(answer_of(start))

    opened, shown = await run(OPENING, prepare)
    return opened, shown
