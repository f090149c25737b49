"""Write the table of docs/cli.md: each command with what it takes and what it does.

``python docs/commands.py`` rewrites the table between the marks of the page; ``tests/test_docs.py`` compares them.
"""

import inspect
import re
from pathlib import Path

from stribeck.cli.running import COMMANDS

PAGE = Path(__file__).parent / "cli.md"
MARKED = re.compile(r"(<!-- commands -->\n\n).*?(\n<!-- end of commands -->)", re.DOTALL)

READ_MORE = {
    "new": "data_sheet.md",
    "check": "checks.md",
    "regimes": "#what-moves-friction",
    "figures": "figures.md",
    "explore": "explorer.md",
    "sweep": "sweep.md",
    "bench": "bench.md",
    "fit": "fitting.md",
    "next": "fitting.md#what-to-measure-next",
    "master": "fitting.md#one-curve-for-all-fluids-and-loads",
    "compare": "fitting.md#which-contact-law",
    "report": "data_sheet.md#one-page-to-hand-over",
    "experiment": "experiments.md",
    "stroke": "strokes.md#from-a-case-file",
    "loop": "strokes.md#from-a-measured-loop",
    "leak": "leakage.md",
    "surface": "surfaces.md",
}


def row(name, command):
    """Return what a command takes, with a link to its page, and what its help says first, up to its details."""
    words = [name]
    for each in inspect.signature(command).parameters.values():
        if each.kind is not each.KEYWORD_ONLY:
            word = f"{each.name.upper()}{'...' * (each.kind is each.VAR_POSITIONAL or 'list' in str(each.annotation))}"
            words.append(word if each.default is each.empty else f"[{word}]")
    said = re.split("[:;,.\n]", inspect.getdoc(command))[0].replace("|", r"\|")
    shown = f"`{' '.join(words)}`"
    return f"| {f'[{shown}]({READ_MORE[name]})' if name in READ_MORE else shown} | {said} |\n"


def with_table(text):
    """Return the text of the page with the commands of now."""
    head = "| `stribeck` | What it does |\n| --- | --- |\n"
    table = head + "".join(row(name, command) for name, command in COMMANDS.items())
    text, count = MARKED.subn(lambda found: found[1] + table + found[2], text)
    if count != 1:
        raise ValueError(f"{PAGE.name} has {count} places for the table of commands")
    return text


if __name__ == "__main__":
    PAGE.write_text(with_table(PAGE.read_text()))
