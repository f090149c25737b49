"""Files as test rigs write them: forces, mean speeds, ratios, units, repeats, run-in, steps, spreadsheets.

The layouts are made from public descriptions of ball-on-disc (mini traction machine) and pin-on-disc exports.
"""

import functools
import math
import re
from pathlib import Path

import numpy as np
import pytest
from command_line import call, case_text, fit_settings
from fit_data import exact

import stribeck as sb

SPEEDS = (0.001, 0.01, 0.1, 1.0)
FRICTIONS = (0.5, 0.25, 0.0625, 0.125)


@pytest.fixture
def read(tmp_path):
    def reader(text, geometry="line", **table):
        path = tmp_path / "rig.txt"
        path.write_text(text)
        return sb.read_measurements(path, fit_settings(table, geometry))

    return reader


@pytest.fixture
def read_ball(read):
    return functools.partial(read, geometry="point")


def ball_on_disc(steps=1, comma=False):
    """Return an export of a mini traction machine: a preamble, then for each step a header and a table with tabs."""
    lines = [f"Setting {i}:\tvalue {i}" for i in range(40)]
    lines[3] = "Lubricant:\tSaliva model, 0.5 % gum"
    for step in range(steps):
        lines += ["", f"Step {step + 1} Stribeck", ""]
        lines.append("Rolling Speed (mm/s)\tTraction Force (N)\tBall Load (N)\tTraction Coeff (-)\tSRR (%)\tPot Temp (°C)")
        for u, mu in zip(SPEEDS, FRICTIONS, strict=True):
            scatter = 1 + 0.01 * math.sin(7 * step + 40 * u)
            lines.append(f"{500 * u:.6f}\t{1.3 * mu * scatter:.8f}\t1.3\t{mu * scatter:.8f}\t50\t25.1")
    text = "\n".join([*lines, "", "End of test"])
    return text.replace(".", ",") if comma else text


PIN_ON_DISC = "\n".join(
    [
        "Instrument;Pin-on-disc tribometer",
        "Sample;PDMS",
        "",
        "Time [s];Linear Speed [cm/s];Fx [N];Fz [mN];Penetration [um]",
        *(f"{i};{100 * u};{-0.5 * mu};500;{i}" for i, (u, mu) in enumerate(zip(SPEEDS, FRICTIONS, strict=True))),
    ]
)


@pytest.mark.quick
def test_the_export_of_a_ball_on_disc_rig_is_read_as_it_is(subtests, read):
    for comma in [False, True]:
        with subtests.test(comma=comma):
            found = read(ball_on_disc(comma=comma), columns={"friction": "Traction Coeff"})
            assert found.values == pytest.approx(SPEEDS)
            assert found.friction == pytest.approx(FRICTIONS, rel=0.011)
            assert "speed = 2 x 'Rolling Speed (mm/s)', a mean of two surface speeds" in found.taken
            assert "[fit.columns]" in found.taken
            assert any("Pot Temp" in note for note in found.notes)


@pytest.mark.quick
def test_friction_is_made_of_two_forces(read):
    text = ball_on_disc().replace("Traction Coeff (-)", "Wear (-)")
    found = read(text)
    assert found.friction == pytest.approx(FRICTIONS, rel=0.011)
    assert "friction = |'Traction Force (N)' / 'Ball Load (N)'|" in found.taken
    pin = read(PIN_ON_DISC, columns={"speed": "Linear Speed"})
    assert pin.friction == pytest.approx(FRICTIONS) and pin.values == pytest.approx(SPEEDS)


@pytest.mark.quick
def test_a_speed_that_may_be_mean_or_sum_is_asked_for(read):
    text = ball_on_disc().replace("Rolling Speed", "Speed").replace("Traction Coeff", "COF")
    with pytest.raises(sb.InputError, match="may be the mean of both surface speeds or their sum; say which in"):
        read(text)
    mean = read(text, columns={"entrainment_speed": "Speed"}).values
    total = read(text, columns={"speed": "Speed"}).values
    assert mean == pytest.approx(2 * total) and mean == pytest.approx(SPEEDS)


