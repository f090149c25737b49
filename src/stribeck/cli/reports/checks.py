"""The checks of a contact in words: the headline, a table, and a sentence for each that is not fine or notable."""

from __future__ import annotations

from typing import TYPE_CHECKING

from stribeck.checks.check import Checks
from stribeck.cli.exits import say
from stribeck.cli.reports.printing import print_table, table_of

if TYPE_CHECKING:
    from rich.console import Console

__all__ = ["print_checks"]

VERDICT_STYLES = {"fine": "green", "doubtful": "yellow", "outside": "bold red"}  # Colours of the verdicts.


def print_checks(console: Console, checks: Checks, title: str) -> None:
    """Print whether the model applies and why."""
    say(console, checks.headline, VERDICT_STYLES[checks.verdict])
    if title:
        say(console, title, "bold")
    table = table_of("check", "value", "fine", "verdict", right=(1, 2))
    for each in checks:
        value, limit = each.texts
        table.add_row(
            each.name, value, limit, each.verdict, style=None if each.verdict == "fine" else VERDICT_STYLES[each.verdict]
        )
    print_table(console, table)
    for each in checks.said:
        say(console, f"{each.word}: {each.sentence}")
    for sentence in checks.unchecked:
        say(console, f"Not checked: {sentence}")
