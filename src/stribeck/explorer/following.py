"""A page follows its inputs: one answer is on its way, and what takes longer comes when the sliders rest.

What changes meanwhile is asked next, so that the last value wins and a slow machine shows fewer pictures instead of late ones.
"""

from __future__ import annotations

import asyncio
import re
import time
from collections.abc import Callable, Sequence
from html import escape
from typing import Any

from nicegui import background_tasks

from stribeck.explorer.answer import Answer, Answerer
from stribeck.explorer.inputs import url
from stribeck.explorer.inputs.carried import errors_of
from stribeck.explorer.inputs.history import History
from stribeck.explorer.inputs.inputs import Inputs
from stribeck.explorer.inputs.url import Pin
from stribeck.explorer.measured import Measured, speeds_of
from stribeck.explorer.opening import curves_of
from stribeck.explorer.page import UPDATING_TEXT, Page
from stribeck.explorer.serving.pools import Threads, run
from stribeck.explorer.view import View
from stribeck.quantities.units import InputError
from stribeck.regimes.margin_intervals import with_intervals
from stribeck.regimes.margins import RegimeMargins, regime_margins
from stribeck.solver.solve_error import SolveError

__all__ = ["Following", "Superseded", "without_rtol"]

MARK_AFTER_SECONDS = 0.15  # Wait for an answer after which the old one is marked as old [s].

# Age at which an unfinished answer is ended when the inputs change; a younger one is still shown [s].
CANCEL_AFTER_SECONDS = 1.0

IDLE_SECONDS = 0.4  # Pause after the last change before slow work begins [s].


def without_rtol(sentence: str) -> str:
    """Return a sentence about a failure without advice on the tolerance, which the page does not offer."""
    left = re.sub(r"[;,]? *\b(?:ask for|or)\b[^.;]*\brtol\b[^.;]*", "", sentence)
    return re.sub(r"\brtol\b", "tolerance", left)


class Superseded(Exception):  # noqa: N818
    """The inputs changed, or the page was closed, while something slow was computed for them."""


def reason(problem: Exception) -> str:
    """Return in a sentence why something could not be computed."""
    if isinstance(problem, InputError | SolveError):
        return without_rtol(str(problem))
    return f"Internal error ({' '.join(repr(problem).split())[:300]})."


def find_margins(now: Inputs, go_on: Callable[..., None]) -> RegimeMargins | str:
    """Return the margins of a contact, or the reason why there are none."""
    try:
        if now.table.geometry == "point":
            return '<p class="note">Margins of a ball take ten seconds to a minute; run stribeck regimes.</p>'
        found = regime_margins(now.contact, definition=now.definition, on_point=go_on)
        errors = errors_of(now.rest)
        return with_intervals(now.contact, found, errors, now.definition) if errors else found
    except Superseded:
        raise
    except Exception as problem:  # else what is being updated would say so for ever
        return f'<p class="note">{escape(reason(problem))}</p>'


