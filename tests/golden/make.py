"""Make the file of golden values, ``tests/data/golden.json``, with the code of today.

Usage::

    python tests/golden/make.py [--add CASES.jsonl ...] [--kind state ...]

It is the reference by which every later change is judged (``tests/test_golden.py``): run this only when a number changes on
purpose, look at the difference, and say in the commit why.  Without arguments all cases of the file are computed anew, which
takes minutes; ``--kind`` computes those of some kinds alone, and ``--add`` those of files of one case a line, which join the
file.  ``golden/observed.py`` says what a case is.
"""

import argparse
import json
import math
import os
from pathlib import Path

for threads in ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS"):
    os.environ.setdefault(threads, "1")

from observed import KINDS, observed  # noqa: E402

FILE = Path(__file__).parents[1] / "data" / "golden.json"
DIGITS, DIGITS_OF_ERRORS = 12, 3


def rounded(value, digits):
    """Return a number with few digits, None for one that is not finite."""
    return float(f"{value:.{digits - 1}e}") if math.isfinite(value) else None


def compact(found):
    """Return what was observed with numbers as the file holds them; errors are rounded up."""
    values = {}
    for name, (value, error) in found["values"].items():
        error = error * (1 + 10.0 ** (1 - DIGITS_OF_ERRORS))
        values[name] = [rounded(value, DIGITS), rounded(error, DIGITS_OF_ERRORS)]
    return {"words": found["words"], "values": values}


def write(rows):
    """Write the file, a case and what it gives on each line, those of a kind together."""
    order = list(KINDS)
    rows = sorted(rows, key=lambda row: order.index(row["case"]["kind"]))
    lines = ",\n".join(json.dumps(row, separators=(",", ":")) for row in rows)
    new = FILE.with_suffix(".new")
    new.write_text(f"[\n{lines}\n]\n")
    new.replace(FILE)


def main():
    """Compute what is asked for, and write the file after every twenty cases."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--add", nargs="*", type=Path, default=[], metavar="CASES.jsonl")
    parser.add_argument("--kind", nargs="*", choices=KINDS, default=[])
    given = parser.parse_args()
    rows = json.loads(FILE.read_text()) if FILE.exists() else []
    new = [json.loads(line) for path in given.add for line in path.read_text().splitlines()]
    kinds = given.kind or ([] if given.add else list(KINDS))
    at = [i for i, row in enumerate(rows) if row["case"]["kind"] in kinds]
    at += range(len(rows), len(rows) + len(new))
    rows += [{"case": case} for case in new]
    for done, i in enumerate(at, 1):
        rows[i] |= compact(observed(rows[i]["case"]))
        if done % 20 == 0 or done == len(at):
            print(f"{done} of {len(at)} cases")
            write([row for row in rows if "values" in row])


if __name__ == "__main__":
    main()