@pytest.mark.quick
def test_a_case_whose_surfaces_both_move_is_asked_which_speed_its_file_holds(tmp_path):
    def read(header, columns=None, ratio=0.5):
        path = tmp_path / "rig.csv"
        path.write_text("\n".join([f"{header};COF", *(f"{u};{mu}" for u, mu in zip(SPEEDS, FRICTIONS, strict=True))]))
        return sb.read_measurements(path, sb.FitSettings(slide_to_roll=ratio, columns=columns or {})).values

    assert read("speed [m/s]", ratio=2.0) == pytest.approx(SPEEDS)
    for header in ("speed [m/s]", "Hersey number", "eta U [Pa*s*m/s]"):
        with pytest.raises(sb.InputError, match="both surfaces move .slide-to-roll ratio 0.5., so that .* the mean of both"):
            read(header)
    assert read("Hersey number", {"hersey_number": "Hersey number"}) == pytest.approx(SPEEDS)
    assert read("speed [m/s]", {"speed": "speed"}) == pytest.approx(SPEEDS)
    assert read("sum of speeds [m/s]") == pytest.approx(SPEEDS)
    for found in (read("speed [m/s]", {"entrainment_speed": "speed"}), read("mean speed [m/s]")):
        assert found == pytest.approx([2 * u for u in SPEEDS])
    assert read("sliding speed [m/s]") == pytest.approx([4 * u for u in SPEEDS])
    with pytest.raises(sb.InputError, match="does not give the sum of the surface speeds at the slide-to-roll ratio 0"):
        read("sliding speed [m/s]", ratio=0.0)


@pytest.mark.quick
def test_sliding_speed_and_both_surface_speeds_become_their_sum(read):
    rows = [f"{u * 0.5 * 0.5};{u * 0.625};{u * 0.375};50;{mu}" for u, mu in zip(SPEEDS, FRICTIONS, strict=True)]
    header = "Sliding speed [m/s];Ball speed [m/s];Disc speed [m/s];SRR [%];COF"
    both = read("\n".join([header, *rows]))
    assert both.values == pytest.approx(SPEEDS) and "'Ball speed [m/s]' + 'Disc speed [m/s]'" in both.taken
    slid = read("\n".join([header.replace("Ball speed", "A").replace("Disc speed", "B"), *rows]))
    assert slid.values == pytest.approx(SPEEDS) and "2 x 'Sliding speed [m/s]' / 'SRR [%]'" in slid.taken
    rolled = "\n".join(
        ["Rolling Speed (mm/s);Sliding Speed (mm/s);Traction Coeff (-)"]
        + [f"{500 * u};{250 * u};{mu}" for u, mu in zip(SPEEDS, FRICTIONS, strict=True)]
    )
    assert read(rolled).values == pytest.approx(SPEEDS) and "2 x 'Rolling Speed (mm/s)'" in read(rolled).taken
    alone = "\n".join(["Sliding speed [m/s];COF", *(f"{u};{mu}" for u, mu in zip(SPEEDS, FRICTIONS, strict=True))])
    assert read(alone).values == pytest.approx(SPEEDS)  # one surface at rest


@pytest.mark.quick
def test_repeats_become_error_bars(read):
    found = read(ball_on_disc(steps=5), columns={"friction": "Traction Coeff"})
    assert len(found) == 4 and found.values == pytest.approx(SPEEDS)
    scatters = [np.array([1 + 0.01 * math.sin(7 * step + 40 * u) for step in range(5)]) for u in SPEEDS]
    assert found.friction == pytest.approx([mu * s.mean() for mu, s in zip(FRICTIONS, scatters, strict=True)])
    pooled = math.sqrt(np.mean([(s / s.mean()).var(ddof=1) for s in scatters]))
    assert found.error == pytest.approx(pooled * found.friction / math.sqrt(5), rel=1e-6)
    [note] = [note for note in found.notes if "20 rows at 4 speeds put together" in note]
    assert re.search(r"the scatter of repeats, \S+ % of a single row, became the error of each mean", note)
    assert "'step' as run" in found.taken
    apart = read(ball_on_disc(steps=5), columns={"friction": "Traction Coeff"}, repeats=False)
    assert len(apart) == 20 and apart.error is None


