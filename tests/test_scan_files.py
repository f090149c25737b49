"""Heights in the layouts that instruments and programs write: sizes, units, indices, codes and reasons of refusal."""

import math
import zipfile
from pathlib import Path

import numpy as np
import pytest
from command_line import call
from topography_files import write_gwy, write_sdf, write_x3p

import stribeck as sb

DATA = Path(__file__).parent / "data"
RANDOM = np.random.default_rng(83)
LINE = np.cumsum(RANDOM.standard_normal(400))
LINE = 0.5 * (LINE - LINE.mean()) / LINE.std()
X = 0.156 * np.arange(400)
MAP = np.cumsum(RANDOM.standard_normal((48, 48)), axis=1) / 8  # a line of the scan in each row


def read(folder, text, **options):
    (folder / "scan.csv").write_text(text, encoding="cp1252")
    return sb.surfaces.read_topography(folder / "scan.csv", **options)


def rows(*columns, sep=",", form=("{:.4f}",)):
    forms = [*form, *["{:.4f}"] * len(columns)]
    return "\n".join(sep.join(f.format(v) for f, v in zip(forms, row, strict=False)) for row in zip(*columns, strict=True))


def matrix(sep="\t"):
    return "\n".join(sep.join(f"{v:.5f}" for v in row) for row in MAP)


def test_text_of_gwyddion_has_its_own_sizes_and_no_others(capsys):
    path = DATA / "20_gwyddion_ascii_not_square.txt"
    scan = sb.surfaces.read_topography(path)
    assert scan.spacing == pytest.approx((1e-6, 0.5e-6), rel=1e-9)
    assert np.std(scan.heights) == pytest.approx(0.5e-6, rel=1e-3)
    assert "'Width: 48.00 µm' and 'Height: 24.00 µm'" in scan.notes[-1]
    with pytest.raises(
        sb.InputError, match=r"declares 0.5 um between points along y \('Height: 24.00 µm'\), but spacing = '1 um'"
    ):
        sb.surfaces.read_topography(path, spacing="1 um")
    assert sb.surfaces.read_topography(path, spacing="1 um x 0.5 um").spacing == pytest.approx((1e-6, 0.5e-6))
    assert sb.surfaces.read_topography(path, spacing=("1 um", 5e-7)).spacing == pytest.approx((1e-6, 0.5e-6))
    command = call(capsys, "surface", path, "--spacing", "1 um")
    assert command.code == 2 and "leave out the wrong one" in command.err


def test_a_stylus_file_with_rounded_positions_and_trailing_commas_is_a_profile():
    scan = sb.surfaces.read_topography(DATA / "21_stylus_csv_trailing_commas_rounded.csv")
    assert scan.heights.shape == (400,) and not scan.notes
    assert scan.spacing == pytest.approx((0.156e-6,), rel=3e-4)
    assert np.std(scan.heights) == pytest.approx(0.5e-6, rel=1e-3)


def test_the_distance_of_pixels_is_read_from_the_block_above_the_heights():
    scan = sb.surfaces.read_topography(DATA / "22_confocal_csv_meta_block.csv")
    assert scan.heights.shape == (48, 48) and scan.spacing == pytest.approx((1e-6, 1e-6))
    assert np.std(scan.heights) == pytest.approx(0.5e-6, rel=1e-3)
    assert "XY calibration" in scan.notes[-1]


def test_two_traces_are_no_map():
    with pytest.raises(sb.InputError, match=r"'z2 \(um\)'.* x and two heights of a line, or x, y and height of a map\?"):
        sb.surfaces.read_topography(DATA / "23_two_traces_one_file.csv")


def test_a_code_for_no_height_is_missing_and_named():
    scan = sb.surfaces.read_topography(DATA / "24_missing_code_minus_9999.csv")
    assert scan.missing == 4 and scan.heights.shape == (400,)
    assert scan.notes == ("4 points hold -9999, a code for no height, and count as missing.",)
    assert any("4 of 400 points" in note for note in scan.repaired().notes)


