"""Fluids as users describe them: laws in SI units, or in Hertz units with groups, that become a film; and liquids of them."""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import Annotated, Any

from stribeck.fluids.fluid import Film
from stribeck.fluids.laws import DensityLaw, FilmUnits, FlowFactors, RateLaw, Smooth, ViscosityLaw, check_law
from stribeck.fluids.newtonian import Newtonian
from stribeck.fluids.rheology.viscosity import Constant, Incompressible, check_range
from stribeck.quantities.docstrings import Described
from stribeck.quantities.formats import format_si
from stribeck.quantities.units import InputError, show, to_si

MAX_RELAXATION_TIME = 1e100  # Largest relaxation time and largest rate [Hertz units]: squares of rates stay finite.

_TEMPERATURE = re.compile(r"\s*([+-]?[0-9]+(?:\.[0-9]*)?)\s*(degC|°C|deg C|C|K)\s*")


# Kinds of laws by their argument of a fluid, and examples.
KINDS: dict[str, tuple[type[Any], str]] = {
    "rheology": (RateLaw, "Carreau, Cross, Eyring or PowerLaw"),
    "viscosity": (ViscosityLaw, "Barus or Roelands"),
    "density": (DensityLaw, "DowsonHigginson"),
}


@dataclass(frozen=True)
class Fluid(Described, title="Parameters"):
    """A fluid with several laws at once; what is left out is constant.

    A contact takes one law alone too: ``fluid=Carreau("1 ms", 0.5)`` is ``fluid=Fluid(rheology=Carreau("1 ms", 0.5))``.

    Raises
    ------
    InputError
        Where an argument is no law of its kind.

    Examples
    --------
    >>> from stribeck.fluids import Carreau, Roelands
    >>> Fluid(Carreau("1 ms", 0.5), Roelands("15 1/GPa")).name
    'carreau + roelands'
    """

    rheology: Annotated[
        RateLaw | None, "how the viscosity falls with the shear rate: Carreau, Cross, Eyring or PowerLaw; Newtonian without it"
    ] = None
    viscosity: Annotated[ViscosityLaw | None, "how the viscosity grows with the pressure: Barus or Roelands"] = None
    density: Annotated[DensityLaw | None, "how the density grows with the pressure: DowsonHigginson"] = None

    def __post_init__(self) -> None:
        """Refuse what is no law of its kind."""
        for name, (kind, examples) in KINDS.items():
            law = getattr(self, name)
            if law is not None and not (isinstance(law, kind) and not isinstance(law, type)):
                raise InputError(f"{name} = {show(law)} is no law of this kind; give one of sb.fluids: {examples}.")
            if law is not None:
                check_law(law)

    @property
    def name(self) -> str:
        """The names of its laws."""
        names = [law.name for law in self.laws if law.name]
        return " + ".join(names) if self.rheology is not None else " + ".join(["newtonian", *names])

    @property
    def laws(self) -> tuple[RateLaw | ViscosityLaw | DensityLaw, ...]:
        """Its laws."""
        return tuple(law for law in (self.rheology, self.viscosity, self.density) if law is not None)

    @property
    def parameters(self) -> dict[str, float | str]:
        """Parameters of its laws."""
        return {name: value for law in self.laws for name, value in law.parameters.items()}

    def at(self, units: FilmUnits, slide: float = 1.0, flow_factors: FlowFactors | None = None) -> Film:
        r"""Return the film in Hertz units, for all speeds.

        Parameters
        ----------
        units : FilmUnits
            What makes its numbers dimensionless: those of a contact, or for numbers in Hertz units at the speed group
            :math:`\lambda` of the groups ``FilmUnits(1, lambda, 1, 1, kappa)``.
        slide : float
            Half the slide-to-roll ratio.
        flow_factors : FlowFactors, optional
            Of rough surfaces; smooth ones have none.

        Returns
        -------
        Film
            What the equations ask.

        Raises
        ------
        InputError
            Where :math:`\alpha_p p_\mathrm{Hz}` exceeds 5, or flow factors meet a fluid that thins.
        """
        viscosity = Constant() if self.viscosity is None else self.viscosity.scaled(units)
        check_range(viscosity)
        density = Incompressible() if self.density is None else self.density.scaled(units)
        if self.rheology is None:
            flow = Smooth() if flow_factors is None or units.decay_length == 0 else flow_factors.scaled(units)
            return Newtonian(viscosity, density, flow, slide)
        if flow_factors is not None and not isinstance(flow_factors, Smooth):
            raise InputError(
                f"flow_factors and a fluid that thins ({self.rheology.name}) are given together; flow factors are known for "
                "Newtonian fluids only. Leave one of them out."
            )
        from stribeck.fluids.shear_thinning import ShearThinning

        rheology = self.rheology.scaled(units)
        _check_time(self.rheology, rheology.time)
        return ShearThinning(rheology, viscosity, density, slide)


