"""The groups that are solved: at rest where all gaps are positive, which are shifted afterwards.

A film with a cavity at ambient pressure is solved as one with an exit.
"""

import math
from dataclasses import replace

import numpy as np

from stribeck._types import Array
from stribeck.contact_laws.law import AsperityLaw, is_exponential
from stribeck.contact_laws.scaled import ShiftedLaw
from stribeck.contacts.groups import BASE_MODEL, Groups, Model
from stribeck.fluids.fluid import Cavitation
from stribeck.numerics.series import along
from stribeck.numerics.settings import NEGLIGIBLE

# Separation at the largest pressure of the smooth contact at rest: a tenfold pressure leaves the gap positive.
SAFE_SEPARATION = -math.log(NEGLIGIBLE)


def separation_at_pressure(shape: AsperityLaw, log_pressure: float) -> float:
    """Return the separation at which ln(Phi) has a given value, by bisection from -1e6 to 1e6, or the nearer end."""
    low, high = max(-1e6, shape.lowest), 1e6
    for _ in range(100):
        middle = 0.5 * (low + high)
        with np.errstate(all="ignore"):
            above = float(shape.log_pressure(np.array([middle]))[0]) > log_pressure
        low, high = (middle, high) if above else (low, middle)
    return 0.5 * (low + high)


def effective_model(model: Model) -> Model:
    """Return the model with exit in place of reformation at ambient pressure, where a cavity reaches to infinity."""
    if model.cavitation is Cavitation.REFORM and model.cavity_pressure == 0.0:
        return replace(model, cavitation=Cavitation.EXIT)
    return model


def with_positive_gap(groups: Groups) -> tuple[Groups, float]:
    r"""Return the groups to solve for, whose gap is positive everywhere, and the shift to add to their gap [u_Hz].

    .. math::

        \Delta h = -e \kappa \ln \frac{\bar F_N}{\bar F_N'}, \qquad
        \Delta h = -\kappa \max(0, s_0 - \Phi^{-1}(\bar F_N^e))

    A sliding contact is solved as it is, with an exit where its cavity is at ambient pressure.  At rest the load only shifts
    gap and offset: a heavy contact of the exponential law is solved at the load of one, and one of another law at separations
    so much larger, that at the pressure of the smooth
    contact they are s_0, :data:`SAFE_SEPARATION`.  Laws that diverge at zero need no shift.
    """
    if groups.speed > 0:
        model = effective_model(groups.model)
        return (groups if model is groups.model else replace(groups, model=model)), 0.0
    if groups.model != BASE_MODEL:  # at rest neither the fluid nor the end of its film matters
        groups = replace(groups, model=Model(solid=groups.model.solid, profile=groups.model.profile))
    shape = groups.law
    if shape is None or is_exponential(shape):
        exponents = groups.scaling
        load = math.exp(-SAFE_SEPARATION / exponents.pressure_exponent)
        if groups.load <= load:
            return groups, 0.0
        roughness = load**exponents.roughness_exponent * groups.relative_roughness
        lighter = replace(groups, load=load, roughness=roughness)
        heavier = exponents.pressure_exponent * math.log(float(groups.load / lighter.load))
        return lighter, -float(groups.relative_roughness) * heavier
    if shape.lowest > -np.inf or isinstance(shape, ShiftedLaw):
        return groups, 0.0
    shift = max(0.0, SAFE_SEPARATION - separation_at_pressure(shape, float(np.log(groups.pressure_scale))))
    if shift == 0.0:
        return groups, 0.0
    return replace(groups, law=ShiftedLaw(shape, shift)), -shift * float(groups.relative_roughness)


def shift_along(
    groups: Groups, base: Groups, direction: tuple[float, float, float], order: int
) -> tuple[tuple[float, float, float], Array]:
    """Return the direction of the groups to solve for along a path, and the series of the shift of their gap."""
    # ``base`` are those of ``groups`` by with_positive_gap; load and shift of the law stay fixed along the path.
    _, by_load, by_roughness = direction
    exponents = groups.scaling
    rate = by_roughness - exponents.roughness_exponent * by_load
    line = np.zeros(order + 1)  # the shift over kappa
    if base.load != groups.load:
        line[:2] = math.log(float(groups.load / base.load)), by_load
        direction, line = (0.0, 0.0, rate), -exponents.pressure_exponent * line
    elif isinstance(base.law, ShiftedLaw) and not isinstance(groups.law, ShiftedLaw):
        line[0] = -base.law.shift
    return direction, float(base.relative_roughness) * np.convolve(line, along(rate, order))[: order + 1]
