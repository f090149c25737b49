"""The page: fields and sliders in, charts and numbers out, one :class:`Tab` for each that is open.

A tab keeps one answer on its way. What changes meanwhile is asked next, so that the last value wins and a slow machine shows
fewer pictures instead of late ones.
"""

from __future__ import annotations

import asyncio
import json
import math
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from typing import Any

from nicegui import background_tasks, events, ui

from ..distances import TransitionDistances, transition_distances
from ..solve import SolveError
from ..units import InputError
from . import charts, files, inputs, table, url
from .inputs import FIELDS, GROUP_FIELDS, Inputs
from .measured import Measured
from .palette import DARK, LIGHT
from .results import Answer, Curve, Model
from .url import Pin

__all__ = ["Tab"]

REST = 0.4
"""Seconds after the last change from which what takes longer is done."""

PATIENCE = 2.0
"""Seconds after which a browser that does not answer gets the next picture all the same."""

LIVE = ThreadPoolExecutor(2, "explorer")
SLOW = ThreadPoolExecutor(1, "explorer-slow")
"""Threads of what follows the slider, and of what comes when it rests."""

MOST_MEASURED = 3
LARGEST_FILE = 5_000_000

DEFINITIONS = {"paper": "as printed", "balanced": "balanced"}
ABSCISSAS = {"speed": "speed", "hersey": "Hersey number"}


class Superseded(Exception):  # noqa: N818
    """The inputs changed while something slow was computed for them."""


