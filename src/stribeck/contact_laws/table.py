"""Contact law of a user as a table of separations and pressures.

The table is checked when the law is made: the pressure must be positive and fall from row to row. It is interpolated in the
logarithm of the pressure, as smoothly as its rows allow.
"""

from __future__ import annotations

import math
import os
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from stribeck._types import Array
from stribeck.contact_laws.law import AsperityLaw
from stribeck.numerics.trace import pointwise
from stribeck.quantities.lazy import cached_property
from stribeck.quantities.units import InputError, RowError, real_array, show

MIN_ROWS = 4  # Least rows of a tabulated law.

HEADERS = "the first line must be 'separation, pressure', or with units such as 'gap [mm], pressure [MPa]'"

# Factor by which the slope between two rows may leave the straight lines around it: a monotone cubic keeps to it, and a
# smoother interpolant is refused where it does not.
MAX_SLOPE_RATIO = 3.0

END_PRESSURE_RATIO = 1e-3  # Pressure at the end of a table over the largest of a state above which the state draws a note.


@dataclass(frozen=True)
class TableLaw(AsperityLaw):
    r"""Contact law interpolated between the rows of a table.

    .. math:: \Phi(s_i) = p_i/(\beta E^*), \qquad s_i = \alpha h_i/h_\mathrm{rms}

    Parameters
    ----------
    separation : array_like, shape (n,)
        Separations, ascending, at least four [-].
    pressure : array_like, shape (n,)
        Pressures there over beta E*, positive and descending [-].
    title : str
        What the table is, for outputs.

    Raises
    ------
    InputError
        If a row is no pair of finite numbers, separations do not ascend, or pressures are not positive and descending; the
        sentence names the row, the first being row 1.

    Notes
    -----
    Between the rows ln(Phi) is a spline of degree five, else three, where it falls everywhere and its slope stays within a
    factor three of the straight lines around it; else the cubic that is monotone piece by piece.  Outside the rows it goes on
    straight, and a solution whose pressure lies there says so in its notes.
    """

    separation: tuple[float, ...]
    pressure: tuple[float, ...]
    title: str = ""

    def __init__(self, separation: ArrayLike, pressure: ArrayLike, title: str = "") -> None:
        s, p = _column("separation", separation), _column("pressure", pressure)
        _check_rows(s, p)
        object.__setattr__(self, "separation", tuple(s))
        object.__setattr__(self, "pressure", tuple(p))
        object.__setattr__(self, "title", str(title))

    @classmethod
    def read(
        cls,
        path: str | os.PathLike[str],
        *,
        alpha: float | None = None,
        beta: float | None = None,
        roughness: float | None = None,
        modulus: float | None = None,
    ) -> TableLaw:
        """Read the table from a CSV file.

        Parameters
        ----------
        path : str or path-like
            A text file with a header, ``separation, pressure`` for numbers without units or, for example,
            ``gap [um], pressure [MPa]``, and a row of two numbers on each line; commas, semicolons or tabs part them.
        alpha, beta, roughness, modulus : float, optional
            Coefficients of the contact, h_rms [m] and E* [Pa], which a table with units needs.

        Returns
        -------
        TableLaw
            The law, its title the name of the file.

        Raises
        ------
        InputError
            If the file cannot be read or is no such table; the sentence names line and column.
        """
        from stribeck.files.columns import Column, read_columns  # slow to import, and most laws have no file

        plain = {"separation": Column("separation", "number"), "pressure": Column("pressure", "number")}
        with_units = {"gap": Column("gap|separation", "length"), "pressure": Column("pressure", "pressure")}
        columns = read_columns(path, HEADERS, with_units, plain)
        s, p = columns.in_si.values()
        if "gap" in columns.in_si:
            needed = {"alpha": alpha, "beta": beta, "roughness": roughness, "modulus": modulus}
            missing = [name for name, value in needed.items() if not value]
            if missing:
                raise InputError(
                    f"{path} has units, so that {' and '.join(missing)} of the contact must be given and positive."
                )
            assert alpha and beta and roughness and modulus
            s, p = s * (alpha / roughness), p / (beta * modulus)
        with columns.named():
            return cls(s, p, title=Path(path).name)

    @property
    def name(self) -> str:
        """The word ``"table"``."""
        return "table"

    @property
    def parameters(self) -> dict[str, float | str]:
        """Title, number of rows and their first and last separation."""
        found: dict[str, float | str] = {"title": self.title} if self.title else {}
        return found | {
            "rows": float(len(self.separation)),
            "first_separation": self.separation[0],
            "last_separation": self.separation[-1],
        }

    @cached_property
    def _spline(self) -> tuple[Any, Any, int]:
        """The interpolant of ln(Phi), its derivative, and its degree."""
        return _interpolant(np.array(self.separation), np.log(np.array(self.pressure)))

    @cached_property
    def _ends(self) -> tuple[float, float, float, float]:
        """First and last separation, and the slopes there."""
        first, last = self.separation[0], self.separation[-1]
        slope = self._spline[1]
        return first, last, float(slope(first)), float(slope(last))

    @property
    def degree(self) -> int:
        """Degree of the interpolant: 5, 3, or 1 for the cubic of which only the slope is continuous."""
        return self._spline[2]

    def log_pressure(self, separation: Any) -> Any:
        """Return ln(Phi) at the separation s."""
        first, last, slope_first, slope_last = self._ends
        spline, slope, _ = self._spline
        inside = np.clip(separation, first, last)
        outside = separation - inside
        found = pointwise(lambda s: (np.asarray(spline(s)), slope(s)), inside)
        return found + np.where(outside < 0, slope_first, slope_last) * outside

    def notes(self, separation: float) -> tuple[str, ...]:
        """Return what to know about a state."""
        first, last = self.separation[0], self.separation[-1]
        found = []
        if separation < first:
            found.append(
                f"The minimum separation is {separation:.3g}, below the first row of the contact law's table, {first:.3g}: "
                "the law is continued there by its tangent."
            )
        largest = float(self.log_pressure(np.array([separation]))[0])
        left = math.exp(min(0.0, math.log(self.pressure[-1]) - largest))
        if left > END_PRESSURE_RATIO:
            found.append(
                f"The last row of the contact law's table, {last:.3g}, still has {100 * left:.2g} % of the largest contact "
                "pressure: beyond it the law is continued by its tangent."
            )
        return tuple(found)


