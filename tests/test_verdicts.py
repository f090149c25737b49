"""Verdicts: what a soft body may do is said beside the contact law, in each command, and unusual inputs of sweeps too."""

import json

import pytest
from command_line import EXAMPLES, PDMS, call

import stribeck as sb

GEL = {
    "radius": "5 mm",
    "modulus": "10 kPa",
    "viscosity": "1 mPa*s",
    "speed": "1 mm/s",
    "roughness": "1 um",
    "alpha": 2.0,
    "beta": 0.06,
    "boundary_friction": 0.05,
}
"""A gel on which a ball presses with a load that the exponential law does not hold for, 20 mN."""


def gel_case(folder, **changes):
    """Write the case of the gel and return its path."""
    inputs = GEL | {"load": "20 mN"} | changes
    lines = [f'{name} = "{value}"' if isinstance(value, str) else f"{name} = {value}" for name, value in inputs.items()]
    path = folder / "gel.toml"
    path.write_text("\n".join(["[contact]", 'geometry = "point"', *lines, ""]))
    return path


def test_commands_begin_with_what_must_hold_for_a_gel(subtests, capsys, tmp_path):
    for load, law in [("1 mN", ""), ("20 mN", ", with another law and")]:
        with subtests.test(load=load, law=law):
            said = call(capsys, "solve", gel_case(tmp_path, load=load), "--rtol", "1e-2").out
            assert said.replace("\n", " ").startswith(
                f"The model applies{law} if adhesion is small and no liquid flows in pores"
            )


def test_diffusivity_and_permeability_are_one_fact(tmp_path):
    facts = {"diffusivity": "1e-9 m^2/s", "permeability": "1e-18 m^2"}
    with pytest.raises(sb.InputError, match="give one of them"):
        sb.check(sb.PointContact(**GEL, load="1 mN"), **facts)
    path = gel_case(tmp_path)
    path.write_text(path.read_text() + '[check]\ndiffusivity = "1e-9 m^2/s"\npermeability = "1e-18 m^2"\n')
    with pytest.raises(sb.InputError, match=r"\[check\].*give one of them"):
        sb.load_case(path)


def test_per_cent_is_advised_only_where_it_is_used(capsys, tmp_path):
    path = gel_case(tmp_path, alpha=20.0, boundary_friction=70.0, load="1 mN")
    said = call(capsys, "solve", path, "--rtol", "1e-2").out
    assert "alpha 20, usually" in said.replace("\n", " ") and "70 % is 0.7" in said.replace("\n", " ")


def test_a_sweep_says_unusual_inputs(subtests, capsys, tmp_path_factory):
    for old, new, said in [
        ("boundary_friction = 0.7", "boundary_friction = 70", "70 % is 0.7"),
        ("boundary_friction = 0.7", "boundary_friction = 0.7\nslide_to_roll = 50", "50 % is 0.5"),
        ('viscosity = "50 mPa*s"', 'viscosity = "50 Pa*s"', "viscosity 50 Pa*s"),
        ('load = ["15 N/m", "30 N/m"]', 'load = ["1 mN/m", "30 N/m"]', "load 1 mN/m"),
    ]:
        with subtests.test(old=old, new=new, said=said):
            tmp_path = tmp_path_factory.mktemp("case")
            text = (
                (EXAMPLES / "sweep.toml").read_text().replace("points = 26", "points = 2").replace("points = 3", "points = 2")
            )
            assert old in text
            path = tmp_path / "sweep.toml"
            path.write_text(text.replace(old, new))
            errors = call(capsys, "sweep", str(path), "--out", str(tmp_path / "s.sqlite")).err
            assert "Unusual: " in errors and said in errors.replace("\n", " ")


def test_the_verdict_on_a_contact_is_one_where_its_curve_leaves_the_range_of_the_law(capsys, tmp_path):
    """Regimes doubted the law for points of the curve that no check doubted, and the report did not."""
    path = tmp_path / "case.toml"
    path.write_text(PDMS.read_text().replace("boundary_friction = 0.7", "boundary_friction = 0.001"))
    contact = sb.load_case(path).contact
    assert sb.stribeck_curve(contact).law_in_doubt.any()
    said = {each.name: each.verdict for each in sb.check(contact)}
    shown = json.loads(call(capsys, "regimes", path, "--json").out)["checks"]
    assert {each["name"]: each["verdict"] for each in shown}.items() <= said.items()
