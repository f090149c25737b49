"""Data files and the case among the words of a command that fits."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from stribeck.quantities.units import InputError

if TYPE_CHECKING:
    from stribeck.cases.case import Case

ENDING = ".toml"  # Of case files


def read_arguments(command: str, files: Sequence[Path]) -> tuple[list[Path], Case]:
    """Return the data files and the case that a command was given, which may stand in any order."""
    # Imported here, so that other commands need not load fits.
    from stribeck.cases.reading import load_case
    from stribeck.files.toml import read_toml
    from stribeck.fits.reading import files_of, missing_text

    example = f"stribeck {command} measured.csv case.toml"
    if not files:
        raise InputError(f"DATA is missing, and CASE too; give files of measured friction and the case, as in: {example}.")
    found = files_of(files)
    cases = [path for path in found if path.suffix.lower() == ENDING]
    data = [path for path in found if path.suffix.lower() != ENDING]
    listed = " and ".join(map(str, found))
    if not cases:
        raise InputError(
            f"CASE is missing: {listed} {'are' if len(data) > 1 else 'is'} taken for data, as the name of a case ends in "
            f"{ENDING}; give it as in: {example}. To write one: stribeck new case.toml."
        )
    for path in cases:
        read_toml(path)  # which says what is wrong with one
    if not data:
        what = "are case files" if len(cases) > 1 else "is a case file"
        raise InputError(f"DATA is missing: {listed} {what}; give files of measured friction too, as in: {example}.")
    if len(cases) > 1:
        several = " and ".join(map(str, cases))
        raise InputError(f"{several} are case files; {command} takes one of them, with any number of data files.")
    for path in found:
        if not path.exists():
            raise InputError(missing_text(path))
    return data, load_case(cases[0])
