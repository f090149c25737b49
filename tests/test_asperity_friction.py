"""Friction of asperities as a shear stress times their real area of contact."""

import math
import pickle
from pathlib import Path

import numpy as np
import pytest
from command_line import call

import stribeck as sb
from stribeck.asperity_friction import Coulomb, ShearStress, ShearStressTable
from stribeck.surfaces import SelfAffine, persson_law

EXAMPLES = Path(__file__).parents[1] / "examples"
TAU = 2e5


@pytest.fixture(scope="module")
def seal():
    return sb.load_case(EXAMPLES / "rod_seal.toml").contact


def with_heights(contact, h_rms, **changes):
    """Return the contact with a surface of the same spectrum and other heights."""
    law = contact.law.scaled(h_rms)
    return contact.replace(law=law, **law.coefficients, **changes)


def test_where_little_of_the_surface_touches_a_stress_is_a_coefficient(seal):
    rough = with_heights(seal, 20e-6, load=10.0, speed=1e-3, cavitation="none", shear_stress=TAU)
    state = sb.solve(rough)
    mu0 = rough.asperity_friction.coefficient_at_small_area(rough)
    assert mu0 == pytest.approx(math.sqrt(8 / math.pi) * TAU / (rough.modulus * rough.law.rms_slope), rel=1e-9)
    assert state.contact_load_share > 0.5
    assert state.friction.asperities == pytest.approx(mu0 * state.contact_load_share, rel=1e-3)
    by_coefficient = sb.solve(rough.replace(boundary_friction=mu0))
    assert by_coefficient.friction.asperities == mu0 * state.contact_load_share
    assert by_coefficient.friction.fluid == state.friction.fluid


def test_near_full_contact_friction_is_the_stress_times_the_dry_width(seal):
    smooth = with_heights(seal, 0.3e-6, speed=0.0, cavitation="none", shear_stress=TAU)
    low, high = (sb.solve(smooth.replace(load=load)) for load in (800.0, 3200.0))
    for state in (low, high):
        contact = state.contact
        assert float(state.friction) * contact.load == pytest.approx(TAU * 2 * contact.hertz.half_width, rel=0.025)
        assert state.friction.total < 0.5 * contact.asperity_friction.coefficient_at_small_area(contact)
    assert float(high.friction) / float(low.friction) == pytest.approx(0.5, rel=0.02)


def test_friction_has_no_unit(seal):
    stiff = seal.replace(shear_stress="200 kPa", speed_exponent=0.2)
    factor = 10.0
    scaled = stiff.replace(
        modulus=factor * stiff.modulus,
        load=factor * stiff.load,
        viscosity=factor * stiff.viscosity,
        shear_stress=factor * TAU,
    )
    one, other = (sb.solve(each).friction for each in (stiff, scaled))
    assert other.asperities == pytest.approx(one.asperities, rel=1e-9)
    assert sb.solve(seal, asperity_friction=ShearStress(TAU, speed_exponent=0.2)).friction == one


def test_the_stress_follows_the_sliding_speed_by_its_exponent_or_table():
    power = ShearStress("0.1 MPa", speed_exponent=0.3, reference_speed="1 mm/s")
    assert power.stress(1e-3) == pytest.approx(1e5)
    assert power.stress(1e-2) == pytest.approx(1e5 * 10**0.3)
    table = ShearStressTable(["1 mm/s", "10 mm/s"], [power.stress(1e-3), power.stress(1e-2)])
    assert table.stress(4e-3) == pytest.approx(power.stress(4e-3), rel=1e-12)


def test_the_sliding_speed_is_the_difference_of_the_surfaces(seal):
    constant = sb.solve(seal, asperity_friction=ShearStress(TAU)).friction.asperities
    for slide_to_roll, sliding in ((2.0, seal.speed), (1.0, 0.5 * seal.speed)):
        power = ShearStress(TAU, speed_exponent=0.5, reference_speed=1e-3)
        found = sb.solve(seal, asperity_friction=power, slide_to_roll=slide_to_roll).friction.asperities
        assert found / constant == pytest.approx(math.sqrt(sliding / 1e-3), rel=1e-5)


def test_the_area_lies_within_its_stated_error_on_both_geometries(seal, subtests):
    ball = sb.load_case(EXAMPLES / "pdms_ball.toml").contact
    for contact, rtols in ((seal, (1e-4, 1e-9)), (ball.replace(speed=0.0), (1e-3, 1e-6))):
        with subtests.test(geometry=contact.groups.geometry):
            coarse, fine = (sb.solve(contact, rtol=rtol) for rtol in rtols)
            assert 0 < fine.real_contact_area < 1.2
            assert abs(coarse.real_contact_area - fine.real_contact_area) <= coarse.real_contact_area_error
            assert fine.real_contact_area_error < 1e-5


def test_a_ball_rubs_by_its_real_area():
    ball = sb.load_case(EXAMPLES / "pdms_ball.toml").contact.replace(speed=0.0, shear_stress=TAU)
    state = sb.solve(ball)
    area = state.real_contact_area * math.pi * ball.hertz.half_width**2
    assert float(state.friction) == pytest.approx(TAU * area / ball.load, rel=1e-12)
    assert area < state.contact.hertz.half_width**2 * math.pi * 1.2


