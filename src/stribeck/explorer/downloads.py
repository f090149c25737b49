"""Files of the page: pictures, data and the case of what is shown."""

import functools
import io
import re
from collections.abc import Sequence
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np

from stribeck.contacts.contact import model_words
from stribeck.curves.result import with_contact
from stribeck.explorer.answer import Answer
from stribeck.explorer.curves import hersey_scale
from stribeck.explorer.inputs.inputs import Inputs
from stribeck.files.datasets import write_csv
from stribeck.files.toml import parse_toml, toml_text
from stribeck.plot.curve import add_curves
from stribeck.plot.style import INK, SERIES
from stribeck.quantities.units import InputError

KINDS = {
    "Picture of the curve (PNG)": "curve.png",
    "Picture of the curve (SVG)": "curve.svg",
    "Picture of the fields (PNG)": "state.png",
    "Picture of the fields (SVG)": "state.svg",
    "Curves (CSV)": "csv",
    "Gap and pressure (CSV)": "profile.csv",
    "Case file of this state (TOML)": "toml",
}
"""Downloads: label and ending."""


@functools.cache
def examples() -> dict[str, Path]:
    """Return the examples that come with the package, by their titles."""
    here = Path(__file__).parent / "examples"
    folder = here if here.is_dir() else Path(__file__).parents[3] / "examples"
    found = {}
    for path in sorted(folder.glob("*.toml")):
        tables = parse_toml(path.read_bytes(), path)
        if "contact" in tables and not {"fit", "vary"} & tables.keys():
            found[str(tables.get("title", path.stem))] = path
    return found


def name_of(kind: str, title: str) -> str:
    """Return the name of a file: the headline in plain letters, and the ending."""
    stem = re.sub(r"[^a-z0-9]+", "-", title.lower()).strip("-")[:40] or "stribeck"
    return f"{stem}-{kind}" if "." in kind else f"{stem}.{kind}"


def pin_name(inputs: Inputs, start: Inputs, taken: Sequence[str]) -> str:
    """Return the name of a pinned curve: the inputs in which it differs from the start."""
    changed = []
    for name, row in inputs.fields.items():
        value = getattr(inputs.contact, name)
        if name != "speed" and value != getattr(start.contact, name, None):
            changed.append(f"{row.label} {'none' if value is None else inputs.table.text(name, float(value), 4)}")
    models = [(each.table.geometry, model_words(each.contact.groups, each.contact)) for each in (inputs, start)]
    if models[0] != models[1]:
        geometry = {"line": "cylinder", "point": "ball"}[models[0][0]]
        changed.insert(0, models[0][1] or geometry)
    name = ", ".join(changed[:3]) or "start"
    if inputs.case.definition != start.case.definition:
        name += f", {inputs.case.definition}"
    number = 2
    unique = name
    while unique in taken:
        unique, number = f"{name} ({number})", number + 1
    return unique


def content(kind: str, shown: Answer) -> bytes:
    """Return the content of a file of what is shown."""
    what, _, ending = kind.rpartition(".")
    if ending == "toml":
        return case_text(shown).encode()
    if ending in ("png", "svg"):
        file = io.BytesIO()
        metadata: dict[str, Any] = {"Date": None} if ending == "svg" else {}
        figure_of(shown, what).savefig(file, format=ending, metadata=metadata)
        return file.getvalue()
    found = shown.solution.to_dataset() if what else curves_dataset(shown)
    with TemporaryDirectory(prefix="stribeck-") as folder:
        path = Path(folder) / "data.csv"
        write_csv(found.assign_attrs(title=shown.inputs.case.title), path)
        return path.read_bytes()


def case_text(shown: Answer) -> str:
    """Return the case file of the present state, with everything that the page keeps for it."""
    tables = shown.inputs.tables
    if "curve" not in tables and shown.curve is not None and "curve" not in shown.stale:
        ends = shown.curve.speed[[0, -1]].tolist()
        tables["curve"] = {"over": "speed", "range": ends, "points": len(shown.curve.speed)}
    return toml_text(tables)


