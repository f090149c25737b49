"""Propagated errors of a state: medians, intervals, the probability of each regime, and the share of each input."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Any

from stribeck.contacts.contact import Contact
from stribeck.contacts.friction import Definition
from stribeck.contacts.inputs import follows_surface
from stribeck.files.results import Exported, Labelled, Record, columns_of_records, json_of
from stribeck.quantities.formats import format_percent, format_share, format_si
from stribeck.quantities.results import Card, Told
from stribeck.quantities.standard_errors import StandardErrors
from stribeck.quantities.units import DIMENSIONS, listed

# Load shares and friction coefficients below this are smaller than the error of the solver at its default tolerance
MIN_OBSERVABLE = 1e-6

MIN_PROBABILITY = 1e-3  # Probability below which only a few of the 20 000 samples are left

MAX_INPUTS = 3  # Inputs that the sentence of the regimes names; `sources` names all

MIN_NAMED_SHARE = 1e-3  # Smallest share of the variance that is named


@dataclass(frozen=True)
class Spread(Record):
    """The distribution of one number."""

    name: Annotated[str, "quantity", "1"]
    label: Annotated[str, "its label in reports", "1"]
    value: Annotated[float, "value for the inputs as given", ""]
    median: Annotated[float, "median", ""]
    interval_68: Annotated[tuple[float, float], "68 % interval", ""]
    interval_95: Annotated[tuple[float, float], "95 % interval", ""]
    dimension: Annotated[str, "A key of :data:`stribeck.quantities.units.DIMENSIONS`"] = "number"

    _properties = {"unit": ("1", "SI unit")}

    @property
    def unit(self) -> str:
        """SI unit of its numbers; empty for bare ones."""
        return DIMENSIONS[self.dimension].unit

    @property
    def texts(self) -> tuple[str, str]:
        """Value and 95 % interval, with units; numbers that no solver knows as a bound."""
        value, low, high = (
            f"< {MIN_OBSERVABLE:g}"
            if self.dimension == "number" and 0 < end < MIN_OBSERVABLE
            else format_si(end, self.dimension)
            for end in (self.value, *self.interval_95)
        )
        return value, high if low == high else f"{low} to {high}"

    @property
    def text(self) -> str:
        """Value and 95 % interval in one."""
        value, interval = self.texts
        return f"{value} ({interval})"


@dataclass(frozen=True, repr=False)
class Uncertainty(Exported, Told):
    """A state with the propagated errors of its inputs.

    Its dataset has value, median, ends of the intervals and SI unit along ``quantity``.
    """

    _picture = "stribeck.plot.rows.plot_uncertainty"

    contact: Annotated[Contact, "the contact with the inputs as given"]
    errors: Annotated[StandardErrors, "standard error of each uncertain input of the contact over its value"]
    spreads: Annotated[tuple[Spread, ...], "friction, films, load shares and transitions"]
    regimes: Annotated[dict[str, float], "probability of boundary, mixed and hydrodynamic lubrication"]
    contributions: Annotated[
        dict[str, float],
        "share of each input in the variance of ln(friction), by exact derivatives, without what it has in common with those "
        "before it; they sum to one",
    ]
    method: Annotated[str, '``"atlas"`` or ``"solver"``: where the states of the samples come from']
    notes: Annotated[
        tuple[str, ...],
        "where the interval of friction is less sure than 5 % of its width, and why, a sentence each; else empty",
    ] = ()
    definition: Annotated[Definition, "definition of the viscous friction"] = "balanced"

    def __getitem__(self, name: str) -> Spread:
        """Return the spread of a name."""
        for each in self.spreads:
            if each.name == name:
                return each
        raise KeyError(f"{name!r}; there are {', '.join(each.name for each in self.spreads)}")

    @property
    def probabilities(self) -> str:
        """The probability of each regime in words."""
        return ", ".join(f"{name} {format_share(value, MIN_PROBABILITY)}" for name, value in self.regimes.items())

    @property
    def probability_sentence(self) -> str:
        """The same as a sentence, with the inputs whose errors it counts, of many how many."""
        labels = [self.contact.INPUTS.rows[name].label for name in self.errors]
        inputs = listed(labels) if len(labels) <= MAX_INPUTS else f"{len(labels)} inputs"
        counted = f" by the errors of {inputs}" if labels else ""
        return f"Probability of each regime{counted}: {self.probabilities}."

    def to_dict(self) -> dict[str, Any]:
        """Return spreads, probabilities and contributions in SI units, ready for JSON."""
        names = "errors spreads contributions method definition notes"
        return json_of(self, names, correlations=self.errors.nested, regime_probabilities=self.regimes)

    def to_si(self) -> dict[str, float]:
        """Return the values for the inputs as given in SI units, by the name of each quantity."""
        return {each.name: each.value for each in self.spreads}

    def _labelled(self) -> Labelled:
        columns = columns_of_records("quantity", self.spreads, Spread._labels)
        names = {"quantity": columns.pop("name")}
        about = {f"probability_{name}": part for name, part in self.regimes.items()}
        about |= {f"error_{name}": error for name, error in self.errors.items()}
        about |= {f"correlation_{'_'.join(sorted(pair))}": each for pair, each in self.errors.correlations.items()}
        about |= {f"share_{name}": part for name, part in self.contributions.items()}
        title = {"title": "Propagated errors of a state", "method": self.method, "definition": self.definition}
        return columns, names, title | {"notes": "\n".join(self.notes)} | about

    def _card(self) -> Card:
        rows = [("with errors of the inputs", "value", "95 %"), *((each.label, *each.texts) for each in self.spreads)]
        return Card(self.probability_sentence, table=rows, right=(1, 2), sentences=self.sources)

    @property
    def sources(self) -> tuple[str, ...]:
        """What intervals count, the share of each input in the variance of friction, and the notes, a sentence each."""
        labels = self.contact.INPUTS.rows
        exact = (exact_inputs(self.contact, self.errors),) if self.errors else ()
        named = {name: part for name, part in self.contributions.items() if part >= MIN_NAMED_SHARE}
        parts = ", ".join(f"{labels[name].label} {format_percent(part)}" for name, part in named.items())
        return (*exact, *((f"Sources of the variance of friction: {parts}.",) if parts else ()), *self.notes)


def exact_inputs(contact: Contact, errors: StandardErrors) -> str:
    """Return the sentence that says which inputs have an error in intervals, and which count as exact."""
    rows = contact.INPUTS.rows
    known = [row.label for name, row in rows.items() if name in errors]
    exact = [
        row.label
        for name, row in rows.items()
        if name not in errors and getattr(contact, name, None) and not (name == "beta" and follows_surface(contact, errors))
    ]
    together = " with their correlations" if errors.correlations else " as independent" if len(known) > 1 else ""
    counted = f"Intervals count the errors of {listed(known)}{together}"
    return f"{counted}; {listed(exact)} count{'s' if len(exact) == 1 else ''} as exact." if exact else f"{counted}."
