"""What a figure of the paper is: states to solve, numbers to draw, and the sentence that they support.

Its module in ``article`` has ``TITLE`` and ``CLAIM``, ``compute`` and ``draw``, and the size, the steps and the tolerance.

The drawing sees the numbers only, never the solver, so that a dataset from a file draws the same picture.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from importlib import import_module
from importlib.metadata import version

from stribeck.figures import style
from stribeck.figures.job import FigureJob, Report
from stribeck.figures.style import Dataset, Figure
from stribeck.quantities.units import InputError, show

FIGURES = ("3", "4", "5", "6", "7", "8", "9", "10", "11", "S1")
"""Names of the figures that hold results, in the order of the paper."""

NAME = re.compile(r"(?:fig(?:ure)?s?[\s._-]*)?(s?[0-9]+)[\s._-]*\(?[a-f]?\)?", re.IGNORECASE)
"""How people write the name of a figure: 3, 3a, S1, figure_3, Fig. 3(a); a panel means its figure."""


SAID = ("title", "claim", "size", "steps", "rtol")  # What the module of a figure says of it, in capitals


@dataclass(frozen=True)
class PaperFigure:
    """A figure of the paper."""

    name: str  # Its name there, one of :data:`FIGURES`
    title: str  # Headline
    claim: str  # What the paper says that it shows, in one sentence
    compute: Callable[[FigureJob], Dataset]  # Solves all states and returns what is drawn
    draw: Callable[[Figure, Dataset], None]  # Draws it, from the dataset alone
    size: tuple[float, float] = (12.0, 6.6)  # Width and height [inch]
    steps: int = 1  # States and curves to solve
    rtol: float = 1e-7  # Relative tolerance of each state

    @property
    def stem(self) -> str:
        """Name of its files without their endings."""
        return f"figure_{self.name.lower()}"

    def data(self, report: Report = lambda done, steps: None) -> Dataset:
        """Solve the figure and return its numbers with their provenance."""
        found = self.compute(FigureJob(report, self.steps, self.rtol))
        source = f"stribeck {version('stribeck')}"
        return found.assign_attrs(
            {"figure": self.name, "title": self.title, "claim": self.claim, "source": source} | found.attrs
        )

    def picture(self, data: Dataset) -> Figure:
        """Return the picture of a dataset."""
        figure = style.new_figure(data, *self.size)
        self.draw(figure, data)
        return figure


def load_figure(name: str) -> PaperFigure:
    """Return a figure by its name in :data:`FIGURES`, from what its module says."""
    module = import_module(f".article.figure_{name.lower()}", __package__)
    given = {each: getattr(module, each.upper()) for each in SAID if hasattr(module, each.upper())}
    return PaperFigure(name, compute=module.compute, draw=module.draw, **given)


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
