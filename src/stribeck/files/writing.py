"""Files of results: checked before the work, written whole or not at all."""

import errno
import importlib.util
import os
from collections.abc import Collection, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any

from stribeck.quantities.units import InputError, show

PathLike = str | os.PathLike[str]

FULL_DISK_ERRORS = (errno.ENOSPC, errno.EDQUOT, errno.EFBIG)  # Errors of a disk, a quota or a limit that takes no more

PROBE_BYTES = 65536  # Written to find out whether a disk is full


class MissingExtraError(InputError, ImportError):
    """A library that only some outputs need is not installed; the message says how to install it."""

    def __init__(self, purpose: str, extra: str, library: str) -> None:
        super().__init__(f"{purpose} needs {library}; install it with: pip install 'stribeck[{extra}]'.")


def need_extra(purpose: str, extra: str, library: str) -> None:
    """Refuse what needs a library that is not installed."""
    if importlib.util.find_spec(library) is None:
        raise MissingExtraError(purpose, extra, library)


def path_of(value: Any, name: str = "path") -> Path:
    """Return a path that was given as text or path-like; refuse what is none, and a name that no file system takes."""
    try:
        path = Path(value)
    except TypeError:
        raise InputError(f"{name} = {show(value)}; it must be a path: text, or a pathlib.Path.") from None
    try:
        path.stat()
    except (FileNotFoundError, NotADirectoryError):
        pass
    except (OSError, ValueError) as problem:
        raise InputError(f"{show(str(path))} cannot be looked up ({reason_of(problem)}); give another path.") from None
    return path


def check_writable(path: PathLike, suffixes: Collection[str], *, force: bool = False) -> Path:
    """Return where a file shall be written, or refuse a place where it cannot."""
    given = path_of(path)
    if given.suffix.lower() not in suffixes:
        *others, last = suffixes
        known = f"{', '.join(others)} or {last}" if others else last
        ending = f"the ending {given.suffix!r}" if given.suffix else "no ending"
        raise InputError(f"{given} has {ending}; the name of this file must end in {known}.")
    try:
        target = given.resolve()
        if target.is_dir():
            raise InputError(f"{given} is a directory; give the name of a file.")
        if target.exists():
            if not target.is_file():
                raise InputError(f"{given} is not an ordinary file; choose another name.")
            if not force:
                raise InputError(
                    f"{given} exists already and is kept; add --force (in Python force=True) to replace it, "
                    "or choose another name."
                )
            if not os.access(target, os.W_OK):
                raise InputError(f"{given} is write-protected; choose another name.")
        if not target.parent.is_dir():
            raise InputError(f"{given} cannot be written because the folder {given.parent} does not exist; create it first.")
        probe = _temporary_name(target)
        probe.touch(exist_ok=False)
        probe.unlink()
    except (OSError, RuntimeError, ValueError) as problem:
        if isinstance(problem, InputError):
            raise
        raise InputError(f"{given} cannot be written ({reason_of(problem)}); choose another place.") from None
    return target


@contextmanager
def atomic_write(path: PathLike, suffixes: Collection[str], *, force: bool = False) -> Iterator[Path]:
    """Give a temporary name beside ``path`` to write to, and move it there after success: ``path`` is never half written."""
    target = check_writable(path, suffixes, force=force)
    temporary = _temporary_name(target)
    try:
        yield temporary
        with temporary.open("rb+") as file:
            os.fsync(file.fileno())
        check_writable(path, suffixes, force=force)  # the file may have come to exist meanwhile
        os.replace(temporary, target)
        sync_folder(target.parent)
    except (OSError, UnicodeEncodeError) as problem:  # libraries take no name that is not UTF-8
        raise InputError(f"{path} could not be written ({reason_of(problem, temporary)}); it is unchanged.") from None
    finally:
        temporary.unlink(missing_ok=True)


def _temporary_name(target: Path) -> Path:
    """Return a new hidden name in the folder of ``target``, with its ending."""
    return target.with_name(f".stribeck-{os.urandom(6).hex()}{target.suffix}")


def sync_folder(folder: Path) -> None:
    """Write a folder to the disk, so that a file that was moved there is found after a power cut."""
    try:
        number = os.open(folder, os.O_RDONLY)
    except OSError:  # Windows opens no folders, and needs none of this
        return
    try:
        os.fsync(number)
    except OSError as problem:
        if problem.errno not in (errno.EINVAL, errno.ENOTSUP, errno.EBADF):  # some file systems of networks cannot
            raise
    finally:
        os.close(number)


def reason_of(problem: BaseException, file: Path | None = None) -> str:
    """Return what was wrong with a file, in the words of the system."""
    if file is not None and getattr(problem, "errno", None) not in FULL_DISK_ERRORS:
        trial = _temporary_name(file)
        try:
            with trial.open("wb") as stream:
                stream.write(bytes(PROBE_BYTES))
                stream.flush()
                os.fsync(stream.fileno())
        except OSError as found:
            if found.errno in FULL_DISK_ERRORS:
                problem = found
        finally:
            with suppress(OSError):
                trial.unlink(missing_ok=True)
    return getattr(problem, "strerror", None) or " ".join(str(problem).split()) or type(problem).__name__
