"""The part common to all results: a representation that fits a screen, and equality of numbers."""

import html
import inspect
import textwrap
from collections.abc import Callable, Sequence
from dataclasses import dataclass, fields, is_dataclass
from typing import Any

import numpy as np

from stribeck.quantities.docstrings import Described


@dataclass(frozen=True)
class Card:
    """The lines that a result shows: headline, rows and notes."""

    headline: str  # Meaning of the result, in a line
    rows: Sequence[tuple[str, str]] = ()  # Name and value of what matters
    notes: Sequence[str] = ()  # Limits of the result, in sentences
    table: Sequence[Sequence[str]] = ()  # What matters as a table, whose first row names its columns
    right: Sequence[int] = ()  # Columns of the table that end flush
    sentences: Sequence[str] = ()  # What else there is to say

    @property
    def all_rows(self) -> list[tuple[str, str]]:
        """The rows, those of the table among them: the first cell, and the others with what they are."""
        head, *rows = self.table or [()]
        said = [", ".join(f"{name} {cell}" for name, cell in zip(head[1:], row[1:], strict=True) if cell) for row in rows]
        return [*((row[0], words) for row, words in zip(rows, said, strict=True)), *self.rows]


class Shown(Described):
    """A result shown as a :class:`Card`: lines in a terminal, a table in a notebook; by default its fields in short."""

    def _card(self) -> Card:
        summary = (inspect.getdoc(type(self)) or "").partition("\n")[0]
        named = [each.name for each in fields(self) if each.name != "notes"]  # type: ignore[arg-type]
        return Card(summary, [(name, brief_text(getattr(self, name))) for name in named], getattr(self, "notes", ()))

    def __repr__(self) -> str:
        """Return the card as lines of text."""
        card = self._card()
        width = max((len(name) for name, _ in card.all_rows), default=0)
        lines = [f"{name:>{width}}: {value}" for name, value in card.all_rows]
        notes = [f"Note: {note}" for note in card.notes]
        return "\n".join([f"{type(self).__name__}: {card.headline}", *lines, *card.sentences, *notes])

    def _repr_html_(self) -> str:
        """Return the card as a table."""
        return card_html(type(self).__name__, self._card())


class Told(Shown):
    """A result whose text is what a command prints of it: headline, table, sentences and notes."""

    def __str__(self) -> str:
        """Return the card as text, its table in columns."""
        card = self._card()
        rows = [f"{name}: {value}" for name, value in card.rows]
        notes = [f"Note: {note}" for note in card.notes]
        return "\n".join([card.headline, *table_lines(card.table, card.right), *rows, *card.sentences, *notes])


def brief_text(value: Any) -> str:
    """Return a value in less than a line: numbers with four digits, arrays by their size and range."""
    if isinstance(value, np.ndarray):
        shape = " x ".join(map(str, value.shape)) or "1"
        finite = value[np.isfinite(value)] if value.dtype.kind in "fi" else value[:0]
        return f"{shape} values" + (f", {finite.min():.4g} to {finite.max():.4g}" if finite.size else "")
    if isinstance(value, float):
        return f"{value:.4g}"
    if is_dataclass(value) and not isinstance(value, type):
        return type(value).__name__
    return textwrap.shorten(value if isinstance(value, str) else repr(value), 90, placeholder=" ...")


def table_lines(rows: Sequence[Sequence[str]], right: Sequence[int] = ()) -> list[str]:
    """Return a table as lines; the first row is the heading, and the columns ``right`` end flush."""
    if not rows:
        return []
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    lines = []
    for row in rows:
        cells = zip(row, widths, strict=True)
        texts = [cell.rjust(width) if i in right else cell.ljust(width) for i, (cell, width) in enumerate(cells)]
        lines.append(" " + "  ".join(texts).rstrip())
    return [lines[0], " " + "-" * (max(map(len, lines)) - 1), *lines[1:]]


def card_html(kind: str, card: Card) -> str:
    """Return a card as a table of HTML."""
    rows = "".join(
        f"<tr><th scope='row' style='text-align:left'>{html.escape(name)}</th>"
        f"<td style='text-align:left'>{html.escape(value)}</td></tr>"
        for name, value in card.all_rows
    )
    notes = "".join(f"<p>{html.escape(note)}</p>" for note in (*card.sentences, *card.notes))
    return f"<div><b>{html.escape(kind)}:</b> {html.escape(card.headline)}<table>{rows}</table>{notes}</div>"


class ByValue:
    """A result that equals another if all its numbers do, as after pickling; NaN equals NaN."""

    def __eq__(self, other: object) -> bool:
        """Return whether the other has the same type and the same values."""
        if type(other) is not type(self):
            return NotImplemented
        names = [each.name for each in fields(self) if each.compare]  # type: ignore[arg-type]
        return all(equal_values(getattr(self, name), getattr(other, name)) for name in names)

    def __hash__(self) -> int:
        """Hash by type: equal results have equal hashes, and few of them meet in one dictionary."""
        return hash(type(self))


def equal_values(one: Any, other: Any) -> bool:
    """Return whether two values are equal, arrays and numbers bit for bit, NaN to NaN; functions are left out."""
    if isinstance(one, np.ndarray) or isinstance(other, np.ndarray):
        numeric = np.asarray(one).dtype.kind == "f" and np.asarray(other).dtype.kind == "f"
        return np.array_equal(one, other, equal_nan=numeric)
    if isinstance(one, tuple | list) and isinstance(other, tuple | list):
        return len(one) == len(other) and all(map(equal_values, one, other))
    if isinstance(one, dict) and isinstance(other, dict):
        return one.keys() == other.keys() and all(equal_values(value, other[key]) for key, value in one.items())
    if isinstance(one, float) and isinstance(other, float) and one != one:
        return other != other
    if type(one) is type(other) and is_dataclass(one) and not isinstance(one, ByValue | type):
        names = [each.name for each in fields(one) if each.compare]
        return all(equal_values(getattr(one, name), getattr(other, name)) for name in names)
    if isinstance(one, Callable) and isinstance(other, Callable):  # type: ignore[arg-type]
        return True
    return bool(one == other)
