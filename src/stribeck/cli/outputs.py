"""What a command prints and writes: text or JSON, a picture, files of data and cases."""

from __future__ import annotations

import json
import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

from cyclopts import Parameter

from stribeck.cli.exits import EXIT_BAD_INPUT, complain, show
from stribeck.files.writing import check_writable, need_extra
from stribeck.quantities.units import InputError

if TYPE_CHECKING:
    from stribeck.cases.case import Case
    from stribeck.checks.check import Checks


def answer(
    as_json: bool,
    content: Callable[[], dict[str, Any]],
    lines: Callable[[], Iterable[str]],
    checks: Checks | None = None,
    case: Case | None = None,
    written: Iterable[str] = (),
) -> None:
    """Print what a command found, as JSON with checks and conversions, or as text with the files that were written."""
    if not as_json:
        show([*lines(), *(f"Written: {path}" for path in written)])
        return
    found = (checks.to_dict() if checks is not None else {}) | content()
    found |= {"conversions": list(case.conversions)} if case is not None and case.conversions else {}
    print(json.dumps(_plain(found), indent=2, ensure_ascii=False, allow_nan=False))


def _plain(content: Any) -> Any:
    """Return content for JSON; what is not finite becomes null, as JSON knows no nan."""
    if isinstance(content, dict):
        return {name: _plain(value) for name, value in content.items()}
    if hasattr(content, "tolist"):  # of arrays
        return _plain(content.tolist())
    if isinstance(content, list | tuple):
        return [_plain(value) for value in content]
    if isinstance(content, float) and not math.isfinite(content):
        return None
    return content


@Parameter(name="*")
@dataclass(frozen=True)
class Outputs:
    """What is printed and written of a result.

    Parameters
    ----------
    plot
        Picture to write: .png, .svg or .pdf.
    json
        Print JSON.
    force
        Replace files that are there.
    no_notes
        Draw without the notes below the picture.
    """

    plot: Path | None = None
    json: bool = False
    force: bool = False
    no_notes: bool = False

    def check(self, case: Path | None = None, data: Sequence[Path] = ()) -> None:
        """Refuse a picture, a case and files of data that could not be written, before the work whose results they are for."""
        from stribeck.files.datasets import check_export
        from stribeck.plot.style import PICTURE_ENDINGS

        for path in data:
            check_export(path, force=self.force)
        if self.plot is not None:
            check_writable(self.plot, PICTURE_ENDINGS, force=self.force)
            need_extra("a picture", "plot", "matplotlib")
        if case is not None:
            check_writable(case, (".toml",), force=self.force)
        paths = [*data, *filter(None, (self.plot, case))]
        for i, path in enumerate(paths):
            if path.resolve() in [each.resolve() for each in paths[:i]]:
                raise InputError(f"{path} is given twice as an output; give each output its own name.")

    def write(
        self,
        found: Any,
        title: str = "",
        data: Sequence[Path] = (),
        others: Mapping[Path, Callable[[], object]] | None = None,
        **drawing: Any,
    ) -> tuple[list[str], list[str]]:
        """Write files of a result; return the names of those that were written, and a sentence about each that was not."""
        from stribeck.files.datasets import write_data

        titled = {"title": title} if title else {}
        noted = {"notes": False} if self.no_notes else {}
        actions: dict[Path, Callable[[], object]] = {}
        if data:
            dataset = found.to_dataset()
            dataset.attrs |= titled
            actions |= {path: partial(write_data, dataset, path, force=self.force) for path in data}
        if self.plot is not None:
            actions[self.plot] = partial(found.plot, self.plot, force=self.force, **titled, **noted, **drawing)
        written, problems = [], []
        for path, action in (actions | dict(others or {})).items():
            try:
                action()
            except InputError as problem:
                problems.append(str(problem))
            else:
                written.append(str(path))
        return written, problems

    def finish(
        self,
        found: Any,
        lines: Callable[[], Iterable[str]],
        title: str = "",
        *,
        content: Callable[[], dict[str, Any]] | None = None,
        data: Sequence[Path] = (),
        others: Mapping[Path, Callable[[], object]] | None = None,
        checks: Checks | None = None,
        case: Case | None = None,
    ) -> int:
        """Write the files of a result, print it, and return the exit code of what could not be written."""
        written, problems = self.write(found, title, data, others)
        made = content or found.to_dict
        answer(self.json, lambda: made() | {"files": written}, lines, checks, case, written)
        return complain("\n".join(problems), EXIT_BAD_INPUT if problems else 0)


OUTPUTS = Outputs()  # Where no option is given
