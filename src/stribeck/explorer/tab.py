"""One open page: it takes the changes of the user, asks for the answer, and gives it to the page.

A tab keeps one answer on its way. What changes meanwhile is asked next, so that the last value wins and a slow machine shows
fewer pictures instead of late ones.
"""

from __future__ import annotations

import asyncio
import re
import threading
import weakref
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from html import escape
from pathlib import Path, PurePath
from typing import Any

from nicegui import background_tasks, events, ui

from stribeck.cases.reading import load_case
from stribeck.explorer import downloads as files
from stribeck.explorer import table
from stribeck.explorer.answer import Answer, Answerer
from stribeck.explorer.asked import choices, inputs, url
from stribeck.explorer.asked.history import History
from stribeck.explorer.asked.inputs import Inputs
from stribeck.explorer.asked.url import Pin
from stribeck.explorer.charts.palette import LIGHT
from stribeck.explorer.curves import Curve, hersey_scale
from stribeck.explorer.downloads import View
from stribeck.explorer.measured import Measured, fit_measured, speeds_of
from stribeck.explorer.page import UPDATING, Page
from stribeck.explorer.reading import read_file
from stribeck.explorer.scans import ENDINGS, Scan, with_scan
from stribeck.explorer.serving.tidy import tidy_soon
from stribeck.files.writing import MissingExtraError
from stribeck.quantities.units import InputError
from stribeck.regimes.margins import RegimeMargins, regime_margins
from stribeck.solver.solve import SolveError

__all__ = ["TABS", "Tab", "opening"]

MOMENT = 0.15
"""Seconds of waiting for an answer after which the old one is marked."""

REST = 0.4
"""Seconds after the last change from which what takes longer is done."""

LIVE = ThreadPoolExecutor(2, "explorer")
SLOW = ThreadPoolExecutor(1, "explorer-slow")
FILES = ThreadPoolExecutor(2, "explorer-files")
"""Threads of what follows the slider, of what comes when it rests, and of files that are read."""

MOST_OPENED = 4
OPENED: dict[str, Answer] = {}
OPENED_LOCK = threading.Lock()
"""Answers to the last inputs with which pages opened."""

MOST_WAITING = 50
WAITING: list[Tab] = []
"""Pages that were sent and whose browser did not answer yet; of more than so many the oldest is given up."""

TABS: weakref.WeakValueDictionary[str, Tab] = weakref.WeakValueDictionary()
"""Open pages, by the names of their clients; a page that is closed drops out."""

MOST_MEASURED = 3


def without_rtol(sentence: str) -> str:
    """Return a sentence about a failure without advice on the tolerance, which the page does not offer."""
    return re.sub(r"[;,]? *(?:ask for|or) [^.;]*rtol[^.;]*", "", sentence)


class Superseded(Exception):  # noqa: N818
    """The inputs changed while something slow was computed for them."""


def answer_of(now: Inputs) -> Answer:
    """Return the answer to the inputs with which a page opens; many pages open with the same ones."""
    key = url.encode(now)
    with OPENED_LOCK:
        found = OPENED.get(key)
        if found is None:
            found = OPENED[key] = Answerer()(now)
            while len(OPENED) > MOST_OPENED:
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
    """Return what an address asks for and its answer, computed beside the event loop.

    Parameters
    ----------
    items : list of (str, str)
        Keys and values of the address.
    start : Inputs
        What the command was started with.

    Returns
    -------
    Opened, View
        The inputs, and their answer with the pinned curves; that of the start where they cannot be solved.
    """

    def prepare() -> tuple[url.Opened, View]:
        opened = url.decode(items, start)
        try:
            answer = answer_of(opened.inputs)
            return opened, View(answer, curves_of(Answerer(), opened.pins, answer))
        except (InputError, SolveError) as problem:
            told = url.Opened(opened.inputs, opened.pins, {**opened.problems, "state": ("", str(problem))})
            return told, View(answer_of(start))

    opened, shown = await Tab.run(LIVE, prepare)
    return opened, shown


