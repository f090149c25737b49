"""One BLAS thread for the small matrices here: with more, OpenBLAS is several times slower beside any other load.

The number of threads changes last digits too, so that several threads of a caller need the same one.
"""

import threading
from collections.abc import Callable
from functools import lru_cache, wraps
from typing import Any, ParamSpec, TypeVar

from stribeck.quantities.keywords import with_nearest

P = ParamSpec("P")
R = TypeVar("R")


@lru_cache(maxsize=1)
def _libraries() -> tuple[list[Any], list[Any]]:
    """Return the BLAS libraries whose number of threads is that of the process, and those where each thread has its own."""
    from threadpoolctl import ThreadpoolController  # noqa: PLC0415

    found = ThreadpoolController().select(user_api="blas").lib_controllers
    own = [library for library in found if getattr(library, "threading_layer", None) == "openmp"]
    return [library for library in found if library not in own], own


def _set_threads(library: Any, number: int) -> None:
    # From version 3.8 threadpoolctl ignores all threads but the first to set a number, which need not be one that solves.
    getattr(library, "_real_set_num_threads", library.set_num_threads)(number)


class _Limit:
    """A limit to one thread that lasts from the first to the last of the calls that want it."""

    # If each call restored what it found, one that came second and left last would leave one thread for good.

    def __init__(self) -> None:
        self.calls = 0
        self.before: list[tuple[Any, int]] = []

    def enter(self, libraries: list[Any]) -> None:
        if self.calls == 0:
            self.before = [(library, library.num_threads) for library in libraries]
            for library in libraries:
                _set_threads(library, 1)
        self.calls += 1

    def leave(self) -> None:
        self.calls -= 1
        if self.calls == 0:
            for library, number in self.before:
                _set_threads(library, number)


class _OwnLimit(threading.local):
    """The limit of each thread, made in it when first asked for."""

    def __init__(self) -> None:
        self.limit = _Limit()


_LOCK, _OF_PROCESS, _OF_THREAD = threading.Lock(), _Limit(), _OwnLimit()


def one_blas_thread(function: Callable[P, R]) -> Callable[P, R]:
    """Return ``function`` limited to one BLAS thread while it runs; calls in several threads may overlap."""

    @wraps(function)
    def limited(*args: P.args, **kwargs: P.kwargs) -> R:
        with _LOCK:
            of_process, of_thread = _libraries()
            _OF_PROCESS.enter(of_process)
            _OF_THREAD.limit.enter(of_thread)
        try:
            return function(*args, **kwargs)
        except TypeError as problem:
            raise with_nearest(problem, function) from None
        finally:
            with _LOCK:
                _OF_THREAD.limit.leave()
                _OF_PROCESS.leave()

    return limited