def test_two_codes_for_no_height_are_both_missing(tmp_path):
    """Points above and below the range: the gap from one code to the heights was taken for one between heights."""
    for codes in ((99999, -9999), (32767, -32768)):
        heights = 100 * (MAP - MAP.max()).copy()
        heights[3:5, 3:5], heights[20:22, 9] = codes
        text = "\n".join("\t".join(f"{height:.4f}" for height in row) for row in heights)
        scan = read(tmp_path, text, spacing="1 um", height_unit="nm")
        assert scan.missing == 6 and len(scan.notes) == 2


SIZES = {
    "nanometres": "# Width: 48000 nm\n# Height: 24000 nm\n# Value units: µm\n",
    "without comments": "Width: 48.00 µm\nHeight: 24.00 µm\nValue units: µm\n",
    "in German": "# Kanal: Z\n# Breite: 0.048 mm\n# Höhe: 0.024 mm\n# Unit: um\n",
    "of pixels": "X pixel size,1000,nm\nY pixel size,500,nm\nHeight unit,um\nHeight data\n",
    "of steps, units in the key": "X step [um];1.0\nY step [um];0,5\nUnit;um\n",
    "of both axes": "Scan size: 48 x 24 um\nZ unit: um\n",
    "of both axes with units": "Scan Size: 48 µm x 24 µm\nData unit: Micrometer\n",
    "per pixel": "X scale: 1000 nm per pixel\nY scale: 500 nm/pixel\nz unit: um\n",
    "by the unit alone": "Resolution X: 1000 nm/pixel\nResolution Y: 500 nm/pixel\nz unit: um\n",
}


def test_sizes_above_a_matrix_give_the_spacing_along_each_axis(subtests, tmp_path):
    for case in SIZES:
        with subtests.test(case=case):
            scan = read(tmp_path, SIZES[case] + matrix())
            assert scan.spacing == pytest.approx((1e-6, 0.5e-6), rel=1e-9)
            assert scan.heights == pytest.approx(MAP.T * 1e-6, abs=6e-12)


def test_lines_that_contradict_each_other_are_refused(tmp_path):
    with pytest.raises(sb.InputError, match="'Pixel size: 2 um' and 'Width: 48 um' contradict each other for 48 points"):
        read(tmp_path, "Pixel size: 2 um\nWidth: 48 um\nHeight: 24 um\nUnit: um\n" + matrix())


def test_one_size_of_a_map_that_is_not_square_is_refused(tmp_path):
    text = "Scan size: 48 um\nAspect ratio: {}\nUnit: um\n" + matrix()
    with pytest.raises(sb.InputError, match="'Scan size: 48 um' gives one size and 'Aspect ratio: 4:1' two; give both"):
        read(tmp_path, text.format("4:1"))
    assert read(tmp_path, text.format("1:1")).spacing == pytest.approx((1e-6, 1e-6))


PROFILES = {
    "index": "Index,x (um),z (um)\n" + rows(range(400), X, LINE, form=("{}",)),
    "index without a name": ",x (um),z (um)\n" + rows(range(400), X, LINE, form=("{}",)),
    "index between tabs": "\tx (um)\tz (um)\n" + rows(range(400), X, LINE, form=("{}",), sep="\t"),
    "index in quotes": '"","x_um","z_um"\n' + rows(range(1, 401), X, LINE, form=('"{}"',)),
    "units below": "Lateral,Raw\num,Micrometer\n" + rows(X, LINE, form=("{:.1f}",)),
    "units in brackets below": "Lateral,Total Profile\n(µm),(Å)\n" + rows(X, 1e4 * LINE, form=("{:.1f}",)),
    "block above": "Length,62.4,um\nStylus radius,12.5 um\nLateral um,Total Profile Å,\n"
    + rows(X, 1e4 * LINE, ("",) * 400, form=("{:.1f}", "{:.1f}", "{}")),
    "three digits": "x (um) z (um)\n" + rows(X, LINE, form=("{:.3g}",), sep=" "),
    "trailing semicolons": "x [µm];z [um];;\n"
    + rows(X, LINE, ("",) * 400, ("",) * 400, form=("{:.3f}", "{:.4f}", "{}", "{}"), sep=";"),
    "table of R": '"x_um" "z_um"\n' + rows(range(1, 401), X, LINE, sep=" ", form=('"{}"',)),
    "end in words": "x (um),z (um)\n" + rows(X, LINE) + "\nEnd of data\n",
    "two pages": "x (um),z (um)\n" + rows(X[:90], LINE[:90]) + "\nx (um),z (um)\n" + rows(X[90:], LINE[90:]),
    "old Ångström": "Lateral um,Raw A\n" + rows(X, 1e4 * LINE, form=("{:.4f}", "{:.1f}")),
    "column": "Points: 400\nSpacing: 0.156 um\nHeight unit: um\n" + rows(LINE),
}


