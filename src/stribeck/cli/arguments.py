"""Words of a command line, read into numbers, cases and files that can be written."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

from cyclopts import Parameter

import stribeck as sb
from stribeck.cli.exits import EXIT_BAD_INPUT, answer, complain
from stribeck.cli.progress import interruptible
from stribeck.files.writing import check_writable, need_extra
from stribeck.quantities.outputs import GROUPS
from stribeck.quantities.units import InputError, checked_word, read_number, show, to_si

if TYPE_CHECKING:
    from stribeck.checks.check import Checks

DEFAULT_RTOL = 1e-6  # Tolerance of a case that names none; to load cases for it alone takes longer than a state.


def _read_by(read: Callable[[str, str], Any]) -> Parameter:
    """Return that an option is read by a function of its name in Python and of its text, which may begin with a minus."""

    def convert(_: Any, tokens: Sequence[Any]) -> Any:
        return read(tokens[0].keyword.lstrip("-").replace("-", "_"), tokens[0].value)

    return Parameter(converter=convert, allow_leading_hyphen=True)


def _read_whole(name: str, text: str) -> int:
    if not re.fullmatch(r"[+-]?[0-9]{1,18}", text.strip()):
        raise InputError(f"{name} = {show(text)} is not a whole number; write, for example, 101.")
    return int(text)


Number = Annotated[float | None, _read_by(read_number)]
Whole = Annotated[int, _read_by(_read_whole)]
Quantity = Annotated[float | str | None, Parameter(allow_leading_hyphen=True)]  # A bare number is in SI units
Quantities = Annotated[list[float | str] | None, Parameter(consume_multiple=True)]
Names = Annotated[list[str] | None, Parameter(consume_multiple=True)]
Pair = Annotated[tuple[float | str, float | str] | None, Parameter(allow_leading_hyphen=True)]
Triple = Annotated[tuple[float | str, float | str, float | str] | None, Parameter(allow_leading_hyphen=True)]
Verbose = Annotated[bool, Parameter(alias="-v", help="Print everything, not the answer alone.")]


@Parameter(name="*")
@dataclass(frozen=True)
class GroupOptions:
    """What a case has, and groups do not: coefficients and contact law.

    Parameters
    ----------
    boundary_friction
        Dry friction coefficient; only with --groups, default 1.
    beta
        Contact-law beta; only with --groups, default 1.
    law
        Contact law: exponential (default), greenwood-williamson or greenwood-tripp; only with --groups.
    """

    boundary_friction: Number = None
    beta: Number = None
    law: str | None = None


@Parameter(name="*")
@dataclass(frozen=True)
class ModelOptions:
    """Parts of the model in place of those of a case.

    Parameters
    ----------
    slide_to_roll
        Slide-to-roll ratio 2 (u1 - u2)/(u1 + u2): 2 is pure sliding, 0 pure rolling; defaults to the value in the case, or 2.
    cavitation
        How the film ends: none, exit (at ambient pressure) or reform (at the pressure of a cavity); defaults to the case, or
        none.
    cavity_pressure
        Pressure of the cavity with --cavitation reform, relative to ambient, such as '-0.1 MPa'; with --groups over p_Hz.
    flow_factors
        What roughness does to the flow: none, effective-medium or patir-cheng; defaults to the case, or none.
    """

    slide_to_roll: Number = None
    cavitation: str | None = None
    cavity_pressure: Quantity = None
    flow_factors: str | None = None

    def parts(self) -> dict[str, Any]:
        """Return those that are given."""
        return {name: value for name, value in vars(self).items() if value is not None}


@Parameter(name="*")
@dataclass(frozen=True)
class Outputs:
    """What is printed and written of a result.

    Parameters
    ----------
    plot
        Picture to write: .png, .svg or .pdf.
    json
        Print JSON.
    force
        Replace files that are there.
    no_notes
        Draw without the notes below the picture.
    """

    plot: Path | None = None
    json: bool = False
    force: bool = False
    no_notes: bool = False

    def check(self, case: Path | None = None, data: Sequence[Path] = ()) -> None:
        """Refuse a picture, a case and files of data that could not be written, before the work whose results they are for."""
        from stribeck.files.datasets import check_export
        from stribeck.plot.style import PICTURE_ENDINGS

        for path in data:
            check_export(path, force=self.force)
        if self.plot is not None:
            check_writable(self.plot, PICTURE_ENDINGS, force=self.force)
            need_extra("a picture", "plot", "matplotlib")
        if case is not None:
            check_writable(case, (".toml",), force=self.force)
        paths = [*data, *filter(None, (self.plot, case))]
        for i, path in enumerate(paths):
            if path.resolve() in [each.resolve() for each in paths[:i]]:
                raise InputError(f"{path} is given twice as an output; give each output its own name.")

    def write(
        self,
        found: Any,
        title: str = "",
        data: Sequence[Path] = (),
        others: Mapping[Path, Callable[[], object]] | None = None,
        **drawing: Any,
    ) -> tuple[list[str], list[str]]:
        """Write files of a result; return the names of those that were written, and a sentence about each that was not."""
        from stribeck.files.datasets import write_data

        titled = {"title": title} if title else {}
        noted = {"notes": False} if self.no_notes else {}
        actions: dict[Path, Callable[[], object]] = {}
        if data:
            dataset = found.to_dataset()
            dataset.attrs |= titled
            actions |= {path: partial(write_data, dataset, path, force=self.force) for path in data}
        if self.plot is not None:
            actions[self.plot] = partial(found.plot, self.plot, force=self.force, **titled, **noted, **drawing)
        written, problems = [], []
        with interruptible(writes=True):  # or one file would be there without the next, and "nothing was written" be said
            for path, action in (actions | dict(others or {})).items():
                try:
                    action()
                except InputError as problem:
                    problems.append(str(problem))
                else:
                    written.append(str(path))
        return written, problems

    def finish(
        self,
        found: Any,
        lines: Callable[[], Iterable[str]],
        title: str = "",
        *,
        content: Callable[[], dict[str, Any]] | None = None,
        data: Sequence[Path] = (),
        others: Mapping[Path, Callable[[], object]] | None = None,
        checks: Checks | None = None,
        case: sb.Case | None = None,
    ) -> int:
        """Write the files of a result, print it, and return the exit code of what could not be written."""
        written, problems = self.write(found, title, data, others)
        made = content or found.to_dict
        answer(self.json, lambda: made() | {"files": written}, lines, checks, case, written)
        return complain("\n".join(problems), EXIT_BAD_INPUT if problems else 0)


# None of them given
GROUP_OPTIONS, MODEL_OPTIONS, OUTPUTS = GroupOptions(), ModelOptions(), Outputs()


def read_case(
    path: Path | None, groups: Sequence[float | str] | None, beside: GroupOptions, model: ModelOptions
) -> sb.Case | None:
    """Return the case, or None where groups are given instead, with a word on what is hardly meant beside them."""
    if path is not None and groups is not None:
        if re.fullmatch(r"[-+0-9.eE]+", str(path)):
            given = " ".join(f"{group:g}" if isinstance(group, float) else group for group in groups)
            raise InputError(f"--groups has more than {len(groups)} numbers: {given} {path}; see --help.")
        raise InputError(f"{path} and --groups are both given; give one of them.")
    if path is None and groups is None:
        raise InputError("CASE is missing; give a case file, or dimensionless groups with --groups.")
    if path is None:
        said = {"boundary_friction": beside.boundary_friction, "slide_to_roll": model.slide_to_roll}
        if any(value is not None for value in said.values()):
            from stribeck.checks.body import unusual
            from stribeck.contacts.geometries import LINE

            complain(unusual(said, LINE), 0)
        return None
    for name, value in vars(beside).items():
        if value is not None:
            option = f"--{name.replace('_', '-')}"
            raise InputError(f"{option} = {value} goes with --groups only; in {path} it is the key {name}.")
    return sb.load_case(path)


def as_group(name: str, value: float | str) -> float:
    """Return the number that a group is."""
    return read_number(name, value) if isinstance(value, str) else value


def as_rtol(rtol: float | None, case: sb.Case | None) -> float:
    """Return the relative tolerance: that of the option, else of the case, else the default."""
    return rtol if rtol is not None else case.rtol if case else DEFAULT_RTOL


def curve_arguments(
    case: sb.Case | None,
    over: str | None,
    ends: Pair,
    points: int | None,
    rtol: float | None,
    groups: Pair,
    beside: GroupOptions,
) -> dict[str, Any]:
    """Return the arguments of :func:`stribeck_curve` that a command line asks for."""
    from stribeck.cases.case import CurveSettings, curve_range

    settings = case.curve if case else CurveSettings()
    varied = settings.over if over is None else checked_word("over", over, GROUPS)
    found: dict[str, Any] = {"points": settings.points if points is None else points, "rtol": as_rtol(rtol, case)}
    if case is not None:
        found |= {"problem": case.contact, "definition": case.definition}
        span = settings.range if varied == settings.over else None
        if ends is not None:
            span = curve_range(list(ends), varied, case.contact.INPUTS)
    else:
        fixed = [name for name in GROUPS if name != varied]
        found |= {name: as_group(name, value) for name, value in zip(fixed, groups or (), strict=True)} | vars(beside)
        span = None
        if ends is not None:
            span = as_group(varied, ends[0]), as_group(varied, ends[1])
    if span is not None:
        found[varied] = span
    elif varied != "speed":
        raise InputError(f"range is missing; a curve over {varied} needs --range with the lowest and highest {varied}.")
    return found


def check_duration(value: float | str | None, name: str) -> float | None:
    """Return a positive time in seconds, or None where none is given."""
    if value is None:
        return None
    seconds = to_si(value, "time", name, "60 s")
    if seconds <= 0:
        raise InputError(f"{name} = {show(value)}; it must be a time above zero, such as '60 s'.")
    return seconds
