"""Write the list of docs/cli.md: each command with its page.

``python docs/commands.py`` rewrites the list between the marks of the page; ``tests/test_docs.py`` compares them.
"""

import re
from pathlib import Path

from stribeck.cli.running import COMMANDS

PAGE = Path(__file__).parent / "cli.md"
MARKED = re.compile(r"(<!-- commands -->\n\n).*?(\n<!-- end of commands -->)", re.DOTALL)

READ_MORE = {
    "new": "data_sheet.md",
    "check": "checks.md",
    "solve": "#a-state-and-a-curve",
    "curve": "#a-state-and-a-curve",
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


def with_table(text):
    """Return the text of the page with the commands of now, each with a link to its page."""
    shown = [f"[`{name}`]({READ_MORE[name]})" for name in COMMANDS]
    text, count = MARKED.subn(lambda found: found[1] + ",\n".join(shown) + ".\n" + found[2], text)
    if count != 1:
        raise ValueError(f"{PAGE.name} has {count} places for the list of commands")
    return text


if __name__ == "__main__":
    PAGE.write_text(with_table(PAGE.read_text()))
