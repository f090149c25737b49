"""What a figure of the paper is: states to solve, numbers to draw, and the sentence that they support.

The drawing sees the numbers only, never the solver, so that a dataset from a file draws the same picture.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from importlib import import_module
from importlib.metadata import version
from typing import TYPE_CHECKING

from stribeck.quantities.units import InputError, show

if TYPE_CHECKING:
    import xarray
    from matplotlib.figure import Figure

Report = Callable[[int, int], object]
"""``report(done, steps)`` is called after each step of a figure's work; it may raise KeyboardInterrupt to end it."""

FIGURES = ("3", "4", "5", "6", "7", "8", "9", "10", "11", "S1")
"""Names of the figures that hold results, in the order of the paper."""

NAME = re.compile(r"(?:fig(?:ure)?s?[\s._-]*)?(s?[0-9]+)[\s._-]*\(?[a-f]?\)?", re.IGNORECASE)
"""How people write the name of a figure: 3, 3a, S1, figure_3, Fig. 3(a); a panel means its figure."""


@dataclass(frozen=True)
class PaperFigure:
    """A figure of the paper."""

    name: str  # Its name there, one of :data:`FIGURES`
    title: str  # Headline
    claim: str  # What the paper says that it shows, in one sentence
    compute: Callable[[Report], xarray.Dataset]  # `compute(report)` solves all states and returns what is drawn as one Dataset
    draw: Callable[[xarray.Dataset], Figure]  # `draw(dataset)` returns the picture, from the dataset alone

    @property
    def stem(self) -> str:
        """Name of its files without their endings."""
        return f"figure_{self.name.lower()}"

    def data(self, report: Report = lambda done, steps: None) -> xarray.Dataset:
        """Solve the figure and return its numbers with their provenance."""
        provenance = {
            "figure": self.name,
            "title": self.title,
            "claim": self.claim,
            "source": f"stribeck {version('stribeck')}",
        }
        found = self.compute(report)
        return found.assign_attrs(provenance | found.attrs)


def load_figure(name: str) -> PaperFigure:
    """Return a figure by its name in :data:`FIGURES`."""
    figure = import_module(f".article.figure_{name.lower()}", __package__).FIGURE
    assert isinstance(figure, PaperFigure) and figure.name == name
    return figure


def figure_names(texts: Iterable[str]) -> tuple[str, ...]:
    """Return the figures that are meant, each once, in the order of the paper."""
    wanted = set()
    for text in texts:
        match = NAME.fullmatch(text.strip())
        name = match[1].upper() if match else ""
        if name not in FIGURES:
            raise InputError(f"figure {show(text)} is not one of {', '.join(FIGURES)}; 1 and 2 of the paper hold no results.")
        wanted.add(name)
    return tuple(name for name in FIGURES if name in wanted or not wanted)
