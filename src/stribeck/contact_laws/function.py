"""Contact law of a user as two functions, which are checked when the law is made: values, fall and derivative."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from stribeck._types import Array
from stribeck.quantities.units import InputError, show

__all__ = ["FunctionLaw"]

SLOPE_TOLERANCE = 1e-5
"""Relative difference between a function's derivative and the differences of its values that is refused."""


TAKEN = ("exponential", "persson", "greenwood-williamson", "greenwood-tripp", "table", "smooth")
"""Names by which files and reports know other laws."""


@dataclass(frozen=True)
class FunctionLaw:
    r"""Contact law given by two functions: ln(Phi) and its derivative.

    .. math:: p_c = \beta E^* \exp[f(s)], \qquad s = \alpha h/h_\mathrm{rms}

    Parameters
    ----------
    log_pressure : callable
        f: takes an array of separations, returns ln(Phi) at each.
    log_slope : callable
        df/ds, likewise, negative.
    name : str
        What outputs call the law; not the name of one of the package's.
    lowest : float
        Separation down to which the functions have values: zero, or minus infinity for functions that go on below.
    checked : tuple of float
        Separations between which they are checked, on 400 points that are dense at the lower end.

    Raises
    ------
    InputError
        If the functions return something else than finite numbers of the same shape, if f does not fall, if its
        differences are not its derivative within 1e-5, or if the name is taken.
    """

    log_pressure: Callable[[Array], Array]
    log_slope: Callable[[Array], Array]
    name: str = "function"
    lowest: float = 0.0
    checked: tuple[float, float] = field(default=(1e-3, 100.0), repr=False)

    def __post_init__(self) -> None:
        """Check the functions."""
        if not isinstance(self.name, str) or not self.name or self.name in TAKEN:
            raise InputError(f"name = {show(self.name)} must be a word other than {', '.join(TAKEN)}, which are other laws.")
        for name, function in (("log_pressure", self.log_pressure), ("log_slope", self.log_slope)):
            if not callable(function):
                raise InputError(f"{name} = {show(function)} must be a function of an array of separations.")
        try:
            low, high = map(float, self.checked)
            in_order = self.lowest <= 0.0 < low < high < math.inf
        except (TypeError, ValueError):
            in_order = False
        if not in_order:
            raise InputError(
                f"lowest = {show(self.lowest)}, checked = {show(self.checked)}; lowest must be 0 or below, "
                "checked two increasing positive separations."
            )
        s = np.geomspace(low, high, 400)
        values, slopes = _values("log_pressure", self.log_pressure, s), _values("log_slope", self.log_slope, s)
        _refuse("log_slope", slopes, slopes >= 0, s, "it must be negative everywhere")
        step = 1e-5 * s
        ahead, behind = (_values("log_pressure", self.log_pressure, s + sign * step) for sign in (1, -1))
        wrong = (
            np.abs((ahead - behind) / (2 * step) - slopes) > SLOPE_TOLERANCE * np.abs(slopes) + 1e-10 * np.abs(values) / step
        )
        _refuse("log_slope", slopes, wrong, s, "it must be the derivative of log_pressure, but finite differences disagree")

    @property
    def parameters(self) -> dict[str, float | str]:
        """None: a function has no parameters to print."""
        return {}

    def notes(self, separation: float) -> tuple[str, ...]:
        """Return what to know about a state.

        Parameters
        ----------
        separation : float
            Its minimum separation [-].

        Returns
        -------
        tuple of str
            One sentence each.
        """
        if separation >= self.checked[0]:
            return ()
        return (f"The minimum separation is {separation:.2g}, below the range in which the contact law was checked.",)


def _values(name: str, function: Callable[[Array], Array], s: Array) -> Array:
    with np.errstate(all="ignore"):
        found = function(s)
    try:
        values = np.asarray(found, dtype=float)
    except (TypeError, ValueError):
        values = np.empty(0)
    if values.shape != s.shape:
        raise InputError(f"{name} must return a number for each separation of an array; it returned {show(found)}.")
    _refuse(name, values, ~np.isfinite(values), s, "it must be finite")
    return values


def _refuse(name: str, values: Array, wrong: Any, s: Array, what: str) -> None:
    if wrong.any():
        i = int(np.argmax(wrong))
        raise InputError(f"{name} is {values[i]:.6g} at separation {s[i]:.6g}; {what}.")
