"""Contact law of a user as two functions, which are checked when the law is made: values, fall and derivative."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field

from stribeck._types import Array
from stribeck.contact_laws.law import check_slopes
from stribeck.quantities.units import InputError, show

__all__ = ["FunctionLaw"]


# Names that outputs use for the laws of the package and for smooth surfaces.
RESERVED_NAMES = ("exponential", "persson", "greenwood-williamson", "greenwood-tripp", "table", "smooth")


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
        if not isinstance(self.name, str) or not self.name or self.name in RESERVED_NAMES:
            raise InputError(
                f"name = {show(self.name)} must be a word other than {', '.join(RESERVED_NAMES)}, which are other laws."
            )
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
        check_slopes(self.log_pressure, self.log_slope, low, high)

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
