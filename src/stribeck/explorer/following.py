"""A page follows its inputs: one answer is on its way, and what takes longer comes when the sliders rest.

What changes meanwhile is asked next, so that the last value wins and a slow machine shows fewer pictures instead of late ones.
"""

from __future__ import annotations

import asyncio
import re
from collections.abc import Callable, Sequence
from html import escape
from typing import Any

from nicegui import background_tasks

from stribeck.explorer import table
from stribeck.explorer.answer import Answer, Answerer
from stribeck.explorer.asked import url
from stribeck.explorer.asked.history import History
from stribeck.explorer.asked.inputs import Inputs
from stribeck.explorer.asked.url import Pin
from stribeck.explorer.downloads import View
from stribeck.explorer.measured import Measured, speeds_of
from stribeck.explorer.opening import curves_of
from stribeck.explorer.page import UPDATING, Page
from stribeck.explorer.serving.pools import LIVE, SLOW, run
from stribeck.quantities.units import InputError
from stribeck.regimes.margins import RegimeMargins, regime_margins
from stribeck.solver.solve import SolveError

__all__ = ["Following", "Superseded", "without_rtol"]

MOMENT = 0.15
"""Seconds of waiting for an answer after which the old one is marked."""

REST = 0.4
"""Seconds after the last change from which what takes longer is done."""


def without_rtol(sentence: str) -> str:
    """Return a sentence about a failure without advice on the tolerance, which the page does not offer."""
    return re.sub(r"[;,]? *(?:ask for|or) [^.;]*rtol[^.;]*", "", sentence)


class Superseded(Exception):  # noqa: N818
    """The inputs changed while something slow was computed for them."""


def ways(now: Inputs, go_on: Callable[..., None]) -> RegimeMargins | str:
    """Return the margins of a contact, or the reason why there are none."""
    try:
        if now.table.geometry == "point":
            return '<p class="note">Margins of a ball take ten seconds to a minute; run stribeck regimes.</p>'
        return regime_margins(now.contact, definition=now.definition, on_point=go_on)
    except (InputError, SolveError) as problem:
        return f'<p class="note">{escape(without_rtol(str(problem)))}</p>'