def python_text(shown: Answer) -> str:
    """Return a program that solves the present state and its curve, with the case where the contact has more than inputs."""
    inputs, contact = shown.inputs, shown.inputs.tables["contact"]
    definition, rtol = inputs.case.definition, inputs.case.rtol
    if (
        inputs.tables.keys() <= {"title", "notes", "contact", "solver", "fit"}
        and "law" not in contact
        and not inputs.case.errors
    ):
        lines = [f"    {name}={value!r}," for name, value in contact.items() if name != "geometry"]
        made = "\n".join(["import stribeck as sb", "", f"contact = sb.{inputs.table.kind.__name__}(", *lines, ")"])
    else:
        text = f'r"""{case_text(shown)}"""' if '"""' not in case_text(shown) else repr(case_text(shown))
        write = f'Path("case.toml").write_text({text}, encoding="utf-8")'
        made = "\n".join(
            ["from pathlib import Path", "", "import stribeck as sb", "", write, 'contact = sb.load_case("case.toml").contact']
        )
    return f"""{made}
state = sb.solve(contact, rtol={rtol!r})
print(state)
print(state.friction(definition={definition!r}))
sb.stribeck_curve(contact, definition={definition!r}).plot().savefig("curve.png")
"""


def command_text(shown: Answer) -> str:
    """Return commands that write the case of the present state and solve it and its curve."""
    return f"""cat > case.toml <<'END_OF_CASE'
{case_text(shown)}END_OF_CASE
stribeck solve case.toml
stribeck curve case.toml --plot curve.png
"""


CODES = {"python": python_text, "command": command_text}


def _present_curve(shown: Answer) -> Any:
    """Return the curve through the present state."""
    if shown.curve is None or "curve" in shown.stale:
        raise InputError("the curve is not solved yet; save again when it is.")
    return with_contact(shown.curve.found, shown.inputs.contact)


def figure_of(shown: Answer, what: str) -> Any:
    """Return the picture of the curve, with pinned and measured ones, or of the state, as the package draws it."""
    inputs = shown.inputs
    if what == "state":
        return shown.solution.plot(title=inputs.case.title)
    curve, hersey = _present_curve(shown), inputs.abscissa == "hersey"
    assert shown.curve is not None
    band, verdict = shown.curve.band, "" if "checks" in shown.stale else shown.checks.headline
    figure = curve.plot(title=inputs.case.title, abscissa=inputs.abscissa, band=band, verdict=verdict)
    added: list[tuple[Any, Any, dict[str, Any]]] = []
    for i, pin in enumerate(each for each in shown.pins if each.curve is not None):
        assert pin.curve is not None
        places = pin.curve.speed * (hersey_scale(pin.contact) if hersey else 1.0)
        look = {"color": SERIES[-1 - i % len(SERIES)], "ls": (0, (3 + 2 * i, 2)), "lw": 1.4, "label": pin.name}
        added.append((places, pin.curve.sizes[pin.definition], look))
    for each in shown.measured:
        places = each.places(inputs.contact, inputs.abscissa) * (hersey_scale(inputs.contact) if hersey else 1.0)
        added.append((places, each.friction, {"fmt": "o", "ms": 4, "mfc": "none", "mec": INK, "label": each.name}))
    if added:
        add_curves(figure, added)
    return figure


def curves_dataset(shown: Answer) -> Any:
    """Return the curve with its inputs, and the friction of the pinned ones at the same speeds, as a dataset."""
    found = _present_curve(shown).to_dataset()
    speed = found["speed"].values
    for i, pin in enumerate(shown.pins, 1):
        if pin.curve is not None:
            low, high = pin.curve.speed[[0, -1]]
            inside = (speed >= low) & (speed <= high)
            friction = np.full(len(speed), np.nan)
            friction[inside] = pin.curve.found.at(speed[inside]).friction
            about = {"units": "1", "long_name": f"friction coefficient, {pin.name}"}
            found[f"friction_pin_{i}"] = ("speed", friction, about)
            found.attrs[f"pin_{i}"] = pin.name
    return found
