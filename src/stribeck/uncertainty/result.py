"""Propagated errors of a state: medians, intervals, the probability of each regime, and the share of each input."""

from __future__ import annotations

import html
from collections.abc import Collection
from dataclasses import asdict, dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from stribeck.contacts.contact import Contact
from stribeck.contacts.part_inputs import all_input_rows
from stribeck.files.datasets import Column, listed, new_dataset
from stribeck.files.results import Exported
from stribeck.quantities.formats import format_percent, format_share, format_si
from stribeck.quantities.units import DIMENSIONS

if TYPE_CHECKING:
    import xarray

__all__ = ["Spread", "Uncertainty"]


# Load shares and friction coefficients below this are smaller than the error of the solver at its default tolerance
MIN_OBSERVABLE = 1e-6

MIN_PROBABILITY = 1e-3  # Probability below which only a few of the 20 000 samples are left

MIN_NAMED_SHARE = 1e-3  # Smallest share of the variance that is named


@dataclass(frozen=True)
class Spread:
    """The distribution of one number.

    Attributes
    ----------
    name, label : str
        Its name in a solution, and its label in reports.
    value : float
        Its value for the inputs as given, in SI units.
    median : float
        Its median.
    interval_68, interval_95 : tuple of float
        Intervals that hold it with 68 and 95 % probability.
    dimension : str
        A key of :data:`stribeck.quantities.units.DIMENSIONS`.
    """

    name: str
    label: str
    value: float
    median: float
    interval_68: tuple[float, float]
    interval_95: tuple[float, float]
    dimension: str = "number"

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
class Uncertainty(Exported):
    """A state with the propagated errors of its inputs.

    Attributes
    ----------
    contact : Contact
        The contact with the inputs as given.
    errors : dict of str to float
        Standard error of the logarithm of each uncertain input of the contact.
    spreads : tuple of Spread
        Friction, films, load shares and transitions.
    regimes : dict of str to float
        Probability of boundary, mixed and hydrodynamic lubrication.
    contributions : dict of str to float
        Share of each input in the variance of ln(friction), by exact derivatives; they sum to one. Empty for a model
        without derivatives.
    method : str
        ``"atlas"`` or ``"solver"``: where the states of the samples come from.
    notes : tuple of str
        Where the interval of friction is less sure than 5 % of its width, and why, a sentence each; else empty.
    """

    _picture = "stribeck.plot.uncertainty.plot_uncertainty"

    contact: Contact
    errors: dict[str, float]
    spreads: tuple[Spread, ...]
    regimes: dict[str, float]
    contributions: dict[str, float]
    method: str
    notes: tuple[str, ...] = ()

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

    def to_dict(self) -> dict[str, Any]:
        """Return spreads, probabilities and contributions, ready for JSON.

        Returns
        -------
        dict
            Numbers in SI units under their names.
        """
        return {
            "errors": self.errors,
            "spreads": [asdict(each) for each in self.spreads],
            "regime_probabilities": self.regimes,
            "contributions": self.contributions,
            "method": self.method,
            "notes": list(self.notes),
        }

    def to_si(self) -> dict[str, float]:
        """Return the values for the inputs as given in SI units.

        Returns
        -------
        dict of str to float
            By the name of each quantity.
        """
        return {each.name: each.value for each in self.spreads}

    def to_dataset(self) -> xarray.Dataset:
        """Return the spreads as an xarray Dataset.

        Returns
        -------
        xarray.Dataset
            Along ``quantity``: value, median, ends of the intervals and the SI unit; the probability of each regime, the
            standard error and the share of each input as attributes; needs the extra ``data``.

        Raises
        ------
        MissingExtraError
            If xarray is not installed.
        """
        numbers = {
            "value": ("value for the inputs as given", [each.value for each in self.spreads]),
            "median": ("median", [each.median for each in self.spreads]),
        }
        for percent in (68, 95):
            ends = [getattr(each, f"interval_{percent}") for each in self.spreads]
            for end, name in enumerate(("low", "high")):
                numbers[f"{name}_{percent}"] = (f"{name} end of the {percent} % interval", [each[end] for each in ends])
        columns: dict[str, Column] = {
            name: ("quantity", np.array(values), "SI, see unit", label) for name, (label, values) in numbers.items()
        }
        columns["unit"] = ("quantity", listed([DIMENSIONS[each.dimension].unit for each in self.spreads]), "1", "SI unit")
        names: dict[str, Column] = {"quantity": ("quantity", listed([each.name for each in self.spreads]), "1", "quantity")}
        about = {f"probability_{name}": part for name, part in self.regimes.items()}
        about |= {f"error_{name}": error for name, error in self.errors.items()}
        about |= {f"share_{name}": part for name, part in self.contributions.items()}
        return new_dataset(
            columns,
            names,
            {"title": "Propagated errors of a state", "method": self.method, "notes": "\n".join(self.notes), **about},
        )

    def __str__(self) -> str:
        """Return the table as text."""
        width = max(len(each.label) for each in self.spreads)
        lines = [f"{each.label.ljust(width)}  {each.text}" for each in self.spreads]
        return "\n".join([*lines, f"Regime: {self.probabilities}.", *self.sources])

    __repr__ = __str__

    @property
    def sources(self) -> tuple[str, ...]:
        """What intervals count, the share of each input in the variance of friction, and the notes, a sentence each."""
        labels = all_input_rows(self.contact.INPUTS)
        exact = (exact_inputs(self.contact, self.errors),) if self.errors else ()
        named = {name: part for name, part in self.contributions.items() if part >= MIN_NAMED_SHARE}
        parts = ", ".join(f"{labels[name].label} {format_percent(part)}" for name, part in named.items())
        return (*exact, *((f"Sources of the variance of friction: {parts}.",) if parts else ()), *self.notes)

    def _repr_html_(self) -> str:
        """Return the table for notebooks."""
        rows = "".join(
            f"<tr><td>{html.escape(each.label)}</td><td>{html.escape(each.text)}</td></tr>" for each in self.spreads
        )
        paragraphs = "".join(f"<p>{html.escape(each)}</p>" for each in (self.probabilities, *self.notes))
        return f"<table><tr><th>quantity</th><th>value (95 %)</th></tr>{rows}</table>{paragraphs}"


def exact_inputs(contact: Contact, errors: Collection[str]) -> str:
    """Return the sentence that says which inputs have an error in intervals, and which count as exact."""
    rows = all_input_rows(contact.INPUTS)
    known = [row.label for name, row in rows.items() if name in errors]
    exact = [
        row.label
        for name, row in rows.items()
        if name not in errors and getattr(contact, name, None) and not (name == "beta" and follows_surface(contact, errors))
    ]
    counted = f"Intervals count the errors of {_listed(known)}"
    return f"{counted}; {_listed(exact)} count as exact." if exact else f"{counted}."


def follows_surface(contact: Contact, errors: Collection[str]) -> bool:
    """Return whether beta moves with an uncertain roughness, as under Persson's law."""
    return "roughness" in errors and "beta" not in errors and contact.law is not None and contact.law.name == "persson"


def _listed(names: list[str]) -> str:
    return names[0] if len(names) == 1 else f"{', '.join(names[:-1])} and {names[-1]}"
