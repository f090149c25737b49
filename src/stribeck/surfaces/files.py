"""Heights from the files of instruments: plain text by ourselves, some forty formats through SurfaceTopography."""

import codecs
import math
import os
import warnings
import zipfile
from pathlib import Path
from typing import Any

import numpy as np

from stribeck._types import Array
from stribeck.files.writing import MissingExtraError, path_of
from stribeck.quantities.units import InputError, show, to_si
from stribeck.surfaces.text import MAX_FILE_BYTES, TEXT_ENDINGS, Spacing, mark_codes, read_text, spacing_of
from stribeck.surfaces.topography import Topography

AMBIGUOUS_ENDINGS = (".dat", ".xyz")  # Endings of text files that binary files of instruments have too, as those of MetroPro

# Formats of SurfaceTopography that begin with no mark of their own, so that other files pass for them
FORMATS_WITHOUT_MARK = {"asc", "hgt", "xyz"}

MAX_POINTS = MAX_FILE_BYTES // 8  # Points whose heights fill as much memory as the largest file


def read_topography(
    path: str | os.PathLike[str],
    *,
    unit: str | None = None,
    height_unit: str | None = None,
    spacing: Spacing = None,
    channel: str | None = None,
) -> Topography:
    """Read the heights of a measured surface.

    Parameters
    ----------
    path : str or path-like
        The file: plain text (.csv, .tsv, .txt, .dat, .xyz), or a format that SurfaceTopography knows, such as .x3p, .sur,
        .opd, .sdf, .plux, .al3d, .spm or .nc (extra ``surface``).
    unit : str, optional
        Unit of lengths, such as ``"um"``, where the file does not declare it.
    height_unit : str, optional
        Unit of height, if different.
    spacing : str, float or sequence of two, optional
        Distance between points with its unit, or in m, where the file does not hold it; one for both axes, or one each, as
        ``"1 um x 0.5 um"``.
    channel : str, optional
        Name of the channel, where the file has several; the default is the first with heights.

    Returns
    -------
    Topography
        The heights in m, NaN where points are missing.

    Raises
    ------
    InputError
        Where the file cannot be read, declares no unit, or contradicts what is given.
    MissingExtraError
        Where the format needs SurfaceTopography and it is not installed.
    """
    path = path_of(path)
    if not path.is_file():
        raise InputError(f"{path} is not a file; check the name.")
    for name, value in (("unit", unit), ("height_unit", height_unit)):
        if value is not None:
            to_si(f"1 {value}", "length", name)
    if path.suffix.lower() in TEXT_ENDINGS and not (path.suffix.lower() in AMBIGUOUS_ENDINGS and _is_binary(path)):
        if channel is not None:
            raise InputError(f"{path} is plain text without channels; leave out channel = {show(channel)}.")
        return read_text(path, unit=unit, height_unit=height_unit, spacing=spacing)
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # it warns of MPI that is not there
            import SurfaceTopography
            from SurfaceTopography.Exceptions import ReadFileError
    except ImportError:
        raise MissingExtraError(f"reading {path.name}", "surface", "SurfaceTopography") from None
    try:
        _check_whole(path)
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # its readers warn of metadata that we do not use
            # A stream of our own, as some readers leave theirs open.
            with path.open("rb") as stream, SurfaceTopography.open_topography(stream) as reader:
                _check_format(path, reader)
                return _from_channel(path, reader, _channel(path, reader, channel), unit, height_unit, spacing)
    except InputError:
        raise
    except ReadFileError as problem:
        reason = _reason_of_its_reader(path) if "tried " in str(problem) else f" ({_first(problem)})"
        raise InputError(
            f"{path} is damaged or in a format that SurfaceTopography does not know{reason}; export it "
            f"as X3P or as text with units."
        ) from None
    except Exception as problem:  # its forty readers leak errors of many kinds, and each means the same to the user
        raise InputError(
            f"{path} could not be read by SurfaceTopography ({type(problem).__name__}: {_first(problem)}); "
            "export it as X3P or as text with units."
        ) from None


def _is_binary(path: Path) -> bool:
    """Return whether a file is an instrument's and no text."""
    with path.open("rb") as stream:
        begin = stream.read(4096)
    return b"\0" in begin and not begin.startswith((codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE))


def _check_whole(path: Path) -> None:
    """Refuse a file that is empty or too large, and a zip archive, as .x3p and .plux are, that is cut off or spoilt."""
    size = path.stat().st_size
    if size == 0:
        raise InputError(f"{path} is empty; copy it from the instrument again.")
    if size > MAX_FILE_BYTES:
        raise InputError(f"{path} has more than {MAX_FILE_BYTES // 10**9} GB; crop the scan.")
    with path.open("rb") as stream:
        if stream.read(4) != b"PK\x03\x04":
            return
    try:
        with zipfile.ZipFile(path) as archive:
            # What a part says of its size holds: no more of it is unpacked.
            size = sum(part.file_size for part in archive.infolist())
            if size > MAX_FILE_BYTES:
                raise InputError(
                    f"{path} would be {size / 1e9:.3g} GB unpacked, more than {MAX_FILE_BYTES // 10**9} GB; crop the scan."
                )
            spoilt = archive.testzip()
    except InputError:
        raise
    except (zipfile.BadZipFile, OSError, ValueError):
        raise InputError(
            f"{path} is cut off or damaged: it starts as a zip archive but has no table of contents at the end; "
            "copy it from the instrument again."
        ) from None
    except (RuntimeError, NotImplementedError) as problem:
        raise InputError(f"{path} is a zip archive that cannot be opened ({_first(problem)}); export it again.") from None
    if spoilt is not None:
        raise InputError(
            f"{path} is damaged: {spoilt} in it has changed since it was written; copy it from the instrument again."
        )