def _check_time(given: RateLaw, time: float) -> None:
    """Refuse a law whose rate at which thinning begins has no square in double precision."""
    if not MAX_RELAXATION_TIME**-1 <= time <= MAX_RELAXATION_TIME:
        name = next(iter(given.parameters), "relaxation_time")
        value = given.parameters.get(name, given.time)
        raise InputError(
            f"{name} = {show(value)}: thinning would begin at {1 / max(time, 1e-300):.3g} of the shear rate that the contact "
            f"has at speed group 1; the ratio must lie between {1 / MAX_RELAXATION_TIME:g} and {MAX_RELAXATION_TIME:g}. "
            "Check the unit."
        )


def as_fluid(fluid: Any) -> Fluid:
    """Return what users give as a fluid: a :class:`Fluid`, one law, or none."""
    if isinstance(fluid, Fluid):
        return fluid
    if fluid is None or fluid == "newtonian":
        return Fluid()
    for name, (kind, _) in KINDS.items():
        if isinstance(fluid, kind) and not isinstance(fluid, type):
            return Fluid(**{name: fluid})
    raise InputError(
        f"fluid = {show(fluid)}; give a law of sb.fluids such as Carreau('1 ms', 0.5) or Barus('15 1/GPa'), or "
        "Fluid(rheology, viscosity, density) for several; liquids by name are in sb.fluids.PRESETS."
    )


def as_flow_factors(factors: Any) -> FlowFactors | None:
    """Return what users give as flow factors: a law, the name of one, or none."""
    if factors is None or factors == "none":
        return None
    if isinstance(factors, str) and factors in ("effective-medium", "patir-cheng"):
        from stribeck.fluids.effective_medium import EffectiveMedium
        from stribeck.fluids.flow_factors import PatirCheng

        return EffectiveMedium() if factors == "effective-medium" else PatirCheng()
    if isinstance(factors, FlowFactors) and not isinstance(factors, type):
        check_law(factors)
        return factors
    raise InputError(
        f"flow_factors = {show(factors)}; give 'effective-medium', 'patir-cheng', a law of sb.fluids such as "
        "PatirCheng(alpha=2.0, gamma=1), or 'none'."
    )


# What functions say that make liquids.
TEMPERATURE = 'str or float\n    As ``"25 degC"``, ``"298 K"`` or a number of degrees Celsius'
LIQUID = "Liquid\n    The liquid."
IMPOSSIBLE = "InputError\n    Where a number is impossible."


@dataclass(frozen=True)
class Liquid(Described):
    """A liquid under given conditions.

    Examples
    --------
    >>> import stribeck as sb
    >>> liquid = sb.fluids.glycerol_water(0.5, temperature="20 degC")
    >>> round(1e3 * liquid.viscosity, 1)  # mPa s
    6.0
    """

    name: Annotated[str, "what it is, with its conditions"]
    viscosity: Annotated[float, "viscosity at ambient pressure and low rate", "Pa s"]
    fluid: Annotated[Fluid, "how it depends on pressure and shear rate"]
    source: Annotated[str, "where the numbers are from"]
    thinning_rate: Annotated[
        float | None,
        "shear rate at which it begins to thin, where known of one without a law of thinning",
        "1/s",
    ] = None

    @property
    def inputs(self) -> dict[str, Any]:
        """The arguments ``viscosity`` and ``fluid`` of a contact."""
        return {"viscosity": self.viscosity, "fluid": self.fluid}

    def __str__(self) -> str:
        """Return name, viscosity, laws and source in one line."""
        return f"{self.name}: {format_si(self.viscosity, 'viscosity')}, {self.fluid.name} ({self.source})"


def celsius(temperature: str | float) -> float:
    """Return a temperature in degrees Celsius, given so as a number or as text in degC or K."""
    if isinstance(temperature, str):
        found = _TEMPERATURE.fullmatch(temperature.replace("\N{MINUS SIGN}", "-"))
        if found is None:
            raise InputError(f"temperature = {show(temperature)}; write it as '25 degC' or '298 K'.")
        return float(found[1]) - (273.15 if found[2] == "K" else 0.0)
    return to_si(temperature, "number", "temperature", "25")


def check_temperature(T: float, low: float, high: float) -> float:
    """Return a temperature, refused where a formula does not hold [degC]."""
    if not low <= T <= high:
        raise InputError(f"temperature = {T:g} degC must lie between {low:g} and {high:g} degC, where the formula holds.")
    return T
