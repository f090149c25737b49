"""A curve as a function: observables, friction and their errors at any of its values."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from stribeck._types import Array
from stribeck.contacts.friction import Definition
from stribeck.quantities.outputs import ALL_NAMES
from stribeck.solver.series.line_path import POSITION
from stribeck.solver.solve import minimum_estimate

__all__ = ["CurveValues"]


@dataclass(frozen=True, eq=False)
class CurveValues:
    """What a curve is at one of its values, or at many.

    Attributes
    ----------
    value : float or ndarray
        What the curve runs over: the group [-], or SI units where the curve has a contact.
    values : dict
        Observables by name, such as ``central_gap``; they are attributes too, in Hertz units and for beta = 1.
    relative_errors : ndarray
        Estimated relative errors of the observables, by name in :attr:`errors`.
    minimum_position_error : float or ndarray
        Estimated absolute error of the position of the minimum gap [a].
    friction_contact, friction_viscous, friction : float or ndarray
        Friction coefficient and its two parts [-].
    friction_error : float or ndarray
        Estimated absolute error of the friction coefficient [-].
    """

    value: Any
    values: dict[str, Any]
    relative_errors: Array = field(repr=False)
    minimum_position_error: Any = field(repr=False)
    friction_contact: Any
    friction_viscous: Any
    friction: Any
    friction_error: Any

    @classmethod
    def of(
        cls,
        value: Array,
        found: Array,
        errors: Array,
        boundary_friction: float,
        beta: float,
        definition: Definition,
        rtol: float,
    ) -> CurveValues:
        """Return the values that rows of a path are; numbers where ``value`` is one.

        Parameters
        ----------
        value : ndarray
            What the curve runs over.
        found, errors : ndarray, shape (n, observables)
            Of a path.
        boundary_friction, beta : float
            Coefficients of the friction.
        definition : {"balanced", "published"}
            Of the viscous friction.
        rtol : float
            Tolerance of the curve.

        Returns
        -------
        CurveValues
            The values.
        """
        relative = np.maximum(errors[:, :POSITION], minimum_estimate(rtol))
        shown = (lambda column: column) if np.ndim(value) else (lambda column: float(column[0]))
        values = {name: shown(found[:, i]) for i, name in enumerate((*ALL_NAMES, "minimum_position"))}
        nothing = np.nan
        plain = cls(
            value if np.ndim(value) else float(value),
            values,
            relative if np.ndim(value) else relative[0],
            shown(errors[:, POSITION]),
            *(nothing, nothing, nothing, nothing),
        )
        return plain.with_friction(boundary_friction, beta, definition)

    def with_friction(self, boundary_friction: float, beta: float, definition: Definition) -> CurveValues:
        """Return the values with the friction by other coefficients.

        Parameters
        ----------
        boundary_friction, beta : float
            Coefficients of the friction.
        definition : {"balanced", "published"}
            Of the viscous friction.

        Returns
        -------
        CurveValues
            The values.
        """
        name = f"viscous_{definition}"
        contact, viscous = boundary_friction * self.values["contact_load_share"], beta * self.values[name]
        error = boundary_friction * self.errors["contact_load_share"] + np.abs(viscous) * self.errors[name]
        if not np.ndim(self.value):
            error = float(error)
        return replace(
            self, friction_contact=contact, friction_viscous=viscous, friction=contact + viscous, friction_error=error
        )

    @property
    def errors(self) -> dict[str, Any]:
        """Estimated relative error of each observable; absolute for the load shares."""
        return {name: self.relative_errors[..., i] for i, name in enumerate(ALL_NAMES)}

    def __getattr__(self, name: str) -> Any:
        """Return an observable under its own name."""
        if name != "values" and name in self.values:
            return self.values[name]
        raise AttributeError(f"{type(self).__name__} has no attribute {name!r}")

    def __dir__(self) -> list[str]:
        """Return the names of attributes, observables among them."""
        return [*super().__dir__(), *self.values]
