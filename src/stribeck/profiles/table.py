r"""A measured or computed shape: from heights at positions, or from its dry pressure.

Inside a dry contact of half-width l about c, with :math:`x = c + l t` and :math:`t = \cos\theta`, the pressure and the slope
of the body that has it are

.. math:: p = \sum_n b_n \sin n\theta, \qquad h_0' = \frac{2}{E^*} \sum_n b_n T_n(t)
"""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, ClassVar

import numpy as np
from numpy.polynomial import chebyshev

from stribeck._types import Array
from stribeck.profiles.shapes import Shape
from stribeck.quantities.lazy import cached_property
from stribeck.quantities.units import InputError, real_array, show, to_si

MIN_POINTS = 4  # Fewest points of a table through which a cubic spline goes
POINTS_PER_TERM = 2  # Points of a pressure for each term of its series


@dataclass(frozen=True, init=False)
class Table(Shape):
    """A shape by its heights at positions, with a cubic spline between them and its tangents beyond.

    Parameters
    ----------
    x : array_like or str, optional
        Positions along the contact, ascending [m]; or the name of a CSV file with a column of positions, ascending or
        descending, and one of heights, both with units in their headings.
    z : array_like, optional
        Heights of the body's surface, whatever they are counted from [m].
    reversed : bool
        Whether the contact moves the other way.

    Raises
    ------
    InputError
        If there are too few points, or they are not ascending or not finite.
    """

    name: ClassVar[str] = "table"
    label: ClassVar[str] = "measured shape"

    x: tuple[float, ...]
    z: tuple[float, ...]
    reversed: bool = False

    def __init__(self, x: Any = None, z: Any = None, reversed: bool = False) -> None:
        if isinstance(x, str | Path):
            if z is not None:
                raise InputError(f"x = {show(x)} names a file, and z is given too; give one of them.")
            x, z = _columns_of(Path(x))
        if x is None or z is None:
            raise InputError("x and z are missing: positions and heights of the shape, or x alone, the name of a CSV file.")
        positions, heights = real_array("x", x), real_array("z", z)
        if positions.ndim != 1 or positions.shape != heights.shape or len(positions) < MIN_POINTS:
            raise InputError(f"a table of a shape needs as many heights as positions, and at least {MIN_POINTS}.")
        if not (np.isfinite(positions).all() and np.isfinite(heights).all() and (np.diff(positions) > 0).all()):
            raise InputError("positions and heights of a shape must be finite, and the positions ascending.")
        for field, value in (("x", tuple(positions.tolist())), ("z", tuple(heights.tolist())), ("reversed", bool(reversed))):
            object.__setattr__(self, field, value)

    def __repr__(self) -> str:
        """Return how many points it has, which a page would not hold."""
        return f"Table({len(self.x)} points from {self.x[0]:g} to {self.x[-1]:g} m{_turned(self)})"

    @property
    def parameters(self) -> Mapping[str, float | str]:
        """How many points it has and where they end."""
        return {"points": float(len(self.x)), "first": self.x[0], "last": self.x[-1]} | dict(super().parameters)

    @property
    def places(self) -> tuple[float, ...]:
        """Both ends, beyond which the shape goes on along its tangents [m]."""
        return self.x[0], self.x[-1]

    @cached_property
    def _spline(self) -> Any:
        from scipy.interpolate import CubicSpline  # slow to import, and most contacts have no such shape

        # From the lowest one: far away every gap goes over into that of a cylinder that touches the same plane.
        return CubicSpline(self.x, np.array(self.z) - min(self.z))

    def gap(self, x: Array) -> Array:
        """Return the gap [m]."""
        inside = np.clip(x, self.x[0], self.x[-1])
        return np.asarray(self._spline(inside) + (x - inside) * self._spline(inside, 1))

    def slope(self, x: Array) -> Array:
        """Return its slope."""
        return np.asarray(self._spline(np.clip(x, self.x[0], self.x[-1]), 1))


