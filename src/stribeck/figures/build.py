"""The figures of the paper: what each is, and how their files are made in a folder, whole or not at all.

``article/figure_3.toml`` says title, claim, finding, the variables of the data and the settings of the panels; ``compute`` of
the module beside it returns the numbers, and ``draw`` draws them.  The drawing sees the numbers only, never the solver, so
that a dataset from a file draws the same picture.

The NetCDF file of a figure is also its memory. It holds a fingerprint of the sources that its numbers come from, and is
used again as long as these are the same.
"""

from __future__ import annotations

import hashlib
import os
import re
import tomllib
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from importlib import import_module
from importlib.metadata import version
from pathlib import Path
from typing import TYPE_CHECKING, Literal

from stribeck.figures import style
from stribeck.figures.job import FigureJob, Report, Said
from stribeck.figures.style import Dataset, Figure, Panels
from stribeck.files.datasets import NETCDF_ENDINGS, write_netcdf
from stribeck.files.writing import PathLike, atomic_write, check_writable, need_extra
from stribeck.quantities.units import InputError, show
from stribeck.solver.solve_error import SolveError

if TYPE_CHECKING:
    import xarray


FIGURES = ("3", "4", "5", "6", "7", "8", "9", "10", "11", "S1")
"""Names of the figures that hold results, in the order of the paper."""

NAME = re.compile(r"(?:fig(?:ure)?s?[\s._-]*)?(s?[0-9]+)[\s._-]*\(?[a-f]?\)?", re.IGNORECASE)
"""How people write the name of a figure: 3, 3a, S1, figure_3, Fig. 3(a); a panel means its figure."""

PICTURE_ENDINGS = (".png", ".svg")

EXTRAS = (
    ("a figure", "plot", "matplotlib"),
    ("the data of a figure", "data", "xarray"),
    ("the data of a figure", "data", "netCDF4"),
)

# Beginnings of the names of sources that change no number of a figure.
SOURCES_WITHOUT_NUMBERS = (
    "__main__.py",
    "cases/",
    "cli/",
    "explorer/",
    "figures/style.py",
    "plot/",
    "fits/",
    "sweeps/",
)

OnProgress = Callable[[str, int, int], object]
"""``on_progress(name, done, steps)`` is called at the start of each figure and after each step of its work."""


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


@dataclass(frozen=True)
class Made:
    """What became of one figure."""

    name: str  # Its name in the paper
    outcome: Literal["solved", "reused", "failed", "unwritten", "interrupted"]
    files: tuple[Path, ...] = ()  # What was written or, for data that are used again, found
    message: str = ""  # A sentence where there is no figure


def make_figures(
    names: Iterable[str] = (),
    folder: PathLike = "figures",
    *,
    force: bool = False,
    on_progress: OnProgress = lambda name, done, steps: None,
) -> list[Made]:
    """Make figures of the paper: for each a PNG, an SVG and the data as NetCDF, such as ``figure_3.png``."""
    figures = [load_figure(name) for name in figure_names(names)]
    for purpose, extra, library in EXTRAS:
        need_extra(purpose, extra, library)
    place = _folder(folder)
    for figure in figures:
        _check_files(figure, place, force)
    made: list[Made] = []
    for figure in figures:
        try:
            on_progress(figure.name, 0, 1)
            made.append(_make(figure, place, force, on_progress))
        except SolveError as problem:
            made.append(Made(figure.name, "failed", message=f"Figure {figure.name} was not made: {problem}"))
        except InputError as problem:
            made.append(Made(figure.name, "unwritten", message=f"Figure {figure.name} was not made: {problem}"))
        except KeyboardInterrupt:
            made.append(Made(figure.name, "interrupted", message=f"Interrupted at figure {figure.name}."))
            break
    return made


def fingerprint(figure: PaperFigure) -> str:
    """Return what changes when the numbers of a figure may change."""
    package = Path(__file__).parents[1]
    found = hashlib.sha256(version("stribeck").encode())
    for path in sorted(path for ending in ("py", "toml") for path in package.rglob(f"*.{ending}")):
        name = path.relative_to(package).as_posix()
        of_another = name.startswith("figures/article/figure_") and path.stem != figure.stem
        if not name.startswith(SOURCES_WITHOUT_NUMBERS) and not of_another:
            found.update(name.encode() + b"\0" + path.read_bytes())
    return found.hexdigest()[:16]


def _make(figure: PaperFigure, place: Path, force: bool, on_progress: OnProgress) -> Made:
    stem = place / figure.stem
    file, mark = stem.with_suffix(".nc"), fingerprint(figure)
    data = None if force else _read(figure, file)
    reused = data is not None and data.attrs.get("fingerprint") == mark
    if data is None or not reused:
        data = figure.data(lambda done, steps: on_progress(figure.name, done, steps))
        data = data.assign_attrs(fingerprint=mark)
        # Before the pictures: it is the sign that they may be replaced.
        write_netcdf(data, file, force=True)
    picture = figure.picture(data)
    for ending in PICTURE_ENDINGS:
        with atomic_write(stem.with_suffix(ending), PICTURE_ENDINGS, force=True) as temporary:
            style.save(picture, temporary)
    files = tuple(stem.with_suffix(ending) for ending in (*PICTURE_ENDINGS, *NETCDF_ENDINGS))
    return Made(figure.name, "reused" if reused else "solved", files)


def _read(figure: PaperFigure, file: Path) -> xarray.Dataset | None:
    """Return the data of a figure from its file, or None where the file is not of this command."""
    import xarray

    if not file.is_file():
        return None
    try:
        with xarray.open_dataset(file, engine="netcdf4", decode_times=False) as found:
            data = found.load()
    except (OSError, ValueError):
        return None
    return data if data.attrs.get("figure") == figure.name and "fingerprint" in data.attrs else None


def _folder(folder: PathLike) -> Path:
    """Return the folder, made where it was missing."""
    place = Path(folder)
    try:
        if place.exists() and not place.is_dir():
            raise InputError(f"{place} is a file; give the name of a folder.")
        if not place.exists() and not place.parent.is_dir():
            raise InputError(f"{place} cannot be created because the folder {place.parent} does not exist; create it first.")
        place.mkdir(exist_ok=True)
    except OSError as problem:
        reason = problem.strerror or str(problem)
        raise InputError(f"{place} cannot be created ({reason}); choose another place.") from None
    if not os.access(place, os.W_OK | os.X_OK):
        raise InputError(f"{place} is write-protected; choose another folder.")
    return place


def _check_files(figure: PaperFigure, place: Path, force: bool) -> None:
    """Refuse to replace files that this command has not made."""
    stem = place / figure.stem
    ours = force or _read(figure, stem.with_suffix(".nc")) is not None
    for ending in (*PICTURE_ENDINGS, *NETCDF_ENDINGS):
        check_writable(stem.with_suffix(ending), (ending,), force=ours)
