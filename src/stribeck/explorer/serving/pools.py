"""The threads in which pages compute: of what follows a slider, of what comes when it rests, and of files that are read."""

from __future__ import annotations

import asyncio
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from typing import Any

__all__ = ["FILES", "LIVE", "SLOW", "run"]

LIVE = ThreadPoolExecutor(2, "explorer")
SLOW = ThreadPoolExecutor(1, "explorer-slow")
FILES = ThreadPoolExecutor(2, "explorer-files")


async def run(pool: ThreadPoolExecutor, function: Callable[..., Any], *arguments: Any) -> Any:
    """Return what a function gives, computed in a thread."""
    return await asyncio.get_running_loop().run_in_executor(pool, function, *arguments)
