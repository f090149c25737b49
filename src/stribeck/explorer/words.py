"""The page of words: every input and number of the explorer, in the words of the package's tables, to which its helps link."""

from __future__ import annotations

import functools
from html import escape

from stribeck.explorer.inputs.choices import CHOICES, help_of_choice, typical
from stribeck.explorer.inputs.inputs import FIELDS, GROUP_FIELDS, help_of
from stribeck.explorer.table import MEANINGS, TRANSITION_HELP, TRANSITION_LABELS, state_rows
from stribeck.solver.solve import solve

ROUGHLY = 1e-3  # Relative tolerance of the states whose numbers are listed.

STYLE = (
    "body{font:15px/1.5 system-ui,sans-serif;max-width:46em;margin:2em auto;padding:0 1em}"
    "dt{font-weight:600}:target{background:#e2eff8}"
)


@functools.cache
def words_page() -> str:
    """Return the page as HTML, with an anchor for each name."""
    inputs = {name: (row.label, help_of(name, geometry)) for geometry, rows in FIELDS.items() for name, row in rows.items()}
    groups = {name: (row.label, help_of(name, "line")) for name, row in GROUP_FIELDS.items()}
    states = [solve(typical(geometry).contact, rtol=ROUGHLY) for geometry in FIELDS]
    numbers = {row.key: (row.label, row.help) for state in states for row in state_rows(state, "balanced")}
    numbers |= {f"speed_factor_{name}": (label, TRANSITION_HELP) for name, label in TRANSITION_LABELS.items()}
    regimes = {name: (name, meaning) for name, meaning in MEANINGS.items()}
    lists = {name: (choice.label, help_of_choice(name, ())) for name, choice in CHOICES.items()}
    parts = {"Inputs": inputs, "Model": lists, "Dimensionless groups": groups, "Numbers": numbers, "Regimes": regimes}
    html = "".join(
        f"<h2>{title}</h2><dl>{''.join(_entry(name, *words) for name, words in found.items())}</dl>"
        for title, found in parts.items()
    )
    head = '<meta charset="utf-8"><meta name="viewport" content="width=device-width"><title>Words of the explorer</title>'
    body = f"<body><h1>Words of the explorer</h1>{html}</body>"
    return f'<!doctype html><html lang="en"><head>{head}<style>{STYLE}</style></head>{body}</html>'


def _entry(name: str, label: str, words: str) -> str:
    return f'<dt id="{name}">{escape(label)}</dt><dd>{escape(words)} <code>{name}</code></dd>'
