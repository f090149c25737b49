"""Errors of inputs, and how these go together: two that follow from one hardness, or from one fit."""

from __future__ import annotations

import math
from collections.abc import Mapping
from itertools import combinations
from typing import Any

import numpy as np

from stribeck._types import Array
from stribeck.quantities.keywords import known_names
from stribeck.quantities.units import InputError, checked_kind, show

INTERVAL_95 = 1.959964  # Half of the 95 % interval of a normal distribution, in standard errors

# Of two numbers that are proportional, less what keeps the matrix positive definite
PROPORTIONAL_CORRELATION = 1 - 1e-9


class StandardErrors(dict[str, Any]):
    """Standard errors of inputs by name, those of a case or a fit, with their correlations.

    It is a dictionary; ``errors | others`` takes others in the place of those of the same name.

    Parameters
    ----------
    errors : mapping
        Error of each input, a number over its value or text, such as ``"20 %"``.
    correlations : mapping, optional
        Correlation of the logarithms of two inputs, between -1 and 1, by one name and then the other:
        ``{"beta": {"roughness": -0.9}}``.  Inputs that are not named together are independent.

    Raises
    ------
    InputError
        If one is not between -1 and 1 or names an input without an error, or if they contradict one another.

    Examples
    --------
    >>> import stribeck as sb
    >>> errors = sb.results.StandardErrors({"beta": 0.2, "roughness": 0.1}, {"beta": {"roughness": -0.9}})
    >>> errors | {"load": 0.05}
    {'beta': 0.2, 'roughness': 0.1, 'load': 0.05}
    """

    def __init__(
        self, errors: Mapping[str, Any] | None = None, correlations: Mapping[str, Mapping[str, float]] | None = None
    ) -> None:
        super().__init__(errors or {})
        self.correlations: dict[frozenset[str], float] = {}  # By the two inputs
        if correlations is None:
            correlations = getattr(errors, "nested", {})
        table = "a table, such as { roughness = -0.9 }"
        for first, others in checked_kind("correlations", correlations, Mapping, "a table").items():
            for name in (first, *checked_kind(first, others, Mapping, table)):
                if name not in self:
                    raise InputError(f"{show(name)} has no error that could be correlated; {known_names(name, self)}")
            for second, value in others.items():
                if isinstance(value, bool) or not isinstance(value, int | float) or not -1 < value < 1 or first == second:
                    raise InputError(f"{first} and {second} = {show(value)}; it must be between -1 and 1, of two inputs.")
                if self.correlations.setdefault(frozenset((first, second)), float(value)) != value:
                    raise InputError(f"{first} and {second} have two correlations; give one, in one order or the other.")
        try:
            np.linalg.cholesky(self.matrix)
        except np.linalg.LinAlgError:
            raise InputError(f"{show(self.nested)} contradict one another; check their signs and digits.") from None

    def __eq__(self, other: object) -> bool:
        """Return whether errors are the same, and their correlations, which a dictionary of others leaves open."""
        return dict(self) == other and getattr(other, "nested", self.nested) == self.nested

    def __ne__(self, other: object) -> bool:
        """Return whether they differ."""
        return not self == other

    def __or__(self, other: Mapping[str, Any]) -> StandardErrors:  # type: ignore[override]
        """Return these errors and others, which are independent of these."""
        found = StandardErrors({**self, **other})
        kept = {pair: each for pair, each in self.correlations.items() if pair.isdisjoint(other)}
        found.correlations = kept | getattr(other, "correlations", {})
        return found

    __ior__ = __or__  # type: ignore[assignment]

    def __ror__(self, other: Mapping[str, Any]) -> StandardErrors:  # type: ignore[override]
        """Return others with these errors in their place."""
        return StandardErrors(other) | self

    def copy(self) -> StandardErrors:
        """Return the same errors with their correlations.

        Returns
        -------
        StandardErrors
            Errors that may be changed without these.
        """
        return StandardErrors(self)

    @property
    def nested(self) -> dict[str, dict[str, float]]:
        """The correlations as they are given."""
        found: dict[str, dict[str, float]] = {}
        for pair, each in self.correlations.items():
            if pair <= self.keys():  # an error may have been taken out
                first, second = sorted(pair)
                found.setdefault(first, {})[second] = each
        return found

    @property
    def matrix(self) -> Array:
        """The correlations of all errors, in their order."""
        found, place = np.eye(len(self)), {name: k for k, name in enumerate(self)}
        for pair, each in self.correlations.items():
            i, j = (place[name] for name in pair)
            found[i, j] = found[j, i] = each
        return found


def with_proportional(errors: StandardErrors, name: str, to: str) -> StandardErrors:
    """Return errors with that of a number that is proportional to another, in the place of its own if it has one."""
    found = errors | {name: errors[to]}
    others = {each: r for pair, r in errors.correlations.items() if to in pair for each in pair - {name, to}}
    found.correlations |= {frozenset((name, each)): PROPORTIONAL_CORRELATION * r for each, r in others.items()}
    found.correlations[frozenset((name, to))] = PROPORTIONAL_CORRELATION
    return found


def errors_of_sources(sources: Mapping[str, Mapping[str, float]]) -> StandardErrors:
    """Return errors by what each independent source brings, with its sign; some share a source."""
    total = {name: math.hypot(*each.values()) for name, each in sources.items()}
    found: dict[str, dict[str, float]] = {}
    for first, second in combinations(sources, 2):
        if shared := sources[first].keys() & sources[second].keys():
            product = sum(sources[first][each] * sources[second][each] for each in shared)
            found.setdefault(first, {})[second] = product / (total[first] * total[second])
    return StandardErrors(total, found)


def correlation_table(errors: StandardErrors) -> list[str]:
    """Return the lines of the correlations in a case file; none where there are none."""
    rows = (
        (name, ", ".join(f"{other} = {each:.12g}" for other, each in others.items())) for name, others in errors.nested.items()
    )
    return ["", "[correlations]", *(f"{name} = {{ {others} }}" for name, others in rows)] if errors.correlations else []
