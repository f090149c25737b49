"""Slide-to-roll ratios of zero, and the units that the table [fit.units] gives columns that others are made of."""

from pathlib import Path

import pytest

import stribeck as sb

ROLLING = (Path(__file__).parent / "data" / "16_pure_rolling_and_half_sliding.csv").read_text()
SPEEDS = [0.002, 0.02, 0.2, 2.0]


@pytest.fixture
def read(tmp_path):
    def reader(text, geometry="point", **settings):
        path = tmp_path / "rig.csv"
        path.write_text(text)
        return sb.read_measurements(path, sb.FitSettings(geometry=geometry, **settings))

    return reader


@pytest.mark.quick
def test_rows_of_pure_rolling_are_a_curve(subtests, read):
    for geometry in ["line", "point"]:
        with subtests.test(geometry=geometry):
            found = read(ROLLING, geometry)
            assert len(found) == 8 and len(found.curves) == 2
            assert not any("left out" in note for note in found.notes)
            if geometry == "point":
                assert [each["slide_to_roll"] for each in found.inputs] == [0.0, 0.5]
            for curve in (0, 1):
                assert found.values[found.curve == curve] == pytest.approx(SPEEDS)


@pytest.mark.quick
def test_a_file_of_pure_rolling_alone_is_read(read):
    found = read("\n".join(ROLLING.split("\n")[:5]))
    assert found.values == pytest.approx(SPEEDS) and found.inputs == ({"slide_to_roll": 0.0},)


@pytest.mark.quick
def test_a_ratio_measured_about_zero_is_pure_rolling(read):
    noisy = ROLLING
    for ratio in ("0.1", "-0.05", "0.02", "-0.2"):
        noisy = noisy.replace(";0\n", f";{ratio}\n", 1)
    found = read(noisy)
    assert [each["slide_to_roll"] for each in found.inputs] == [0.0, 0.5]
    assert found.values[found.curve == 0] == pytest.approx(SPEEDS)


@pytest.mark.quick
def test_the_sum_is_asked_for_where_a_sliding_speed_and_pure_rolling_leave_it_open(read):
    text = "\n".join(["Sliding speed [mm/s];SRR [%];COF", "0;0;0.1", "5;50;0.3", "10;50;0.2", "20;50;0.1"])
    with pytest.raises(sb.InputError, match="does not give the sum of the surface speeds where 'SRR .%.' is zero"):
        read(text)


FORCES = "\n".join(["speed [mm/s];Fx;Fz", "1;0.5;1000", "2;0.4;1000", "4;0.3;1000", "8;0.2;1000"])


@pytest.mark.quick
def test_units_of_forces_are_taken_from_the_case(read):
    found = read(FORCES, units={"friction_force": "N", "normal_force": "mN"})
    assert found.friction == pytest.approx([0.5, 0.4, 0.3, 0.2]) and found.inputs == ({"load": 1.0},)
    weights = read(FORCES.replace("1000", "1"), units={"friction_force": "gf", "normal_force": "gf"})
    assert weights.friction == pytest.approx([0.5, 0.4, 0.3, 0.2])
    over = read(FORCES.replace("Fz", "Fz [N]").replace("Fx", "Fx [N]"), units={"normal_force": "mN"})
    assert over.friction == pytest.approx([0.5, 0.4, 0.3, 0.2])
    with pytest.raises(sb.InputError, match="friction_force = 'N' in .fit.units."):
        read(FORCES)


@pytest.mark.quick
def test_the_unit_of_a_speed_is_that_of_the_column_it_is_made_of(read):
    rows = "\n1;0.5\n2;0.4\n4;0.3\n8;0.2"
    bare = read(f"Mean entrainment speed;COF{rows}", units={"speed": "mm/s"})
    own = read(f"Mean entrainment speed;COF{rows}", units={"entrainment_speed": "mm/s"})
    written = read(f"Mean entrainment speed [mm/s];COF{rows}", units={"speed": "m/s"})
    for found in (bare, own, written):
        assert found.values == pytest.approx([0.002, 0.004, 0.008, 0.016])


@pytest.mark.quick
def test_a_unit_in_the_case_counts_once_where_a_column_is_made_of_another(read):
    text = "\n".join(["speed [mm/s];load;SRR;COF", "1;5;20;0.5", "2;5;20;0.4", "4;5;20;0.3", "8;5;20;0.2"])
    found = read(text, units={"load": "mN", "slide_to_roll": "%"}, columns={"speed": "speed"})
    assert found.inputs == ({"load": pytest.approx(0.005), "slide_to_roll": pytest.approx(0.2)},)


@pytest.mark.quick
def test_a_unit_of_a_column_that_is_not_there_is_said_to_be_idle(read):
    found = read("speed [mm/s];COF\n1;0.5\n2;0.4\n4;0.3", units={"normal_force": "mN"})
    assert "No column was taken for normal force, of which [fit.units] has the unit." in found.notes


@pytest.mark.quick
def test_what_has_no_unit_is_given_none(subtests, tmp_path_factory):
    for name in ["run", "curve"]:
        with subtests.test(name=name):
            tmp_path = tmp_path_factory.mktemp("case")
            case = tmp_path / "case.toml"
            example = (Path(__file__).parents[1] / "examples" / "pdms_cylinder.toml").read_text()
            case.write_text(f'{example}\n[fit.units]\n{name} = "s"\n')
            with pytest.raises(sb.InputError, match=f"{name} = 's' is not a known key"):
                sb.load_case(case)
