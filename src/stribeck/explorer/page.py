"""The page in the browser: it shows what it is sent, of which only what changed is sent, and calls back what the user does."""

from dataclasses import asdict
from typing import Any

import numpy as np
from nicegui import ui

from stribeck.explorer import table
from stribeck.explorer.answer import Answer
from stribeck.explorer.charts import DEFINITION_LABELS, all_charts
from stribeck.explorer.curves import in_atlas
from stribeck.explorer.downloads import KINDS, examples
from stribeck.explorer.inputs.choices import CHOICES, list_of
from stribeck.explorer.inputs.inputs import GROUP_FIELDS, Inputs, row_of
from stribeck.explorer.uploads import SCAN_ENDINGS

UPDATING_TEXT = "Updating ..."  # Text while something is still being computed.

FRAME_TIMEOUT = 2.0  # Time after which a browser that does not answer gets the next picture nevertheless [s].

FILE_ENDINGS = (".toml", ".csv", ".txt", ".tsv", ".dat", ".xlsx", *SCAN_ENDINGS)

# Parts that the browser closes without a word to Python
PARTS_OF_BROWSER = ("complaint", "code", "mapping", "fitting", "fitted")

Problems = dict[str, dict[str, str]]  # What is wrong with fields and lists: text, sentence, and the key of a list


class Page(ui.element, component="page.js"):
    """The page of one browser tab."""

    def __init__(self) -> None:
        super().__init__()
        toggles = {"definition": DEFINITION_LABELS, "abscissa": {"speed": "speed", "hersey": "Hersey number"}}
        self._props |= {"client": self.client.id, "kinds": KINDS, "examples": list(examples()), "toggles": toggles}
        self._props |= {"endings": ",".join(FILE_ENDINGS)}
        self.shown: dict[str, Any] = {}

    def show(self, **parts: Any) -> Any:
        """Send what changed; awaited, it returns when the browser has drawn it, or does not answer."""
        charts = parts.pop("charts", {})
        changed = {name: part for name, part in parts.items() if name in PARTS_OF_BROWSER or self.shown.get(name) != part}
        drawn = {name: chart for name, chart in charts.items() if self.shown.get(f"chart {name}") != chart}
        self.shown |= changed | {f"chart {name}": chart for name, chart in drawn.items()}
        return self.run_method("show", changed | {"charts": drawn}, timeout=FRAME_TIMEOUT)

    def renew(self) -> None:
        """Let fields and lists be sent anew: what was typed may be another text for the same value."""
        for name in ("rows", "groups", "lists"):
            self.shown.pop(name, None)


def form_of(now: Inputs, problems: Problems) -> dict[str, Any]:
    """Return what fields, sliders, lists and switches show."""
    return {
        "title": now.case.title,
        "geometry": now.table.geometry,
        "rows": [row_of(now, name) | problems.get(name, {}) for name in now.fields],
        # Of another shape the groups follow from its dry contact, and no one of them can be moved alone.
        "groups": [row_of(now, name) | problems.get(name, {}) for name in GROUP_FIELDS if now.contact.profile is None],
        "lists": [list_of(now, name) | problems.get(name, {}) for name in CHOICES],
        "chosen": {"definition": now.case.definition, "abscissa": now.abscissa},
    }


def parts_of(answer: Answer) -> dict[str, Any]:
    """Return what shows an answer: numbers, sentences and charts."""
    curve, rows = answer.curve, table.numbers(answer)
    drawn = all_charts(answer)
    chips = [{"name": pin.name, "icon": "push_pin", "colour": f"pin{i}"} for i, pin in enumerate(answer.pins)]
    chips += [{"name": found.name, "icon": "scatter_plot", "colour": "ink"} for found in answer.measured]
    parts = {
        "answer": table.main_of(answer, rows),
        "notes": [] if curve is None else table.notes_of(note for note in curve.notes if not answer.checks.covers(note)),
        "numbers": [asdict(row) | {"value": repr(row.value), "error": repr(row.error)} for row in rows],
        "remarks": table.notes_of_state(answer),
        "comparison": table.comparison(answer),
        "waits": UPDATING_TEXT if "margins" in answer.stale else "",
        "map": f"at this load (group {float(answer.inputs.contact.groups.load):.3g}){_map_text(answer)}",
        "shape": _shape_text(answer) if "shape" in drawn else "",
        "chips": chips,
        "fit": bool(answer.measured),
        "charts": drawn,
    }
    if curve is not None and "curve" not in answer.stale:
        parts["source"] = curve.source
    elif answer.why:
        parts["source"] = table.without_rtol(answer.why)
    return parts


def _shape_text(answer: Answer) -> str:
    """Return the title of the drawing of the body's shape."""
    contact = answer.inputs.contact
    return f"{CHOICES['shape'].label}: {getattr(contact.profile, 'label', contact.groups.model.profile.name)}"


def _map_text(answer: Answer) -> str:
    """Return how much of the map is solved."""
    diagram = answer.diagram
    if diagram is None or "diagram" in answer.stale:
        return f": {UPDATING_TEXT}"
    if diagram.part < 1:
        return f": {100 * diagram.part:.0f} % solved"
    if not np.isnan(diagram.lines[0]).any():
        return ""
    return f"; blank where it {'lies outside the lookup table' if in_atlas(answer.inputs.contact) else 'could not be solved'}"