class Knob(ui.slider):
    """A slider that the browser moves by itself, without waiting for the server."""

    LOOPBACK = False


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
        self.answer: Answer | None = None
        self.asked = False
        self.working = False
        self.setting = False
        self.resting: asyncio.Task[Any] | None = None
        self.rows: dict[str, dict[str, Any]] = {}
        self.charts: dict[str, ui.echart] = {}
        self.client = ui.context.client
        self.build(opened)
        for name, (text, sentence) in opened.problems.items():
            self.mark(name, text, sentence)

    # --- the page ---

    def build(self, opened: url.Opened) -> None:
        """Make all elements, with the first answer in them."""
        self.dark = ui.dark_mode(None)
        self.palette = LIGHT
        self.status_text = ""
        try:
            self.answer = self.model(self.inputs)
        except (InputError, SolveError) as problem:
            self.status_text = str(problem)
            self.inputs = self.start
            self.answer = self.model(self.inputs)
        with ui.element("main").classes("explorer"):
            self.build_bar()
            with ui.element("section").classes("card controls").props('aria-label="Inputs"'):
                self.build_controls()
            with ui.element("div").classes("middle"):
                with ui.element("section").classes("card friction").props('aria-label="Stribeck curve"'):
                    self.build_friction()
                with ui.element("section").classes("card fields").props('aria-label="Gap and pressure"'):
                    ui.html("<h2>Gap and pressure along the contact</h2>", sanitize=False)
                    with ui.element("div").classes("pair"):
                        self.chart("gap", "Gap along the contact")
                        self.chart("pressure", "Contact and fluid pressure along the contact")
            with ui.element("div").classes("side"):
                with ui.element("section").classes("card numbers").props('aria-label="Numbers"'):
                    self.status = ui.label(self.status_text).classes("status").props('role="status"')
                    self.numbers = ui.html("", sanitize=False)
                with ui.element("section").classes("card more").props('aria-label="Distances"'):
                    ui.html("<h2>To the next regimes, by each input</h2>", sanitize=False)
                    self.distances = ui.html('<p class="caption">solved when the sliders rest</p>', sanitize=False)
                with ui.element("section").classes("card diagram").props('aria-label="Phase diagram"'):
                    self.diagram_head = ui.html("<h2>Regimes</h2>", sanitize=False)
                    self.chart("diagram", "Regimes over speed and roughness")
        ui.keyboard(self.on_key)
        self.draw_all()

    def build_bar(self) -> None:
        """Make the line of title and buttons."""
        with ui.element("header").classes("bar"):
            self.title = ui.html("", sanitize=True, tag="h1")
            self.upload = (
                ui.upload(on_upload=self.on_upload, auto_upload=True, multiple=True, max_file_size=LARGEST_FILE)
                .on("rejected", lambda: self.complain(f"Files are read up to {LARGEST_FILE // 1_000_000} MB."))
                .props('accept=".toml,.csv,.txt" aria-hidden="true"')
                .classes("hidden-upload")
            )
            with button("Load", "upload_file", "Load a case (TOML) or a measured curve (CSV)") as load:
                load.on("click", js_handler=f"() => getElement({self.upload.id}).pickFiles()")
            with button("Save", "download", "Download what is shown"):
                with ui.menu():
                    for label, kind in files.KINDS.items():
                        ui.menu_item(label, lambda kind=kind: background_tasks.create(self.save(kind)))
            button("Pin", "push_pin", "Keep this curve to compare (p)").on("click", self.pin)
            button("Link", "link", "Copy the address of this state (l)").on("click", js_handler=self.copy_script())
            button("", "contrast", "Light or dark (t)").on("click", self.toggle_theme).props("aria-label='Light or dark'")
            self.show_title()

    @staticmethod
    def copy_script() -> str:
        """Return what copies the address, which the page keeps up to date."""
        return (
            "() => { (navigator.clipboard ? navigator.clipboard.writeText(location.href) : Promise.reject())"
            ".then(() => Quasar.Notify.create({message: 'Address copied', timeout: 1200}),"
            " () => Quasar.Notify.create({message: 'The address bar holds the link', timeout: 2500})) }"
        )

    def build_controls(self) -> None:
        """Make fields and sliders of the contact and of the groups."""
        ui.html("<h2>Contact</h2>", sanitize=False)
        for name in FIELDS:
            self.build_row(name)
        ui.html("<h2>Dimensionless groups</h2>", sanitize=False)
        for name in GROUP_FIELDS:
            self.build_row(name)
        ui.html(
            '<p class="caption">A group moves load, speed and roughness, so that the other two groups stay.</p>', sanitize=False
        )

    def build_row(self, name: str) -> None:
        """Make the field, the unit and the slider of one quantity."""
        shown = GROUP_FIELDS.get(name) or FIELDS[name]
        with ui.element("div").classes("knob").props(f"data-row={name}") as row:
            ui.html(f"{shown.label}<i>{shown.symbol}</i>", sanitize=False).classes("name")
            field = ui.input(value=inputs.number_text(self.inputs, name)).props(
                f'dense outlined inputmode="text" autocomplete="off" spellcheck="false" aria-label="{shown.label}" name={name}'
            )
            field.on("keydown.enter", lambda: self.commit(name, field.value))
            field.on("blur", lambda: self.commit(name, field.value))
            unit = None
            if shown.units:
                unit = ui.select(self.unit_options(name), value=self.inputs.units[name])
                unit.props(f'dense borderless options-dense aria-label="Unit of {shown.label}"')
                unit.on_value_change(lambda event: self.choose_unit(name, event.value))
            else:
                ui.element("span")
            low, high = math.log10(shown.low), math.log10(shown.high)
            slider = Knob(min=low, max=high, step=0.01, value=inputs.position(self.inputs, name))
            slider.props(f'aria-label="{shown.label}" color=primary thumb-size=16px track-size=3px')
            slider.on_value_change(lambda event: self.slide(name, event.value))
            sentence = ui.label("").classes("sentence").props('role="alert"')
        self.rows[name] = {"row": row, "field": field, "unit": unit, "slider": slider, "sentence": sentence}

    def unit_options(self, name: str) -> dict[str, str]:
        """Return the units of a field, its own among them, as they are shown."""
        units = dict.fromkeys((*FIELDS[name].units, self.inputs.units[name]))
        return {unit: unit.replace("*", "·") for unit in units}

    def build_friction(self) -> None:
        """Make the chart of friction with its switches and the list of pins."""
        with ui.element("div").classes("head"):
            ui.html("<h2>Stribeck curve</h2>", sanitize=False)
            self.source = ui.label("").classes("caption")
            with ui.element("div").classes("choice"):
                for options, name in ((DEFINITIONS, "definition"), (ABSCISSAS, "abscissa")):
                    toggle = ui.toggle(options, value=getattr(self.inputs, name))
                    toggle.props(f'no-caps unelevated dense aria-label="{name}"')
                    toggle.on_value_change(lambda event, name=name: self.choose(name, event.value))
                    self.rows[name] = {"toggle": toggle}
        self.chips = ui.element("div").classes("chips")
        self.chart("friction", "Friction over speed")

    def chart(self, name: str, label: str) -> None:
        """Make an empty chart."""
        self.charts[name] = ui.echart({}).classes(f"chart chart-{name}").props(f'role="img" aria-label="{label}"')

    # --- what the user does ---

    def slide(self, name: str, place: Any) -> None:
        """Take the place of a slider."""
        if not self.setting and place is not None:
            self.attempt(name, str(place), lambda: inputs.slid(self.inputs, name, float(place)), kept=self.rows[name]["slider"])

    def commit(self, name: str, text: str) -> None:
        """Take the text of a field, where it was changed."""
        if text is not None and text.strip() != inputs.number_text(self.inputs, name):
            self.attempt(name, text, lambda: inputs.typed(self.inputs, name, text))
        else:
            self.unmark(name)

    def choose_unit(self, name: str, unit: str) -> None:
        """Show a field in another unit."""
        if not self.setting and unit:
            self.attempt(name, unit, lambda: inputs.in_unit(self.inputs, name, unit))

    def choose(self, name: str, value: str) -> None:
        """Take the definition of friction, or what the curve is drawn over."""
        if not self.setting:
            self.change(replace(self.inputs, **{name: value}))  # type: ignore[arg-type]

    def attempt(self, name: str, text: str, action: Callable[[], Inputs], kept: Any = None) -> None:
        """Change the inputs, or mark the field with the reason why not."""
        try:
            changed = action()
        except InputError as problem:
            self.mark(name, text, str(problem))
            return
        self.unmark(name)
        self.change(changed, kept)

    def change(self, changed: Inputs, kept: Any = None) -> None:
        """Take new inputs, show them in all fields but the slider that is being moved, and ask for their answer."""
        self.inputs = changed
        self.show_inputs(kept)
        self.ask()

    def mark(self, name: str, text: str, sentence: str) -> None:
        """Mark a field with a sentence; what has no field goes to the line above the numbers."""
        row = self.rows.get(name, {})
        if "field" not in row:
            self.status.text = sentence
            return
        row["sentence"].text = sentence
        row["row"].classes("wrong")
        row["field"].props('aria-invalid="true"')
        row["field"].value = text

    def unmark(self, name: str) -> None:
        """Take the mark off a field."""
        row = self.rows[name]
        if row["sentence"].text:
            row["sentence"].text = ""
            row["row"].classes(remove="wrong")
            row["field"].props(remove="aria-invalid")

    def show_inputs(self, kept: Any = None) -> None:
        """Show the inputs in all fields, units and sliders; ``kept`` is in somebody's hand and stays."""
        self.setting = True
        for name in (*FIELDS, *GROUP_FIELDS):
            row = self.rows[name]
            self.unmark(name)
            row["field"].value = inputs.number_text(self.inputs, name)
            if row["unit"] is not None:
                unit = self.inputs.units[name]
                if unit not in row["unit"].options:
                    row["unit"].set_options(self.unit_options(name), value=unit)
                row["unit"].value = unit
            if row["slider"] is not kept:
                row["slider"].value = round(inputs.position(self.inputs, name), 4)
        for name in ("definition", "abscissa"):
            self.rows[name]["toggle"].value = getattr(self.inputs, name)
        self.setting = False

    def on_key(self, event: events.KeyEventArguments) -> None:
        """Do what a letter stands for, outside fields."""
        if event.action.keydown and not (event.modifiers.ctrl or event.modifiers.alt or event.modifiers.meta):
            if event.key == "p":
                self.pin()
            elif event.key == "t":
                self.toggle_theme()
            elif event.key == "l":
                self.client.run_javascript(f"({self.copy_script()})()")

    def toggle_theme(self) -> None:
        """Go from light to dark or back."""
        self.set_theme(self.palette is LIGHT)

    def set_theme(self, dark: bool) -> None:
        """Take the colours of the theme."""
        self.dark.value = dark
        self.palette = DARK if dark else LIGHT
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
        self.chips.clear()
        with self.chips:
            for i, pin in enumerate(self.pins):
                chip = ui.chip(pin.name, icon="push_pin", removable=True).style(f"color: {self.palette.pins[i % 6]} !important")
                chip.on("remove", lambda pin=pin: self.unpin(pin))
            for found in self.measured:
                chip = ui.chip(found.name, icon="scatter_plot", removable=True).style(f"color: {self.palette.mark} !important")
                chip.on("remove", lambda found=found: self.forget(found))

    def forget(self, found: Measured) -> None:
        """Drop a measured curve."""
        self.measured.remove(found)
        self.show_chips()
        self.ask()

    async def on_upload(self, event: events.UploadEventArguments) -> None:
        """Take a case or a measured curve."""
        name, content = event.file.name, await event.file.read()
        self.upload.reset()
        try:
            if name.lower().endswith(".toml"):
                case = await self.run(LIVE, files.read_case, name, content)
                self.status.text = ""
                self.start = inputs.from_case(case)
                self.change(replace(self.start, abscissa=self.inputs.abscissa))
                self.show_title()
            else:
                found = await self.run(LIVE, files.read_curve, name, content)
                self.measured = [*self.measured, found][-MOST_MEASURED:]
                self.show_chips()
                self.ask()
        except InputError as problem:
            self.complain(str(problem))

    async def save(self, kind: str) -> None:
        """Offer a file of what is shown."""
        if self.answer is None:
            return
        with self.client:
            try:
                shown = files.Shown(self.answer, self.pinned(self.answer), tuple(self.measured))
                content = await self.run(SLOW, files.content, kind, shown)
            except (InputError, SolveError) as problem:
                self.complain(str(problem))
                return
            ui.download.content(content, files.name_of(kind, self.inputs.title))

    def complain(self, text: str) -> None:
        """Show sentences about a file until they are read."""
        with self.client, ui.dialog(value=True), ui.card():
            for line in text.splitlines():
                ui.label(line)

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
                    self.status.text = f"{problem} The last picture stays."
                    continue
                self.status.text = ""
                await self.draw()
        finally:
            self.working = False
        self.rest()

    @staticmethod
    async def run(pool: ThreadPoolExecutor, function: Callable[..., Any], *arguments: Any) -> Any:
        """Return what a function gives, computed in a thread."""
        return await asyncio.get_running_loop().run_in_executor(pool, function, *arguments)

    def pinned(self, answer: Answer) -> list[tuple[str, Curve, float]]:
        """Return the pinned curves as far as they are known, over the speeds of the axis."""
        found = []
        for pin in self.pins:
            curve = self.model.curve(pin.contact, pin.definition, answer.speeds)
            if curve is not None:
                found.append((pin.name, curve, pin.contact.viscosity / pin.contact.load))
        return found

    def options(self) -> dict[str, dict[str, Any]]:
        """Return what all charts show."""
        assert self.answer is not None
        return charts.all_charts(self.answer, self.pinned(self.answer), self.measured, self.palette)

    def draw_all(self) -> None:
        """Put whole charts into a page that is being made."""
        for name, options in self.options().items():
            self.charts[name].options.update(options)
        self.show_numbers()

    def show_numbers(self) -> None:
        """Show the numbers and the lines that go with the charts."""
        assert self.answer is not None
        answer = self.answer
        self.numbers.content = table.numbers_html(answer, table.numbers(answer))
        source = "" if answer.curve is None else answer.curve.source
        self.source.text = "curve is solved when the sliders rest" if answer.curve is None or answer.curve.stale else source
        load = f"{float(answer.inputs.contact.groups.load):.3g}"
        self.diagram_head.content = f"<h2>Regimes <span class='caption'>at this load (group {load})</span></h2>"

    async def draw(self) -> None:
        """Send the answer, and wait until the browser has drawn it."""
        self.show_numbers()
        for name, options in self.options().items():
            last = self.charts[name].run_chart_method(
                "setOption", charts.data_only(options), {"replaceMerge": ["series"], "silent": True}, timeout=PATIENCE
            )
        try:
            await last
        except TimeoutError:  # a tab in the background draws nothing
            pass

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
        with self.client:
            address = f"?{url.encode(now, self.pins)}"
            self.client.run_javascript(f"history.replaceState(null, '', {json.dumps(address)})")
            if await self.run(SLOW, self.model.settle, now) and self.inputs is now:
                self.ask()
                return
            found = await self.run(SLOW, self.ways, now)
            if found is not None and self.inputs is now:
                content = found if isinstance(found, str) else table.distances_html(found)
                self.distances.content = content

    def ways(self, now: Inputs) -> TransitionDistances | str | None:
        """Return the distances of a contact, the reason why there are none, or None where it is no longer shown."""

        def go_on(done: int, scans: int) -> None:
            if self.inputs is not now or self.client._deleted:
                raise Superseded

        try:
            return transition_distances(now.contact, definition=now.definition, on_point=go_on)
        except Superseded:
            return None
        except (InputError, SolveError) as problem:
            return f'<p class="note">{table.escape(str(problem))}</p>'

    async def open(self) -> None:
        """Do what needs the browser: its theme, and what comes at rest."""
        await self.client.connected(timeout=30)
        with self.client:
            self.show_chips()
            try:
                dark = await self.client.run_javascript("matchMedia('(prefers-color-scheme: dark)').matches", timeout=5)
            except TimeoutError:
                dark = False
            if dark:
                self.set_theme(True)
            else:
                self.rest()

    def show_title(self) -> None:
        """Show the headline of the case."""
        title = table.escape(self.inputs.title)
        self.title.content = f"<b>stribeck</b> explorer<span>{title}</span>"


def button(label: str, icon: str, tooltip: str) -> ui.button:
    """Return a quiet button."""
    made = ui.button(label, icon=icon, color=None).props("flat dense no-caps")
    with made:
        ui.tooltip(tooltip)
    return made