@pytest.mark.quick
def test_a_first_run_that_differs_is_marked_as_run_in(read):
    rows = []
    for run in range(1, 6):
        for k, (u, mu) in enumerate(zip(SPEEDS, FRICTIONS, strict=True)):
            rows.append(f"{run};{u};{mu * (1.2 if run == 1 else 1) * (1 + 0.01 * math.sin(3 * run + k))}")
    text = "\n".join(["Run;speed [m/s];COF", *rows])
    found = read(text)
    assert found.run_in == (2, 3, 4, 5)
    assert found.friction == pytest.approx(FRICTIONS, rel=0.01)
    [note] = [note for note in found.notes if "run-in" in note]
    assert note.startswith("Run 1 lies +19 %") and "rows 2 to 5, left out" in note
    kept = read(text, run_in="keep")
    assert kept.friction == pytest.approx([1.04 * mu for mu in FRICTIONS], rel=0.01)
    assert kept.run_in == found.run_in
    steps = read("\n".join(["Step;speed [m/s];COF", *(f"{k};{row.partition(';')[2]}" for k, row in enumerate(rows))]))
    assert steps.run_in == found.run_in  # each row has a number of its own
    assert steps.friction == pytest.approx(found.friction)


@pytest.mark.quick
def test_a_spreadsheet_is_read_like_text(tmp_path):
    openpyxl = pytest.importorskip("openpyxl")
    book = openpyxl.Workbook()
    book.active.append(["Report", "of a rig"])
    for _ in range(20):
        book.active.append([True, False])  # no numbers
    sheet = book.create_sheet("Data")
    for row in (["Operator", "N. N."], [], ["Entrainment\nspeed [mm/s]", "COF [-]", "Remark"]):
        sheet.append(row)
    for u, mu in zip(SPEEDS, FRICTIONS, strict=True):
        sheet.append([500 * u / 3, mu, "ok"] if u < SPEEDS[-1] else [500 * u / 3, mu])
    path = tmp_path / "rig.xlsx"
    book.save(path)
    found = sb.read_measurements(path)
    assert found.values == pytest.approx(np.array(SPEEDS) / 3, rel=1e-14) and found.friction.tolist() == list(FRICTIONS)
    assert found.rows[0] == 4
    assert not any("hidden" in note for note in found.notes)
    sheet.row_dimensions[5].hidden = sheet.row_dimensions[6].hidden = True  # as a filter does
    book.save(path)
    found = sb.read_measurements(path)
    assert len(found.values) == len(SPEEDS)
    assert "Rows hidden in the sheet count too: 5, 6; delete those that should not." in found.notes
    (tmp_path / "bad.xlsx").write_text("no zip")
    with pytest.raises(sb.InputError, match="cannot be read as a spreadsheet"):
        sb.read_measurements(tmp_path / "bad.xlsx")
    openpyxl.Workbook().save(tmp_path / "empty.xlsx")
    with pytest.raises(sb.InputError, match="holds no numbers"):
        sb.read_measurements(tmp_path / "empty.xlsx")


def test_a_fit_prints_what_the_columns_were_taken_for(tmp_path, capsys):
    speeds, frictions = exact()
    rows = "\n".join(f"{u / 2}\t{0.3 * f}\t0.3" for u, f in zip(speeds, frictions, strict=True))
    data, case = tmp_path / "rig.txt", tmp_path / "case.toml"
    data.write_text(f"Mean speed (m/s)\tFriction force (N)\tNormal force (N)\n{rows}")
    case.write_text(case_text())
    answer = call(capsys, "fit", data, case, "--free", "boundary_friction")
    assert answer.code == 0, answer.err
    assert "Read: friction = |'Friction force (N)' / 'Normal force (N)'|; speed = 2 x 'Mean speed (m/s)'" in answer.out


