r"""Oils as data sheets name them: ISO VG grade and viscosity index, or two viscosities, at any temperature.

.. math::

    \lg \lg (\nu + 0.7) = A - B \lg T

with :math:`\nu` in cSt and T in K, through the viscosities at 40 and 100 degrees Celsius (ASTM D341, whose further terms
change viscosities above 2 cSt by up to 0.5 %, and lower ones by up to 2 %).  A viscosity index V
gives the one at 100 degrees from that at 40 (ASTM D2270):

.. math::

    V = 100 \frac{L - \nu_{40}}{L - H} \text{ up to 100, beyond it} \quad V = 100 + \frac{10^N - 1}{0.00715}, \quad
    N = \frac{\lg (H/\nu_{40})}{\lg \nu_{100}}

where L and H are the viscosities at 40 degrees of reference oils of index 0 and 100 that have the same :math:`\nu_{100}`.
"""

import math
import re

from stribeck.fluids.description import IMPOSSIBLE, LIQUID, TEMPERATURE, Fluid, Liquid, celsius, check_temperature
from stribeck.numerics.newton import root_between
from stribeck.quantities.docstrings import told
from stribeck.quantities.units import InputError, show, to_si

OIL_EYRING_STRESS = 3e6  # Stress kT per molecule of PAO 10 (0.63 kg/mol), rounded down [Pa].

THERMAL_EXPANSION = 0.65  # Density that mineral oils lose per kelvin [kg/m^3/K]

# ASTM D2270: smallest viscosity at 100 degC [cSt]; coefficients of its square, itself and one, of L and of H.
REFERENCE_OILS = (
    (2.0, (1.14673, 1.7576, -0.109), (0.84155, 1.5521, -0.077)),
    (3.8, (3.38095, -15.4952, 33.196), (0.78571, 1.7929, -0.183)),
    (4.4, (2.5, -7.2143, 13.812), (0.82143, 1.5679, 0.119)),
    (5.0, (0.101, 16.635, -45.469), (0.04985, 9.1613, -18.557)),
    (6.4, (3.35714, -23.5643, 78.466), (0.22619, 7.7369, -16.656)),
    (7.0, (0.01191, 21.475, -72.87), (0.79762, -0.7321, 14.61)),
    (7.7, (0.41858, 16.1558, -56.04), (0.05794, 10.5156, -28.24)),
    (9.0, (0.88779, 7.5527, -16.6), (0.26665, 6.7015, -10.81)),
    (12.0, (0.7672, 10.7972, -38.18), (0.20073, 8.4658, -22.49)),
    (15.0, (0.97305, 5.3135, -2.2), (0.28889, 5.9741, -4.93)),
    (18.0, (0.97256, 5.25, -0.98), (0.24504, 7.416, -16.73)),
    (22.0, (0.91413, 7.4759, -21.82), (0.20323, 9.1267, -34.23)),
    (28.0, (0.87031, 9.7157, -50.77), (0.18411, 10.1015, -46.75)),
    (40.0, (0.84703, 12.6752, -133.31), (0.17029, 11.4866, -80.62)),
    (55.0, (0.85921, 11.1009, -83.19), (0.1713, 11.368, -76.94)),
    (70.0, (0.83531, 14.6731, -216.246), (0.16841, 11.8493, -96.947)),
)
# What functions say that make oils.
OF_OIL = {"temperature": f"{TEMPERATURE}, -20 to 150.", "density_15": "str or float\n    Density at 15 degrees [kg/m^3]."}

THINNEST, THICKEST = 2.0, 500.0  # Viscosities at 100 degC between which the index is defined, or oils are known [cSt]
SOURCE = "ASTM D341 and D2270; density at 15 degC less 0.65 kg/m^3 per kelvin"


@told(OF_OIL, raises=IMPOSSIBLE)
def iso_vg(
    grade: str | float = 46.0,
    temperature: str | float = 40.0,
    viscosity_index: float = 100.0,
    density_15: str | float = 870.0,
) -> Liquid:
    """Return a mineral oil of an ISO VG grade, its kinematic viscosity at 40 degrees Celsius, at another temperature.

    Parameters
    ----------
    grade : str or float
        ISO VG grade, the viscosity at 40 degrees [cSt], as ``46``, ``"46 cSt"`` or ``"VG 46"``; 5 to 3200.
    viscosity_index : float
        Viscosity index [-], 0 to 250; 90 to 105 of mineral oils, 130 to 200 of synthetic and multigrade ones.

    Returns
    -------
    Liquid
        The liquid.  A grade is known to 10 %; by the index the viscosity is exact to 1 % between 20 and 100 degrees.

    Examples
    --------
    >>> import stribeck as sb
    >>> hydraulic = sb.fluids.iso_vg(46, temperature="60 degC")
    >>> round(1e3 * hydraulic.viscosity, 1)  # mPa s; 20.6 cSt
    17.3
    """
    named = re.fullmatch(r"\s*(?:ISO)?[\s-]*VG[\s-]*(.*)", grade, re.IGNORECASE) if isinstance(grade, str) else None
    at_40 = centistokes(named[1] if named else grade, "grade")
    if not 5 <= at_40 <= 3200:
        raise InputError(f"grade = {show(grade)} must lie between 5 and 3200 cSt, the viscosity at 40 degC, as in ISO VG 46.")
    index = to_si(viscosity_index, "number", "viscosity_index", "100")
    if not 0 <= index <= 250:
        raise InputError(f"viscosity_index = {show(viscosity_index)} must lie between 0 and 250; mineral oils have 90 to 105.")
    return _oil(f"ISO VG {at_40:g}, index {index:g},", at_40, _at_100(at_40, index), temperature, density_15)