@pytest.mark.slow
def test_a_curve_has_the_friction_of_its_states_and_its_least(seal):
    contact = seal.replace(shear_stress=TAU, speed_exponent=0.1)
    curve = sb.stribeck_curve(contact, speed=(0.3, 1.0), points=3)
    for i in (0, 2):
        state = sb.solve(contact.replace(speed=curve.values[i]), rtol=1e-9)
        allowed = state.friction.error + curve.friction.error[i]
        assert abs(state.friction.total - curve.friction.total[i]) <= allowed
    least, around = curve.minimum, math.exp(0.05)
    below, at, above = (
        sb.solve(contact.replace(speed=least.value * each), rtol=1e-9).friction.total for each in (1 / around, 1, around)
    )
    assert at < min(below, above)
    # The curvature shows that the slope vanishes there: both sides are alike.
    assert abs(above - below) < 0.1 * (above + below - 2 * at)
    assert least.friction == pytest.approx(at, rel=1e-6)
    said = curve.to_dataset().attrs
    assert said["asperity_friction"] == "shear-stress" and math.isnan(said["boundary_friction"])


def test_a_batch_rubs_as_its_states_do(seal):
    contact = seal.replace(shear_stress=TAU)
    batch = sb.solve_batch(contact, speed=np.array([1e-3, 0.1]))
    alone = [sb.solve(contact.replace(speed=speed)).friction for speed in (1e-3, 0.1)]
    assert np.abs(batch.friction.total - np.array(alone)).max() <= np.max(batch.friction.error) + alone[0].error


def test_a_coefficient_stays_what_it_is(seal):
    state = sb.solve(seal)
    assert state.friction.asperities == seal.boundary_friction * state.contact_load_share
    assert state.friction(Coulomb(0.3)) == state.friction(0.3) == state.friction
    given = ShearStress(TAU)
    assert state.friction(given).asperities == sb.solve(seal, asperity_friction=given).friction.asperities


def test_one_friction_takes_the_place_of_the_other(seal):
    stress = seal.replace(shear_stress=TAU)
    assert stress != seal
    assert stress == stress.replace() == pickle.loads(pickle.dumps(stress))
    assert hash(stress) == hash(stress.replace())
    assert stress.replace(boundary_friction=0.3) == seal
    assert stress.replace(load="500 N/m").asperity_friction == ShearStress(TAU)
    assert stress.replace(shear_stress="0.3 MPa").asperity_friction.shear_stress == 3e5
    assert "boundary_friction" not in stress.to_si()
    assert stress.groups == seal.groups


def test_a_case_file_and_the_command_take_a_stress(seal, tmp_path, capsys):
    text = (EXAMPLES / "rod_seal.toml").read_text().replace("boundary_friction = 0.3", "")
    path = tmp_path / "case.toml"
    path.write_text(text + '\n[asperity_friction]\nmodel = "shear-stress"\nshear_stress = "0.2 MPa"\n')
    assert sb.load_case(path).contact == seal.replace(shear_stress=TAU)
    assert "0.01821" in call(capsys, "solve", path).out
    path.write_text(text.replace('load = "770 N/m"', 'load = "770 N/m"\nshear_stress = "0.2 MPa"'))
    with pytest.raises(sb.InputError, match=r"it stands in the table \[asperity_friction\]"):
        sb.load_case(path)


def test_what_has_no_stress_is_refused_with_a_sentence(seal, subtests):
    for make, words in [
        (lambda c: c.replace(law=None, shear_stress=TAU), "which law = 'exponential' does not know"),
        (lambda c: c.replace(law="greenwood-williamson", alpha=1.0, shear_stress=TAU), "does not know: give the"),
        (lambda c: c.replace(shear_stress=TAU).boundary_friction, "what was asked needs a coefficient"),
        (lambda c: c.replace(shear_stress=TAU, boundary_friction=0.3), "are both given"),
        (lambda c: c.replace(shear_stress="-1 MPa"), "must be zero or positive"),
        (lambda c: c.replace(shear_stress="1 mm"), "expected a pressure"),
        (lambda c: c.replace(asperity_friction="0.2 MPa"), "give one of stribeck.asperity_friction"),
        (lambda c: c.replace(shear_stress=TAU, speed_exponent=-0.5, speed=0.0), "infinite at rest"),
        (lambda c: c.replace(asperity_friction=ShearStressTable([1e-3, 1e-2], [1e5, 2e5])), "outside the table"),
        (lambda c: ShearStressTable([1e-2, 1e-3], [1e5, 2e5]), "speeds that rise"),
        (lambda c: ShearStressTable([1e-3, 1e-2], [1e5]), "give a stress for each speed"),
        (lambda c: sb.solve(sb.Groups(1e-5, 0.1, 1e-4), asperity_friction=ShearStress(TAU)), "needs a contact in SI units"),
        (lambda c: sb.solve(sb.Groups(1e-5, 0.1, 1e-4)).friction(ShearStress(TAU)), "needs a contact in SI units"),
        (
            lambda c: sb.stribeck_curve(load=0.1, roughness=1e-4, speed=[1e-6, 1e-3], boundary_friction=ShearStress(TAU)),
            "needs a contact in SI units",
        ),
    ]:
        with subtests.test(words), pytest.raises(sb.InputError, match=words):
            make(seal)


def test_a_law_of_a_spectrum_knows_its_area_whatever_its_shape(seal):
    law = persson_law(SelfAffine(h_rms=1e-6, q0=2 * math.pi / 150e-6, q1=2 * math.pi / 1.5e-6, hurst=0.8))
    assert sb.solve(seal.replace(law=law, shear_stress=TAU)).real_contact_area > 0
    finite = seal.replace(law=sb.contact_laws.FiniteSurface(seal.alpha, seal.law), shear_stress=TAU)
    assert 0 < sb.solve(finite).real_contact_area < sb.solve(seal).real_contact_area
