"""What one open page does: it takes what the user changes, asks for the answer, and gives it to the page.

A tab keeps one answer on its way. What changes meanwhile is asked next, so that the last value wins and a slow machine shows
fewer pictures instead of late ones.
"""

from __future__ import annotations

import asyncio
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from html import escape
from typing import Any

from nicegui import background_tasks, events, ui

from stribeck.explorer import downloads as files
from stribeck.explorer import inputs, table, url
from stribeck.explorer.answer import Model
from stribeck.explorer.charts.palette import LIGHT
from stribeck.explorer.curves import Curve
from stribeck.explorer.downloads import Shown
from stribeck.explorer.inputs import Inputs
from stribeck.explorer.measured import Measured, read_measured
from stribeck.explorer.page import Page
from stribeck.explorer.url import Pin
from stribeck.quantities.units import InputError
from stribeck.regimes.distances import TransitionDistances, transition_distances
from stribeck.solver.solve import SolveError

__all__ = ["Tab"]

REST = 0.4
"""Seconds after the last change from which what takes longer is done."""

LIVE = ThreadPoolExecutor(2, "explorer")
SLOW = ThreadPoolExecutor(1, "explorer-slow")
"""Threads of what follows the slider, and of what comes when it rests."""

MOST_MEASURED = 3


class Superseded(Exception):  # noqa: N818
    """The inputs changed while something slow was computed for them."""


class Tab:
    """One open page.

    Parameters
    ----------
    opened : Opened
        What its address asks for.
    start : Inputs
        What the command was started with.
    """

    def __init__(self, opened: url.Opened, start: Inputs) -> None:
        self.inputs, self.pins = opened.inputs, list(opened.pins)
        self.start = start
        self.measured: list[Measured] = []
        self.model = Model()
        self.asked = False
        self.working = False
        self.resting: asyncio.Task[Any] | None = None
        try:
            self.answer = self.model(self.inputs)
        except (InputError, SolveError):
            self.answer = self.model(self.start)
        self.page = Page(self.inputs)
        self.connect()
        self.page.draw_all(self.inputs, self.seen())
        self.problems = opened.problems

    def connect(self) -> None:
        """Let the elements of the page call what the user means by them."""
        page = self.page
        for name, knob in page.knobs.items():
            knob.on("slide", lambda event, name=name: self.slide(name, event.args))
            knob.on("commit", lambda event, name=name: self.commit(name, event.args))
            knob.on("unit", lambda event, name=name: self.choose_unit(name, event.args))
        for name, toggle in page.toggles.items():
            toggle.on_value_change(lambda event, name=name: self.choose(name, event.value))
        for kind, item in page.save_items.items():
            item.on_click(lambda kind=kind: background_tasks.create(self.save(kind)))
        page.upload.on_upload(self.on_upload)
        page.pin_button.on("click", self.pin)
        page.theme_button.on("click", self.toggle_theme)
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
        self.inputs = changed
        self.page.show_choices(changed)
        self.ask()

    def on_key(self, event: events.KeyEventArguments) -> None:
        """Do what a letter stands for, outside fields."""
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
        self.pins.append(Pin(name, self.inputs.contact, self.inputs.definition))
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

    def forget(self, found: Measured) -> None:
        """Drop a measured curve."""
        self.measured.remove(found)
        self.show_chips()
        self.ask()

    async def on_upload(self, event: events.UploadEventArguments) -> None:
        """Take a case or a measured curve."""
        name, content = event.file.name, await event.file.read()
        self.page.upload.reset()
        try:
            if name.lower().endswith(".toml"):
                case = await self.run(LIVE, files.read_case, name, content)
                self.page.status.text = ""
                self.start = inputs.from_case(case)
                self.change(replace(self.start, abscissa=self.inputs.abscissa))
                self.page.show_title(self.inputs)
            else:
                found = await self.run(LIVE, read_measured, name, content, self.inputs.contact)
                self.measured = [*self.measured, *found][-MOST_MEASURED:]
                self.show_chips()
                self.ask()
        except InputError as problem:
            self.page.complain(str(problem))

    async def save(self, kind: str) -> None:
        """Offer a file of what is shown."""
        with self.page.client:
            try:
                content = await self.run(SLOW, files.content, kind, self.seen())
            except (InputError, SolveError) as problem:
                self.page.complain(str(problem))
                return
            ui.download.content(content, files.name_of(kind, self.inputs.title))

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
            while self.asked:
                self.asked = False
                now = self.inputs
                try:
                    self.answer = await self.run(LIVE, self.model, now)
                except (InputError, SolveError) as problem:
                    self.page.status.text = f"{problem} The last picture stays."
                except Exception as problem:  # a page that silently no longer follows would be worse
                    self.page.status.text = f"Something went wrong that should not ({problem!r}). The last picture stays."
                else:
                    self.page.status.text = ""
                await self.page.draw(self.inputs, self.seen())
        finally:
            self.working = False
        self.rest()

    @staticmethod
    async def run(pool: ThreadPoolExecutor, function: Callable[..., Any], *arguments: Any) -> Any:
        """Return what a function gives, computed in a thread."""
        return await asyncio.get_running_loop().run_in_executor(pool, function, *arguments)

    def pinned(self) -> list[tuple[str, Curve, float]]:
        """Return the pinned curves as far as they are known, over the speeds of the axis."""
        found = []
        for pin in self.pins:
            curve = self.model.curve(pin.contact, pin.definition, self.answer.speeds)
            if curve is not None:
                found.append((pin.name, curve, pin.contact.viscosity / pin.contact.load))
        return found

    def seen(self) -> Shown:
        """Return the answer, and the curves that are shown with it."""
        return Shown(self.answer, self.pinned(), tuple(self.measured))

    # --- when the sliders rest ---

    def rest(self) -> None:
        """Wait for a while without change, then do what takes longer."""
        if self.resting is not None:
            self.resting.cancel()
        self.resting = background_tasks.create(self.settle(), name="explorer rests")

    async def settle(self) -> None:
        """Put the state into the address; solve the curve outside the atlas and the distances in all inputs."""
        await asyncio.sleep(REST)
        now = self.inputs
        with self.page.client:
            self.page.show_address(f"?{url.encode(now, self.pins)}")
            if await self.run(SLOW, self.model.settle, now) and self.inputs is now:
                self.ask()
                return
            found = await self.run(SLOW, self.ways, now)
            if found is not None and self.inputs is now:
                content = found if isinstance(found, str) else table.distances_html(found)
                self.page.distances.content = content

    def ways(self, now: Inputs) -> TransitionDistances | str | None:
        """Return the distances of a contact, the reason why there are none, or None where it is no longer shown."""

        def go_on(done: int, scans: int) -> None:
            if self.inputs is not now or self.page.client._deleted:
                raise Superseded

        try:
            return transition_distances(now.contact, definition=now.definition, on_point=go_on)
        except Superseded:
            return None
        except (InputError, SolveError) as problem:
            return f'<p class="note">{escape(str(problem))}</p>'

    async def open(self) -> None:
        """Do what needs the browser: its theme, and what comes at rest."""
        await self.page.client.connected(timeout=30)
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
