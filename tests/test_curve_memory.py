"""What a curve keeps in memory: it hardly grows with its points, what is read off it solves nothing, and it leaves nothing."""

import gc
import types

import numpy as np

import stribeck as sb

BALL = sb.PointContact(
    radius="10 mm",
    modulus="2.7 MPa",
    load="0.3 N",
    viscosity="50 mPa*s",
    speed="1 mm/s",
    roughness="1 um",
    alpha=2.0,
    beta=0.06,
    boundary_friction=0.7,
)


def bytes_of(kept):
    """Return the bytes of all arrays that an object holds, directly or not."""
    waiting, seen, found = [kept], set(), 0
    while waiting:
        each = waiting.pop()
        if id(each) in seen or isinstance(each, type | types.ModuleType | types.FunctionType):
            continue
        seen.add(id(each))
        if isinstance(each, np.ndarray):
            found += each.nbytes if each.base is None else 0
        waiting += gc.get_referents(each)
    return found


def test_a_point_keeps_its_fields_and_no_matrices():
    curve = sb.stribeck_curve(BALL, speed=("10 mm/s", "20 mm/s"), points=2, rtol=1e-2, cavitation="exit")
    for solution in curve.solutions:
        assert bytes_of(solution) < 100 * 8 * solution.nodes


def test_a_film_that_ends_keeps_its_responses_at_the_nodes_where_it_does():
    # Total pressure and gap at all nodes under a residual at each cavitated one took a third more.
    groups = sb.Groups(speed=1e-3, load=1e-3, roughness=1e-3, geometry="point")
    solution = sb.solve(groups, rtol=1e-3, cavitation="exit")
    assert bytes_of(solution) < 7 * solution.nodes**2


def test_points_notes_and_marks_are_read_off_a_curve_without_solving_its_points():
    curve = sb.stribeck_curve(BALL, speed=("10 mm/s", "80 mm/s"), points=5, rtol=3e-3)
    before, fields = bytes_of(curve), 8 * curve.solutions[-1].nodes
    finer = curve.sampled(60)
    assert finer.notes and finer.regimes and finer.to_dataset().sizes["speed"] == 60
    assert bytes_of((curve, finer)) - before < 60 * 20 * fields  # a solved state holds a hundred times its fields and more


def test_a_curve_and_a_state_that_are_dropped_leave_their_memory_at_once():
    for _ in range(2):  # the first one fills what is kept for others
        gc.collect()
        gc.disable()
        try:
            curve = sb.stribeck_curve(load=0.1, roughness=1e-4, speed=(1e-3, 1e-1), points=3, rtol=1e-3)
            assert len(curve.friction) == len(curve.observable("central_gap")) == 3 and curve.minimum is not None
            state = sb.solve(BALL, rtol=1e-2, cavitation="exit")
            del curve, state
            left = gc.collect()
        finally:
            gc.enable()
    assert left == 0