@dataclass(frozen=True)
class _OfPressure(Shape):
    """A shape by the series of its dry pressure."""

    label: ClassVar[str] = "shape of a dry pressure"

    centre: float
    half_width: float
    slopes: tuple[float, ...]  # Chebyshev coefficients of its slope
    reversed: bool = False

    def __repr__(self) -> str:
        """Return how many terms its series has, which a page would not hold."""
        first, last = self.places
        return f"<shape {self.name}: {len(self.slopes)} terms from {first:g} to {last:g} m{_turned(self)}>"

    @property
    def name(self) -> str:  # type: ignore[override]
        """The name that outputs print; no name of a law, as no case has its numbers."""
        return "of a dry pressure"

    @property
    def parameters(self) -> Mapping[str, float | str]:
        """Where the pressure was."""
        return {"centre": self.centre, "half_width": self.half_width} | dict(super().parameters)

    @property
    def places(self) -> tuple[float, ...]:
        """Both edges of the contact, beyond which the slope goes on as a straight line [m]."""
        return self.centre - self.half_width, self.centre + self.half_width

    def gap(self, x: Array) -> Array:
        """Return the gap [m]."""
        t, beyond = self._split(x)
        heights, bends = chebyshev.chebint(self.slopes), chebyshev.chebder(self.slopes)
        inside = chebyshev.chebval(t, heights) + beyond * chebyshev.chebval(t, self.slopes)
        return np.asarray(self.half_width * (inside + 0.5 * beyond**2 * chebyshev.chebval(t, bends)))

    def slope(self, x: Array) -> Array:
        """Return its slope."""
        t, beyond = self._split(x)
        bends = chebyshev.chebder(self.slopes)
        return np.asarray(chebyshev.chebval(t, self.slopes) + beyond * chebyshev.chebval(t, bends))

    def _split(self, x: Array) -> tuple[Array, Array]:
        """Return the position in the contact, and the distance from it, in half-widths."""
        t = (np.asarray(x) - self.centre) / self.half_width
        return np.clip(t, -1.0, 1.0), t - np.clip(t, -1.0, 1.0)


def _turned(shape: Any) -> str:
    """Return what to add to the words of a shape that moves the other way."""
    return ", reversed" if shape.reversed else ""


def from_pressure(x: Any, p: Any, modulus: str | float, reversed: bool = False) -> Shape:
    r"""Return the shape that has a dry pressure, such as one from finite elements.

    .. math:: h_0'(x) = \frac{2}{\pi E^*} \, \mathrm{p.v.} \int \frac{p(y)}{x - y} \, dy

    Parameters
    ----------
    x : array_like
        Positions from one edge of the contact to the other, ascending [m].
    p : array_like
        Pressures there, zero at both ends [Pa].
    modulus : str or float
        Effective modulus E* of the half-space on which it acts [Pa].
    reversed : bool
        Whether the contact moves the other way.

    Returns
    -------
    Shape
        The shape; beyond the contact, where no pressure tells of it, its slope goes on as a straight line.

    Raises
    ------
    InputError
        If there are too few points, they are not ascending, or a pressure inside is not positive.

    Notes
    -----
    The pressure is taken for smooth but for the square roots at its edges: it is a series with half as many terms as there
    are points.
    """
    positions, pressures = real_array("x", x), real_array("p", p)
    E_star = to_si(modulus, "pressure", "modulus")
    if positions.ndim != 1 or positions.shape != pressures.shape or len(positions) < MIN_POINTS:
        raise InputError(f"a pressure needs as many values as positions, and at least {MIN_POINTS}.")
    if not ((np.diff(positions) > 0).all() and (pressures[1:-1] > 0).all()):
        raise InputError("the positions of a pressure must be ascending, and all pressures between its edges positive.")
    centre, half = 0.5 * float(positions[0] + positions[-1]), 0.5 * float(positions[-1] - positions[0])
    angles = np.arccos(np.clip((positions[::-1] - centre) / half, -1.0, 1.0))
    terms = np.arange(1, max(MIN_POINTS, len(positions) // POINTS_PER_TERM))
    basis = np.sin(np.outer(angles, terms))
    coefficients, *_ = np.linalg.lstsq(basis, pressures[::-1], rcond=None)
    return _OfPressure(centre, half, (0.0, *(2 / E_star * coefficients).tolist()), reversed)


def _columns_of(path: Path) -> tuple[Array, Array]:
    """Return positions and heights from a file [m]."""
    from stribeck.files.columns import Column, read_columns  # slow to import, and most shapes name no file

    columns = {name: Column(name, "length") for name in ("x", "z")}
    advice = "the first line must be 'x [mm], z [mm]', with the units of the file"
    found = read_columns(path, advice, columns)
    x, z = found.in_si.values()
    way = -1 if x[-1] < x[0] else 1  # -1 where the rows go backwards
    wrong = np.flatnonzero(way * np.diff(x) <= 0)
    if wrong.size:
        i = int(wrong[0])
        raise InputError(
            f"{path}: row {found.rows[i + 1]} has a position of {x[i + 1]:g} m after {x[i]:g} m in row {found.rows[i]}; sort "
            "the rows by x, with one height at each position."
        )
    return x[::way], z[::way]
