"""A drag that nearly vanishes, as of rolling films on one wall: the error that is stated of it is its own."""

import stribeck as sb

RTOL = 1e-4
NEARLY = 1e-6


def rolling(speed: float, slide_to_roll: float, cavitation: str) -> sb.Groups:
    contact = {"radius": 1.0, "modulus": 1.0, "viscosity": 1.0, "alpha": 1.0, "beta": 1.0, "boundary_friction": 1.0}
    groups = sb.Groups(speed, 0.1, 1e-3)
    return sb.LineContact.from_groups(groups, **contact, slide_to_roll=slide_to_roll, cavitation=cavitation).groups


def vanishing(speed: float, wall: str, cavitation: str) -> tuple[float, float]:
    """Return a slide-to-roll ratio at which a Newtonian drag nearly vanishes, and the drag there.

    The film of a given speed is the same at any ratio, so that the drag is linear in it.
    """
    ratios = (-1.0, 1.0)
    low, high = (getattr(sb.solve(rolling(speed, s, cavitation), rtol=1e-10), wall) for s in ratios)
    slope = (high - low) / 2
    return (NEARLY - 1) * (low + high) / (2 * slope), NEARLY * (low + high) / 2


def test_the_stated_error_of_a_drag_that_nearly_vanishes_holds(subtests):
    for wall in ["viscous_balanced", "viscous_upper"]:
        for cavitation in ["none", "exit"]:
            with subtests.test(wall=wall, cavitation=cavitation):
                ratio, true = vanishing(1e-2, wall, cavitation)
                groups = rolling(1e-2, ratio, cavitation)
                curve = sb.stribeck_curve(groups, points=2, speed=(5e-3, 2e-2), rtol=RTOL)
                for found in (sb.solve(groups, rtol=RTOL), curve.at(1e-2), curve.solve_at(1e-2)):
                    assert abs(getattr(found, wall) - true) <= abs(true) * found.errors[wall]
                state = sb.solve(groups, rtol=RTOL)
                assert state.error_estimate <= RTOL
                if wall == "viscous_balanced":
                    friction = curve.at(1e-2)
                    assert abs(friction.friction.fluid - true) <= friction.friction.error
                    of_state = state.friction(boundary_friction=1e-9)  # the errors of asperities would hide that of the drag
                    assert abs(of_state.fluid - true) <= of_state.error
