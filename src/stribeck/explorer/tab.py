"""One open page: what the user does on it."""

from __future__ import annotations

import weakref
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path, PurePath
from typing import Any

from nicegui import events, ui

from stribeck.cases.reading import load_case
from stribeck.explorer import downloads as files
from stribeck.explorer.charts.palette import LIGHT
from stribeck.explorer.following import Following, Superseded, reason
from stribeck.explorer.inputs import choices, inputs, url
from stribeck.explorer.inputs.inputs import Inputs
from stribeck.explorer.inputs.url import Pin
from stribeck.explorer.measured import Measured, fit_measured
from stribeck.explorer.reading import read_file
from stribeck.explorer.scans import SCAN_ENDINGS, Scan, with_scan
from stribeck.explorer.serving.pools import FILES, run
from stribeck.explorer.serving.tidy import tidy_soon
from stribeck.explorer.view import View
from stribeck.files.writing import MissingExtraError
from stribeck.quantities.units import InputError

__all__ = ["TABS", "Tab"]

MAX_WAITING_PAGES = 50  # Pages that wait for their browser's first answer; of more the oldest is given up.
WAITING_PAGES: list[Tab] = []  # Pages that were sent and whose browser did not answer yet.

# Open pages, by the names of their clients; a page that is closed drops out.
TABS: weakref.WeakValueDictionary[str, Tab] = weakref.WeakValueDictionary()

MAX_MEASURED = 3  # Files of measured curves that a page shows.