def _check_format(path: Path, reader: Any) -> None:
    """Refuse what was taken for text or bare numbers, although its ending is that of a format with a mark of its own."""
    from SurfaceTopography.IO import readers

    ending = path.suffix.lower().lstrip(".")
    if reader.format() in FORMATS_WITHOUT_MARK and any(
        ending in _endings(known) and known.format() not in FORMATS_WITHOUT_MARK for known in readers
    ):
        raise InputError(
            f"{path} does not start like a .{ending} file{_reason_of_its_reader(path)}: it is damaged, or has the wrong "
            "ending; copy it from the instrument again, or name it .txt if it is text."
        )


def _reason_of_its_reader(path: Path) -> str:
    """Return in brackets what the readers of a file's ending say of it, or nothing."""
    from SurfaceTopography.IO import open_topography, readers

    ending = path.suffix.lower().lstrip(".")
    reasons = []
    for known in readers:
        if ending not in _endings(known) or known.format() in FORMATS_WITHOUT_MARK:
            continue
        try:
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")
                with path.open("rb") as stream, open_topography(stream, format=known.format()):
                    pass
        except Exception as problem:  # of any kind, as above
            reasons.append(f"{known.__name__}: {_first(problem) or type(problem).__name__}".rstrip("."))
    return f" ({'; '.join(reasons)})" if reasons else ""


def _endings(reader: Any) -> list[str]:
    try:
        return list(reader.file_extensions())
    except RuntimeError:  # it has none
        return []


def _channel(path: Path, reader: Any, name: str | None) -> Any:
    heights = [channel for channel in reader.channels if channel.is_height_channel]
    if not heights:
        raise InputError(f"{path} has no channel of heights.")
    if name is None:
        return heights[0]
    for channel in heights:
        if channel.name == name:
            return channel
    known = ", ".join(repr(channel.name) for channel in heights)
    raise InputError(f"{path} has no channel of heights called {show(name)}; it has {known}.")


def _from_channel(
    path: Path, reader: Any, channel: Any, unit: str | None, height_unit: str | None, spacing: Spacing
) -> Topography:
    format_name = reader.format()
    shape, declared, sizes = tuple(channel.nb_grid_pts), channel.unit, channel.physical_sizes
    if math.prod(shape) > MAX_POINTS:
        raise InputError(f"{path} has {' x '.join(map(str, shape))} points, more than {MAX_POINTS}; crop the scan.")
    if declared is None and unit is None:
        raise InputError(
            f"{path} does not declare its unit; add --unit um, and --height-unit nm where heights have another one "
            "(in Python unit='um', height_unit='nm')."
        )
    length = to_si(f"1 {declared or unit}", "length", "unit")
    if declared is not None:
        for name, given in (("unit", unit), ("height_unit", height_unit)):
            if given is not None:
                raise InputError(f"{path} declares its unit, {declared}; leave out {name} = {show(given)}.")
    if sizes is not None and any(size is None for size in sizes):
        sizes = None
    elif sizes is not None and not all(0 < size < math.inf for size in sizes):
        raise InputError(
            f"{path} declares a scan of {' x '.join(f'{size:g}' for size in sizes)} {declared or unit}; export it again, or "
            "as text with units."
        )
    arguments: dict[str, Any] = {}
    if sizes is None:
        apart = spacing_of(spacing, len(shape))
        if apart is None:
            raise InputError(
                f"{path} does not declare the distance between points; add --spacing '0.5 um' (in Python spacing='0.5 um')."
            )
        arguments["physical_sizes"] = tuple(n * step / length for n, step in zip(shape, apart, strict=True))
    elif spacing is not None:
        raise InputError(f"{path} declares the distance between its points; leave out spacing = {show(spacing)}.")
    if declared is None:
        arguments["unit"] = unit
    topography = channel.topography(**arguments)
    heights: Array = np.array(np.ma.filled(np.ma.asarray(topography.heights(), dtype=float), np.nan))
    notes = mark_codes(heights)
    factor = to_si(f"1 {height_unit}", "length", "height_unit") if height_unit else length
    steps = tuple(float(size) * length / n for size, n in zip(topography.physical_sizes, heights.shape, strict=True))
    if not topography.is_uniform:
        raise InputError(f"{path} holds a line with uneven steps; export it as text with two columns.")
    if min(heights.shape) == 1:  # a profile in a format of maps
        steps = steps[:1] if heights.shape[0] > 1 else steps[-1:]
        heights = heights.ravel()
    resolution = topography.short_reliability_cutoff()
    source = (
        f"{path.name} ({format_name}, channel {channel.name!r})"
        if len(reader.channels) > 1
        else f"{path.name} ({format_name})"
    )
    if resolution is not None and not (math.isfinite(resolution) and resolution > 0):
        resolution = None
    return Topography(
        heights * factor,
        steps,
        source=source,
        resolution=None if resolution is None else float(resolution) * length,
        notes=tuple(notes),
    )


def _first(problem: BaseException) -> str:
    text = " ".join(str(problem).split())
    return text if len(text) <= 120 else text[:117] + "..."