class Following:
    """The answers of one open page."""

    def __init__(self, opened: url.Opened, shown: View) -> None:
        self.inputs, self.pins = opened.inputs, list(opened.pins)
        self.measured: list[Measured] = []
        self.model = Answerer(shown.answer)
        self.states: list[Any] = list(shown.states)
        self.message = ""
        self.is_requested = False
        self.changes = self.answered_changes = 0
        self.working = False
        self.resting: asyncio.Task[Any] | None = None
        self.closed = False
        self.answer, self.pinned = shown.answer, list(shown.pins)
        self.threads = Threads()
        self.page = Page(self.inputs)
        self.history = History(self.inputs)

    def request(self) -> None:
        """Ask for the answer to the present inputs; only one is on its way."""
        self.is_requested = True
        if not self.working:
            self.working = True
            background_tasks.create(self.work(), name="explorer answers")

    async def work(self) -> None:
        """Answer until nothing is asked any more, the last inputs last."""
        try:
            while self.is_requested and not self.closed:
                self.is_requested = False
                now, changes = self.inputs, self.changes
                try:
                    await self.compute_answer(now, changes)
                    await self.page.draw(self.inputs, self.view())
                except Superseded:
                    continue
                except Exception as problem:  # a page that silently no longer follows would be worse
                    await self.keep_last_answer(problem)
                else:
                    self.page.show_message(self.message)
                    self.message = ""
                self.answered_changes = changes
        finally:
            self.working = False
        self.rest()

    async def keep_last_answer(self, problem: Exception) -> None:
        """Keep the last answer, with all that belongs to it, and say why the next one is not there."""
        self.page.fail(f"{reason(problem)} What is shown belongs to the inputs before.")
        if not isinstance(problem, InputError | SolveError):
            self.model = Answerer(self.answer)  # what the failure left in the old one is not to be trusted
        try:
            await self.page.draw(self.inputs, self.view())
        except Exception as again:
            self.page.fail(f"{reason(again)} Reload the page.")

    async def compute_answer(self, now: Inputs, changes: int) -> None:
        """Compute the answer; where that takes longer than a moment, mark what is shown."""
        began = time.monotonic()

        def watch() -> None:
            if self.closed or (self.changes != changes and time.monotonic() - began > CANCEL_AFTER_SECONDS):
                raise Superseded

        arguments = now, tuple(self.pins), speeds_of(self.measured, now)
        work = asyncio.ensure_future(run(self.threads.live, self.compute, *arguments, watch=watch))
        done, _ = await asyncio.wait({work}, timeout=MARK_AFTER_SECONDS)
        if not done:
            self.page.show_working(now)
        self.answer, self.pinned, self.states = await work

    def compute(self, now: Inputs, pins: Sequence[Pin], measured: Sequence[float] = ()) -> tuple[Answer, list[Any], list[Any]]:
        """Return the answer, the pinned curves as far as they are known over the speeds of its axis, and their states."""
        answer = self.model(now, measured)
        states = [(pin.name, self.model.state_of_pin(pin.contact), pin.definition) for pin in pins]
        return answer, curves_of(self.model, pins, answer), states

    def view(self) -> View:
        """Return the answer, and the curves that are shown with it."""
        return View(self.answer, self.pinned, tuple(self.measured), self.states)

    async def refresh(self, now: Inputs) -> None:
        """Show what has been solved since for the inputs that are shown."""
        if self.is_shown(now) and not self.working:
            arguments = now, tuple(self.pins), speeds_of(self.measured, now)
            found = await run(self.threads.live, self.compute, *arguments, watch=self.progress_callback(now))
            if self.is_shown(now) and not self.working:
                self.answer, self.pinned, self.states = found
                await self.page.draw(self.inputs, self.view())

    def is_shown(self, now: Inputs) -> bool:
        """Whether the page shows the answer to these inputs, and no others were asked for since."""
        return self.answer.inputs is now and self.answered_changes == self.changes and not self.closed

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
        now = self.answer.inputs
        go_on = self.progress_callback(now)

        def report(part: float) -> None:
            go_on()
            self.page.progress = f"{UPDATING_TEXT} {100 * part:.0f} %"

        async def attempt(part: Callable[..., Any]) -> None:
            try:
                await part(now, go_on)
            except Superseded:
                raise
            except Exception as problem:  # of one part, which holds up no other
                self.page.fail(reason(problem))

        self.page.progress = ""
        slow = self.threads.slow
        with self.page.client:
            try:
                curve = asyncio.ensure_future(run(slow, self.model.settle, now, report, watch=go_on))
                curve.add_done_callback(lambda task: task.cancelled() or task.exception())
                began = asyncio.get_running_loop().time()
                done, _ = await asyncio.wait({curve}, timeout=IDLE_SECONDS)
                if done and not curve.exception() and curve.result():
                    await self.refresh(now)
                await asyncio.sleep(max(0.0, began + IDLE_SECONDS - asyncio.get_running_loop().time()))
                self.page.show_address(f"?{url.encode(now, self.pins)}")
                self.history.rest(now)
                self.page.show_history(self.history.steps)
                if not done:
                    while not curve.done():
                        if self.page.progress:  # it is being solved, and does not only wait for another page
                            self.page.show_progress()
                        await asyncio.wait({curve}, timeout=IDLE_SECONDS)
                    if not curve.exception() and curve.result():
                        await self.refresh(now)
                try:
                    curve.result()
                    if await run(slow, self.model.settle, now, go_on, True, watch=go_on):
                        await self.refresh(now)
                    self.page.progress = self.model.why_no_curve(now)
                except Superseded:
                    raise
                except Exception as problem:  # else what is being updated would say so for ever
                    self.page.progress = reason(problem)
                    self.page.fail(f"The curve could not be computed. {self.page.progress}")
                if self.page.progress:
                    self.page.show_progress()
                parts = [self.settle_margins, self.settle_spread, self.settle_checks, self.settle_notes]
                for part in [self.settle_map, *parts] if self.model.map_is_quick(now) else [*parts, self.settle_map]:
                    await attempt(part)
            except Superseded:
                return

    async def settle_map(self, now: Inputs, go_on: Callable[..., None]) -> None:
        """Show the rows of the phase diagram as they are solved."""
        rows = self.model.diagrams(now, go_on)
        while await run(self.threads.slow, next, rows, False, watch=go_on) is not False:
            await self.refresh(now)

    async def settle_margins(self, now: Inputs, go_on: Callable[..., None]) -> None:
        """Show the margins to the next regimes."""
        found = await run(self.threads.slow, find_margins, now, go_on, watch=go_on)
        if self.is_shown(now):
            self.page.show_margins(found, now)
            await self.refresh(now)

    async def settle_spread(self, now: Inputs, go_on: Callable[..., None]) -> None:
        """Show what the errors of the inputs leave open."""
        if await run(self.threads.slow, self.model.settle_spread, now, go_on, watch=go_on):
            await self.refresh(now)

    async def settle_checks(self, now: Inputs, go_on: Callable[..., None]) -> None:
        """Show what the checks say that need the curve, or another one."""
        if await run(self.threads.slow, self.model.settle_checks, now, go_on, watch=go_on):
            await self.refresh(now)

    async def settle_notes(self, now: Inputs, go_on: Callable[..., None]) -> None:
        """Show what to know of the curve."""
        if await run(self.threads.slow, self.model.settle_notes, now, go_on, watch=go_on):
            await self.refresh(now)

    @property
    def is_seen(self) -> bool:
        """Whether a browser shows the page; what it left is given up at once, and done anew if it comes back."""
        return not self.closed and self.page.client.has_socket_connection

    def progress_callback(self, now: Inputs) -> Callable[..., None]:
        """Return what slow work calls again and again: it ends where the inputs have changed."""

        def go_on(*_: Any) -> None:
            if not self.is_shown(now) or not self.is_seen:
                raise Superseded

        return go_on
