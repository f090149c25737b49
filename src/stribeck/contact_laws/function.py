"""Contact law of a user as a function, which is checked when the law is made: values, fall and derivative."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Annotated, Any

from stribeck._types import Array
from stribeck.contact_laws.law import check_falls
from stribeck.numerics.trace import pointwise
from stribeck.quantities.docstrings import Described
from stribeck.quantities.units import InputError, show

# Names that outputs use for the laws of the package and for smooth surfaces.
RESERVED_NAMES = ("exponential", "persson", "greenwood-williamson", "greenwood-tripp", "table", "smooth")


@dataclass(frozen=True)
class _WithSlope:
    """A function and its derivative as one."""

    value: Callable[[Any], Any]
    slope: Callable[[Array], Array]

    def __call__(self, separation: Any) -> Any:
        """Return the value, with its derivative where the separation has one."""
        return pointwise(lambda s: (self.value(s), self.slope(s)), separation)


@dataclass(frozen=True)
class FunctionLaw(Described, title="Parameters"):
    r"""Contact law given by a function, ln(Phi).

    .. math:: p_c = \beta E^* \exp[f(s)], \qquad s = \alpha h/h_\mathrm{rms}

    Raises
    ------
    InputError
        If the functions return something else than finite numbers of the same shape, if f does not fall, if its
        differences are not its derivative within 1e-5, or if the name is taken.
    """

    log_pressure: Annotated[
        Callable[[Any], Any],
        "the function f: it takes an array of separations and returns ln(Phi) at each, falling; written with functions of "
        "numpy it brings its derivative",
    ]
    log_slope: Annotated[
        Callable[[Array], Array] | None, "its derivative df/ds, likewise, for a function that is not, as an interpolation"
    ] = None
    name: Annotated[str, "what outputs call the law; not the name of one of the package's"] = "function"
    lowest: Annotated[
        float, "separation down to which the functions have values: zero, or minus infinity for functions that go on below"
    ] = 0.0
    checked: Annotated[
        tuple[float, float],
        "separations between which they are checked, on 400 points that are dense at the lower end",
    ] = field(default=(1e-3, 100.0), repr=False)

    def __post_init__(self) -> None:
        """Check the functions."""
        if not isinstance(self.name, str) or not self.name or self.name in RESERVED_NAMES:
            raise InputError(
                f"name = {show(self.name)} must be a word other than {', '.join(RESERVED_NAMES)}, which are other laws."
            )
        for name, function in (("log_pressure", self.log_pressure), ("log_slope", self.log_slope)):
            if not (callable(function) or (function is None and name == "log_slope")):
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
        if self.log_slope is not None:
            object.__setattr__(self, "log_pressure", _WithSlope(self.log_pressure, self.log_slope))
        check_falls(self.log_pressure, low, high)

    @property
    def parameters(self) -> dict[str, float | str]:
        """None: a function has no parameters to print."""
        return {}

    def notes(self, separation: float) -> tuple[str, ...]:
        """Return what to know about a state."""
        if separation >= self.checked[0]:
            return ()
        return (f"The minimum separation is {separation:.2g}, below the range in which the contact law was checked.",)