def test_a_profile_in_any_layout_is_the_same_profile(subtests, tmp_path):
    for case in PROFILES:
        with subtests.test(case=case):
            scan = read(tmp_path, PROFILES[case])
            assert scan.spacing == pytest.approx((0.156e-6,), rel=1e-3)
            assert scan.heights == pytest.approx(LINE * 1e-6, abs=6e-11)


def test_a_map_with_an_index_or_rounded_positions_is_that_map(tmp_path):
    x, y = np.meshgrid(np.arange(48), np.arange(48))
    columns = (0.156 * x.ravel(), 0.3125 * y.ravel(), MAP.ravel())
    numbered = read(tmp_path, "No.;X (um);Y (um);Z (um)\n" + rows(range(48 * 48), *columns, sep=";", form=("{}",)))
    rounded = read(tmp_path, "x (um),y (um),z (um)\n" + rows(*columns, form=("{:.1f}", "{:.1f}")))
    for scan in (numbered, rounded):
        assert scan.heights == pytest.approx(MAP.T * 1e-6, abs=1e-10)
        assert scan.spacing == pytest.approx((0.156e-6, 0.3125e-6), rel=5e-3)
    counted = read(
        tmp_path, "\n".join(f"{i}\t{row}" for i, row in enumerate(matrix().splitlines())), unit="um", spacing="1 um"
    )
    assert counted.heights.shape == (48, 48) and "numbers the points" in counted.notes[0]


def test_positions_along_both_edges_of_a_matrix_are_its_spacing(tmp_path):
    lines = [[f"{0.5 * i:g}", *row.split("\t")] for i, row in enumerate(matrix().splitlines())]
    top = ["", *(f"{1.0 * i:g}" for i in range(48))]
    scan = read(tmp_path, "\n".join("\t".join(row) for row in [top, *lines]), unit="um")
    assert scan.spacing == pytest.approx((1e-6, 0.5e-6)) and scan.heights == pytest.approx(MAP.T * 1e-6, abs=6e-12)
    with pytest.raises(sb.InputError, match="the first column of the matrix rises in even steps, as positions do"):
        read(tmp_path, "\n".join("\t".join(row) for row in lines), unit="um", spacing="1 um")


def test_marks_between_thousands_are_never_read_as_decimals_unsaid(subtests, tmp_path):
    z = 1e4 + 1e3 * LINE
    thousands = [f"{v:,.0f}" for v in z]
    german = [v.replace(",", ".") for v in thousands]
    some = [f"{v:,.0f}".replace(",", ".") for v in 1e3 * np.abs(LINE)]
    comma = [f"{x:.3f}".replace(".", ",") for x in X]
    for case, columns, row, cell in (
        ("German", (comma, german), 2, german[0]),
        ("English", (X, thousands), 2, thousands[0]),
        ("German, of some", (comma, some), some.index(next(v for v in some if "." in v)) + 2, "a point"),
        ("both marks", (X, [f"{v:,.1f}" for v in z]), 2, "not a number"),
    ):
        with subtests.test(case=case), pytest.raises(sb.InputError, match=rf"(row|line) {row}, column.*{cell}"):
            read(tmp_path, "x [µm];z [nm]\n" + rows(*columns, sep=";", form=("{}", "{}")))
    for case, options, text in (
        ("integer positions", {}, "x [µm];z [nm]\n" + rows(range(400), german, sep=";", form=("{}", "{}"))),
        ("one column", {"spacing": "1 um"}, "z [nm]\n" + "\n".join(thousands)),
    ):
        with subtests.test(case=case):
            scan = read(tmp_path, text, **options)
            assert scan.heights == pytest.approx(np.rint(z) * 1e-12, rel=1e-12)
            value = float(german[0])
            assert any(f"was read as {value:g}, not as {1000 * value:g}." in note for note in scan.notes)
    assert not read(tmp_path, "x [µm];z [nm]\n" + rows(X, LINE * 100, sep=";", form=("{:.3f}", "{:.3f}"))).notes


