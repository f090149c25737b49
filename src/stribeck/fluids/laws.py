"""What a film is put together from: laws of viscosity, density, shear rate and flow between rough surfaces.

Each is a frozen class whose numbers are in SI units, and in a film in Hertz units: :meth:`Law.scaled` goes from the first to
the second.  A new law is one class with the members of its protocol.  Its functions are written with those of numpy, so that
they take values, and values with their derivatives (:mod:`stribeck.numerics.dual`): slopes follow.
"""

from __future__ import annotations

from abc import abstractmethod
from dataclasses import dataclass
from typing import Any, NamedTuple, Protocol, Self, runtime_checkable

import numpy as np

from stribeck._types import Array
from stribeck.quantities.schema import numbers_of


class FilmUnits(NamedTuple):
    r"""What the numbers of a law are divided by to be in Hertz units."""

    pressure: float  # `p_\mathrm{Hz}` [Pa]
    time: float
    gap: float  # `u_\mathrm{Hz}` [m]
    viscosity: float  # `\eta_0`, the viscosity at ambient pressure and low rate [Pa s]
    decay_length: float = 0.0  # `h_\mathrm{rms}/\alpha`, which the roughness is where `\alpha = 1` [m]
    alpha: float | None = None  # `\alpha` of the contact; None where a law must know it itself

    @property
    def stress(self) -> float:
        r"""Unit of shear stresses, :math:`p_\mathrm{Hz} u_\mathrm{Hz}/(6 a)` [Pa]."""
        return self.viscosity / self.time


HERTZ_UNITS = FilmUnits(1.0, 1.0, 1.0, 1.0)  # Units of laws that are in Hertz units already.


class Law(Protocol):
    """What all laws have: a name, parameters, and their form in Hertz units."""

    @property
    def name(self) -> str:
        """Name that outputs print and case files have; empty for what does nothing."""
        return ""

    @property
    def parameters(self) -> dict[str, float | str]:
        """What distinguishes this law from others of its name, for outputs: its numbers."""
        return {name: getattr(self, name) for name in numbers_of(type(self))}

    @abstractmethod
    def scaled(self, units: FilmUnits) -> Self:
        """Return the law in Hertz units; a law without numbers that have a unit returns itself."""

    def notes(self, gap: Array, pressure: Array | None) -> tuple[str, ...]:
        """Return sentences on where a state leaves the range of the law, in Hertz units; mostly none."""
        return ()


@runtime_checkable
class ViscosityLaw(Law, Protocol):
    """Viscosity as a function of pressure."""

    @abstractmethod
    def log(self, pressure: Any) -> Any:
        """Return ln(eta/eta0)."""


@runtime_checkable
class DensityLaw(Law, Protocol):
    """Density as a function of pressure."""

    @abstractmethod
    def ratio(self, pressure: Any) -> Any:
        """Return rho/rho0."""


@runtime_checkable
class FlowFactors(Law, Protocol):
    """What roughness does to the flow, as a function of the mean gap."""

    @abstractmethod
    def pressure(self, gap: Any) -> Any:
        """Return the flow under a pressure gradient over that between smooth surfaces, phi_x > 0."""

    @abstractmethod
    def shear(self, gap: Any) -> Any:
        """Return what sliding carries along in valleys, sigma phi_s [u_Hz]."""

    def jump(self, gap: Array, slide: float) -> Array | None:
        """Return by how much ``h + s S``, over phi_x, jumps between each node and the next one, zero mostly; None if never."""
        return None

    def friction(self, gap: Any) -> tuple[Any, Any, Any] | None:
        """Return the factors phi_f, phi_fs and phi_fp of the drag; None where it is that between smooth walls."""
        return None

    @property
    def closed_at(self) -> float | None:
        """Mean gap at which the last path of the flow closes and phi_x turns sharply; None if there is no such gap."""
        return None


@dataclass(frozen=True)
class Smooth(FlowFactors):
    """The flow between smooth surfaces, which a gap many times the roughness is too."""

    def scaled(self, units: FilmUnits) -> Self:
        """Return itself: it has no numbers."""
        return self

    def pressure(self, gap: Any) -> Any:
        """Return one."""
        return np.ones_like(gap)

    def shear(self, gap: Any) -> Any:
        """Return zero."""
        return np.zeros_like(gap)


class Profile(NamedTuple):
    """The flow across the film at many nodes: rates x, stresses g and slopes dg/dx at the walls a and b, and A, B, C."""

    x_a: Array
    x_b: Array
    g_a: Array
    g_b: Array
    slope_a: Array
    slope_b: Array
    by_mean: Array
    mixed: Array
    by_slope: Array

    def change(self, r_0: Array | float, r_1: Array | float) -> tuple[Array, Array]:
        """Return the changes of T and Q for those of both integrals."""
        determinant = self.by_mean * self.by_slope - self.mixed**2
        return (self.by_slope * r_0 - self.mixed * r_1) / determinant, (self.by_mean * r_1 - self.mixed * r_0) / determinant


@runtime_checkable
class RateLaw(Law, Protocol):
    """Shear stress as a function of the shear rate, rising.

    In its methods rates x are times the relaxation time and stresses g times that time over the viscosity; both are >= 0.
    """

    @property
    @abstractmethod
    def time(self) -> float:
        """One over the rate at which thinning begins."""

    @property
    def plateau(self) -> float:
        """Rate x below which the viscosity is constant up to even powers of it; zero where there is no such rate."""
        return 1.0

    @abstractmethod
    def stress(self, rate: Any) -> Any:
        """Return g(x)."""

    @abstractmethod
    def rate(self, stress: Array) -> Array:
        """Return x(g)."""

    @abstractmethod
    def moments(self, rate: Array, stress: Array) -> tuple[Array, Array]:
        r"""Return :math:`\int x \, dg` and :math:`\int g x \, dg` from zero to x, where the stress is g."""

    def across(self, r_0: Array, r_1: Array, start: tuple[Array, Array] | None) -> Profile | None:
        """Return the flow across a film as :func:`stribeck.fluids.local_flow.profile` does; None if it takes the moments."""
        return None


def joined_names(base: str, *laws: Law) -> str:
    """Return the name of a film: its own and those of its laws that have one."""
    return " + ".join([base, *(law.name for law in laws if law.name)])


def joined_parameters(*laws: Law) -> dict[str, float | str]:
    """Return the parameters of the laws of a film."""
    return {name: value for law in laws for name, value in law.parameters.items()}


def notes_of(*laws: Law, gap: Array, pressure: Array | None) -> tuple[str, ...]:
    """Return the notes of the laws of a film."""
    return tuple(note for law in laws for note in law.notes(gap, pressure))