def _column(name: str, values: ArrayLike) -> list[float]:
    found = real_array(name, values)
    if found.ndim != 1:
        raise InputError(f"{name} = {show(values)}; it must be a list of numbers, one for each row of the table.")
    return [float(value) for value in found]


def _check_rows(s: Sequence[float], p: Sequence[float]) -> None:
    """Refuse rows that are no contact law, and name the first."""
    if len(s) != len(p):
        raise InputError(f"separation has {len(s)} rows and pressure {len(p)}; they must have the same length.")
    if len(s) < MIN_ROWS:
        raise InputError(f"the table of the contact law has {len(s)} rows; at least {MIN_ROWS} are needed.")
    for i in range(len(s)):
        problem = ""
        if not (math.isfinite(s[i]) and math.isfinite(p[i])):
            problem = f", {s[i]:g} and {p[i]:g}, is not finite; remove or correct it."
        elif p[i] <= 0:
            problem = f": pressure {p[i]:g} must be positive; end the table where contact ends."
        elif i and s[i] <= s[i - 1]:
            problem = f": separation {s[i]:g} must exceed that of the row before, {s[i - 1]:g}."
        elif i and p[i] >= p[i - 1]:
            problem = f": pressure {p[i]:g} must be below that of the row before, {p[i - 1]:g}."
        if problem:
            raise RowError(f"{{row}}{problem}", i, f"row {i + 1} of the contact law's table")


def _interpolant(s: Array, f: Array) -> tuple[Any, Any, int]:
    """Return the smoothest decreasing interpolant, its derivative, and its degree (1 where only the slope is continuous)."""
    from scipy.interpolate import CubicHermiteSpline, PchipInterpolator, make_interp_spline  # slow to import

    secants = np.diff(f) / np.diff(s)
    around = np.stack([np.append(secants[:1], secants[:-1]), secants, np.append(secants[1:], secants[-1:])])
    low, high = MAX_SLOPE_RATIO * around.min(axis=0), around.max(axis=0) / MAX_SLOPE_RATIO
    parts = np.linspace(0.0, 1.0, 33)
    points = s[:-1] + parts[:, None] * np.diff(s)
    for degree in (5, 3):
        if len(s) > degree:
            spline = make_interp_spline(s, f, k=degree)
            slope = spline.derivative()
            if ((slope(points) >= low) & (slope(points) <= high)).all():
                return spline, slope, degree
    slopes = PchipInterpolator(s, f).derivative()(s)
    for end, secant in ((0, secants[0]), (-1, secants[-1])):
        if slopes[end] >= 0.0:
            slopes[end] = secant
    cubics = CubicHermiteSpline(s, f, slopes)
    return cubics, cubics.derivative(), 1
