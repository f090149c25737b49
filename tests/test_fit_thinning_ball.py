"""Fits of balls in a fluid that thins: the error that is stated of the friction is that of the states, and no wild number.

Six seconds, as each state of such a ball takes a third of one.
"""

import numpy as np
from command_line import case_text

import stribeck as sb

BALL = {"geometry": '"point"', "load": '"1 N"', "speed": '"10 mm/s"', "roughness": '"0.3 um"', "viscosity": '"0.5 Pa*s"'}
FLUID = {"model": '"carreau"', "relaxation_time": '"1 ms"', "exponent": "0.6"}


def test_the_stated_error_of_friction_covers_the_solved_one_and_is_near_the_tolerance(tmp_path):
    path = tmp_path / "ball.toml"
    path.write_text(case_text(BALL, fluid=FLUID, solver={"rtol": "1e-3"}))
    case = sb.load_case(path)
    speeds = np.array([0.01, 0.05, 0.2])
    data = tmp_path / "data.csv"
    data.write_text("speed [m/s],friction\n" + "\n".join(f"{u},{0.02 * (u / 0.01) ** 0.6}" for u in speeds))
    found = sb.fit(data, case, free=["viscosity"], intervals=False)
    solved = sb.solve(found.contact.replace(speed=speeds[1]), rtol=1e-4).friction().total
    assert abs(found.friction[1] / solved - 1) <= found.model_error + 1e-4 <= 3e-2