def test_marks_between_thousands_above_the_heights_are_refused_or_the_decimal_sign_of_the_heights(subtests, tmp_path):
    unit = "\nZ unit: um\n"
    for size in ("48,000 nm", "48,000 nm x 24,000 nm", "1,048.5 nm", "1.048,5 nm", "48'000 nm", "48 000 nm", "1.048.000 pm"):
        words = "in .Scan Size: .*. may have marks between thousands; write it with a decimal point"
        with subtests.test(size=size), pytest.raises(sb.InputError, match=words):
            read(tmp_path, f"Scan Size: {size}{unit}" + matrix())
    with pytest.raises(sb.InputError, match="'-9,999' in 'Invalid: -9,999' may have"):
        read(tmp_path, f"Scan Size: 48 um\nInvalid: -9,999{unit}" + matrix())
    for size, text in (("48.000 um x 24.000 um", matrix()), ("48,000 um x 24,000 um", matrix().replace(".", ","))):
        with subtests.test(size=size):
            assert read(tmp_path, f"Scan Size: {size}{unit}{text}").spacing == pytest.approx((1e-6, 0.5e-6), rel=1e-9)
    heights = rows(np.resize(LINE, 1024 * 32), form=("{:.2f}",))
    scan = read(tmp_path, f"Samples/line: 1,024\nLines: 32\nPixel size: 1 um{unit}{heights}")
    assert scan.heights.shape == (1024, 32)


def test_one_named_column_with_decimal_commas_is_one_column(subtests, tmp_path):
    for form in ("{:.4f}", "{:.1f}"):
        heights = rows(LINE, form=(form,)).replace(".", ",")
        wanted = [float(form.format(v)) * 1e-6 for v in LINE]
        for case, header, options in (
            ("spacing given", "Z [µm]", {"spacing": "0.5 um"}),
            ("spacing above", "Pixelgröße: 0,5 µm\nRa\t0,41 µm\nZ [µm]", {}),
            ("unit below", "Z\n[µm]", {"spacing": "0.5 um"}),
        ):
            with subtests.test(case=case, form=form):
                scan = read(tmp_path, f"{header}\n{heights}", **options)
                assert scan.spacing == pytest.approx((0.5e-6,)) and scan.heights == pytest.approx(wanted, abs=1e-15)
    for header in (",z [um]", "x,z [um]"):  # two columns of whole numbers
        with pytest.raises(sb.InputError, match="unit of its positions"):
            read(tmp_path, header + "\n" + rows(10 * np.arange(400), range(400), form=("{}", "{}")))


def test_heights_in_one_column_with_lines_and_samples_are_a_map(tmp_path):
    column = "Height(nm)\n" + rows(MAP.ravel())
    scan = read(tmp_path, "Scan Size: 24000 nm\n\\Samps/line: 48\n\\Lines: 48\n" + column)
    assert scan.spacing == pytest.approx((0.5e-6, 0.5e-6)) and scan.heights == pytest.approx(MAP.T * 1e-9, abs=6e-14)
    assert "48 lines of 48 heights" in scan.notes[0]
    for counts in ("Samps/line: 48\nLines: 47\n", "Samps/line: 48\n"):
        with pytest.raises(sb.InputError, match="has 2304 heights in one column, but declares 'Samps/line: 48'"):
            read(tmp_path, "Scan Size: 24000 nm\n" + counts + column)
    with pytest.raises(sb.InputError, match="two columns are two channels of a map"):
        channels = "Height(nm)\tError(nm)\n" + rows(MAP.ravel(), MAP.ravel(), sep="\t")
        read(tmp_path, "Scan Size: 24000 nm\nSamps/line: 48\nLines: 48\n" + channels)
    assert read(tmp_path, "Samps/line: 400\nSpacing: 1 um\nz (um)\n" + rows(LINE)).heights.shape == (400,)