class Following:
    """The answers of one open page.

    Parameters
    ----------
    opened : Opened
        What its address asks for.
    shown : View
        The answer to the inputs of the address, with the pinned curves.
    """

    def __init__(self, opened: url.Opened, shown: View) -> None:
        self.inputs, self.pins = opened.inputs, list(opened.pins)
        self.measured: list[Measured] = []
        self.model = Answerer(shown.answer)
        self.states: list[Any] = list(shown.states)
        self.said = ""
        self.asked = False
        self.working = False
        self.resting: asyncio.Task[Any] | None = None
        self.closed = False
        self.answer, self.pinned = shown.answer, list(shown.pins)
        self.page = Page(self.inputs)
        self.history = History(self.inputs)

    def ask(self) -> None:
        """Ask for the answer to the present inputs; only one is on its way."""
        self.asked = True
        if not self.working:
            self.working = True
            background_tasks.create(self.work(), name="explorer answers")

    async def work(self) -> None:
        """Answer until nothing is asked any more, the last inputs last."""
        try:
            while self.asked and not self.closed:
                self.asked = False
                now = self.inputs
                try:
                    await self.answered(now)
                except (InputError, SolveError) as problem:
                    self.page.say(f"{without_rtol(str(problem))} The last picture is kept.", bad=True)
                except Exception as problem:  # a page that silently no longer follows would be worse
                    self.page.say(f"Internal error ({problem!r}). The last picture is kept.", bad=True)
                else:
                    self.page.say(self.said)
                    self.said = ""
                try:
                    await self.page.draw(self.inputs, self.seen())
                except Exception as problem:
                    self.page.say(f"Internal error ({problem!r}). The last picture is kept.", bad=True)
        finally:
            self.working = False
        self.rest()

    async def answered(self, now: Inputs) -> None:
        """Compute the answer; where that takes longer than a moment, mark what is shown."""
        work = asyncio.ensure_future(run(LIVE, self.compute, now, tuple(self.pins), speeds_of(self.measured, now)))
        done, _ = await asyncio.wait({work}, timeout=MOMENT)
        if not done:
            self.page.show_working(now)
        self.answer, self.pinned, self.states = await work

    def compute(self, now: Inputs, pins: Sequence[Pin], measured: Sequence[float] = ()) -> tuple[Answer, list[Any], list[Any]]:
        """Return the answer, the pinned curves as far as they are known over the speeds of its axis, and their states."""
        answer = self.model(now, measured)
        states = [(pin.name, self.model.state_of_pin(pin.contact), pin.definition) for pin in pins]
        return answer, curves_of(self.model, pins, answer), states

    def seen(self) -> View:
        """Return the answer, and the curves that are shown with it."""
        return View(self.answer, self.pinned, tuple(self.measured), self.states)

    async def refresh(self, now: Inputs) -> None:
        """Show what has been solved since for the inputs that are shown."""
        if self.inputs is now and not self.working and not self.closed:
            self.answer, self.pinned, self.states = await run(
                LIVE, self.compute, now, tuple(self.pins), speeds_of(self.measured, now)
            )
            if self.inputs is now:
                await self.page.draw(now, self.seen())

    # --- when the sliders rest ---

    def rest(self) -> None:
        """Wait for a while without change, then do what takes longer."""
        if self.closed:
            return
        if self.resting is not None:
            self.resting.cancel()
        self.resting = background_tasks.create(self.settle(), name="explorer rests")

    async def settle(self) -> None:
        """Solve the curve outside the atlas at once; at rest put the state into the address and do what takes longer."""
        now = self.inputs
        go_on = self.watcher(now)

        def report(part: float) -> None:
            go_on()
            self.page.progress = f"{UPDATING} {100 * part:.0f} %"

        self.page.progress = ""
        with self.page.client:
            try:
                curve = asyncio.ensure_future(run(SLOW, self.model.settle, now, report))
                curve.add_done_callback(lambda task: task.cancelled() or task.exception())
                began = asyncio.get_running_loop().time()
                done, _ = await asyncio.wait({curve}, timeout=REST)
                if done and curve.result():
                    await self.refresh(now)
                await asyncio.sleep(max(0.0, began + REST - asyncio.get_running_loop().time()))
                self.page.show_address(f"?{url.encode(now, self.pins)}")
                self.history.rest(now)
                self.page.show_ways(self.history.ways)
                if not done:
                    while not curve.done():
                        if self.page.progress:  # it is being solved, and does not only wait for another page
                            self.page.show_progress()
                        await asyncio.wait({curve}, timeout=REST)
                    if curve.result():
                        await self.refresh(now)
                if await run(SLOW, self.model.settle, now, go_on, True):
                    await self.refresh(now)
                self.page.progress = self.model.why_no_curve(now)
                if self.page.progress:
                    self.page.show_progress()
                slow = [self.settle_margins, self.settle_checks]
                for part in [self.settle_map, *slow] if self.model.map_is_quick(now) else [*slow, self.settle_map]:
                    await part(now, go_on)
            except Superseded:
                return
            except Exception as problem:  # else what is being updated would say so for ever
                self.page.say(f"Internal error ({problem!r}).", bad=True)

    async def settle_map(self, now: Inputs, go_on: Callable[..., None]) -> None:
        """Show the rows of the phase diagram as they are solved."""
        rows = self.model.diagrams(now, go_on)
        while await run(SLOW, next, rows, False) is not False:
            await self.refresh(now)

    async def settle_margins(self, now: Inputs, go_on: Callable[..., None]) -> None:
        """Show the margins to the next regimes."""
        found = await run(SLOW, ways, now, go_on)
        if self.inputs is now:
            self.page.show_margins(found if isinstance(found, str) else table.margins_html(found), now)

    async def settle_checks(self, now: Inputs, go_on: Callable[..., None]) -> None:
        """Show what the checks say that need the curve, or another one."""
        if await run(SLOW, self.model.settle_checks, now, go_on):
            await self.refresh(now)

    @property
    def is_seen(self) -> bool:
        """Whether a browser shows the page; what it left is given up at once, and done anew if it comes back."""
        return not self.closed and self.page.client.has_socket_connection

    def watcher(self, now: Inputs) -> Callable[..., None]:
        """Return what slow work calls again and again: it ends where the inputs have changed."""

        def go_on(*_: Any) -> None:
            if self.inputs is not now or not self.is_seen:
                raise Superseded

        return go_on
