"""The page: its elements, and what each of them shows.

It knows nothing of how an answer is found; :class:`stribeck.explorer.tab.Tab` gives it one and does what the user asks for.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from html import escape
from typing import Any

import numpy as np
from nicegui import ui
from nicegui.json import dumps

from stribeck.explorer import downloads as files
from stribeck.explorer import table
from stribeck.explorer.answer import Answer
from stribeck.explorer.charts import charts
from stribeck.explorer.charts.drawing import drawing
from stribeck.explorer.charts.palette import DARK, LIGHT
from stribeck.explorer.charts.parts import Options
from stribeck.explorer.curves import in_atlas
from stribeck.explorer.downloads import examples
from stribeck.explorer.inputs import choices, inputs
from stribeck.explorer.inputs.choices import CHOICES
from stribeck.explorer.inputs.inputs import FIELDS, GROUP_FIELDS, NAMES, Inputs
from stribeck.explorer.inputs.url import Pin
from stribeck.explorer.measured import Measured
from stribeck.explorer.scans import SCAN_ENDINGS
from stribeck.explorer.view import View
from stribeck.regimes.margins import RegimeMargins

__all__ = ["UPDATING_TEXT", "Page"]

UPDATING_TEXT = "Updating ..."  # Text while something is still being computed.

FRAME_TIMEOUT = 2.0  # Time after which a browser that does not answer gets the next picture nevertheless [s].

ABSCISSAS = {"speed": "speed", "hersey": "Hersey number"}


class Slider(ui.element, component="slider.js"):
    """Field, unit and slider of one quantity."""

    def __init__(self, name: str, start: dict[str, Any]) -> None:
        super().__init__()
        self._props |= {"name": name, "start": start}
        self.classes("knob-box")


class ChoiceRow(ui.element, component="choice.js"):
    """A list to choose from, and fields for what the choice needs."""

    def __init__(self, name: str, start: dict[str, Any]) -> None:
        super().__init__()
        self._props |= {"name": name, "label": CHOICES[name].label, "start": start}


class Chart(ui.element, component="chart.js"):
    """A chart, empty until the first frame."""

    def __init__(self, name: str, label: str) -> None:
        super().__init__()
        self._props |= {"label": label}
        self.classes(f"chart chart-{name}")


def knob_state(now: Inputs, name: str) -> dict[str, Any]:
    """Return what a field, or a list, shows."""
    if name in CHOICES:
        return choices.state_of(now, name)
    if name not in GROUP_FIELDS and name not in now.fields:
        # Of another geometry: it is not seen, and named all the same.
        other = next(fields[name] for fields in FIELDS.values() if name in fields)
        empty = {"symbol": "", "low": 0, "high": 1, "text": "", "unit": "", "units": [], "place": 0}
        return {"hidden": True, "label": other.label, **empty}
    field, unit = now.shown_as(name), now.units.get(name, "")
    return {
        "hidden": False,
        "label": field.label,
        "symbol": field.symbol,
        "low": math.log10(field.low),
        "high": math.log10(field.high),
        "text": inputs.number_text(now, name),
        "unit": unit,
        "units": list(dict.fromkeys((*field.units, unit))) if unit else [],
        "place": round(inputs.position(now, name), 4),
    }


class Page:
    """The elements of one page."""

    def __init__(self, now: Inputs) -> None:
        self.client = ui.context.client
        self.client_name = dumps(self.client.id)
        self.margins_inputs: Inputs | None = None
        self.found_margins: RegimeMargins | None = None
        self.moved: int | None = None
        self.knobs: dict[str, Slider | ChoiceRow] = {}
        self.charts: dict[str, Chart] = {}
        self.toggles: dict[str, ui.toggle] = {}
        self.shown: dict[str, Any] = {}
        self.drawn: dict[str, Options] = {}
        self.progress = ""
        self.dark = ui.dark_mode(None)
        self.palette = LIGHT
        self.build(now)

    # --- the elements ---

    def build(self, now: Inputs) -> None:
        """Make all elements."""
        with ui.element("div").classes("explorer"):
            self.build_bar(now)
            self.verdict = ui.html("", sanitize=False).classes("applies").props('role="status"')
            with ui.element("section").classes("card controls").props('aria-label="Inputs"'):
                self.build_controls(now)
            with ui.element("div").classes("middle"):
                with ui.element("section").classes("card friction").props('aria-label="Stribeck curve"'):
                    self.build_friction(now)
                    self.curve_notes = (
                        ui.html("", sanitize=False)
                        .classes("curve-notes")
                        .props('tabindex="0" role="region" aria-label="Notes on the curve"')
                    )
                    self.comparison = ui.html("", sanitize=False).classes("comparison")
                with ui.element("section").classes("card fields").props('aria-label="Gap and pressure"'):
                    ui.html("<h2>Gap and pressure along the contact</h2>", sanitize=False)
                    with ui.element("div").classes("pair"):
                        self.chart("gap", "Gap along the contact")
                        self.chart("pressure", "Contact and fluid pressure along the contact")
                    with ui.element("div").classes("of-ball"):
                        ui.html("<h2>Film on the plane of the contact</h2>", sanitize=False)
                        self.chart("plane", "Film of the ball on the plane of the contact")
                with ui.element("section").classes("card model").props('aria-label="Model"'):
                    ui.html("<h2>Model</h2>", sanitize=False)
                    with ui.element("div").classes("rows"):
                        for name in list(CHOICES)[1:]:
                            self.knobs[name] = ChoiceRow(name, knob_state(now, name))
            with ui.element("div").classes("side"):
                with ui.element("section").classes("card numbers").props('aria-label="Numbers"'):
                    self.status = ui.label().classes("status").props('role="status"')
                    with ui.element("div").classes("retry") as self.retry_row:
                        self.retry = button("Try again", "refresh", "Compute this once more")
                        self.back = button("Back", "undo", "Go back to what is shown")
                    self.retry_row.set_visibility(False)
                    self.numbers = ui.html("", sanitize=False)
                with ui.element("section").classes("card more").props('aria-label="Margins"'):
                    head = f"Margins to the next regimes <span class='caption waits'>{UPDATING_TEXT}</span>"
                    ui.html(f"<h2>{head}</h2>", sanitize=False)
                    self.margins = ui.html("", sanitize=False).classes("margins")
                with ui.element("section").classes("card diagram").props('aria-label="Phase diagram"'):
                    self.diagram_head = ui.html("<h2>Regimes</h2>", sanitize=False)
                    self.chart("diagram", "Regimes over speed and roughness")
        self.keyboard = ui.keyboard()

    def build_bar(self, now: Inputs) -> None:
        """Make the line of title and buttons."""
        endings = ",".join((".toml", ".csv", ".txt", ".tsv", ".dat", *SCAN_ENDINGS))
        with ui.element("header").classes("bar"):
            self.title = ui.html("", sanitize=False, tag="h1")
            self.upload = (
                ui.element("input")
                .props(f'type=file multiple accept="{endings}" aria-hidden="true" tabindex=-1')
                .classes("hidden-upload")
                .on("change", js_handler=f"event => explorerUpload(event.target, {self.client_name})")
            )
            with button("Load", "upload_file", "Load a case, a measured curve, a surface or an example"), ui.menu():
                item = ui.menu_item("File: a case (TOML), a measured curve (CSV) or a height map ...")
                item.on("click", js_handler=f"() => getHtmlElement({self.upload.id}).click()")
                self.examples = {path: ui.menu_item(title) for title, path in examples().items()}
            with button("Save", "download", "Download picture, data or case"):
                with ui.menu():
                    for label, kind in files.KINDS.items():
                        send = f"() => explorerDownload({self.client_name}, {dumps(kind)})"
                        ui.menu_item(label).on("click", js_handler=send)
            self.history = {
                "undo": button("", "undo", "Undo (Ctrl-Z)").props("aria-label=Undo").classes("history-undo"),
                "redo": button("", "redo", "Redo (Ctrl-Shift-Z)").props("aria-label=Redo").classes("history-redo"),
            }
            self.pin_button = button("Pin", "push_pin", "Keep this curve to compare (p)")
            button("Link", "link", "Copy the address of this state (l)").on("click", js_handler="() => explorerCopy()")
            self.theme_button = button("", "contrast", "Light or dark (t)").props("aria-label='Light or dark'")

    def build_controls(self, now: Inputs) -> None:
        """Make fields and sliders of the contact and of the groups."""
        ui.html("<h2>Contact <span class='caption'>drawing not to scale</span></h2>", sanitize=False)
        self.drawing = ui.html("", sanitize=False).classes("drawing")
        first = next(iter(CHOICES))
        self.knobs[first] = ChoiceRow(first, knob_state(now, first))
        for name in NAMES:
            self.knobs[name] = Slider(name, knob_state(now, name))
        ui.html("<h2>Dimensionless groups</h2>", sanitize=False)
        for name in GROUP_FIELDS:
            self.knobs[name] = Slider(name, knob_state(now, name))
        ui.html(
            '<p class="caption">Changing one group changes speed, load and roughness; the other two groups stay fixed.</p>',
            sanitize=False,
        )

    def build_friction(self, now: Inputs) -> None:
        """Make the chart of friction with its switches and the list of pins."""
        with ui.element("div").classes("head"):
            ui.html("<h2>Stribeck curve</h2>", sanitize=False)
            self.source = ui.html("", sanitize=False).classes("caption")
            with ui.element("div").classes("choice"):
                for options, name in ((charts.DEFINITION_LABELS, "definition"), (ABSCISSAS, "abscissa")):
                    toggle = ui.toggle(options, value=getattr(now, name))
                    toggle.props(f'no-caps unelevated dense aria-label="{name}"')
                    self.toggles[name] = toggle
        with ui.element("div").classes("below"):
            self.chips = ui.element("div").classes("chips")
            self.fit_button = button("Fit", "insights", "Fit dry friction and roughness to the measured curve")
            self.fit_button.set_visibility(False)
        self.chart("friction", "Friction over speed")

    def chart(self, name: str, label: str) -> None:
        """Make an empty chart."""
        self.charts[name] = Chart(name, label)

    # --- what they show ---

    def show_address(self, query: str) -> None:
        """Put a state into the address."""
        self.client.run_javascript(f"history.replaceState(null, '', {dumps(query)})")

    def copy_address(self) -> None:
        """Put the address into the clipboard."""
        self.client.run_javascript("explorerCopy()")

    def show_history(self, there: dict[str, bool]) -> None:
        """Enable what can be undone and redone."""
        for name, enabled in there.items():
            self.history[name].set_enabled(enabled)

    def show_choices(self, now: Inputs) -> None:
        """Show the definition of friction, and what the curve is drawn over."""
        for name, toggle in self.toggles.items():
            toggle.value = getattr(now, name)

    def mark(self, name: str, text: str, sentence: str) -> None:
        """Mark a field with a sentence; what has no field goes to the line above the numbers."""
        if isinstance(self.knobs.get(name), Slider | ChoiceRow):
            self.knobs[name].run_method("complain", text, sentence)
        else:
            self.show_message(sentence, bad=True)

    def show_message(self, sentence: str, *, bad: bool = False) -> None:
        """Show a sentence above the numbers, in red where something went wrong."""
        self.status.text = sentence
        self.status.classes(remove="said") if bad else self.status.classes("said")
        self.retry_row.set_visibility(False)

    def fail(self, sentence: str) -> None:
        """Say what went wrong, and offer to try again or to go back."""
        self.show_message(sentence, bad=True)
        self.retry_row.set_visibility(True)

    def renew(self, name: str) -> None:
        """Let a field be shown anew, without mark."""
        self.shown.pop(name, None)

    def set_theme(self, dark: bool) -> None:
        """Take the colours of the theme."""
        self.dark.value = dark
        self.palette = DARK if dark else LIGHT

    def show_chips(
        self,
        pins: Sequence[Pin],
        measured: Sequence[Measured],
        unpin: Callable[[Pin], None],
        forget: Callable[[Measured], None],
    ) -> None:
        """List the pinned and the measured curves, each with what is called when it is removed."""
        self.chips.clear()
        with self.chips:
            for i, pin in enumerate(pins):
                chip = ui.chip(pin.name, icon="push_pin", removable=True)
                chip.style(f"--curve: {self.palette.pins[i % 6]}")
                chip.on("remove", lambda pin=pin: unpin(pin))
            for found in measured:
                chip = ui.chip(found.name, icon="scatter_plot", removable=True).style(f"--curve: {self.palette.ink}")
                chip.on("remove", lambda found=found: forget(found))

    def complain(self, text: str) -> None:
        """Show sentences about a file until they are read."""
        with self.client, ui.dialog(value=True) as dialog, ui.card():
            for line in text.splitlines():
                ui.label(line)
            ui.button("Close", on_click=dialog.close).props("flat no-caps autofocus")
        # Closed ones are removed, or each would stay with its page.
        dialog.on("hide", dialog.delete)

    def draw_all(self, now: Inputs, view: View) -> None:
        """Put all numbers into a page that is being made; its charts come with the first frame."""
        for element, content in self.text_elements(view):
            element.content = content
        self.shown |= {name: knob_state(now, name) for name in self.knobs}

    def text_elements(self, view: View) -> list[tuple[ui.html, str]]:
        """Return the numbers, and the lines that go with the charts."""
        answer = view.answer
        waits = answer.curve is None or answer.curve.stale
        source = (self.progress or UPDATING_TEXT) if waits or answer.curve is None else answer.curve.source
        load = f"{float(answer.inputs.contact.groups.load):.3g}"
        margins = self.found_margins if not self.margins_text(answer.inputs) else None
        return [
            (self.title, f"<b>stribeck</b> explorer<span>{escape(answer.inputs.title)}</span>"),
            (self.verdict, table.verdict_html(answer)),
            (self.curve_notes, table.curve_notes_html(answer)),
            (self.numbers, table.numbers_html(answer, table.numbers(answer, margins))),
            (self.source, escape(source)),
            (self.drawing, drawing(answer)),
            (self.comparison, table.comparison_html(answer, view.states)),
            (
                self.diagram_head,
                f"<h2>Regimes <span class='caption'>at this load (group {load}){_rows_text(answer)}</span></h2>",
            ),
        ]

    def show_margins(self, found: RegimeMargins | str, now: Inputs) -> None:
        """Show the margins of inputs to the next regimes, or why there are none."""
        self.margins_inputs = now
        self.found_margins = None if isinstance(found, str) else found
        self.margins.content = found if isinstance(found, str) else table.margins_html(found)
        self.client.run_javascript("explorerWaits('')")

    def margins_text(self, now: Inputs) -> str:
        """Return what stands beside the margins: whether they belong to what is shown."""
        shown = self.margins_inputs
        same = shown is not None and all(
            getattr(shown, name) == getattr(now, name) for name in ("contact", "definition", "model", "rest")
        )
        return "" if same else UPDATING_TEXT

    def show_working(self, now: Inputs) -> None:
        """Mark what is shown as that of the contact before, while the next one is being solved; the fields are its own."""
        moved, self.moved = self.moved, None
        self.client.run_javascript(f"explorerWorking({dumps(moved)}, {dumps(self.changed_knobs(now))})")

    def changed_knobs(self, now: Inputs) -> list[list[Any]]:
        """Return the fields and lists that show something else now, with what that is."""
        states = {name: knob_state(now, name) for name in self.knobs}
        changed = [[self.knobs[name].id, state] for name, state in states.items() if self.shown.get(name) != state]
        self.shown |= states
        return changed

    def show_progress(self) -> None:
        """Show the progress of the curve."""
        text = self.shown[self.source.html_id] = escape(self.progress or UPDATING_TEXT)
        self.client.run_javascript(f"document.getElementById({dumps(self.source.html_id)}).innerHTML = {dumps(text)}")

    def show_fit(self, there: bool) -> None:
        """Offer a fit where there is something measured."""
        self.fit_button.set_visibility(there)

    async def draw(self, now: Inputs, view: View) -> None:
        """Send what changed, and wait until the browser has drawn it."""
        frame: dict[str, Any] = {"html": [], "charts": [], "knobs": self.changed_knobs(now), "moved": self.moved}
        shown = view.answer.inputs
        frame |= {"waits": self.margins_text(shown), "geometry": shown.table.geometry}
        self.moved = None
        for element, content in self.text_elements(view):
            if self.shown.get(element.html_id) != content:
                self.shown[element.html_id] = content
                frame["html"].append([element.html_id, content])
        for name, chart in charts.all_charts(view.answer, view.pins, view.measured, self.palette).items():
            if self.drawn.get(name) != chart:
                self.drawn[name] = chart
                frame["charts"].append([self.charts[name].id, chart])
        try:
            await self.client.run_javascript(f"explorerFrame({dumps(frame)})", timeout=FRAME_TIMEOUT)
        except TimeoutError:  # a tab in the background answers when it is looked at
            pass


def _rows_text(answer: Answer) -> str:
    """Return how much of the diagram is solved."""
    diagram = answer.diagram
    if diagram is None or diagram.stale:
        return f": {UPDATING_TEXT}"
    if diagram.part < 1:
        return f": {100 * diagram.part:.0f} % solved"
    if not np.isnan(diagram.boundary).any():
        return ""
    return f"; blank where it {'lies outside the lookup table' if in_atlas(answer.inputs.contact) else 'could not be solved'}"


def button(label: str, icon: str, title: str) -> ui.button:
    """Return a quiet button with a title, which names it where it has no label."""
    made = ui.button(label, icon=icon, color=None).props("flat dense no-caps")
    made.props["title"] = title
    return made
