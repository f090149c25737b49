"""The command ``stribeck``, also as ``python -m stribeck``, before its libraries are loaded.

From its first moment on Ctrl-C ends it with a sentence and exit code 130, and so does too little memory with exit code 1; the
libraries would end in tracebacks, in a segmentation fault, or not at all.
"""

import mmap
import os
import signal
import sys
from collections.abc import Sequence
from importlib.machinery import ModuleSpec, PathFinder
from importlib.util import LazyLoader
from types import FrameType

NEEDED = 500_000_000
"""Address space that loading the package, a solve and a picture take [byte]; measured are 0.47e9."""

UNUSED = ("numpy.f2py", "numpy.testing")
"""Modules that SciPy names when it is loaded and that no command uses; to load them takes a fifth of the time of a solve."""

FAILED, INTERRUPTED = 1, 130


def main() -> int:
    """Load the package, run the command and return its exit code."""
    # A shell makes background jobs ignore Ctrl-C; that stays so.
    heeds = signal.getsignal(signal.SIGINT) is signal.default_int_handler
    if heeds:
        signal.signal(signal.SIGINT, _leave)
    if not _memory_suffices():
        return _told(
            "The memory that this process may take does not suffice: 0.5 GB are needed; raise the limit (ulimit -v) or use "
            "another machine.",
            FAILED,
        )
    sys.meta_path.insert(0, _OnFirstUse)
    try:
        from stribeck.cli import main as run
    except OSError as problem:  # no file handles, or a disk that cannot be read
        return _told(f"The package could not be loaded ({problem.strerror or problem}).", FAILED)

    if heeds:
        signal.signal(signal.SIGINT, signal.default_int_handler)
    code = run()
    if heeds:
        signal.signal(signal.SIGINT, _leave_after)
    return code


class _OnFirstUse:
    """Finder of those modules, which are then loaded where something in them is asked for."""

    @staticmethod
    def find_spec(name: str, path: Sequence[str] | None, target: object = None) -> ModuleSpec | None:
        """Return where one of them is found, and None of others."""
        spec = PathFinder.find_spec(name, path) if name in UNUSED else None
        if spec is not None and spec.loader is not None:
            spec.loader = LazyLoader(spec.loader)
        return spec


def _memory_suffices() -> bool:
    """Return whether the system gives the memory that is needed; if it is little, limit BLAS to one thread."""
    if not hasattr(mmap, "MAP_PRIVATE"):  # Windows
        return True
    for size in (8 * NEEDED, NEEDED):
        try:
            mmap.mmap(-1, size, flags=mmap.MAP_PRIVATE | mmap.MAP_ANONYMOUS).close()
        except OSError:
            os.environ["OPENBLAS_NUM_THREADS"] = os.environ["OMP_NUM_THREADS"] = "1"
        else:
            return True
    return False


def _leave(number: int, frame: FrameType | None) -> None:
    """End at once: while libraries are loaded, an exception would be taken for a fault of theirs."""
    os._exit(_told("Interrupted; nothing was written.", INTERRUPTED))


def _leave_after(number: int, frame: FrameType | None) -> None:
    """End at once, as everything is written."""
    os._exit(INTERRUPTED)


def _told(text: str, code: int) -> int:
    try:
        os.write(sys.__stderr__.fileno() if sys.__stderr__ else 2, f"stribeck: {text}\n".encode())
    except OSError:
        pass
    return code


if __name__ == "__main__":
    sys.exit(main())