def loads_and_repeats(loads=(1.0, 2.0), ratios=(50, 50)):
    """Return an export with three repeats at each of two loads and slide-to-roll ratios; the first repeat is run-in."""
    lines = ["Profile:\tsaliva", ""]
    for load, ratio in zip(loads, ratios, strict=True):
        for repeat in range(3):
            lines.append("Rolling Speed (mm/s)\tSRR (%)\tBall Load (N)\tTraction Coeff (-)\tStep")
            for i, (u, mu) in enumerate(zip(SPEEDS, FRICTIONS, strict=True)):
                friction = mu / load * (1.2 if repeat == 0 else 1 + 0.004 * (-1) ** (i + repeat))
                noise = 1 + 0.004 * math.sin(9 * i + 5 * repeat)
                lines.append(f"{500 * u}\t{ratio}\t{load * noise:.4f}\t{friction:.6f}\t{load}/{repeat}")
            lines.append("")
    return "\n".join(lines)


@pytest.mark.quick
def test_several_loads_in_a_file_are_as_many_curves_of_a_ball(read):
    found = read(loads_and_repeats(), geometry="point")
    assert found.inputs == ({"load": 1.0, "slide_to_roll": 0.5}, {"load": 2.0, "slide_to_roll": 0.5})
    assert found.friction == pytest.approx([*FRICTIONS, *(mu / 2 for mu in FRICTIONS)], rel=0.005)
    assert found.error is not None and len(found.run_in) == 8
    assert "'Ball Load (N)' as load of the curves, 1 N and 2 N" in found.taken
    assert "'load [N]'" not in found.taken  # made by the reader, nowhere in the file
    mixed = read(loads_and_repeats(loads=(1.0, 1.0), ratios=(20, 180)), geometry="point")
    assert mixed.inputs == ({"load": 1.0, "slide_to_roll": 0.2}, {"load": 1.0, "slide_to_roll": 1.8})


@pytest.mark.quick
def test_several_forces_on_a_cylinder_name_its_curves_and_ask_for_their_loads(read):
    found = read(loads_and_repeats())
    assert found.curves == ("1 N", "2 N") and found.inputs == ({}, {})
    assert 'a curve for each of 1 N and 2 N; give the load of each in [fit.curves."1 N"]' in found.taken
    own = read(loads_and_repeats(), curves={"1 N": {"load": "50 N/m"}, "2 N": {"load": "100 N/m"}})
    assert own.inputs == ({"load": 50.0}, {"load": 100.0})
    assert read(loads_and_repeats(loads=(1.0, 1.0))).curves == ("data",)
    assert read(loads_and_repeats(ratios=(20, 180))).curves == ("1 N, 0.2", "2 N, 1.8")


ROLLING = (Path(__file__).parent / "data" / "16_pure_rolling_and_half_sliding.csv").read_text()
ROLLING_SPEEDS = [0.002, 0.02, 0.2, 2.0]


@pytest.mark.quick
def test_rows_of_pure_rolling_are_a_curve(subtests, read):
    for geometry in ["line", "point"]:
        with subtests.test(geometry=geometry):
            found = read(ROLLING, geometry=geometry)
            assert len(found) == 8 and len(found.curves) == 2
            assert not any("left out" in note for note in found.notes)
            if geometry == "point":
                assert [each["slide_to_roll"] for each in found.inputs] == [0.0, 0.5]
            for curve in (0, 1):
                assert found.values[found.curve == curve] == pytest.approx(ROLLING_SPEEDS)


@pytest.mark.quick
def test_a_file_of_pure_rolling_alone_is_read(read_ball):
    found = read_ball("\n".join(ROLLING.split("\n")[:5]))
    assert found.values == pytest.approx(ROLLING_SPEEDS) and found.inputs == ({"slide_to_roll": 0.0},)


