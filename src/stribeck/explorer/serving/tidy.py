"""Memory of closed pages, given back to the system soon after they close.

A page is a net of objects that refer to each other. Python finds such nets seldom in a large process, and the allocator of
Linux keeps what they leave.
"""

from __future__ import annotations

import ctypes
import gc
import sys
import threading

TIDY_DELAY_SECONDS = 5.0  # Time within which pages that close are tidied together [s].

_waiting = threading.Lock()


def set_aside() -> None:
    """Leave out of all later searches what is there before the first page: the modules of a process this large take 70 ms."""
    gc.collect()
    gc.freeze()


def tidy_soon() -> None:
    """Collect closed pages a little later, once for all that close until then."""
    if _waiting.acquire(blocking=False):
        timer = threading.Timer(TIDY_DELAY_SECONDS, _tidy)
        timer.daemon = True
        timer.start()


def _tidy() -> None:
    _waiting.release()
    gc.collect()
    if sys.platform == "linux":
        trim = getattr(ctypes.CDLL(None), "malloc_trim", None)  # glibc has it
        if trim is not None:
            trim(0)
