"""The page: fields and sliders in, charts and numbers out, one :class:`Tab` for each that is open.

A tab keeps one answer on its way. What changes meanwhile is asked next, so that the last value wins and a slow machine shows
fewer pictures instead of late ones.
"""

from __future__ import annotations

import asyncio
import math
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from html import escape
from typing import Any

from nicegui import background_tasks, events, ui
from nicegui.json import dumps

from ..distances import TransitionDistances, transition_distances
from ..solve import SolveError
from ..units import InputError
from . import charts, files, inputs, table, url
from .inputs import FIELDS, GROUP_FIELDS, Inputs
from .measured import Measured, read_measured
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
REJECTED = f"Only .toml, .csv and .txt are read, up to {LARGEST_FILE // 1_000_000} MB."

DEFINITIONS = {"paper": "as printed", "balanced": "balanced"}
ABSCISSAS = {"speed": "speed", "hersey": "Hersey number"}


class Superseded(Exception):  # noqa: N818
    """The inputs changed while something slow was computed for them."""


class Knob(ui.element, component="knob.js"):
    """Field, unit and slider of one quantity.

    Parameters
    ----------
    name : str
        Key of :data:`FIELDS` or :data:`GROUP_FIELDS`.
    start : dict
        What it shows first, as of :func:`knob_state`.
    """

    def __init__(self, name: str, start: dict[str, Any]) -> None:
        super().__init__()
        shown = GROUP_FIELDS.get(name) or FIELDS[name]
        self._props |= {"name": name, "label": shown.label, "symbol": shown.symbol, "start": start}
        self._props |= {"low": math.log10(shown.low), "high": math.log10(shown.high)}
        self.classes("knob-box")


