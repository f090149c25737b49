"""Words of a command line, read into numbers, cases and files that can be written."""

from __future__ import annotations

import importlib.util
import re
from collections.abc import Sequence
from pathlib import Path
from typing import Annotated, Any, Literal

from cyclopts import Parameter

import stribeck as sb
from stribeck.files.writing import MissingExtraError, check_writable
from stribeck.quantities.units import InputError, read_number, show, to_si

Axis = Literal["speed", "load", "roughness"]
AXES: tuple[Axis, ...] = ("speed", "load", "roughness")

DEFAULT_RTOL = 1e-6  # Tolerance of a case that names none; to load cases for it alone takes longer than a state.

CaseFile = Annotated[Path | None, Parameter(name="CASE", show_default=False)]
Word = Annotated[str | None, Parameter(show_default=False)]
Number = Annotated[str | None, Parameter(allow_leading_hyphen=True, show_default=False)]
Flag = Annotated[bool, Parameter(negative="", show_default=False)]
NoNotes = Annotated[bool, Parameter(name="--no-notes", negative="", show_default=False)]
File = Annotated[Path | None, Parameter(show_default=False)]
Pair = Annotated[tuple[str, str] | None, Parameter(allow_leading_hyphen=True, show_default=False, negative="")]
Triple = Annotated[tuple[str, str, str] | None, Parameter(allow_leading_hyphen=True, show_default=False, negative="")]

BoundaryFriction = Annotated[Number, Parameter(help="Dry friction coefficient; only with --groups, default 1.")]
Beta = Annotated[Number, Parameter(help="Contact-law beta; only with --groups, default 1.")]
GroupsLaw = Annotated[
    Word,
    Parameter(help="Contact law: exponential (default), greenwood-williamson or greenwood-tripp; only with --groups."),
]
SlideToRoll = Annotated[
    Number,
    Parameter(
        help="Slide-to-roll ratio 2 (u1 - u2)/(u1 + u2): 2 is pure sliding, 0 pure rolling; defaults to the value in the "
        "case, or 2."
    ),
]
CavitationWord = Annotated[
    Word,
    Parameter(
        help="How the film ends: none, exit (at ambient pressure) or reform (at the pressure of a cavity); defaults to the "
        "case, or none."
    ),
]
CavityPressure = Annotated[
    Number,
    Parameter(
        help="Pressure of the cavity with --cavitation reform, above the ambient one, such as '-0.1 MPa'; with --groups over "
        "p_Hz."
    ),
]
FlowFactorsWord = Annotated[
    Word,
    Parameter(help="What roughness does to the flow: none, effective-medium or patir-cheng; defaults to the case, or none."),
]


def read_case(
    path: Path | None, groups: Sequence[str] | None, boundary_friction: str | None, beta: str | None, law: str | None
) -> sb.Case | None:
    """Return the case, or None where groups are given instead."""
    if path is not None and groups is not None:
        if re.fullmatch(r"[-+0-9.eE]+", str(path)):
            raise InputError(f"--groups has more than {len(groups)} numbers: {' '.join(groups)} {path}; see --help.")
        raise InputError(f"{path} and --groups are both given; give one of them.")
    if path is None and groups is None:
        raise InputError("CASE is missing; give a case file, or dimensionless groups with --groups.")
    if path is None:
        return None
    for name, key, value in (
        ("--boundary-friction", "boundary_friction", boundary_friction),
        ("--beta", "beta", beta),
        ("--law", "law", law),
    ):
        if value is not None:
            raise InputError(f"{name} = {value} goes with --groups only; in {path} it is the key {key}.")
    return sb.load_case(path)


def data_and_case(command: str, data: Path | None, case: Path | None) -> tuple[Path, sb.Case]:
    """Return the file of measured friction and the case of a command that fits, or say which of them is missing."""
    if data is None or case is None:
        missing, example = ("DATA", "measured.csv case.toml") if data is None else ("CASE", f"{data} case.toml")
        raise InputError(f"{missing} is missing; give measured friction and a case file, as in: stribeck {command} {example}.")
    from stribeck.fits.case_file import load_fit_case

    return data, load_fit_case(data, case)


def model_parts(
    slide_to_roll: str | None, cavitation: str | None, cavity_pressure: str | None, flow_factors: str | None
) -> dict[str, Any]:
    """Return the parts of the model that options name, in place of those of a case."""
    given = {
        "slide_to_roll": as_number("slide_to_roll", slide_to_roll),
        "cavitation": cavitation,
        "cavity_pressure": None if cavity_pressure is None else bare_or_text(cavity_pressure),
        "flow_factors": flow_factors,
    }
    return {name: value for name, value in given.items() if value is not None}


