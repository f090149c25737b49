"""The threads in which pages compute: each page has its own for what follows a slider and for what comes when it rests."""

from __future__ import annotations

import asyncio
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
