"""The check of a law or a body that a user wrote: once, with failures as sentences."""

from __future__ import annotations

from collections.abc import Callable, Hashable
from functools import lru_cache
from typing import Any

import numpy as np

from stribeck.quantities.units import InputError

GUIDE = "See Add a fluid in for_developers.md."


def refusal(kind: str, part: Any, sentence: str) -> InputError:
    """Return the error that refuses a part of that kind, with its name."""
    return InputError(f"the {kind} {getattr(part, 'name', None) or type(part).__name__!r}: {sentence} {GUIDE}")


def check_user_part(kind: str, part: Any, check: Callable[[Any], None]) -> None:
    """Refuse a user's part that ``check`` refuses or fails on; parts of the package have tests of their own."""
    if type(part).__module__.startswith("stribeck."):
        return
    if not isinstance(part, Hashable):
        raise refusal(kind, part, "it cannot be hashed; make it a frozen dataclass.")
    _check_once(kind, part, check)


@lru_cache(maxsize=64)
def _check_once(kind: str, part: Any, check: Callable[[Any], None]) -> None:
    try:
        with np.errstate(all="ignore"):
            check(part)
    except InputError:
        raise
    except Exception as error:
        raise refusal(kind, part, f"its check fails with {type(error).__name__}: {error}.") from error
