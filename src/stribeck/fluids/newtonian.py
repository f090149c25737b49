r"""Reynolds' equation on the line: the pressure gradient of a film that carries the flux of the gap h*.

.. math:: \frac{dp_f}{dx} = \lambda \, \frac{h - h^*}{h^3}, \qquad p_f(\pm\infty) = 0

The gradient is kept divided by ``h**3``: multiplied out, Newton's iteration diverges.  All functions leave the factor
lambda out, so that the condition on the flux stays well posed at speed zero.

Source: [BP] Eq. (thin-film_dl); isoviscous fluid, no flow factors.
"""

import math
from dataclasses import dataclass, replace
from typing import Any, ClassVar, NamedTuple, Self, cast

import numpy as np

from stribeck._types import Array, Numbers
from stribeck.fluids.fluid import MAX_CACHED_SHAPES, Film
from stribeck.fluids.laws import DensityLaw, FlowFactors, Smooth, ViscosityLaw, joined_names, joined_parameters, notes_of
from stribeck.fluids.rheology.viscosity import Constant, Incompressible
from stribeck.numerics.dual import value_of, with_slope
from stribeck.numerics.trace import mapped, pointwise
from stribeck.quantities.lazy import cached_property

ONE = np.ones(())

# Logarithmic decay of the Newtonian part of a blend with a fluid that thins: its films are powers of that part; without decay
# the thinnest are lost (test_a_film_of_which_rounding_leaves_three_digits_is_returned_with_its_error).
NEWTONIAN_DECAY = 8.0


class _Factors(NamedTuple):
    """What roughness does to the flow at nodes, each with its slope by the gap: phi_x and S."""

    gap: Array
    pressure: tuple[Array, Array]
    shear: tuple[Array, Array]


class Column:
    """What films of all fluids share: laws of the pressure, walls that move, and what was found last on as many nodes."""

    viscosity: ViscosityLaw
    density: DensityLaw
    slide: float
    entrained: float

    @cached_property
    def uses_pressure(self) -> bool:
        """Whether viscosity or density depend on the pressure."""
        return not (isinstance(self.viscosity, Constant) and isinstance(self.density, Incompressible))

    @cached_property
    def _known(self) -> dict[int, Any]:
        return {}

    def _changed(self, **changes: Any) -> Self:
        """Return the film with other numbers, which shares what is known."""
        found: Self = replace(cast(Any, self), **changes)
        vars(found)["_known"] = self._known
        return found

    def moving(self, share: float) -> Self:
        """Return the film between walls at a share of their speeds."""
        return self._changed(slide=share * self.slide, entrained=share * self.entrained)

    def held(self, gap: Any, pressure: Any) -> Any:
        """Return the gap times the density ratio."""
        return gap * self._of_pressure(pressure)[1] if self.uses_pressure else gap

    def _of_pressure(self, pressure: Any) -> tuple[Any, Any]:
        """Return viscosity and density."""
        return of_pressure(self.viscosity, self.density, pressure) if self.uses_pressure else (ONE, ONE)


