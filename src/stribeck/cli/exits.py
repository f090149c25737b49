"""Exit codes, and sentences on stderr."""

from __future__ import annotations

import sys

FAILED, BAD_INPUT, INTERRUPTED = 1, 2, 130
"""Exit codes besides 0."""


def complain(text: str, code: int) -> int:
    """Print sentences on stderr and return the exit code."""
    for line in text.splitlines():
        print(f"stribeck: {line}", file=sys.stderr)
    return code
