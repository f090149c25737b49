"""Regimes and what moves friction: boundaries of the names, elasticities against finite differences of solves."""

import math

import numpy as np
import pytest

import stribeck as sb
from stribeck.regimes import EXPONENTS, friction_elasticities

CONTACT = sb.LineContact(
    radius="10 mm",
    modulus="2.7 MPa",
    load="30 N/m",
    viscosity="50 mPa*s",
    speed="1 mm/s",
    roughness="1 um",
    alpha=2.0,
    beta=0.06,
    friction_coefficient=0.7,
)


@pytest.mark.parametrize(
    ("fluid", "contact", "regime"),
    [
        (0.0, 1.0, "boundary"),
        (0.05, 0.99, "boundary"),
        (0.051, 0.99, "mixed"),
        (0.99, 0.11, "mixed"),
        (0.99, 0.1, "hydrodynamic"),
        (0.04, 0.1, "hydrodynamic"),
    ],
)
def test_a_regime_is_named_by_the_shares_of_load_and_friction(fluid, contact, regime):
    assert sb.regime_of(fluid, contact) == regime


@pytest.mark.parametrize("name", EXPONENTS)
def test_the_exponents_are_those_of_the_groups(name):
    def logs(factor):
        groups = CONTACT.replace(**{name: factor * getattr(CONTACT, name)}).groups
        return np.log([groups.speed, groups.load, groups.roughness])

    slope = (logs(1.1) - logs(1 / 1.1)) / (2 * math.log(1.1))
    np.testing.assert_allclose(slope, EXPONENTS[name], atol=1e-12)


@pytest.mark.parametrize(("speed", "definition"), [(1e-3, "paper"), (0.03, "balanced")])
def test_elasticities_agree_with_differences_of_cold_solves(speed, definition):
    contact = CONTACT.replace(speed=speed)
    solution, found = friction_elasticities(contact, rtol=1e-9, definition=definition)
    assert solution.friction(definition=definition) == sb.solve(contact, rtol=1e-9).friction(definition=definition)
    step = 1e-2
    for name in EXPONENTS:

        def log_friction(k, name=name):
            other = contact.replace(**{name: getattr(contact, name) * math.exp(k * step)})
            return math.log(sb.solve(other, rtol=1e-9).friction(definition=definition).total)

        f = [log_friction(k) for k in (-2, -1, 1, 2)]
        assert found[name] == pytest.approx((f[0] - 8 * f[1] + 8 * f[2] - f[3]) / (12 * step), abs=1e-6)


def test_elasticities_obey_the_dimensions():
    # Speed and viscosity enter as their product; friction knows no unit of force and none of length.
    _, found = friction_elasticities(CONTACT)
    assert found["speed"] == found["viscosity"]
    assert found["load"] + found["modulus"] + found["viscosity"] == pytest.approx(0, abs=1e-12)
    assert found["alpha"] == -found["roughness"]


def test_at_rest_only_the_dry_friction_coefficient_matters():
    solution, found = friction_elasticities(CONTACT.replace(speed=0))
    assert found.pop("friction_coefficient") == pytest.approx(1, abs=1e-6)
    assert set(found.values()) == {0.0}
    assert solution.groups.speed == 0


def test_a_smooth_contact_does_not_ask_for_its_law_of_roughness():
    _, found = friction_elasticities(CONTACT.replace(roughness=0))
    assert found["roughness"] == found["alpha"] == found["beta"] == found["friction_coefficient"] == 0
    assert found["speed"] > 0.4


def test_where_there_is_no_friction_elasticities_are_no_number():
    _, found = friction_elasticities(CONTACT.replace(speed=0, friction_coefficient=0))
    assert all(math.isnan(value) for value in found.values())


@pytest.mark.parametrize("arguments", [{"rtol": 1e-20}, {"definition": "mine"}])
def test_bad_settings_are_refused(arguments):
    with pytest.raises(sb.InputError):
        friction_elasticities(CONTACT, **arguments)