def test_the_advice_on_a_missing_unit_works(tmp_path):
    for header, options, advice in (
        ("x [mm];z", {"height_unit": "um"}, r"unit of its heights; add --height-unit um \(in Python height_unit='um'\)"),
        ("x;z [um]", {"unit": "mm", "height_unit": "um"}, "unit of its positions; add --unit um --height-unit um"),
    ):
        text = f"{header}\n" + rows(X, LINE, sep=";")
        with pytest.raises(sb.InputError, match=advice):
            read(tmp_path, text)
        assert read(tmp_path, text, **options).spacing == pytest.approx((0.156e-3,))


def test_a_code_for_no_height_that_the_file_declares_is_missing(tmp_path):
    cells = [f"{v:.4f}" for v in LINE]
    cells[7] = cells[9] = "0.1234"
    scan = read(tmp_path, "No data value: 0.1234\nx (um),z (um)\n" + rows(X, cells, form=("{:.3f}", "{}")))
    assert scan.missing == 2 and scan.notes == ("2 points hold 0.1234, a code for no height, and count as missing.",)


def test_a_factor_of_heights_that_was_not_applied_is_said(tmp_path):
    table = "x (um),z (nm)\n" + rows(X, LINE, form=("{:.3f}", "{:.4f}"))
    for line in ["z scale: 0.001", "Bit2nm = 0.1", "Z factor = 0.01 um/digit"]:
        scan = read(tmp_path, line + "\n" + table)
        assert scan.notes == (f"Heights are as they stand in the file: '{line}' was not applied.",)
    for line in ["Z scale: 500 nm", "Bit2nm = 1.0", "Zoom factor: 20"]:
        assert read(tmp_path, line + "\n" + table).notes == ()


def test_a_profile_without_names_may_number_its_points(tmp_path):
    scan = read(tmp_path, rows(range(400), X, LINE, form=("{}",)), unit="um")
    assert scan.heights == pytest.approx(LINE * 1e-6, abs=6e-11) and "numbers the points" in scan.notes[0]


def test_marks_of_instruments_for_no_height_are_missing_and_named(subtests, tmp_path):
    for mark in [
        "-9999",
        "-9999.0",
        "-32768",
        "1e37",
        "1.70141e+38",
        "-3.40282e+38",
        "No Data",
        "no data",
        "nan",
        "-nan(ind)",
        "***",
        "*****",
    ]:
        with subtests.test(mark=mark):
            cells = [f"{v:.4f}" for v in LINE]
            cells[50] = cells[51] = cells[200] = mark
            line = read(tmp_path, "x (um),z (um)\n" + rows(X, cells, form=("{:.3f}", "{}")))
            table = [[f"{v:.4f}" for v in row] for row in MAP]
            table[0][0] = table[3][4] = table[3][5] = mark
            whole = read(
                tmp_path, "# Width: 48 um\n# Height: 24 um\n# Value units: um\n" + "\n".join("\t".join(row) for row in table)
            )
            for scan in (line, whole):
                assert scan.missing == 3
                assert scan.notes[0].startswith("3 points ") and "as missing" in scan.notes[0]


def test_lines_of_a_map_in_which_nothing_was_measured_are_part_of_it(tmp_path):
    missing = "\t".join(["No Data"] * 48)
    scan = read(tmp_path, "\n".join([missing, *matrix().splitlines(), missing]), unit="um", spacing="1 um")
    assert scan.heights.shape == (48, 50) and scan.missing == 96


