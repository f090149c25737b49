"""What pages take of the process: two threads each, and memory, given back to the system soon after they close.

One thread is for what follows a slider, the other for what comes when it rests. A page is a net of objects that refer to each
other: Python finds such nets seldom in a large process, and the allocator of Linux keeps what they leave.
"""

from __future__ import annotations

import asyncio
import ctypes
import gc
import sys
import threading
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from typing import Any

from stribeck.numerics.ending import ended_by

FILES = ThreadPoolExecutor(2, "explorer-files")
"""Of all pages: addresses and files."""


class Threads:
    """The threads of one page, which wait for no other page; they start when they are first needed."""

    def __init__(self) -> None:
        self.live = ThreadPoolExecutor(1, "explorer-live")
        self.slow = ThreadPoolExecutor(1, "explorer-slow")

    def close(self) -> None:
        """Drop what waits, and end with what runs."""
        for pool in (self.live, self.slow):
            pool.shutdown(wait=False, cancel_futures=True)


async def run(
    pool: ThreadPoolExecutor, function: Callable[..., Any], *arguments: Any, watch: Callable[[], object] = lambda: None
) -> Any:
    """Return what a function gives, computed in a thread; what ``watch`` raises between two steps of iterations ends it."""

    def watched() -> Any:
        watch()
        with ended_by(watch):
            return function(*arguments)

    return await asyncio.get_running_loop().run_in_executor(pool, watched)


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
