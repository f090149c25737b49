"""States of a ball along a curve are those of a cold start."""

import pytest

import stribeck as sb


def test_a_contact_nearly_full_in_its_middle_is_followed_along_the_roughness():
    """On rougher and rougher surfaces more angles and higher degrees went to 54 and 13."""
    law = sb.surfaces.persson_law(sb.surfaces.SelfAffine(h_rms=21e-9, q0=6.3e5, q1=6.3e7, hurst=0.8), 0.45)
    load, scale = 1531.0, 1531.0 ** (2 / 3)
    groups = sb.Groups(1.126e-6, load, 0.05 * scale, law=law, geometry="point")
    kappas = [0.0716, 0.0889, 0.108]
    found = sb.solve_batch(groups, roughness=[kappa * scale for kappa in kappas], rtol=1.5e-3)
    assert found.ok.all() and (found.error_estimate <= 1.5e-3).all()
    cold = sb.solve(sb.Groups(1.126e-6, load, 0.108 * scale, law=law, geometry="point"), rtol=1.5e-3)
    for name in ("contact_load_share", "central_gap", "J_balanced"):
        assert getattr(found, name)[-1] == pytest.approx(getattr(cold, name), rel=3e-3, abs=3e-3)
