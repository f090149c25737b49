"""A check, and all checks of a contact together."""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Annotated, Any, Literal

from stribeck.files.results import Exported, Labelled, Record, columns_of_records
from stribeck.quantities.formats import format_si
from stribeck.quantities.results import Card, Told
from stribeck.quantities.units import DIMENSIONS, listed

Verdict = Literal["fine", "doubtful", "outside"]

VERDICTS: tuple[Verdict, ...] = ("fine", "doubtful", "outside")  # From the best to the worst

OUTSIDE = "Outside the range of the model"  # Beginning of the first line of an output if the model does not apply

MIN_STATED_CHANGE = 0.005  # Smallest relative change that a sentence names

MIN_HEADLINE_ERROR = 0.05  # Smallest error that the headline names: about what experiments resolve


@dataclass(frozen=True)
class Check(Record):
    """One check of whether the model applies to a contact."""

    name: Annotated[str, "what is checked", "1"]
    value: Annotated[float, "value for this contact", ""]
    limit: Annotated[float, "largest value that is fine, or smallest if ``at_least``", ""]
    verdict: Annotated[Verdict, "whether the model applies", "1"]
    sentence: Annotated[str, "what the verdict means", "1"]
    unit: Annotated[str, "unit of value and limit; empty for a bare number", "1"] = ""
    at_least: Annotated[bool, "whether larger values than the limit are the fine ones", "1"] = False
    condition: Annotated[str, "what must hold for the model to apply, where the check cannot judge it", "1"] = ""
    error: Annotated[float, "relative error of the result that the check estimates", "1"] = 0.0
    notable: Annotated[bool, "whether outputs print the sentence although the check is fine", "1"] = False

    @property
    def word(self) -> str:
        """The word with which outputs begin its sentence."""
        return "Note" if self.verdict == "fine" else self.verdict.capitalize()

    @property
    def of_law(self) -> bool:
        """Whether it is about the contact law, which another one may mend, and not about the model."""
        return "contact law" in self.name

    @property
    def texts(self) -> tuple[str, str]:
        """Value, and which values are fine, with their unit, for tables."""
        limit = f"{'from' if self.at_least else 'up to'} {number_text(self.limit, self.unit)}"
        return number_text(self.value, self.unit), "always" if self.limit == math.inf else limit