@dataclass(frozen=True)
class Newtonian(Column):
    r"""The fluid whose viscosity does not depend on the shear rate.

    .. math:: G = \frac{\eta(p) \, [h + s S(h) - m/\rho(p)]}{\phi_x(h) \, h^3}

    Viscosity :math:`\eta` and density :math:`\rho` are relative to those at ambient pressure; :math:`S = \sigma \phi_s` and
    :math:`\phi_x` are the flow factors of rough surfaces.
    """

    viscosity: ViscosityLaw = Constant()  # Viscosity as a function of pressure
    density: DensityLaw = Incompressible()  # Density as a function of pressure
    flow: FlowFactors = Smooth()  # Of rough surfaces
    slide: float = 1.0  # Half the slide-to-roll ratio, `s = (u1 - u2)/(u1 + u2)`
    entrained: float = 1.0  # Sum of the speeds over U, see :meth:`moving`
    uses_speed: ClassVar[bool] = False

    @cached_property
    def is_smooth(self) -> bool:
        """Whether no roughness acts on the flow."""
        return isinstance(self.flow, Smooth)

    @cached_property
    def is_plain(self) -> bool:
        """Whether all is constant and smooth."""
        return not self.uses_pressure and self.is_smooth

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

    def gradient(self, gap: Any, pressure: Any, flux_gap: Any) -> Any:
        """Return G."""
        carried_along = gap if self.entrained == 1.0 else self.entrained * gap
        if self.is_plain:
            return (carried_along - flux_gap) / (gap * gap * gap)
        eta, rho = self._of_pressure(pressure)
        thick, resistance = carried_along - flux_gap / rho, eta / (gap * gap * gap)
        if self.is_smooth:
            return resistance * thick
        phi, carried = self.roughness(gap)
        return resistance / phi * (thick + self.slide * carried)

    def jump(self, gap: Array, pressure: Array | None) -> Array | None:
        """Return by how much G jumps between each node and the next one, zero mostly; None if it never does."""
        height = self.flow.jump(gap, self.slide)
        if height is None or not height.any():
            return None
        eta = self._of_pressure(pressure)[0]
        return np.asarray(eta / (self.flow.pressure(gap) * gap**3) * height)

    @property
    def closed_at(self) -> float | None:
        """Mean gap at which roughness closes the last path of the flow; None if it never does."""
        return self.flow.closed_at

    def tractions(self, gap: Any, pressure: Any, flux_gap: Any) -> tuple[Any, Any]:
        r"""Return :math:`(\phi_f \pm \phi_{fs}) \eta s/h \pm 3 \phi_{fp} h G`, at the substrate and at the cylinder."""
        rate, pull = self.slide * self._of_pressure(pressure)[0] / gap, 3 * gap * self.gradient(gap, pressure, flux_gap)
        factors = mapped(self.flow.friction, gap)
        if factors is None:
            return rate + pull, rate - pull
        f, fs, fp = factors
        return (f + fs) * rate + fp * pull, (f - fs) * rate - fp * pull

    def cavity_traction(self, gap: Any, pressure: Any, flux_gap: Any) -> Any:
        r"""Return :math:`\eta s/h` in the part of the width that is wet, :math:`\min(1, m/(\rho h))`."""
        # Shear flow factors can carry more than the gap holds.
        eta, rho = self._of_pressure(pressure)
        return self.slide * eta / gap * np.minimum(1.0, flux_gap / (rho * self.entrained * gap))

    def notes(self, gap: Array, pressure: Array | None, flux_gap: Numbers) -> tuple[str, ...]:
        """Return where the state leaves the range of the laws."""
        return notes_of(self.viscosity, self.density, self.flow, gap=gap, pressure=pressure)

    def roughness(self, gap: Any) -> tuple[Any, Any]:
        """Return phi_x and S, those known if the last on as many nodes were for the same gaps."""
        h = np.ravel(value_of(gap))
        known = self._known.get(h.size)
        if known is None or not np.array_equal(known.gap, h):
            if len(self._known) >= MAX_CACHED_SHAPES:
                self._known.clear()
            known = self._known[h.size] = _Factors(h, with_slope(self.flow.pressure, h), with_slope(self.flow.shear, h))
        shape = np.shape(value_of(gap))
        phi, carried = (tuple(each.reshape(shape) for each in pair) for pair in (known.pressure, known.shear))
        return pointwise(lambda _: phi, gap), pointwise(lambda _: carried, gap)


def of_pressure(viscosity: ViscosityLaw, density: DensityLaw, pressure: Any) -> tuple[Any, Any]:
    """Return viscosity and density at a pressure."""
    return mapped(lambda p: np.exp(viscosity.log(p)), pressure), mapped(density.ratio, pressure)


def flux_gap(gap: Array, weights: Array) -> float:
    r"""Return the flux gap of a given film.

    .. math:: h^* = \frac{\int h^{-2} dx}{\int h^{-3} dx}
    """
    minimum = gap.min()
    scaled = minimum / gap
    return float(minimum * (weights @ scaled**2) / (weights @ scaled**3))


@dataclass(frozen=True)
class Blend:
    """A film whose flow lies between that of a Newtonian fluid and its own; in all else it is its own."""

    film: Film
    newtonian: float  # Part of the Newtonian fluid
    plain: Film = Newtonian()

    @property
    def name(self) -> str:
        """The name of the film."""
        return self.film.name

    @property
    def parameters(self) -> dict[str, float | str]:
        """The parameters of the film."""
        return self.film.parameters

    @property
    def uses_pressure(self) -> bool:
        """Whether the film's gradient depends on the pressure."""
        return self.film.uses_pressure

    def at(self, speed: Any) -> Self:
        """Return the blend at a speed."""
        return replace(self, film=self.film.at(speed))

    def gradient(self, gap: Any, pressure: Any, flux_gap: Any) -> Any:
        """Return the weighted mean of both gradients."""
        own = self.film.gradient(gap, pressure, flux_gap)
        return self.newtonian * self.plain.gradient(gap, None, flux_gap) + (1 - self.newtonian) * own

    def __getattr__(self, name: str) -> object:
        """Return any other attribute of the film."""
        return getattr(self.film, name)


def blend(film: Film, part: float) -> Film:
    """Return the film at a place of the path from the Newtonian one, 0, to its own, 1."""
    if part == 1.0:
        return film
    if not hasattr(film, "with_shorter_time"):
        return cast(Film, Blend(film, 1 - part))
    # The flow of a fluid that thins may grow exponentially with the gradient: no small part of it is small.
    return cast(Film, Blend(film.with_shorter_time(part), (1 - part) * math.exp(-NEWTONIAN_DECAY * part)))