def test_a_line_without_a_height_in_a_column_is_a_gap_and_moves_no_other_point(subtests, tmp_path):
    for mark in ("NaN", "---", "void", "#N/A", "#DIV/0!", "-inf", '""', "No Data"):
        for header in ("Height unit: um\n", "Height unit: um\nz\n"):
            with subtests.test(mark=mark, header=header):
                cells = [f"{v:.4f}" for v in LINE]
                cells[50] = mark
                scan = read(tmp_path, header + "\n".join(cells), spacing="0.156 um")
                assert np.flatnonzero(np.isnan(scan.heights)).tolist() == [50] and scan.heights.size == 400
                assert any("1 point " in note and "as missing" in note for note in scan.notes)
    text = "\n".join(f"{v:.4f}" for v in LINE)
    for between in ("", "# a remark", "\n\n", "Ra;3"):
        lines = text.splitlines()
        lines.insert(50, between)
        with subtests.test(between=between), pytest.raises(sb.InputError, match="line 52, between heights, holds none"):
            read(tmp_path, "\n".join(["z [um]", *lines]), spacing="0.156 um")
    assert read(tmp_path, "z [um]\n\n" + text.replace("\n", "\n\n"), spacing="0.156 um").heights.size == 400
    for between in ("", "\t" * 47, "# a remark"):
        lines = matrix().splitlines()
        lines.insert(5, between)
        with subtests.test(between=between), pytest.raises(sb.InputError, match="line 6, between heights, holds none"):
            read(tmp_path, "\n".join([*lines, "", "\t" * 47]), unit="um", spacing="1 um")
    blocks = "\n\n".join("\n".join(f"{v:.4f}" for v in row) for row in MAP)
    scan = read(tmp_path, f"Samples/line: 48\nLines: 48\nUnit: um\n{blocks}", spacing="1 um")
    assert scan.heights.shape == (48, 48)


def test_a_code_is_one_also_where_heights_come_near_to_it(tmp_path):
    ramp = np.linspace(-8000, 8000, 400)
    ramp[[33, 34, 90]] = -9999
    assert read(tmp_path, "x (um),z (nm)\n" + rows(X, ramp)).missing == 3


def test_heights_that_reach_to_a_code_are_heights(tmp_path):
    ramp = np.linspace(-12000, 12000, 400)
    ramp[33] = -9999
    assert read(tmp_path, "x (um),z (nm)\n" + rows(X, ramp)).missing == 0


def test_more_columns_than_a_profile_has_are_named(tmp_path):
    with pytest.raises(sb.InputError, match=r"4 columns \('X1', 'Z1', 'X2', 'Z2'\); keep two for a line"):
        read(tmp_path, "X1,Z1,X2,Z2\n" + rows(X, LINE, X, LINE), unit="um")


def test_heights_before_their_places_are_not_taken_for_places(subtests, tmp_path):
    rows = [(f"{i}", f"{math.sin(i):.4f}") for i in range(64)]
    for header, order in (("Height [um];Position [um]", (1, 0)), ("x (um);z (um);y (um)", (0, 1, 0)), ("z/um;x/um", (1, 0))):
        with subtests.test(header=header):
            path = tmp_path / "scan.csv"
            path.write_text("\n".join([header, *(";".join(row[k] for k in order) for row in rows)]))
            with pytest.raises(sb.InputError, match="heights stand in the last column"):
                sb.surfaces.read_topography(path)


def test_a_wrong_cell_near_the_top_is_named_and_no_row_is_lost(tmp_path):
    with pytest.raises(sb.InputError, match="line 3, column 2 is 'oops'"):
        read(tmp_path, "x (um),z (um)\n0,1\n1,oops\n" + rows(X + 2, LINE))


def test_the_reason_of_the_reader_is_shown_for_a_file_of_an_instrument(tmp_path):
    heights = MAP * 1e-6
    write_x3p(tmp_path / "whole.x3p", heights, 1e-6, 1e-6)
    with zipfile.ZipFile(tmp_path / "whole.x3p") as whole, zipfile.ZipFile(tmp_path / "a.x3p", "w") as changed:
        for name in whole.namelist():
            changed.writestr(name, whole.read(name).replace(b"bindata/data.bin", b"bindata/other.bin"))
    write_sdf(tmp_path / "a.sdf", heights, 1e-6, 1e-6)
    (tmp_path / "a.sdf").write_text((tmp_path / "a.sdf").read_text()[:900])
    write_gwy(tmp_path / "a.gwy", heights, 1e-6, 1e-6)
    (tmp_path / "a.gwy").write_bytes((tmp_path / "a.gwy").read_bytes()[:900])
    for name, reason in (("a.x3p", "other.bin"), ("a.sdf", "End of stream"), ("a.gwy", "900 bytes")):
        with pytest.raises(sb.InputError, match=f"Reader: .*{reason}"):
            sb.surfaces.read_topography(tmp_path / name)