class Tab(Following):
    """One open page."""

    def __init__(self, opened: url.Opened, start: Inputs, shown: View) -> None:
        super().__init__(opened, shown)
        self.start = start
        TABS[self.page.client.id] = self
        self.connect()
        self.page.draw_all(self.inputs, self.view())
        self.problems = opened.problems
        self.page.show_history(self.history.steps)

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
        page.retry.on("click", self.request)
        page.back.on("click", self.go_back)
        for path, item in page.examples.items():
            item.on("click", lambda path=path: self.take_example(path))
        for name, way in (("undo", -1), ("redo", 1)):
            page.history[name].on("click", lambda way=way: self.step(way))
        page.keyboard.on_key(self.on_key)

    def slide(self, name: str, place: Any) -> None:
        """Take the place of a slider."""
        self.page.moved = self.page.knobs[name].id
        self.attempt(name, str(place), lambda: inputs.with_slider(self.inputs, name, float(place)))

    def commit(self, name: str, text: Any) -> None:
        """Take the text of a field."""
        self.attempt(name, str(text), lambda: inputs.with_text(self.inputs, name, str(text)))

    def choose_unit(self, name: str, unit: Any) -> None:
        """Show a field in another unit."""
        self.attempt(name, str(unit), lambda: inputs.in_unit(self.inputs, name, str(unit)))

    def pick(self, name: str, value: Any) -> None:
        """Choose a part of the model."""
        self.attempt(name, "", lambda: choices.choose(self.inputs, name, str(value)))

    def detail(self, name: str, given: Any) -> None:
        """Take the text of a field of a part of the model."""
        key, text = map(str, given)
        self.attempt(name, key, lambda: choices.with_detail(self.inputs, name, key, text))

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
        self.changes += 1
        self.page.show_choices(changed)
        self.request()

    def go_back(self) -> None:
        """Return to the inputs that are shown, and from these to those before."""
        if self.inputs is self.answer.inputs:
            self.step(-1)
        else:
            self.change(self.answer.inputs)

    def step(self, way: int) -> None:
        """Undo or redo."""
        found = self.history.step(way, self.inputs)
        if found is not None:
            self.change(found)
        self.page.show_history(self.history.steps)

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
        self.request()

    def pin(self) -> None:
        """Keep the present curve."""
        if len(self.pins) >= url.MAX_PINS:
            ui.notify(f"Up to {url.MAX_PINS} curves can be pinned; remove one first.")
            return
        name = files.pin_name(self.inputs, self.start, [pin.name for pin in self.pins])
        self.pins.append(Pin(name, self.inputs.contact, self.inputs.definition, self.inputs.model))
        self.show_chips()
        self.request()

    def unpin(self, pin: Pin) -> None:
        """Drop a pinned curve."""
        self.pins.remove(pin)
        self.show_chips()
        self.request()

    def show_chips(self) -> None:
        """List the pinned and the measured curves."""
        self.page.show_chips(self.pins, self.measured, self.unpin, self.forget)
        self.page.show_fit(bool(self.measured))

    def forget(self, found: Measured) -> None:
        """Drop a measured curve."""
        self.measured.remove(found)
        self.show_chips()
        self.request()

    async def take_example(self, path: Path) -> None:
        """Show an example."""
        found = await run(FILES, lambda: inputs.from_case(load_case(path)))
        with self.page.client:
            self.begin(found)

    def begin(self, found: Inputs) -> None:
        """Show the inputs of a case."""
        self.start = found
        self.change(replace(found, abscissa=self.inputs.abscissa))

    async def take_file(self, name: str, content: bytes) -> None:
        """Take a case, a measured curve or a surface that the browser sent."""
        kinds = {".toml": "case"} | dict.fromkeys(SCAN_ENDINGS, "scan")
        kind = kinds.get(PurePath(name.lower()).suffix, "measured")
        self.page.show_message(f"Reading {name} ...")
        try:
            found = await run(FILES, read_file, kind, name, content, self.inputs.contact)
        except InputError as problem:
            self.page.show_message("")
            self.page.complain(str(problem))
            return
        with self.page.client:
            self.page.show_message("")
            if kind == "case":
                self.begin(found)
            elif isinstance(found, Scan):
                self.take_scan(found)
            else:
                self.measured = [*self.measured, *found][-MAX_MEASURED:]
                self.show_chips()
                self.request()

    def take_scan(self, found: Scan) -> None:
        """Show the contact on a measured surface; undo brings back the one before."""
        try:
            self.change(with_scan(self.inputs, found))
        except InputError as problem:
            self.page.complain(str(problem))
        else:
            self.message = found.report

    async def fit(self) -> None:
        """Fit the inputs to the measured curves of the last file; undo brings back those before."""
        now, last = self.inputs, self.measured[-1]
        self.page.show_message(f"Fitting to {last.file} ...")

        def step(*_: Any) -> None:
            if self.closed or self.inputs is not now:
                raise Superseded

        try:
            fitted = await run(self.threads.slow, fit_measured, now, last, step, watch=step)
        except Superseded:
            self.page.show_message("The fit was given up, as the inputs changed.", bad=True)
        except Exception as problem:
            self.page.show_message(f"No fit: {reason(problem)}", bad=True)
        else:
            with self.page.client:
                self.change(fitted.inputs)
                self.message = fitted.report

    async def content(self, kind: str) -> bytes | None:
        """Return a file of what is shown, or None after saying why there is none."""
        try:
            found: bytes = await run(
                self.threads.slow, files.content, kind, self.view(), self.while_open, watch=self.while_open
            )
        except Superseded:
            return None
        except Exception as problem:
            self.page.complain(str(problem) if isinstance(problem, MissingExtraError) else reason(problem))
            return None
        return found

    def while_open(self, *_: Any) -> None:
        """End slow work of a page that is gone."""
        if self.closed:
            raise Superseded

    def close(self) -> None:
        """Stop what runs for a page that is gone."""
        self.closed = True
        self.threads.close()
        tidy_soon()
        if self.resting is not None:
            self.resting.cancel()

    async def open(self) -> None:
        """Do what needs the browser: its theme, and what comes at rest."""
        WAITING_PAGES.append(self)
        while len(WAITING_PAGES) > MAX_WAITING_PAGES:
            WAITING_PAGES.pop(0).page.client.delete()
        try:
            await self.page.client.connected(timeout=30)
        except TimeoutError:  # the browser went away at once
            if not self.closed:
                self.page.client.delete()
        finally:
            if self in WAITING_PAGES:
                WAITING_PAGES.remove(self)
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
                self.request()