def knob_state(now: Inputs, name: str) -> dict[str, Any]:
    """Return what the knob of a quantity shows."""
    unit = now.units.get(name, "")
    units = list(dict.fromkeys((*FIELDS[name].units, unit))) if name in FIELDS and unit else []
    place = round(inputs.position(now, name), 4)
    return {"text": inputs.number_text(now, name), "unit": unit, "units": units, "place": place}


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
        self.moved: int | None = None
        self.resting: asyncio.Task[Any] | None = None
        self.knobs: dict[str, Knob] = {}
        self.charts: dict[str, ui.echart] = {}
        self.shown: dict[str, Any] = {}
        self.client = ui.context.client
        self.build()
        self.problems = opened.problems

    # --- the page ---

    def build(self) -> None:
        """Make all elements, with the first answer in them."""
        self.dark = ui.dark_mode(None)
        self.palette = LIGHT
        try:
            self.answer = self.model(self.inputs)
        except (InputError, SolveError):
            self.answer = self.model(self.start)
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
                    self.status = ui.label().classes("status").props('role="status"')
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
                .on(
                    "rejected",
                    lambda: self.complain(REJECTED),
                )
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
            button("Link", "link", "Copy the address of this state (l)").on("click", js_handler="() => explorerCopy()")
            button("", "contrast", "Light or dark (t)").on("click", self.toggle_theme).props("aria-label='Light or dark'")
            self.show_title()

    def build_controls(self) -> None:
        """Make fields and sliders of the contact and of the groups."""
        ui.html("<h2>Contact</h2>", sanitize=False)
        for name in FIELDS:
            self.build_row(name)
        ui.html("<h2>Dimensionless groups</h2>", sanitize=False)
        for name in GROUP_FIELDS:
            self.build_row(name)
        ui.html(
            '<p class="caption">A group moves load, speed and roughness; the other two groups stay.</p>',
            sanitize=False,
        )

    def build_row(self, name: str) -> None:
        """Make the knob of one quantity."""
        self.knobs[name] = knob = Knob(name, knob_state(self.inputs, name))
        knob.on("slide", lambda event: self.slide(name, event.args))
        knob.on("commit", lambda event: self.commit(name, event.args))
        knob.on("unit", lambda event: self.choose_unit(name, event.args))

    def build_friction(self) -> None:
        """Make the chart of friction with its switches and the list of pins."""
        self.toggles: dict[str, ui.toggle] = {}
        with ui.element("div").classes("head"):
            ui.html("<h2>Stribeck curve</h2>", sanitize=False)
            self.source = ui.html("", sanitize=False).classes("caption")
            with ui.element("div").classes("choice"):
                for options, name in ((DEFINITIONS, "definition"), (ABSCISSAS, "abscissa")):
                    toggle = ui.toggle(options, value=getattr(self.inputs, name))
                    toggle.props(f'no-caps unelevated dense aria-label="{name}"')
                    toggle.on_value_change(lambda event, name=name: self.choose(name, event.value))
                    self.toggles[name] = toggle
        self.chips = ui.element("div").classes("chips")
        self.chart("friction", "Friction over speed")

    def chart(self, name: str, label: str) -> None:
        """Make an empty chart."""
        self.charts[name] = ui.echart({}).classes(f"chart chart-{name}").props(f'role="img" aria-label="{label}"')

    # --- what the user does ---

    def slide(self, name: str, place: Any) -> None:
        """Take the place of a slider."""
        self.moved = self.knobs[name].id
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
            self.mark(name, text, str(problem))
            return
        self.shown.pop(name, None)  # so that it is shown anew, without mark
        self.change(changed)

    def change(self, changed: Inputs) -> None:
        """Take new inputs and ask for their answer."""
        self.inputs = changed
        for name, toggle in self.toggles.items():
            toggle.value = getattr(changed, name)
        self.ask()

    def mark(self, name: str, text: str, sentence: str) -> None:
        """Mark a field with a sentence; what has no field goes to the line above the numbers."""
        if name in self.knobs:
            self.knobs[name].run_method("complain", text, sentence)
        else:
            self.status.text = sentence

    def on_key(self, event: events.KeyEventArguments) -> None:
        """Do what a letter stands for, outside fields."""
        if event.action.keydown and not (event.modifiers.ctrl or event.modifiers.alt or event.modifiers.meta):
            if event.key == "p":
                self.pin()
            elif event.key == "t":
                self.toggle_theme()
            elif event.key == "l":
                self.client.run_javascript("explorerCopy()")

    def toggle_theme(self) -> None:
        """Go from light to dark or back."""
        self.set_theme(self.palette is LIGHT)

    def set_theme(self, dark: bool) -> None:
        """Take the colours of the theme."""
        self.dark.value = dark
        self.palette = DARK if dark else LIGHT
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
        self.chips.clear()
        with self.chips:
            for i, pin in enumerate(self.pins):
                chip = ui.chip(pin.name, icon="push_pin", removable=True)
                chip.style(f"--curve: {self.palette.pins[i % 6]}")
                chip.on("remove", lambda pin=pin: self.unpin(pin))
            for found in self.measured:
                chip = ui.chip(found.name, icon="scatter_plot", removable=True).style(f"--curve: {self.palette.mark}")
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
                found = await self.run(LIVE, read_measured, name, content, self.inputs.contact)
                self.measured = [*self.measured, *found][-MOST_MEASURED:]
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
                except Exception as problem:  # a page that silently no longer follows would be worse
                    self.status.text = f"Something went wrong that should not ({problem!r}). The last picture stays."
                else:
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
        """Put whole charts and all numbers into a page that is being made."""
        for name, options in self.options().items():
            self.charts[name].options.update(options)
            self.shown[f"chart-{name}"] = charts.data_only(options)
        for element, content in self.words():
            element.content = content
        self.shown |= {name: knob_state(self.inputs, name) for name in self.knobs}

    def words(self) -> list[tuple[ui.html, str]]:
        """Return the numbers, and the lines that go with the charts."""
        assert self.answer is not None
        answer = self.answer
        waits = answer.curve is None or answer.curve.stale
        source = "solved when the sliders rest" if answer.curve is None or waits else answer.curve.source
        load = f"{float(answer.inputs.contact.groups.load):.3g}"
        return [
            (self.numbers, table.numbers_html(answer, table.numbers(answer))),
            (self.source, source),
            (self.diagram_head, f"<h2>Regimes <span class='caption'>at this load (group {load})</span></h2>"),
        ]

    async def draw(self) -> None:
        """Send what changed, and wait until the browser has drawn it."""
        frame: dict[str, Any] = {"html": [], "charts": [], "knobs": [], "moved": self.moved}
        self.moved = None
        for element, content in self.words():
            if self.shown.get(element.html_id) != content:
                self.shown[element.html_id] = content
                frame["html"].append([element.html_id, content])
        for name, whole in self.options().items():
            options = charts.data_only(whole)
            changed = charts.difference(self.shown[f"chart-{name}"], options)
            self.shown[f"chart-{name}"] = options
            if changed is not None:
                frame["charts"].append([self.charts[name].id, *changed])
        for name, knob in self.knobs.items():
            state = knob_state(self.inputs, name)
            if self.shown.get(name) != state:
                self.shown[name] = state
                frame["knobs"].append([knob.id, state])
        try:
            await self.client.run_javascript(f"return explorerFrame({dumps(frame)})", timeout=PATIENCE)
        except TimeoutError:  # a tab in the background answers when it is looked at
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
            self.client.run_javascript(f"history.replaceState(null, '', {dumps(address)})")
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
            return f'<p class="note">{escape(str(problem))}</p>'

    async def open(self) -> None:
        """Do what needs the browser: its theme, and what comes at rest."""
        await self.client.connected(timeout=30)
        with self.client:
            for name, (text, sentence) in self.problems.items():
                self.mark(name, text, sentence)
            self.show_chips()
            try:
                dark = await self.client.run_javascript("matchMedia('(prefers-color-scheme: dark)').matches", timeout=5)
            except TimeoutError:
                dark = False
            if dark:
                self.set_theme(True)
            else:
                self.ask()

    def show_title(self) -> None:
        """Show the headline of the case."""
        title = escape(self.inputs.title)
        self.title.content = f"<b>stribeck</b> explorer<span>{title}</span>"


def button(label: str, icon: str, tooltip: str) -> ui.button:
    """Return a quiet button."""
    made = ui.button(label, icon=icon, color=None).props("flat dense no-caps")
    with made:
        ui.tooltip(tooltip)
    return made
