"""The command ``stribeck``: arguments in, files and tables out; no physics here."""

from stribeck.cli.running import main

__all__ = ["main"]
