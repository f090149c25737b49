"""Every command takes every fluid, cavitation, solid and motion, of a cylinder and of a ball, or refuses it by name."""

import re

import pytest
from command_line import call

SCALES = {
    "line": 'load = "50 N/m"\nroughness = "1 um"',
    "point": 'geometry = "point"\nload = "0.5 N"\nroughness = "5 um"',
}
SLIDING, ROLLING = 'speed = "20 mm/s"', 'entrainment_speed = "10 mm/s"\nslide_to_roll = 0.5'
THINNING = 'relaxation_time = "1 ms"\nexponent = 0.5'
PARTS = {
    "article": "",
    "exit": '[cavitation]\nmodel = "exit"',
    "cavity": '[cavitation]\nmodel = "reform"\ncavity_pressure = "-5 kPa"',
    "suction above the cavity": '[cavitation]\nmodel = "reform"\ncavity_pressure = "-1 bar"',
    "barus": '[fluid]\npressure_coefficient = "100 1/GPa"',
    "roelands": '[fluid]\npressure_coefficient = "100 1/GPa"\nviscosity_law = "roelands"\ndensity = "dowson-higginson"',
    "carreau": f'[fluid]\nmodel = "carreau"\n{THINNING}',
    "cross": f'[fluid]\nmodel = "cross"\n{THINNING}',
    "eyring": '[fluid]\nmodel = "eyring"\neyring_stress = "10 kPa"',
    "patir-cheng": '[flow_factors]\nmodel = "patir-cheng"',
    "layer": '[solid]\nlayer_thickness = "2 mm"\npoisson_ratio = 0.49',
    "standard solid": '[solid]\nretardation_time = "10 ms"\nmodulus_ratio = 3.0',
    "prony": '[solid]\nrelaxation_times = ["1 ms", "10 ms"]\nmoduli = [1.0, 0.5]',
    "rolling": "",
}
SHOWN = {
    ("line", "exit"): "end of the film",
    ("line", "cavity"): "film reforms",
    ("point", "exit"): "dry wake",
    ("line", "prony"): "Prony series",
    ("point", "layer"): "layer",
}
COMMANDS = {
    "solve": ["--rtol", "1e-2", "-v"],
    "curve": ["--points", "3", "--rtol", "1e-3"],
    "check": [],
    "regimes": [],
}
LONG = {"curve", "check", "regimes"}
OF_A_BALL = {"exit", "carreau", "layer", "standard solid", "rolling"}
"""Parts that a ball has words of its own for, or refuses; its states with the others are printed alike and take seconds."""


def is_refused(geometry, answer):
    """Return whether what is refused is what a ball does not have, by its name."""
    return geometry == "point" and "of a ball" in answer.err


@pytest.fixture
def case(tmp_path):
    """Return a function that writes the case of a geometry with a part, and returns its path."""

    def write(geometry, part):
        speed = ROLLING if part == "rolling" else SLIDING
        path = tmp_path / "case.toml"
        path.write_text(
            f'[contact]\n{SCALES[geometry]}\n{speed}\nradius = "10 mm"\nmodulus = "2.1 MPa"\nviscosity = "50 mPa*s"\n'
            f"alpha = 2.0\nbeta = 0.06\nboundary_friction = 0.8\n{PARTS[part]}\n"
        )
        return path

    return write


@pytest.mark.parametrize(
    "command", [pytest.param(name, marks=[pytest.mark.slow] if name in LONG else []) for name in COMMANDS]
)
@pytest.mark.parametrize("geometry", SCALES)
def test_a_command_takes_a_part_or_refuses_it_by_name(subtests, capsys, case, geometry, command):
    for part in OF_A_BALL if (geometry, command) == ("point", "solve") else PARTS:
        with subtests.test(part=part):
            answer = call(capsys, command, case(geometry, part), *COMMANDS[command])
            if answer.code == 2:
                assert is_refused(geometry, answer)
                continue
            assert answer.code == 0 and "rror" not in answer.err, answer.err
            assert command != "solve" or SHOWN.get((geometry, part), "") in answer.out
            assert command != "curve" or "minimum of friction" in answer.out
            assert not re.search(r"\b(nan|inf)\b", answer.out)


@pytest.mark.slow
@pytest.mark.parametrize("part", PARTS)
@pytest.mark.parametrize("geometry", SCALES)
def test_the_files_pictures_and_report_of_a_part_are_written(capsys, case, tmp_path, geometry, part):
    path, folder = case(geometry, part), tmp_path
    targets = ["-o", folder / "curve.nc", "-o", folder / "curve.csv", "--plot", folder / "curve.png"]
    answer = call(capsys, "curve", path, "--points", "3", "--rtol", "1e-3", *targets)
    if answer.code == 2:
        assert is_refused(geometry, answer)
        return
    assert answer.code == 0, answer.err
    assert all((folder / name).stat().st_size > 100 for name in ("curve.nc", "curve.csv", "curve.png"))
    answer = call(capsys, "report", path, "-o", folder / "report.html")
    assert answer.code == 0 and (folder / "report.html").stat().st_size > 1000, answer.err
