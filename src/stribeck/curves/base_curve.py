"""What curves of solved states and curves off the atlas have in common: friction, regimes, minimum and transitions."""

from __future__ import annotations

from abc import abstractmethod
from importlib import import_module
from typing import TYPE_CHECKING, Any, Self

import numpy as np

from stribeck._types import Array
from stribeck.asymptotics.smooth import hydrodynamic
from stribeck.contacts.contact import Contact
from stribeck.contacts.friction import Definition, FrictionArray, check_definition, coefficients
from stribeck.contacts.groups import Groups
from stribeck.contacts.model import BASE_MODEL
from stribeck.curves.coordinate import Over, check_points, given_values
from stribeck.curves.function import CurveValues
from stribeck.curves.landmarks import Landmark
from stribeck.curves.regime import Regime, Transition, check_transition, ranges_of, regimes_along
from stribeck.files.results import Exported
from stribeck.quantities.lazy import cached_property
from stribeck.quantities.outputs import OUTPUT_TABLES
from stribeck.quantities.results import Shown
from stribeck.quantities.units import InputError, show

if TYPE_CHECKING:
    import xarray

__all__ = ["BaseCurve"]

END_ROUNDING = 1e-12  # Relative rounding of the ends of a curve: a value given as the end is inside


class BaseCurve(Exported, Shown):
    """Friction along one coordinate, whatever its states come from."""

    over: Over
    values: Array
    contact: Contact | None
    boundary_friction: float
    beta: float
    definition: Definition

    @property
    @abstractmethod
    def groups(self) -> Groups:
        """Groups of the points, as arrays."""

    @property
    @abstractmethod
    def law_in_doubt(self) -> Array:
        """Whether the contact law is outside its range at each point while asperities matter there."""

    @property
    @abstractmethod
    def _ends(self) -> tuple[float, float]:
        """Values between which the curve is a function."""

    @property
    def observables(self) -> tuple[str, ...]:
        """Names of the observables that the curve has."""
        return tuple(OUTPUT_TABLES[self.groups.geometry].listed)

    @abstractmethod
    def observable(self, name: str) -> Array:
        """Return an observable of every point."""

    @property
    def speed(self) -> Array:
        """Speed of each point [m/s], or its group where the curve has no contact [-]."""
        return self._input("speed")

    @property
    def load(self) -> Array:
        """Load of each point [N/m], of a ball [N], or its group where the curve has no contact [-]."""
        return self._input("load")

    @property
    def roughness(self) -> Array:
        """Roughness of each point [m], or its group where the curve has no contact [-]."""
        return self._input("roughness")

    def _input(self, name: str) -> Array:
        if name == self.over:
            return self.values
        return np.full(len(self.values), getattr(self.groups if self.contact is None else self.contact, name))

    @abstractmethod
    def _where(self, value: float) -> str:
        """Return a value in words."""

    @abstractmethod
    def _values(self, value: Any, s: Array) -> CurveValues:
        """Return the values of the curve at coordinates."""

    @abstractmethod
    def _sampled(self, values: Array) -> Self:
        """Return the curve with other points."""

    @abstractmethod
    def _friction_of(self, boundary_friction: float, beta: float, definition: Definition) -> Array:
        """Return contact and viscous friction, their sum and its error for coefficients, shape (n, 4)."""

    @abstractmethod
    def _accepted(self, rtol: float | None) -> float:
        """Return the error of the observables up to which a landmark is read off the curve."""

    @abstractmethod
    def _find(self, mark: Transition, accepted: float) -> Landmark | None:
        """Return a transition or the minimum, or None where the curve holds none."""

    def __len__(self) -> int:
        """Return the number of points."""
        return len(self.values)

    def at(self, value: Any) -> CurveValues:
        """Return all observables and the friction anywhere on the curve, with their errors.

        Parameters
        ----------
        value : float, str or array_like
            What the curve runs over, inside its range: groups [-], or SI numbers or text with units where the curve has a
            contact.

        Returns
        -------
        CurveValues
            Numbers for one value, arrays for many.

        Raises
        ------
        InputError
            If a value is outside the curve.
        SolveError
            If no states can be solved along the curve.

        Notes
        -----
        A curve is about a dozen solved states, expanded into Taylor series.  Between them observables are polynomials in the
        logarithm of ``value``; their difference from polynomials of lower order is part of the error
        (``test_curve_function.py``).
        """
        values = given_values(self.over, value, self.contact)
        low, high = self._ends
        if not ((values >= low * (1 - END_ROUNDING)) & (values <= high * (1 + END_ROUNDING))).all():
            raise InputError(
                f"{self.over} = {show(value)} is outside the curve, which runs from {self._where(low)} to "
                f"{self._where(high).removeprefix(self.over + ' ')}; compute a curve that contains it."
            )
        return self._values(values if np.ndim(values) else float(values), np.log(np.atleast_1d(values)))

    def sampled(self, points: int) -> Self:
        """Return the same curve with other points, evenly in the logarithm; they are read off it.

        Parameters
        ----------
        points : int
            Their number, at least 2.

        Returns
        -------
        StribeckCurve or AtlasCurve
            Between the same ends.

        Raises
        ------
        InputError
            For a number that is none.
        """
        check_points(points)
        return self._sampled(np.geomspace(self.values[0], self.values[-1], points))

    @cached_property
    def _friction(self) -> Array:
        return self._friction_of(self.boundary_friction, self.beta, self.definition)

    @property
    def friction_contact(self) -> Array:
        """Contact part of the friction coefficient [-]."""
        return np.asarray(self._friction[:, 0])

    @property
    def friction_viscous(self) -> Array:
        """Viscous part of the friction coefficient [-]."""
        return np.asarray(self._friction[:, 1])

    @property
    def friction(self) -> FrictionArray:
        """Friction coefficients [-]: an array with its parts ``contact``, ``viscous`` and its ``error``.

        For the coefficients and the definition of the curve; ``friction(boundary_friction, beta, definition)`` returns it for
        others, each optional.
        """
        return self._friction_for()

    def _friction_for(
        self, boundary_friction: float | None = None, beta: float | None = None, definition: Definition | None = None
    ) -> FrictionArray:
        if boundary_friction is None and beta is None and definition is None:
            found = self._friction
        else:
            given = coefficients(
                None,
                self.boundary_friction if boundary_friction is None else boundary_friction,
                self.beta if beta is None else beta,
            )
            found = self._friction_of(*given, self.definition if definition is None else check_definition(definition))
        return FrictionArray(found[:, 0], found[:, 1], found[:, 2], found[:, 3], self._friction_for)

    @property
    def friction_error(self) -> Array:
        """Estimated absolute error of the friction coefficient [-]."""
        return np.asarray(self._friction[:, 3])

    @property
    def hersey_number(self) -> Array:
        """Hersey number of the points [-], eta U/F_N of a line and eta U R/F_N of a ball."""
        return np.asarray(self.groups.hersey_number(self.beta))

    @property
    def hydrodynamic_friction(self) -> Array:
        """Friction of smooth surfaces by the article's law, the abscissa of its second plot; nan for other models."""
        if self.groups.geometry != "line" or self.groups.model != BASE_MODEL:
            return np.full(len(self), np.nan)
        return np.asarray(hydrodynamic.friction(self.groups, self.beta))

    @property
    def regimes(self) -> tuple[Regime, ...]:
        """Lubrication regime of each point."""
        return regimes_along(self.observable("fluid_load_share"), self.friction_contact, self.friction)

    @cached_property
    def regime_ranges(self) -> tuple[tuple[Regime, float, float], ...]:
        """Regimes along the curve, ascending: name, and the values between which it holds.

        They meet at a located transition where there is one, else in the middle between two points.
        """
        return ranges_of(self.values, self.regimes, self.transitions)

    @property
    def minimum(self) -> Landmark | None:
        """The minimum of the size of the friction, where it or its slope vanishes; None where the curve has none inside."""
        return self.landmark(Transition.MINIMUM)

    def landmark(self, name: str, rtol: float | None = None) -> Landmark | None:
        """Return one transition, or the minimum.

        Parameters
        ----------
        name : str
            ``"boundary_end"``, ``"equal_shares"``, ``"hydrodynamic_start"`` or ``"minimum"``, or the name in outputs.
        rtol : float, optional
            Error of the observables up to which it is read off the curve: the tolerance of the curve costs no further
            state.  Beyond, a state is solved there.  1e-6 if omitted, or the tolerance of the curve if that is smaller.

        Returns
        -------
        Landmark or None
            None where the curve does not hold it.

        Raises
        ------
        InputError
            For another name, or a tolerance that is none.
        """
        mark = check_transition(name)
        accepted = self._accepted(rtol)
        if (mark, accepted) not in self._found:
            self._found[mark, accepted] = self._find(mark, accepted)
        return self._found[mark, accepted]

    @cached_property
    def _found(self) -> dict[tuple[Transition, float], Landmark | None]:
        return {}

    @cached_property
    def transitions(self) -> tuple[Landmark, ...]:
        """The boundaries between regimes, where the load is shared in halves, and the friction minimum.

        As far as the curve holds them, ascending: where the fluid carries 5 % and 50 % of the load, where asperities cause
        10 % of the friction, and where friction is at its minimum.
        """
        found = [self.landmark(name) for name in Transition]
        return tuple(sorted((mark for mark in found if mark is not None), key=lambda mark: mark.value))

    def to_dataset(self) -> xarray.Dataset:
        """Return the curve as an xarray Dataset.

        Returns
        -------
        xarray.Dataset
            Observables, friction, regimes and inputs of each point, with units and long names as attributes;
            needs the extra ``data``.
        """
        # By name, as pictures are: the table needs the curve.
        found: xarray.Dataset = import_module("stribeck.curves.table").curve_dataset(self)
        return found
