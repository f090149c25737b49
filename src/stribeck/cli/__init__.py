"""The command ``stribeck``: arguments in, files and tables out; no physics here."""

from .running import main

__all__ = ["main"]