class Tab:
    """One open page.

    Parameters
    ----------
    opened : Opened
        What its address asks for.
    start : Inputs
        What the command was started with.
    shown : View
        The answer to the inputs of the address, with the pinned curves.
    """

    def __init__(self, opened: url.Opened, start: Inputs, shown: View) -> None:
        self.inputs, self.pins = opened.inputs, list(opened.pins)
        self.start = start
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
        TABS[self.page.client.id] = self
        self.connect()
        self.page.draw_all(self.inputs, self.seen())
        self.problems = opened.problems
        self.history = History(self.inputs)
        self.page.show_ways(self.history.ways)

    def connect(self) -> None:
        """Let the elements of the page call what the user means by them."""
        page = self.page
        for name in (*inputs.NAMES, *inputs.GROUP_FIELDS):
            knob = page.knobs[name]
            knob.on("slide", lambda event, name=name: self.slide(name, event.args))
            knob.on("commit", lambda event, name=name: self.commit(name, event.args))
            knob.on("unit", lambda event, name=name: self.choose_unit(name, event.args))
        for name in choices.CHOICES:
            knob = page.knobs[name]
            knob.on("pick", lambda event, name=name: self.pick(name, event.args))
            knob.on("commit", lambda event, name=name: self.detail(name, event.args))
        for name, toggle in page.toggles.items():
            toggle.on_value_change(lambda event, name=name: self.choose(name, event.value))
        page.client.on_delete(self.close)
        page.client.on_connect(self.rest)
        page.pin_button.on("click", self.pin)
        page.fit_button.on("click", self.fit)
        page.theme_button.on("click", self.toggle_theme)
        for path, item in page.examples.items():
            item.on("click", lambda path=path: self.take_example(path))
        for name, way in (("undo", -1), ("redo", 1)):
            page.history[name].on("click", lambda way=way: self.step(way))
        page.keyboard.on_key(self.on_key)

    # --- what the user does ---

    def slide(self, name: str, place: Any) -> None:
        """Take the place of a slider."""
        self.page.moved = self.page.knobs[name].id
        self.attempt(name, str(place), lambda: inputs.slid(self.inputs, name, float(place)))

    def commit(self, name: str, text: Any) -> None:
        """Take the text of a field."""
        self.attempt(name, str(text), lambda: inputs.typed(self.inputs, name, str(text)))

    def choose_unit(self, name: str, unit: Any) -> None:
        """Show a field in another unit."""
        self.attempt(name, str(unit), lambda: inputs.in_unit(self.inputs, name, str(unit)))

    def pick(self, name: str, value: Any) -> None:
        """Choose a part of the model."""
        self.attempt(name, "", lambda: choices.choose(self.inputs, name, str(value)))

    def detail(self, name: str, given: Any) -> None:
        """Take the text of a field of a part of the model."""
        key, text = map(str, given)
        self.attempt(name, key, lambda: choices.typed_detail(self.inputs, name, key, text))

    def choose(self, name: str, value: str) -> None:
        """Take the definition of friction, or what the curve is drawn over."""
        if getattr(self.inputs, name) != value:
            self.change(replace(self.inputs, **{name: value}))  # type: ignore[arg-type]

    def attempt(self, name: str, text: str, action: Callable[[], Inputs]) -> None:
        """Change the inputs, or mark the field with the reason why not."""
        try:
            changed = action()
        except InputError as problem:
            self.page.mark(name, text, str(problem))
            return
        self.page.renew(name)
        self.change(changed)

    def change(self, changed: Inputs) -> None:
        """Take new inputs and ask for their answer."""
        if changed.title != self.inputs.title:
            self.page.show_title(changed)
        self.inputs = changed
        self.page.show_choices(changed)
        self.ask()

    def step(self, way: int) -> None:
        """Undo or redo."""
        found = self.history.step(way, self.inputs)
        if found is not None:
            self.change(found)
        self.page.show_ways(self.history.ways)

    def on_key(self, event: events.KeyEventArguments) -> None:
        """Act on a keyboard shortcut, outside fields."""
        if event.action.keydown and not (event.modifiers.ctrl or event.modifiers.alt or event.modifiers.meta):
            if event.key == "p":
                self.pin()
            elif event.key == "t":
                self.toggle_theme()
            elif event.key == "l":
                self.page.copy_address()

    def toggle_theme(self) -> None:
        """Go from light to dark or back."""
        self.set_theme(self.page.palette is LIGHT)

    def set_theme(self, dark: bool) -> None:
        """Take the colours of the theme."""
        self.page.set_theme(dark)
        self.show_chips()
        self.ask()

    def pin(self) -> None:
        """Keep the present curve."""
        if len(self.pins) >= url.MOST_PINS:
            ui.notify(f"Up to {url.MOST_PINS} curves can be pinned; remove one first.")
            return
        name = files.pin_name(self.inputs, self.start, [pin.name for pin in self.pins])
        self.pins.append(Pin(name, self.inputs.contact, self.inputs.definition, self.inputs.model))
        self.show_chips()
        self.ask()

    def unpin(self, pin: Pin) -> None:
        """Drop a pinned curve."""
        self.pins.remove(pin)
        self.show_chips()
        self.ask()

    def show_chips(self) -> None:
        """List the pinned and the measured curves."""
        self.page.show_chips(self.pins, self.measured, self.unpin, self.forget)
        self.page.show_fit(bool(self.measured))

    def forget(self, found: Measured) -> None:
        """Drop a measured curve."""
        self.measured.remove(found)
        self.show_chips()
        self.ask()

    async def take_example(self, path: Path) -> None:
        """Show an example."""
        found = await self.run(FILES, lambda: inputs.from_case(load_case(path)))
        with self.page.client:
            self.begin(found)

    def begin(self, found: Inputs) -> None:
        """Show the inputs of a case."""
        self.start = found
        self.change(replace(found, abscissa=self.inputs.abscissa))

    async def take_file(self, name: str, content: bytes) -> None:
        """Take a case, a measured curve or a surface that the browser sent."""
        kinds = {".toml": "case"} | dict.fromkeys(ENDINGS, "scan")
        kind = kinds.get(PurePath(name.lower()).suffix, "measured")
        self.page.say(f"Reading {name} ...")
        try:
            found = await self.run(FILES, read_file, kind, name, content, self.inputs.contact)
        except InputError as problem:
            self.page.say("")
            self.page.complain(str(problem))
            return
        with self.page.client:
            self.page.say("")
            if kind == "case":
                self.begin(found)
            elif isinstance(found, Scan):
                self.take_scan(found)
            else:
                self.measured = [*self.measured, *found][-MOST_MEASURED:]
                self.show_chips()
                self.ask()

    def take_scan(self, found: Scan) -> None:
        """Show the contact on a measured surface; undo brings back the one before."""
        try:
            self.change(with_scan(self.inputs, found))
        except InputError as problem:
            self.page.complain(str(problem))
        else:
            self.said = found.words

    async def fit(self) -> None:
        """Fit the inputs to the measured curves of the last file; undo brings back those before."""
        now, last = self.inputs, self.measured[-1]
        self.page.say(f"Fitting to {last.file} ...")

        def step(*_: Any) -> None:
            if self.closed or self.inputs is not now:
                raise Superseded

        try:
            fitted = await self.run(SLOW, fit_measured, now, last, step)
        except Superseded:
            self.page.say("The fit was given up, as the inputs changed.", bad=True)
        except (InputError, SolveError) as problem:
            self.page.say(f"No fit: {without_rtol(str(problem))}", bad=True)
        else:
            with self.page.client:
                self.change(fitted.inputs)
                self.said = fitted.words

    async def content(self, kind: str) -> bytes | None:
        """Return a file of what is shown, or None after saying why there is none."""
        try:
            found: bytes = await self.run(SLOW, files.content, kind, self.seen())
        except (InputError, SolveError, MissingExtraError) as problem:
            self.page.complain(str(problem))
            return None
        return found

    def close(self) -> None:
        """Stop what runs for a page that is gone."""
        self.closed = True
        tidy_soon()
        if self.resting is not None:
            self.resting.cancel()

    # --- the answer ---

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

    @staticmethod
    async def run(pool: ThreadPoolExecutor, function: Callable[..., Any], *arguments: Any) -> Any:
        """Return what a function gives, computed in a thread."""
        return await asyncio.get_running_loop().run_in_executor(pool, function, *arguments)

    async def answered(self, now: Inputs) -> None:
        """Compute the answer; where that takes longer than a moment, mark what is shown."""
        work = asyncio.ensure_future(self.run(LIVE, self.compute, now, tuple(self.pins), speeds_of(self.measured, now)))
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
            self.answer, self.pinned, self.states = await self.run(
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
                curve = asyncio.ensure_future(self.run(SLOW, self.model.settle, now, report))
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
                self.page.progress = self.model.why_no_curve(now)
                if self.page.progress:
                    self.page.show_progress()
                found = await self.run(SLOW, self.ways, now, go_on)
                if self.inputs is now:
                    self.page.show_margins(found if isinstance(found, str) else table.margins_html(found), now)
                if await self.run(SLOW, self.model.settle_checks, now, go_on):
                    await self.refresh(now)
                rows = self.model.diagrams(now, go_on)
                while await self.run(SLOW, next, rows, False) is not False:
                    await self.refresh(now)
            except Superseded:
                return
            except Exception as problem:  # else what is being updated would say so for ever
                self.page.say(f"Internal error ({problem!r}).", bad=True)

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

    @staticmethod
    def ways(now: Inputs, go_on: Callable[..., None]) -> RegimeMargins | str:
        """Return the margins of a contact, or the reason why there are none."""
        try:
            if now.table.geometry == "point":
                return '<p class="note">Margins of a ball take ten seconds to a minute; run stribeck regimes.</p>'
            return regime_margins(now.contact, definition=now.definition, on_point=go_on)
        except (InputError, SolveError) as problem:
            return f'<p class="note">{escape(without_rtol(str(problem)))}</p>'

    async def open(self) -> None:
        """Do what needs the browser: its theme, and what comes at rest."""
        WAITING.append(self)
        while len(WAITING) > MOST_WAITING:
            WAITING.pop(0).page.client.delete()
        try:
            await self.page.client.connected(timeout=30)
        except TimeoutError:  # the browser went away at once
            if not self.closed:
                self.page.client.delete()
        finally:
            if self in WAITING:
                WAITING.remove(self)
        if self.closed:
            return
        with self.page.client:
            for name, (text, sentence) in self.problems.items():
                self.page.mark(name, text, sentence)
            self.show_chips()
            try:
                dark = await self.page.client.run_javascript("matchMedia('(prefers-color-scheme: dark)').matches", timeout=5)
            except TimeoutError:
                dark = False
            if dark:
                self.set_theme(True)
            else:
                self.ask()
