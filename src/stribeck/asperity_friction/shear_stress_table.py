"""Friction of asperities as a measured shear stress over speed times their real area of contact."""

from dataclasses import replace
from typing import ClassVar, Self

import numpy as np

from stribeck.asperity_friction.shear_stress import OF_STRESS, OverArea
from stribeck.quantities.docstrings import told
from stribeck.quantities.schema import Series, law
from stribeck.quantities.units import InputError


@law
class ShearStressTable(OverArea):
    r"""A shear stress of the real contacts that was measured at several sliding speeds.

    .. math:: F_c = \tau(v) A, \qquad \ln\tau \text{ a straight line in } \ln v \text{ between the speeds}

    Outside the speeds of the table it is refused.  Contact laws that do not know the real area A are refused too.

    Raises
    ------
    InputError
        Where speeds do not rise, or stresses are not as many.

    Notes
    -----
    The table is exact at its speeds; between them it errs as the straight line does, which the table cannot tell.

    Source: the user's measurement.

    Examples
    --------
    >>> table = ShearStressTable(["1 um/s", "1 mm/s"], ["0.1 MPa", "0.3 MPa"])
    >>> round(table.stress(1e-3))
    300000
    """

    name: ClassVar[str] = "shear-stress-table"
    label: ClassVar[str] = "table of shear stress over speed, times real area of contact"

    sliding_speeds: Series = Series(
        label="sliding speeds of the table",
        dimension="speed",
        typical='["1 um/s", "1 mm/s", "1 m/s"]',
    )
    shear_stresses: Series = Series(
        label="shear stresses of the table",
        dimension="pressure",
        typical='["0.1 MPa", "0.2 MPa", "0.3 MPa"]',
    )

    def __post_init__(self) -> None:
        """Refuse a table that is no function."""
        count, others = len(self.sliding_speeds), len(self.shear_stresses)
        if count != others:
            raise InputError(f"sliding_speeds has {count} values and shear_stresses {others}; give a stress for each speed.")
        if count < 2 or not (np.diff(self.sliding_speeds) > 0).all():
            raise InputError("sliding_speeds must be two or more speeds that rise.")

    @property
    def uses_speed(self) -> bool:
        """True: the stress is one of the speed."""
        return True

    @property
    def known_speeds(self) -> tuple[float, float]:
        """First and last speed of the table [m/s]."""
        return self.sliding_speeds[0], self.sliding_speeds[-1]

    @property
    def is_frictionless(self) -> bool:
        """False: stresses of a table are positive."""
        return False

    def scaled(self, by: float) -> Self:
        """Return the table with larger stresses, as :meth:`AsperityFriction.scaled`."""
        return replace(self, shear_stresses=[by * each for each in self.shear_stresses])

    @told(*OF_STRESS, "InputError\n    Outside the speeds of the table.")
    def stress(self, sliding_speed: float) -> float:
        """Return the shear stress at a sliding speed."""
        low, high = self.sliding_speeds[0], self.sliding_speeds[-1]
        # A curve that ends at the last speed of the table may miss it by rounding.
        if not low * (1 - 1e-9) <= sliding_speed <= high * (1 + 1e-9):
            raise InputError(
                f"a sliding speed of {sliding_speed:.4g} m/s is outside the table of shear stresses, {low:g} to {high:g} m/s; "
                "give speeds within it, or extend the table."
            )
        logs = np.interp(np.log(sliding_speed), np.log(self.sliding_speeds), np.log(self.shear_stresses))
        return float(np.exp(logs))
