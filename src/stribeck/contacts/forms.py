"""Inputs in other forms: as data sheets, tribometers and tables of materials have them, and what follows from them."""

import math
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import Any

from stribeck.quantities.schema import Input


@dataclass(frozen=True, kw_only=True)
class Form:
    """Inputs that may be given in place of another."""

    of: str  # The input that follows
    inputs: tuple[Input, ...]  # Inputs that are given in its place, all together
    value: Callable[..., float]  # Value of the result from the inputs, in SI units
    uses: tuple[str, ...] = ()  # Inputs of the contact that it needs besides, before its own, and leaves where they are
    geometry: str = ""  # The geometry that it is for; empty for all
    formula: str = ""  # For people; empty where it need not be said
    source: str = ""  # For people
    error: float = 0.0  # Standard error of the formula itself over the value
    assumed: dict[str, float] = field(default_factory=dict)  # Other inputs that it takes for granted where they are not given
    meaning: str = ""  # Meaning of the input that follows, where people mistake it
    second: tuple[Input, ...] = ()  # Inputs of the other body, which may be given besides, all together
    joins: bool = False  # Whether the input that follows is given too, as that of the first body

    @property
    def names(self) -> tuple[str, ...]:
        """Names of its inputs."""
        return tuple(each.name for each in (*self.inputs, *self.second))


def _in_series(*bodies: float) -> float:
    """Return the modulus E* of one or two bodies from Young's modulus and Poisson ratio of each."""
    return 1 / sum((1 - nu**2) / E for E, nu in zip(bodies[::2], bodies[1::2], strict=True))


def modulus_of_shore_a(hardness: float) -> float:
    """Return Young's modulus [Pa] of rubber of a Shore A hardness."""
    return 0.0981e6 * (56 + 7.62336 * hardness) / (0.137505 * (254 - 2.54 * hardness))


def modulus_of_shore_d(hardness: float) -> float:
    """Return Young's modulus [Pa] of an elastomer of a Shore D hardness."""
    return float(1e6 * 10 ** (0.0235 * (hardness + 50) - 0.6403))


def _pressed(load: float, pressed: float) -> float:
    """Return the load F of F = ``load`` + 2 ``pressed`` F^(1/2), in which a pressure acts on a width that goes as F^(1/2)."""
    return (pressed + math.hypot(pressed, math.sqrt(load))) ** 2


def _hardness(letter: str, typical: str, ends: tuple[float, float], **relation: Any) -> Form:
    """Return how Young's modulus of an incompressible solid follows from a Shore hardness."""
    scale = Input(
        name=f"shore_{letter.lower()}",
        label=f"Shore {letter} hardness",
        dimension="number",
        typical=typical,
        letters=(f"Shore {letter}",),
        lowest=ends[0],
        zero=True,
        highest=ends[1],
        reason="there the relation holds",
    )
    return Form(of="youngs_modulus", inputs=(scale,), assumed={"poisson_ratio": 0.5}, **relation)


def _height(name: str, label: str, typical: str, **relation: Any) -> Form:
    """Return how the rms roughness follows from another height."""
    return Form(of="roughness", inputs=(Input(name=name, label=label, dimension="length", typical=typical),), **relation)


_FORCE = Input(name="force", label="force", dimension="force", typical="50 N")
_WIDTH = Input(name="width", label="width", dimension="length", typical="20 mm")

_YOUNGS_MODULUS = Input(
    name="youngs_modulus",
    label="Young's modulus",
    symbol="$E$",
    dimension="pressure",
    typical="2.0 MPa",
    source="PDMS Sylgard 184",
    letters=("E",),
)
_POISSON_RATIO = Input(
    name="poisson_ratio",
    label="Poisson's ratio",
    symbol=r"$\nu$",
    dimension="number",
    typical="0.5",
    source="rubber and gels",
    letters=("nu",),
    zero=True,
    highest=0.5,
)


def _of_other(row: Input) -> Input:
    """Return a number of the other body, which is rigid without it."""
    symbol, source = f"${row.symbol.strip('$')}_2$", f"{row.source}; without it the other body is rigid"
    return replace(row, name=f"{row.name}_2", label=f"{row.label} of the other body", symbol=symbol, source=source, letters=())


