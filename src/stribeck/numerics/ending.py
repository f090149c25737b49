"""Where work that is no longer wanted ends: between the steps of iterations, by what the caller of the work raises there."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar

__all__ = ["ended_by", "go_on"]

_WATCH: ContextVar[Callable[[], object] | None] = ContextVar("watch", default=None)


@contextmanager
def ended_by(watch: Callable[[], object]) -> Iterator[None]:
    """Let all iterations of this thread call ``watch`` at each step."""
    before = _WATCH.set(watch)
    try:
        yield
    finally:
        _WATCH.reset(before)


def go_on() -> None:
    """Call the watch of this thread, if there is one."""
    watch = _WATCH.get()
    if watch is not None:
        watch()