@told(OF_OIL, LIQUID)
def oil(
    viscosity_40: str | float = 46.0,
    viscosity_100: str | float = 6.8,
    temperature: str | float = 40.0,
    density_15: str | float = 870.0,
) -> Liquid:
    """Return an oil whose kinematic viscosity is known at 40 and at 100 degrees Celsius, at another temperature.

    Parameters
    ----------
    viscosity_40 : str or float
        Kinematic viscosity at 40 degrees [cSt], as ``"46 cSt"`` or a number of cSt.
    viscosity_100 : str or float
        That at 100 degrees [cSt], likewise.

    Raises
    ------
    InputError
        Where a number is impossible, or the oil is not thinner at 100 degrees.

    Examples
    --------
    >>> import stribeck as sb
    >>> round(1e3 * sb.fluids.oil("61.0 cSt", "9.64 cSt", "80 degC", density_15=833.0).viscosity, 2)  # mPa s
    12.35
    """
    at_40, at_100 = centistokes(viscosity_40, "viscosity_40"), centistokes(viscosity_100, "viscosity_100")
    if not 1.5 <= at_100 < at_40:
        raise InputError(
            f"viscosity_100 = {show(viscosity_100)} must lie between 1.5 cSt and viscosity_40 = {show(viscosity_40)}: the "
            "kinematic viscosities at 100 and at 40 degC."
        )
    return _oil(f"oil of {at_40:g} and {at_100:g} cSt", at_40, at_100, temperature, density_15)


def centistokes(value: str | float, name: str) -> float:
    """Return a kinematic viscosity in cSt, given so as a number, or as text with a unit or without."""
    try:
        return to_si(float(value), "number", name)
    except (TypeError, ValueError):
        try:
            return 1e6 * to_si(value, "kinematic", name, "46 cSt")
        except InputError:
            problem = f"{name} = {show(value)}; write a kinematic viscosity such as '46 cSt', or a bare number of cSt."
            raise InputError(problem) from None


def _oil(name: str, at_40: float, at_100: float, temperature: str | float, density_15: str | float) -> Liquid:
    T = check_temperature(celsius(temperature), -20, 150)
    density = to_si(density_15, "density", "density_15", "870 kg/m^3")
    if not 700 <= density <= 1100:
        raise InputError(f"density_15 = {show(density_15)} must lie between 700 and 1100 kg/m^3, as that of oils.")
    slope = (_double_log(at_40) - _double_log(at_100)) / math.log10(373.15 / 313.15)
    kinematic = 10**10 ** (_double_log(at_40) - slope * math.log10((T + 273.15) / 313.15)) - 0.7
    viscosity = 1e-6 * kinematic * (density - THERMAL_EXPANSION * (T - 15))
    return Liquid(f"{name} at {T:g} degC, {kinematic:.3g} cSt", viscosity, Fluid(), SOURCE, OIL_EYRING_STRESS / viscosity)


def _double_log(kinematic: float) -> float:
    return math.log10(math.log10(kinematic + 0.7))


def viscosity_index(at_40: float, at_100: float) -> float:
    """Return the viscosity index of an oil by its viscosities in cSt."""
    of_0, of_100 = next((low, high) for start, low, high in reversed(REFERENCE_OILS) if at_100 >= start)
    low, high = ((a * at_100 + b) * at_100 + c for a, b, c in (of_0, of_100))
    if at_40 >= high:
        return 100 * (low - at_40) / (low - high)
    return 100 + (10 ** (math.log10(high / at_40) / math.log10(at_100)) - 1) / 0.00715


def _at_100(at_40: float, index: float) -> float:
    """Return the viscosity at 100 degrees of an oil of an index: that grows with it."""
    found = root_between(lambda at_100: viscosity_index(at_40, at_100) - index, THINNEST, min(THICKEST, at_40), 1e-9)
    if found is None:
        raise InputError(
            f"viscosity_index = {index:g} and grade = {at_40:g}: the index is defined from 2 cSt at 100 degC on, and this oil "
            "is thinner; give both viscosities, preset = 'oil' with viscosity_40 and viscosity_100."
        )
    return found