# The forms, in the order in which they are applied. A new one is a row here.
FORMS = (
    _hardness(
        "A",
        "70",
        (20, 90),
        value=modulus_of_shore_a,
        formula="E = 0.0981 (56 + 7.62336 S)/(0.137505 (254 - 2.54 S)) MPa",
        source="Gent 1958; other relations differ by a factor of up to 2",
        error=0.3,
    ),
    _hardness(
        "D",
        "50",
        (30, 85),
        value=modulus_of_shore_d,
        formula="lg(E/MPa) = 0.0235 (S + 50) - 0.6403",
        source="Qi, Joyce and Boyce 2003",
        error=0.4,
    ),
    _height(
        "ra",
        "Ra",
        "0.4 um",
        value=lambda ra: math.sqrt(math.pi / 2) * ra,
        formula="Rq = (pi/2)^(1/2) Ra",
        source="Gaussian heights; 1.1 to 1.4 on machined surfaces",
        error=0.1,
    ),
    _height("rq", "Rq", "0.5 um", value=lambda rq: rq, formula="h_rms = Rq", source="ISO 21920"),
    Form(
        of="viscosity",
        inputs=(
            Input(name="kinematic_viscosity", label="kinematic viscosity", dimension="kinematic", typical="46 cSt"),
            Input(
                name="density",
                label="density of the fluid",
                dimension="density",
                typical="870 kg/m^3",
                source="oil; water 1000",
            ),
        ),
        value=lambda nu, rho: nu * rho,
        formula="eta = nu rho",
        source="definition",
    ),
    Form(
        of="speed",
        inputs=(
            Input(name="rotational_speed", label="rotational speed", dimension="rotation", typical="1500 rpm"),
            Input(name="shaft_diameter", label="diameter of the shaft", dimension="length", typical="30 mm"),
        ),
        value=lambda omega, diameter: omega * diameter / 2,
        formula="U = omega d/2, the counterface at rest",
        source="definition",
    ),
    Form(
        of="speed",
        inputs=(
            Input(
                name="stroke",
                label="length of the stroke, from stop to stop",
                symbol="$S$",
                dimension="length",
                typical="50 mm",
                source="a motion to and fro",
                letters=("stroke",),
            ),
            Input(name="frequency", label="frequency of the stroke", symbol="$f$", dimension="rate", typical="2 Hz"),
        ),
        value=lambda stroke, frequency: 2 * stroke * frequency,
        formula="U = 2 S f, the mean over a cycle; the highest speed of a sine is pi/2 times that",
        source="definition",
    ),
    Form(
        of="load",
        geometry="line",
        inputs=(_FORCE, _WIDTH),
        value=lambda force, width: force / width,
        formula="load = force/width",
        source="definition",
    ),
    Form(
        of="load",
        geometry="line",
        uses=("youngs_modulus", "radius"),
        inputs=(
            Input(
                name="squeeze",
                label="squeeze of an O-ring over its cord diameter",
                symbol="$C$",
                dimension="number",
                typical="0.1",
                source="0.08 to 0.16 of dynamic seals, up to 0.25 of static ones",
                letters=("squeeze",),
                highest=0.3,
                reason="it is a share of the cord diameter, twice the radius, and the formula holds up to there",
            ),
        ),
        value=lambda E, R, squeeze: E * 2 * R * (1.25 * squeeze**1.5 + 50 * squeeze**6),
        formula="load = 2 R E (1.25 C^1.5 + 50 C^6)",
        source="Lindley 1967, a cord between two plates",
        error=0.1,
    ),
    Form(
        of="load", geometry="point", inputs=(_FORCE,), value=lambda force: force, formula="load = force", source="definition"
    ),
    Form(
        of="modulus",
        inputs=(_YOUNGS_MODULUS, _POISSON_RATIO),
        second=(_of_other(_YOUNGS_MODULUS), _of_other(_POISSON_RATIO)),
        value=_in_series,
        meaning="which is E*",
    ),
    Form(
        of="speed",
        inputs=(
            Input(
                name="entrainment_speed",
                label="entrainment speed",
                symbol=r"$\bar U$",
                dimension="speed",
                typical="1 mm/s",
                source="the mean of both surface speeds, which tribometers report",
                letters=("mean",),
                zero=True,
            ),
        ),
        value=lambda mean: 2 * mean,
        meaning="the sum of the surface speeds, twice their mean",
    ),
    Form(
        of="radius",
        joins=True,
        inputs=(
            Input(
                name="radius_2",
                label="radius of the other body",
                symbol="$R_2$",
                dimension="length",
                typical="50 mm",
                source="a second curved body; without it the other is flat",
            ),
        ),
        value=lambda first, second: 1 / (1 / first + 1 / second),
    ),
    Form(
        of="load",
        geometry="line",
        joins=True,
        uses=("modulus", "radius"),
        inputs=(
            Input(
                name="sealed_pressure",
                label="pressure that a rubber seal holds back",
                symbol="$P$",
                dimension="pressure",
                typical="1 MPa",
                source="adds to the load of squeeze or lip; hydraulics 1 to 40 MPa",
                zero=True,
            ),
        ),
        value=lambda modulus, radius, load, pressure: _pressed(load, pressure * (4 * radius / (math.pi * modulus)) ** 0.5),
        formula="load + 2 a P, with the half-width a of the contact under both",
        source="incompressible rubber transmits pressure as a liquid does; the film is solved between ambient pressures",
        error=0.2,
    ),
)
