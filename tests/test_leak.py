"""The command ``stribeck leak``: the answer first, both strokes, tables as programs write them, and what is refused."""

import json

import numpy as np
import pytest
from command_line import EXAMPLES, call

import stribeck as sb

pytestmark = pytest.mark.quick

SEAL = EXAMPLES / "rod_seal_pressure.csv"
OILED = ("--modulus", "10 MPa", "--viscosity", "0.1 Pa*s", "--out-speed", "0.1 m/s", "--in-speed", "0.1 m/s")


def leak(capsys, path=SEAL, *options):
    """Return what the command finds as JSON."""
    answer = call(capsys, "leak", path, *OILED, *options, "--json")
    assert (answer.code, answer.err) == (0, "")
    return json.loads(answer.out)


def test_the_answer_comes_first_and_fits_a_screen(capsys):
    answer = call(capsys, "leak", SEAL, *OILED, "--diameter", "40 mm", "--stroke", "200 mm")
    lines = answer.out.splitlines()
    assert (answer.code, answer.err) == (0, "")
    assert lines[0].startswith("The seal does not leak: the way in can take back") and lines[0].endswith("mm³.")
    assert len(lines) <= 25
    turned = call(capsys, "leak", SEAL, *OILED, "--oil", "right").out
    assert turned.startswith("The seal leaks: each stroke out and in leaves a layer of")
    slower_back = call(capsys, "leak", SEAL, *OILED[:-1], "6 mm/s").out
    assert slower_back.startswith("Whether the seal leaks is not decided")


def test_the_json_is_what_python_finds(capsys):
    found = leak(capsys, SEAL, "--diameter", "40 mm", "--stroke", "0.2")
    assert set(found["out"]) - {"law"} <= set(found["units"]) and found["units"]["edge_coefficient"] == "Pa m-1/2"
    rows = [line.split(";") for line in SEAL.read_text().splitlines()[3:]]
    x, p = (
        np.array(column, dtype=float) * factor for column, factor in zip(zip(*rows, strict=True), (1e-3, 1e6), strict=True)
    )
    films = sb.asymptotics.film_of_pressure(x, p, modulus=10e6, viscosity=0.1, speed=0.1)
    assert found["out"]["film"] == pytest.approx(films.forward, rel=1e-9)
    assert found["in"]["film"] == pytest.approx(films.backward, rel=1e-9)
    assert found["net"] == pytest.approx(films.net, rel=1e-9)
    assert found["volume"] == pytest.approx(films.net * np.pi * 0.04 * 0.2, rel=1e-9)
    assert found["decided"] and found["in_range"] and found["out"]["speed"] == 0.1


def test_the_oil_may_be_at_either_end(capsys, tmp_path):
    lines = SEAL.read_text().splitlines()[2:]
    turned = [";".join((f"{-float(x)}", p)) for x, p in (line.split(";") for line in lines[1:])]
    (tmp_path / "turned.csv").write_text("\n".join([lines[0], *turned]))
    here, there = leak(capsys), leak(capsys, tmp_path / "turned.csv", "--oil", "right")
    assert there["net"] == pytest.approx(here["net"], rel=1e-9)
    assert there["out"]["film"] == pytest.approx(here["out"]["film"], rel=1e-9)


def test_tables_are_read_as_programs_write_them(capsys, tmp_path, subtests):
    rows = [line.split(";") for line in SEAL.read_text().splitlines()[3:]]
    expected = leak(capsys)["out"]["film"]
    with_comma = [(x.replace(".", ","), p.replace(".", ",")) for x, p in rows]
    tables = {
        "comma": ["Abstand [mm];Kontaktdruck [MPa]", *map(";".join, with_comma)],
        "node": ["node,X [mm],CPRESS [MPa]", *(f"{i},{x},{p}" for i, (x, p) in enumerate(rows, 1))],
        "other units": ["p [kPa]\tx [um]", *(f"{1e3 * float(p)!r}\t{1e3 * float(x)!r}" for x, p in rows)],
    }
    for name, lines in tables.items():
        with subtests.test(name=name):
            path = tmp_path / f"{name}.csv"
            path.write_text("\n".join(lines))
            assert leak(capsys, path)["out"]["film"] == pytest.approx(expected, rel=1e-6)


def test_a_file_that_cannot_tell_is_refused(subtests, capsys, tmp_path):
    for text, said in [
        ("", "holds no data"),
        ("x;p\n0;1\n1;2\n", "none of which is the position"),
        ("x [mm];p [N]\n0;1\n1;2\n", "none of which is the pressure"),
        ("x [mm];y [mm];p [MPa]\n0;1;2\n1;2;3\n", "2 of which may be the position"),
        ("x [mm];p [MPa]\n0;0\n1;-2\n2;1\n", "negative at x = 0.001 m"),
        ("x [mm];p [MPa]\n0;0\n1;\n2;1\n", "not a number"),
        ("x [mm];p [MPa]\n0;0\n1;2\n2;0\n", "rows between the left edge"),
    ]:
        with subtests.test(text=text, said=said):
            (tmp_path / "pressure.csv").write_text(text)
            answer = call(capsys, "leak", tmp_path / "pressure.csv", *OILED)
            assert (answer.code, answer.out) == (2, "")
            assert said in answer.err and answer.err.startswith("stribeck: ")


def test_impossible_options_are_refused(subtests, capsys):
    for options, said in [
        (("--oil", "top"), "oil = 'top' must be 'left' or 'right'"),
        (("--diameter", "40 mm"), "A volume needs both --diameter and --stroke"),
        (("--diameter", "40 mm", "--stroke", "-1 mm"), "A volume needs both --diameter and --stroke, above zero"),
        (("--in-speed", "0"), "must be above zero"),
        (("--in-speed", "3 mm"), "in_speed = '3 mm' is a length"),
        (("--modulus", "70 Shore A"), "is a hardness"),
    ]:
        with subtests.test(options=options, said=said):
            kept = {name: value for name, value in zip(OILED[::2], OILED[1::2], strict=True) if name not in options}
            answer = call(capsys, "leak", SEAL, *(word for pair in kept.items() for word in pair), *options)
            assert (answer.code, answer.out) == (2, "")
            assert said in answer.err


def test_no_file_is_answered_in_a_sentence(capsys, tmp_path):
    assert "nowhere.csv" in call(capsys, "leak", tmp_path / "nowhere.csv", *OILED).err