@pytest.mark.quick
def test_a_ratio_measured_about_zero_is_pure_rolling(read_ball):
    noisy = ROLLING
    for ratio in ("0.1", "-0.05", "0.02", "-0.2"):
        noisy = noisy.replace(";0\n", f";{ratio}\n", 1)
    found = read_ball(noisy)
    assert [each["slide_to_roll"] for each in found.inputs] == [0.0, 0.5]
    assert found.values[found.curve == 0] == pytest.approx(ROLLING_SPEEDS)


@pytest.mark.quick
def test_the_sum_is_asked_for_where_a_sliding_speed_and_pure_rolling_leave_it_open(read_ball):
    text = "\n".join(["Sliding speed [mm/s];SRR [%];COF", "0;0;0.1", "5;50;0.3", "10;50;0.2", "20;50;0.1"])
    with pytest.raises(sb.InputError, match="does not give the sum of the surface speeds where 'SRR .%.' is zero"):
        read_ball(text)


FORCES = "\n".join(["speed [mm/s];Fx;Fz", "1;0.5;1000", "2;0.4;1000", "4;0.3;1000", "8;0.2;1000"])


@pytest.mark.quick
def test_units_of_forces_are_taken_from_the_case(read_ball):
    found = read_ball(FORCES, units={"friction_force": "N", "normal_force": "mN"})
    assert found.friction == pytest.approx([0.5, 0.4, 0.3, 0.2]) and found.inputs == ({"load": 1.0},)
    weights = read_ball(FORCES.replace("1000", "1"), units={"friction_force": "gf", "normal_force": "gf"})
    assert weights.friction == pytest.approx([0.5, 0.4, 0.3, 0.2])
    over = read_ball(FORCES.replace("Fz", "Fz [N]").replace("Fx", "Fx [N]"), units={"normal_force": "mN"})
    assert over.friction == pytest.approx([0.5, 0.4, 0.3, 0.2])
    with pytest.raises(sb.InputError, match="friction_force = 'N' in .fit.units."):
        read_ball(FORCES)


@pytest.mark.quick
def test_the_unit_of_a_speed_is_that_of_the_column_it_is_made_of(read_ball):
    rows = "\n1;0.5\n2;0.4\n4;0.3\n8;0.2"
    bare = read_ball(f"Mean entrainment speed;COF{rows}", units={"speed": "mm/s"})
    own = read_ball(f"Mean entrainment speed;COF{rows}", units={"entrainment_speed": "mm/s"})
    written = read_ball(f"Mean entrainment speed [mm/s];COF{rows}", units={"speed": "m/s"})
    for found in (bare, own, written):
        assert found.values == pytest.approx([0.002, 0.004, 0.008, 0.016])


@pytest.mark.quick
def test_a_unit_in_the_case_counts_once_where_a_column_is_made_of_another(read_ball):
    text = "\n".join(["speed [mm/s];load;SRR;COF", "1;5;20;0.5", "2;5;20;0.4", "4;5;20;0.3", "8;5;20;0.2"])
    found = read_ball(text, units={"load": "mN", "slide_to_roll": "%"}, columns={"speed": "speed"})
    assert found.inputs == ({"load": pytest.approx(0.005), "slide_to_roll": pytest.approx(0.2)},)


@pytest.mark.quick
def test_a_unit_of_a_column_that_is_not_there_is_said_to_be_idle(read_ball):
    found = read_ball("speed [mm/s];COF\n1;0.5\n2;0.4\n4;0.3", units={"normal_force": "mN"})
    assert "No column was taken for normal force, of which [fit.units] has the unit." in found.notes


@pytest.mark.quick
def test_what_has_no_unit_is_given_none(subtests, tmp_path):
    for name in ["run", "curve"]:
        with subtests.test(name=name):
            case = tmp_path / "case.toml"
            example = (Path(__file__).parents[1] / "examples" / "pdms_cylinder.toml").read_text()
            case.write_text(f'{example}\n[fit.units]\n{name} = "s"\n')
            with pytest.raises(sb.InputError, match=f"{name} = 's' is not a known key"):
                sb.load_case(case)
