r"""Reynolds' equation on the line: the pressure gradient of a film that carries the flux of the gap h*.

.. math:: \frac{dp_f}{dx} = \lambda \, \frac{h - h^*}{h^3}, \qquad p_f(\pm\infty) = 0

The gradient is kept divided by ``h**3``: multiplied out, Newton's iteration diverges.  All functions leave the factor
lambda out, so that the condition on the flux stays well posed at speed zero.

Source: [BP] Eq. (thin-film_dl); isoviscous fluid, no flow factors.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import ClassVar, NamedTuple, Self

import numpy as np

from stribeck._types import Array, Numbers
from stribeck.fluids.fluid import MAX_CACHED_SHAPES, Key, Slopes, key_of
from stribeck.fluids.laws import DensityLaw, FlowFactors, Smooth, ViscosityLaw, joined_names, joined_parameters, notes_of
from stribeck.fluids.rheology.viscosity import Constant, Incompressible

ONE, ZERO = np.ones(()), np.zeros(())


def gradient(gap: Array, flux_gap: Numbers) -> Array:
    """Return ``(h - h*)/h**3``: the pressure gradient over lambda [u_Hz**-2]."""
    return np.asarray((gap - flux_gap) / (gap * gap * gap))


def gap_derivative(gap: Array, flux_gap: Numbers) -> Array:
    """Return the derivative of :func:`gradient` with respect to the gap, ``(3 h* - 2 h)/h**4``."""
    return np.asarray((3.0 * flux_gap - 2.0 * gap) / (gap * gap) ** 2)


def flux_derivative(gap: Array) -> Array:
    """Return the derivative of :func:`gradient` with respect to h*, ``-1/h**3``."""
    return -1.0 / gap**3


class _Column(NamedTuple):
    """What a film is at nodes, and what it was made for."""

    key: Key
    gradient: Array
    slopes: Slopes | None

    @property
    def as_row(self) -> _Column:
        """Column as an array of one row of nodes."""
        if self.slopes is None:
            return _Column(self.key, self.gradient[None], None)
        by_gap, by_pressure, by_flux, _ = self.slopes
        slopes = Slopes(by_gap[None], None if by_pressure is None else by_pressure[None], by_flux[None])
        return _Column(self.key, self.gradient[None], slopes)


@dataclass(frozen=True)
class Newtonian:
    r"""The fluid whose viscosity does not depend on the shear rate.

    .. math:: G = \frac{\eta(p) \, [h + s S(h) - m/\rho(p)]}{\phi_x(h) \, h^3}

    Viscosity :math:`\eta` and density :math:`\rho` are relative to those at ambient pressure; :math:`S = \sigma \phi_s` and
    :math:`\phi_x` are the flow factors of rough surfaces.
    """

    viscosity: ViscosityLaw = Constant()  # Viscosity as a function of pressure
    density: DensityLaw = Incompressible()  # Density as a function of pressure
    flow: FlowFactors = Smooth()  # Of rough surfaces
    slide: float = 1.0  # Half the slide-to-roll ratio, `s = (u1 - u2)/(u1 + u2)`
    uses_pressure: bool = field(init=False, repr=False, compare=False)
    is_smooth: bool = field(init=False, repr=False, compare=False)
    is_plain: bool = field(init=False, repr=False, compare=False)
    _known: dict[tuple[int, ...], _Column] = field(init=False, repr=False, compare=False)
    uses_speed: ClassVar[bool] = False

    def __post_init__(self) -> None:
        """Note whether viscosity or density depend on the pressure, and whether all is constant and smooth."""
        uses_pressure = not (isinstance(self.viscosity, Constant) and isinstance(self.density, Incompressible))
        object.__setattr__(self, "uses_pressure", uses_pressure)
        object.__setattr__(self, "_known", {})
        object.__setattr__(self, "is_smooth", isinstance(self.flow, Smooth))
        object.__setattr__(self, "is_plain", not uses_pressure and self.is_smooth)

    @property
    def name(self) -> str:
        """The names of the laws that are not constant."""
        return joined_names("newtonian", self.viscosity, self.density, self.flow)

    @property
    def parameters(self) -> dict[str, float | str]:
        """Parameters of the laws of the film."""
        return joined_parameters(self.viscosity, self.density, self.flow)

    def at(self, speed: Numbers) -> Self:
        """Return the film itself: no speed matters."""
        return self

    def milder(self, part: float) -> Self:
        """Return the film with milder laws."""
        if self.is_plain:
            return self
        return replace(
            self, viscosity=self.viscosity.milder(part), density=self.density.milder(part), flow=self.flow.milder(part)
        )

    def gradient(self, gap: Array, pressure: Array | None, flux_gap: Numbers) -> Array:
        """Return G."""
        if self.is_plain:
            return gradient(gap, flux_gap)
        if not self.is_smooth:
            return self._at(gap, pressure, flux_gap).gradient
        eta, _, rho, _ = self._of_pressure(pressure)
        return np.asarray(eta * (gap - flux_gap / rho) / (gap * gap * gap))

    def slopes(self, gap: Array, pressure: Array | None, flux_gap: Numbers) -> Slopes:
        """Return the derivatives of G."""
        if self.is_plain:
            return Slopes(gap_derivative(gap, flux_gap), None, flux_derivative(gap))
        found = self._at(gap, pressure, flux_gap, with_slopes=True).slopes
        assert found is not None
        return found

    def jump(self, gap: Array, pressure: Array | None) -> Array | None:
        """Return by how much G jumps between each node and the next one, zero mostly; None if it never does."""
        height = self.flow.jump(gap, self.slide)
        if height is None or not height.any():
            return None
        eta = self._of_pressure(pressure)[0]
        return np.asarray(eta / (self.flow.factor(gap) * gap**3) * height)

    @property
    def closed_at(self) -> float | None:
        """Mean gap at which roughness closes the last path of the flow; None if it never does."""
        return self.flow.closed_at

    def tractions(self, gap: Array, pressure: Array | None, flux_gap: Numbers) -> tuple[Array, Array]:
        r"""Return :math:`(\phi_f \pm \phi_{fs}) \eta s/h \pm 3 \phi_{fp} h G`, at the substrate and at the cylinder."""
        rate, pull = self.slide * self._of_pressure(pressure)[0] / gap, 3 * gap * self.gradient(gap, pressure, flux_gap)
        factors = self.flow.friction(gap)
        if factors is None:
            return rate + pull, rate - pull
        (f, _), (fs, _), (fp, _) = factors
        return (f + fs) * rate + fp * pull, (f - fs) * rate - fp * pull

    def traction_slopes(self, gap: Array, pressure: Array | None, flux_gap: Numbers) -> tuple[Slopes, Slopes]:
        """Return the derivatives of both tractions."""
        h = gap
        eta, eta_slope, _, _ = self._of_pressure(pressure)
        of_g, g, rate = self.slopes(h, pressure, flux_gap), self.gradient(h, pressure, flux_gap), self.slide * eta / h
        pull, by_flux = 3 * (g + h * of_g.by_gap), 3 * h * of_g.by_flux
        lower_shear = upper_shear = rate
        by_gap = -rate / h
        lower, upper = by_gap + pull, by_gap - pull
        by_pressure = None if of_g.by_pressure is None else 3 * h * of_g.by_pressure
        factors = self.flow.friction(h)
        if factors is not None:
            (f, f_slope), (fs, fs_slope), (fp, fp_slope) = factors
            pull = fp * pull + 3 * fp_slope * h * g
            lower_shear, upper_shear = (f + fs) * rate, (f - fs) * rate
            lower = (f_slope + fs_slope) * rate - lower_shear / h + pull
            upper = (f_slope - fs_slope) * rate - upper_shear / h - pull
            by_flux = fp * by_flux
            by_pressure = None if by_pressure is None else fp * by_pressure
        if by_pressure is None:
            return Slopes(lower, None, by_flux), Slopes(upper, None, -by_flux)
        return (
            Slopes(lower, eta_slope * lower_shear + by_pressure, by_flux),
            Slopes(upper, eta_slope * upper_shear - by_pressure, -by_flux),
        )

    def cavity_traction(self, gap: Array, pressure: Array | None, flux_gap: Numbers) -> Array:
        r"""Return :math:`\eta s/h` in the part of the width that is wet, :math:`\min(1, m/(\rho h))`."""
        eta, _, rho, _ = self._of_pressure(pressure)
        return np.asarray(self.slide * eta / gap * np.minimum(1.0, flux_gap / (rho * gap)))

    def cavity_traction_slopes(self, gap: Array, pressure: Array | None, flux_gap: Numbers) -> Slopes:
        """Return the derivatives of :meth:`cavity_traction`."""
        eta, eta_slope, rho, rho_slope = self._of_pressure(pressure)
        traction = self.cavity_traction(gap, pressure, flux_gap)
        partly = np.where(flux_gap < rho * gap, 1.0, 0.0)  # shear flow factors can carry more than the gap holds
        by_pressure = traction * (eta_slope - partly * rho_slope / rho) if self.uses_pressure else None
        return Slopes(-(1 + partly) * traction / gap, by_pressure, partly * self.slide * eta / rho / gap**2)

    def notes(self, gap: Array, pressure: Array | None, flux_gap: Numbers) -> tuple[str, ...]:
        """Return where the state leaves the range of the laws."""
        return notes_of(self.viscosity, self.density, self.flow, gap=gap, pressure=pressure)

    def _of_pressure(self, pressure: Array | None) -> tuple[Array, Array, Array, Array]:
        """Return viscosity, slope of its logarithm, density and its slope."""
        if not self.uses_pressure:
            return ONE, ZERO, ONE, ZERO
        assert pressure is not None
        log, log_slope = self.viscosity.log(pressure)
        return np.exp(log), log_slope, *self.density.ratio(pressure)

    def _at(self, gap: Array, pressure: Array | None, flux_gap: Numbers, with_slopes: bool = False) -> _Column:
        """Return G and where asked for its derivatives, those known if the last on as many nodes were for the same film."""
        if len(gap.shape) == 2 and len(gap) == 1:
            return self._at(gap[0], None if pressure is None else pressure[0], np.ravel(flux_gap), with_slopes).as_row
        key = key_of(flux_gap, gap, pressure)
        last = self._known.get(gap.shape)
        if last is not None and last.key == key and (last.slopes is not None or not with_slopes):
            return last
        if len(self._known) >= MAX_CACHED_SHAPES:
            self._known.clear()
        h, m, s = gap, flux_gap, self.slide
        eta, eta_slope, rho, rho_slope = self._of_pressure(pressure)
        carried, carried_slope = self.flow.shear(h)
        phi, phi_slope = self.flow.pressure(h) if with_slopes else (self.flow.factor(h), None)
        resistance = eta / (phi * h * h * h)
        g = resistance * (h - m / rho + s * carried)
        slopes = None
        if phi_slope is not None:
            by_gap = resistance * (1 + s * carried_slope) - g * (phi_slope / phi + 3 / h)
            by_pressure = eta_slope * g + resistance * m * rho_slope / rho**2 if self.uses_pressure else None
            slopes = Slopes(by_gap, by_pressure, -resistance / rho)
        found = self._known[gap.shape] = _Column(key, g, slopes)
        return found


def flux_gap(gap: Array, weights: Array) -> float:
    r"""Return the flux gap of a given film.

    .. math:: h^* = \frac{\int h^{-2} dx}{\int h^{-3} dx}
    """
    minimum = gap.min()
    scaled = minimum / gap
    return float(minimum * (weights @ scaled**2) / (weights @ scaled**3))
