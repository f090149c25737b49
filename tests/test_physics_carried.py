"""Groups that a curve, a batch or a diagram makes of others keep their contact law, geometry and model."""

import numpy as np

import stribeck as sb

BALL = sb.Groups(1e-2, 1e-3, 1e-4, law=sb.contact_laws.GreenwoodTripp(), geometry="point")


def test_groups_made_of_others_share_their_physics():
    curve = sb.stribeck_curve(BALL, load=np.array([1e-3, 2e-3, 4e-3]), rtol=1e-2)
    batch = sb.solve_batch(BALL, load=[1e-3, 2e-3], rtol=1e-2)
    for groups in (curve.groups, curve.solutions[1].groups, batch.groups):
        assert (groups.law, groups.geometry, groups.model) == (BALL.law, "point", BALL.model)
    diagram = sb.phase_diagram(BALL, load=[1e-3], roughness=[1e-4], speed=[1e-2], rtol=1e-2)
    assert diagram.attrs["contact_law"] == "greenwood-tripp"
    assert (
        diagram.central_gap.item() == sb.solve(BALL, rtol=1e-2).central_gap
        or abs(diagram.central_gap.item() / sb.solve(BALL, rtol=1e-2).central_gap - 1) < 2e-2
    )
