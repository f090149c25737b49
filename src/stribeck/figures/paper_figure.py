"""What a figure of the paper is: its words, the states to solve, the numbers to draw, and its panels.

``article/figure_3.toml`` says title, claim, finding, the variables of the data and the settings of the panels; ``compute`` of
the module beside it returns the numbers, and ``draw`` draws them.

The drawing sees the numbers only, never the solver, so that a dataset from a file draws the same picture.
"""

from __future__ import annotations

import re
import tomllib
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from importlib import import_module
from importlib.metadata import version
from pathlib import Path

from stribeck.figures import style
from stribeck.figures.job import FigureJob, Report, Said
from stribeck.figures.style import Dataset, Figure, Panels
from stribeck.quantities.units import InputError, show

FIGURES = ("3", "4", "5", "6", "7", "8", "9", "10", "11", "S1")
"""Names of the figures that hold results, in the order of the paper."""

NAME = re.compile(r"(?:fig(?:ure)?s?[\s._-]*)?(s?[0-9]+)[\s._-]*\(?[a-f]?\)?", re.IGNORECASE)
"""How people write the name of a figure: 3, 3a, S1, figure_3, Fig. 3(a); a panel means its figure."""


@dataclass(frozen=True)
class PaperFigure:
    """A figure of the paper."""

    name: str  # Its name there, one of :data:`FIGURES`
    said: Said  # What its file says of it
    compute: Callable[[FigureJob], Dataset]  # Solves all states and returns what is drawn
    draw: Callable[[Panels, Dataset], None]  # Draws into its panels, from the dataset alone
    steps: int = 1  # States and curves to solve

    @property
    def stem(self) -> str:
        """Name of its files without their endings."""
        return f"figure_{self.name.lower()}"

    def data(self, report: Report = lambda done, steps: None) -> Dataset:
        """Solve the figure and return its numbers with their provenance."""
        found = self.compute(FigureJob(report, self.said, self.steps))
        about = {"figure": self.name, "title": self.said["title"], "claim": self.said["claim"]}
        return found.assign_attrs(about | {"source": f"stribeck {version('stribeck')}"} | found.attrs)

    def picture(self, data: Dataset) -> Figure:
        """Return the picture of a dataset."""
        figure = style.new_figure(data, *self.said.get("size", (12.0, 6.6)))
        panels = style.panels(figure, self.said["grid"])
        self.draw(panels, data)
        for name, settings in self.said["panels"].items():
            style.finish(panels[name], name, data, **settings)
        return figure


def load_figure(name: str) -> PaperFigure:
    """Return a figure by its name in :data:`FIGURES`."""
    module = import_module(f".article.figure_{name.lower()}", __package__)
    said = tomllib.loads(Path(module.__file__ or "").with_suffix(".toml").read_text(encoding="utf-8"))
    return PaperFigure(name, said, module.compute, module.draw, getattr(module, "STEPS", 1))


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