def as_number(name: str, text: str | None) -> float | None:
    """Return the number that an option holds, or None where it is not given."""
    return None if text is None else read_number(name, text)


def as_group(name: str, text: str) -> float:
    """Return the number that a group is."""
    value = as_number(name, text)
    assert value is not None
    return value


def as_whole(name: str, text: str) -> int:
    """Return the whole number that an option holds."""
    if not re.fullmatch(r"[+-]?[0-9]{1,18}", text.strip()):
        raise InputError(f"{name} = {show(text)} is not a whole number; write, for example, 101.")
    return int(text)


def as_rtol(text: str | None, case: sb.Case | None) -> float:
    """Return the relative tolerance: that of the option, else of the case, else the default."""
    given = as_number("rtol", text)
    return given if given is not None else case.rtol if case else DEFAULT_RTOL


def curve_arguments(
    case: sb.Case | None,
    over: str | None,
    ends: tuple[str, str] | None,
    points: str | None,
    rtol: str | None,
    groups: tuple[str, str] | None,
    boundary_friction: str | None,
    beta: str | None,
) -> dict[str, Any]:
    """Return the arguments of :func:`stribeck_curve` that a command line asks for."""
    from stribeck.cases.case import CurveSettings, curve_range

    settings = case.curve if case else CurveSettings()
    varied: Axis = settings.over if over is None else _axis(over)
    found: dict[str, Any] = {
        "points": settings.points if points is None else as_whole("points", points),
        "rtol": as_rtol(rtol, case),
    }
    if case is not None:
        found |= {"problem": case.contact, "definition": case.definition}
        span = settings.range if varied == settings.over else None
        if ends is not None:
            span = curve_range([bare_or_text(end) for end in ends], varied)
    else:
        fixed = [name for name in AXES if name != varied]
        found |= {name: as_group(name, text) for name, text in zip(fixed, groups or (), strict=True)}
        found |= {"boundary_friction": as_number("boundary_friction", boundary_friction), "beta": as_number("beta", beta)}
        span = None
        if ends is not None:
            low, high = (as_group(varied, text) for text in ends)
            span = low, high
    if span is not None:
        found[varied] = span
    elif varied != "speed":
        raise InputError(f"range is missing; a curve over {varied} needs --range with the lowest and highest {varied}.")
    return found


def _axis(text: str) -> Axis:
    for axis in AXES:
        if text == axis:
            return axis
    raise InputError(f"over = {show(text)} must be 'speed', 'load' or 'roughness'.")


def bare_or_text(text: str) -> float | str:
    """Return a bare number, which is in SI units, as number; what has a unit as it is."""
    try:
        return float(text)
    except ValueError:
        return text


def check_outputs(data: Sequence[Path], plot: Path | None, force: bool) -> tuple[list[Path], list[Path]]:
    """Return the files to write, after a look at whether that will be possible."""
    from stribeck.files.datasets import DATA_ENDINGS, NETCDF_ENDINGS

    for path in data:
        check_writable(path, DATA_ENDINGS, force=force)
    if data:
        need_extra("a data file", "data", "xarray")
    if any(path.suffix.lower() in NETCDF_ENDINGS for path in data):
        need_extra("a NetCDF file", "data", "netCDF4")
    pictures = check_pictures(plot, force)
    targets = [path.resolve() for path in (*data, *pictures)]
    for path, target in zip((*data, *pictures), targets, strict=True):
        if targets.count(target) > 1:
            raise InputError(f"{path} is given twice as an output; give each output its own name.")
    return list(data), pictures


def check_pictures(plot: Path | None, force: bool) -> list[Path]:
    """Return the pictures to write, after a look at whether that will be possible."""
    from stribeck.plot.style import PICTURE_ENDINGS

    if plot is None:
        return []
    check_writable(plot, PICTURE_ENDINGS, force=force)
    need_extra("a picture", "plot", "matplotlib")
    return [plot]


def need_extra(purpose: str, extra: str, library: str) -> None:
    """Refuse what needs a library that is not installed."""
    if importlib.util.find_spec(library) is None:
        raise MissingExtraError(purpose, extra, library)


def read_duration(text: str, name: str) -> float:
    """Return a positive time in seconds."""
    seconds = to_si(float(text) if text.replace(".", "", 1).isdigit() else text, "time", name, "60 s")
    if seconds <= 0:
        raise InputError(f"{name} = {show(text)}; it must be a time above zero, such as '60 s'.")
    return seconds