@dataclass(frozen=True, repr=False)
class Checks(Exported, Told):
    """The checks of one contact; its dataset has them along ``check``."""

    _picture = "stribeck.plot.rows.plot_checks"

    checks: Annotated[tuple[Check, ...], "those that could be made, in the order of the table"]
    unsolved: Annotated[tuple[str, ...], "what could not be checked, and why, one sentence each"] = ()
    missing: Annotated[
        Mapping[str, str],
        "by name of a check, the fact that must be given for it",
    ] = field(default_factory=dict)

    def __iter__(self) -> Iterator[Check]:
        """Iterate over the checks."""
        return iter(self.checks)

    def __len__(self) -> int:
        """Return their number."""
        return len(self.checks)

    def __getitem__(self, name: str) -> Check:
        """Return the check of a name."""
        for each in self.checks:
            if each.name == name:
                return each
        raise KeyError(f"{name!r}; there are {', '.join(each.name for each in self.checks)}")

    @property
    def verdict(self) -> Verdict:
        """The worst verdict of all."""
        return max((each.verdict for each in self.checks), key=VERDICTS.index, default="fine")

    @property
    def applies(self) -> bool:
        """Whether the model applies, with the contact law that it has: no check is outside."""
        return self.verdict != "outside"

    @property
    def applies_with_another_law(self) -> bool:
        """Whether the model applies, but with another contact law."""
        outside = self.with_verdict("outside")
        return bool(outside) and all(each.of_law for each in outside)

    def with_verdict(self, verdict: Verdict) -> tuple[Check, ...]:
        """Return the checks of one verdict.

        Parameters
        ----------
        verdict : {"fine", "doubtful", "outside"}
            Which.

        Returns
        -------
        tuple of Check
            Those checks, in the order of the table.
        """
        return tuple(each for each in self.checks if each.verdict == verdict)

    @property
    def said(self) -> tuple[Check, ...]:
        """The checks whose sentences outputs print: the worst first, then the fine ones that are notable."""
        notable = (each for each in self.with_verdict("fine") if each.notable)
        return (*self.with_verdict("outside"), *self.with_verdict("doubtful"), *notable)

    @property
    def unchecked(self) -> tuple[str, ...]:
        """What could not be checked, and what is missing for it, in sentences."""
        facts = [f"{name} (give {fact})" for name, fact in self.missing.items()]
        return (*self.unsolved, *([f"{', '.join(facts)}."] if facts else []))

    @property
    def _conditions(self) -> list[str]:
        """What must hold for the model to apply, and is not known."""
        return [each.condition for each in self.with_verdict("doubtful") if each.condition]

    @property
    def _applies(self) -> str:
        """The beginning of a sentence that says how the model applies."""
        law = ", with another law" if self.applies_with_another_law else ""
        conditions = f"{' and' if law else ''} if {' and '.join(self._conditions)}" if self._conditions else ""
        return f"The model applies{law}{conditions}"

    @property
    def headline(self) -> str:
        """One sentence: whether the model applies, and which checks fail."""
        outside, doubtful = self.with_verdict("outside"), self.with_verdict("doubtful")
        doubts = [each for each in doubtful if not each.condition or outside and not self.applies_with_another_law]
        doubts_text = f" Doubtful: {_names(doubts)}." if doubts else ""
        largest = max((each for each in self.checks), key=lambda each: each.error, default=None)
        stated = largest is not None and largest.error >= MIN_HEADLINE_ERROR and largest.verdict == "fine"
        error = f" Largest error stated: {100 * largest.error:.0f} % ({largest.name})." if largest and stated else ""
        if self.applies_with_another_law:
            return f"{self._applies}: the present one is outside its range ({_names(outside)}).{doubts_text}{error}"
        if outside:
            return f"{OUTSIDE}: {_names(outside)}.{doubts_text}"
        if self._conditions:
            return f"{self._applies}.{doubts_text}{error}"
        if doubtful:
            return f"The model applies, with doubts about {_names(doubtful)}.{error}"
        return f"The model applies: all {len(self.checks)} checks are fine.{error}"

    @property
    def first_line(self) -> str:
        """Line that outputs print before any number: what is outside, on what the model depends, which input is unusual."""
        outside = self.with_verdict("outside")
        unusual = [each.sentence for each in self.with_verdict("doubtful") if each.name == "inputs"]
        begin = self._applies if self.applies_with_another_law else OUTSIDE
        sentences = [f"{begin}: {' '.join(each.sentence for each in outside)}"] if outside else []
        if self._conditions and not outside:
            sentences = [f"{self._applies}."]
        return " ".join([*sentences, *unusual])

    def covers(self, note: str, *, doubts: bool = False) -> bool:
        """Return whether the first line already contains a note, apart from its numbers.

        Parameters
        ----------
        note : str
            A note of a solution, a curve or a fit.
        doubts : bool
            Whether the sentences of doubtful checks count too.

        Returns
        -------
        bool
            Whether to omit it below that line.
        """
        said = (*self.with_verdict("outside"), *(self.with_verdict("doubtful") if doubts else ()))
        sentences = [_without_numbers(each.sentence).rstrip(".") for each in said]
        return any(_without_numbers(note)[: len(text)] in text for text in sentences)

    def to_dict(self) -> dict[str, Any]:
        """Return verdict and checks, ready for JSON."""
        return {"applies": self.applies, "checks": self.checks}

    def _labelled(self) -> Labelled:
        columns = columns_of_records("check", self.checks, Check._labels)
        names = {"check": columns.pop("name")}
        return columns, names, {"title": "Whether the model applies", "headline": self.headline}

    def _card(self) -> Card:
        rows = [("check", "value", "fine", "verdict"), *((each.name, *each.texts, each.verdict) for each in self.checks)]
        sentences = [f"{each.word}: {each.sentence}" for each in self.said]
        sentences += [f"Not checked: {each}" for each in self.unchecked]
        return Card(self.headline, table=rows, right=(1, 2), sentences=sentences)

    __repr__ = Told.__str__


def verdict_of(value: float, fine: float, outside: float = math.inf) -> Verdict:
    """Return the verdict on a value that is fine up to one bound and outside beyond another, which may be the lower one."""
    if outside < fine:
        value, fine, outside = -value, -fine, -outside
    if value <= fine:
        return "fine"
    return "doubtful" if value <= outside else "outside"


def check_against_limits(
    name: str, value: float, fine: float, outside: float, begin: str, meanings: Mapping[Verdict, str], unit: str = ""
) -> Check:
    """Return the check of a number that is fine up to one bound and outside beyond another, with what each verdict means."""
    verdict = verdict_of(value, fine, outside)
    return Check(name, value, fine, verdict, begin + meanings[verdict], unit, at_least=outside < fine)


def number_text(value: float, unit: str) -> str:
    """Return a number with three digits, and its unit with a fitting prefix."""
    kind = next((name for name, each in DIMENSIONS.items() if unit and each.unit == unit), None)
    if kind is None or not math.isfinite(value):
        return f"{value:.3g} {unit}".rstrip()
    return format_si(value, kind)


def _without_numbers(text: str) -> str:
    """Return a sentence without the numbers in it, which differ from state to state."""
    return re.sub(r"[-+]?[0-9][-+.0-9e]*", "", text)


def _names(checks: Sequence[Check]) -> str:
    return listed(each.name for each in checks)
