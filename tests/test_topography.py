"""Heights from files: real formats, plain text as laboratories write it, dead points, and what is refused."""

import math
import zipfile

import numpy as np
import pytest
from topography_files import write_gwy, write_sdf, write_x3p

import stribeck as sb
from stribeck.surfaces import SelfAffine, Topography, analyse, read_topography, synthetic_topography
from stribeck.surfaces import files as scan_files


@pytest.fixture(scope="module")
def heights():
    return np.random.default_rng(83).standard_normal((40, 36)) * 1e-7


# --- the formats of instruments ---


def test_a_map_in_a_real_format_is_read_back(subtests, tmp_path, heights):
    for name, write in [("a.x3p", write_x3p), ("a.sdf", write_sdf), ("a.gwy", write_gwy)]:
        with subtests.test(name=name, write=write):
            z = heights.copy()
            if name != "a.gwy":  # which has no mark for a missing point
                z[3, 4] = np.nan
            write(tmp_path / name, z, 1e-6, 2e-6)
            read = read_topography(tmp_path / name)
            assert read.spacing == pytest.approx((1e-6, 2e-6), rel=1e-12, abs=0)
            assert np.nanmax(np.abs(read.heights - z)) < 1e-15
            assert np.array_equal(np.isnan(read.heights), np.isnan(z))
            assert read.source == f"{name} ({name[2:]})"


def test_a_format_without_units_is_refused_until_they_are_given(tmp_path, heights):
    np.save(tmp_path / "z.npy", heights * 1e9)
    with pytest.raises(sb.InputError, match="does not declare its unit; add --unit um"):
        read_topography(tmp_path / "z.npy")
    with pytest.raises(sb.InputError, match="distance between points; add --spacing"):
        read_topography(tmp_path / "z.npy", unit="nm")
    read = read_topography(tmp_path / "z.npy", unit="um", height_unit="nm", spacing="0.5 um")
    assert read.spacing == pytest.approx((5e-7, 5e-7))
    assert read.heights == pytest.approx(heights)


def test_codes_for_no_height_are_missing_in_files_of_instruments_too(tmp_path, heights):
    z = np.where(np.arange(heights.size).reshape(heights.shape) % 50 == 7, -9999.0, 1e6 * heights)
    lines = [" ".join(f"{height:.6f}" for height in row) for row in z]
    (tmp_path / "a.asc").write_text("\n".join(["ncols 36", "nrows 40", "NODATA_value -9999", *lines]))
    read = read_topography(tmp_path / "a.asc", unit="um", spacing="1 um")
    assert np.array_equal(np.isnan(read.heights.T), z == -9999)
    assert read.notes == ("29 points hold -9999, a code for no height, and count as missing.",)


def test_a_profile_in_a_format_of_maps_is_a_profile(tmp_path, heights):
    write_x3p(tmp_path / "a.x3p", heights.reshape(-1, 1), 1e-6, 2e-6)
    read = read_topography(tmp_path / "a.x3p")
    assert read.spacing == pytest.approx((1e-6,))
    assert read.heights == pytest.approx(heights.ravel(), abs=1e-15)


def test_points_without_a_distance_are_named_with_their_file(tmp_path, heights):
    write_x3p(tmp_path / "a.x3p", heights, 0.0, 2e-6)
    with pytest.raises(sb.InputError, match=r"a\.x3p declares a scan of 0 x 7\.2e-05 m"):
        read_topography(tmp_path / "a.x3p")


def test_what_a_file_declares_cannot_be_overruled(tmp_path, heights):
    write_x3p(tmp_path / "a.x3p", heights, 1e-6, 1e-6)
    with pytest.raises(sb.InputError, match="declares its unit, m; leave out unit = 'um'"):
        read_topography(tmp_path / "a.x3p", unit="um")
    with pytest.raises(sb.InputError, match="leave out spacing"):
        read_topography(tmp_path / "a.x3p", spacing="1 um")
    with pytest.raises(sb.InputError, match="no channel of heights called 'Phase'; it has"):
        read_topography(tmp_path / "a.x3p", channel="Phase")


def test_a_damaged_file_is_refused_in_one_sentence(subtests, tmp_path):
    for name in ["a.x3p", "a.sur"]:
        with subtests.test(name=name):
            (tmp_path / name).write_bytes(b"\x00\xff\x03\x04 not heights")
            with pytest.raises(sb.InputError, match="is damaged or in a format that SurfaceTopography does not know"):
                read_topography(tmp_path / name)
            with pytest.raises(sb.InputError, match="not a file"):
                read_topography(tmp_path / "b.x3p")


def test_a_file_that_was_cut_off_is_not_said_to_lack_its_unit(tmp_path, heights):
    write_x3p(tmp_path / "a.x3p", heights, 1e-6, 1e-6)
    whole = (tmp_path / "a.x3p").read_bytes()
    for kept in (0, 4, 100, 2000, len(whole) // 2, len(whole) - 60, len(whole) - 1):
        (tmp_path / "b.x3p").write_bytes(whole[:kept])
        said = "is empty" if kept == 0 else "is cut off or damaged: it starts as a zip archive"
        with pytest.raises(sb.InputError, match=f"b.x3p {said}.*copy it from the instrument again"):
            read_topography(tmp_path / "b.x3p")


def test_a_spoilt_part_of_an_archive_is_named(tmp_path, heights):
    write_x3p(tmp_path / "a.x3p", heights, 1e-6, 1e-6)
    spoilt = bytearray((tmp_path / "a.x3p").read_bytes())
    spoilt[len(spoilt) // 2] ^= 0xFF
    (tmp_path / "a.x3p").write_bytes(spoilt)
    with pytest.raises(sb.InputError, match="a.x3p is damaged: bindata/data.bin in it has changed since it was written"):
        read_topography(tmp_path / "a.x3p")


def test_a_zip_archive_is_not_unpacked_where_it_would_fill_the_memory(tmp_path, monkeypatch):
    """3 MB may become 10 GB."""
    bomb = tmp_path / "bomb.x3p"
    with zipfile.ZipFile(bomb, "w", zipfile.ZIP_DEFLATED) as archive:
        for name in ("bindata/data.bin", "more.bin"):
            archive.writestr(name, bytes(600_000))
    assert bomb.stat().st_size < 3000
    monkeypatch.setattr(scan_files, "MAX_FILE_BYTES", 1_000_000)
    monkeypatch.setattr(zipfile.ZipFile, "open", lambda *arguments, **options: pytest.fail("it was unpacked"))
    with pytest.raises(sb.InputError, match=r"bomb\.x3p would be 0\.0012 GB unpacked, more than 0 GB; crop the scan"):
        read_topography(bomb)
    large = tmp_path / "large.opd"
    large.write_bytes(b"x" * 1_000_001)
    with pytest.raises(sb.InputError, match=r"large\.opd has more than 0 GB; crop the scan"):
        read_topography(large)


def test_a_scan_of_too_many_points_is_refused_before_they_are_read(tmp_path, heights, monkeypatch):
    write_x3p(tmp_path / "a.x3p", heights, 1e-6, 1e-6)
    monkeypatch.setattr(scan_files, "MAX_POINTS", heights.size - 1)
    with pytest.raises(sb.InputError, match=rf"a\.x3p has \d+ x \d+ points, more than {heights.size - 1}; crop the scan"):
        read_topography(tmp_path / "a.x3p")


def test_what_is_not_of_the_format_of_its_ending_is_told(subtests, tmp_path):
    for content in [b"1 2 3\n4 5 6\n", b"hello world\n1 2 3\n", bytes(5000)]:
        for name in ["a.x3p", "a.sdf", "a.OPD"]:
            with subtests.test(content=content, name=name):
                (tmp_path / name).write_bytes(content)
                for given in ({}, {"unit": "um", "spacing": "1 um"}):
                    with pytest.raises(sb.InputError, match=f"does not start like a {name[1:].lower()} file"):
                        read_topography(tmp_path / name, **given)


def test_a_binary_file_under_an_ending_of_text_is_read_as_that_of_an_instrument(tmp_path, heights):
    np.save(tmp_path / "z.npy", heights)
    (tmp_path / "z.npy").rename(tmp_path / "scan.dat")  # the ending of MetroPro
    read = read_topography(tmp_path / "scan.dat", unit="m", spacing="1 um")
    assert np.array_equal(read.heights, heights)
    (tmp_path / "bad.dat").write_bytes(b"\x88\x1b\x03\x6f" + bytes(5000))
    with pytest.raises(sb.InputError, match="bad.dat") as caught:
        read_topography(tmp_path / "bad.dat")
    assert "the ending of its format" not in str(caught.value)


def test_heights_under_an_ending_of_no_format_are_read(tmp_path, heights):
    np.savetxt(tmp_path / "a.heights", heights)
    assert read_topography(tmp_path / "a.heights", unit="m", spacing="1 um").heights.shape == heights.T.shape


# --- plain text ---


def grid_rows(z, step):
    return [(i * step, j * step, z[i, j]) for i in range(z.shape[0]) for j in range(z.shape[1])]


DIALECTS = {
    "semicolon, decimal comma": ("x (um);y (um);z (nm)", ";", ","),
    "German header": ("Länge [um];Breite [um];Höhe [nm]", ";", ","),
    "tabs": ("x (um)\ty (um)\tz (nm)", "\t", "."),
    "tabs, decimal comma": ("x (um)\ty (um)\tz (nm)", "\t", ","),
    "comma": ("x (um),y (um),z (nm)", ",", "."),
    "spaces": ("# x (um) y (um) z (nm)", "   ", "."),
    "spaces, decimal comma": ("# x (um) y (um) z (nm)", " ", ","),
}


def test_a_map_in_any_dialect_of_text_is_read_back(subtests, tmp_path, heights):
    for dialect in DIALECTS:
        with subtests.test(dialect=dialect):
            header, separator, point = DIALECTS[dialect]
            rows = grid_rows(heights, 2.5)
            np.random.default_rng(84).shuffle(rows)
            lines = [separator.join(f"{v:.9g}" for v in (x, y, z * 1e9)).replace(".", point) for x, y, z in rows]
            (tmp_path / "map.csv").write_text("\n".join(["Profilometer 7", header, *lines]), encoding="latin-1")
            read = read_topography(tmp_path / "map.csv")
            assert read.spacing == pytest.approx((2.5e-6, 2.5e-6))
            assert np.abs(read.heights - heights).max() < 1e-15


def test_points_that_are_absent_or_empty_are_missing(tmp_path, heights):
    lines = [f"{x:g};{y:g};{z * 1e9:.6f}" for x, y, z in grid_rows(heights, 2.5)]
    lines[5] = lines[5].rpartition(";")[0] + ";"
    lines[6] = lines[6].rpartition(";")[0] + ";---"
    del lines[100]
    (tmp_path / "map.txt").write_text("\n".join(["x [um];y [um];z [nm]", *lines]))
    read = read_topography(tmp_path / "map.txt")
    assert list(zip(*np.nonzero(np.isnan(read.heights)), strict=True)) == [(0, 5), (0, 6), (2, 28)]


def test_a_line_has_its_positions_or_a_spacing(tmp_path):
    x, z = np.arange(80) * 0.25, np.random.default_rng(85).standard_normal(80)
    (tmp_path / "line.csv").write_text("\n".join(f"{a},{b}" for a, b in zip(x[::-1], z[::-1], strict=True)))
    (tmp_path / "z.csv").write_text("\n".join(map(str, z)))
    (tmp_path / "matrix.csv").write_text("\n".join(" ".join(map(str, row)) for row in z.reshape(2, 40).repeat(20, 0)))
    line = read_topography(tmp_path / "line.csv", unit="mm", height_unit="um")
    assert line.spacing == pytest.approx((2.5e-4,))
    assert line.heights == pytest.approx(z * 1e-6)
    assert read_topography(tmp_path / "z.csv", unit="um", spacing="2 um").spacing == (2e-6,)
    matrix = read_topography(tmp_path / "matrix.csv", unit="um", spacing="2 um")
    assert matrix.heights.shape == (40, 40)
    assert matrix.heights[:, 0] == pytest.approx(z[:40] * 1e-6)


def test_an_uneven_line_is_interpolated_and_says_so(tmp_path):
    x = np.cumsum(np.random.default_rng(86).uniform(0.8, 1.2, 200))
    (tmp_path / "line.csv").write_text("\n".join(f"{a} {math.sin(a / 20)}" for a in x))
    line = read_topography(tmp_path / "line.csv", unit="um")
    assert "uneven" in line.notes[0]
    even = x[0] + np.arange(line.heights.size) * line.spacing[0] * 1e6
    assert np.abs(line.heights * 1e6 - np.sin(even / 20)).max() < 0.05
    assert line.resolution == pytest.approx(8 * line.spacing[0])


def test_a_line_keeps_its_step_where_rows_of_missing_points_are_left_out(tmp_path):
    heights = np.random.default_rng(8).normal(size=300).cumsum()
    kept = [i for i in range(300) if i != 7 and not 100 <= i < 115]
    text = "x (um),z (nm)\n" + "".join(f"{0.15625 * i:.3f},{heights[i]:.3f}\n" for i in kept)
    (tmp_path / "line.csv").write_text(text)
    line = read_topography(tmp_path / "line.csv")
    assert line.spacing == (pytest.approx(0.15625e-6, rel=1e-5),) and len(line.heights) == 300
    assert np.flatnonzero(np.isnan(line.heights)).tolist() == [7, *range(100, 115)]
    np.testing.assert_allclose(line.heights[kept], 1e-9 * heights[kept], atol=1e-12)


def test_an_uneven_line_may_miss_as_much_as_a_map(tmp_path):
    x, rng = np.cumsum(np.random.default_rng(86).uniform(0.8, 1.2, 200)), np.random.default_rng(87)
    for missing, refused in ((20, False), (21, True)):
        lost = set(rng.choice(200, missing, replace=False).tolist())
        rows = [f"{a};{'' if i in lost else math.sin(a / 20)}" for i, a in enumerate(x)]
        (tmp_path / "line.csv").write_text("\n".join(["x (um);z (um)", *rows]))
        if refused:
            with pytest.raises(
                sb.InputError, match=r"^line\.csv: 10 % of the points are missing, more than 10 %; crop the scan"
            ):
                read_topography(tmp_path / "line.csv")
        else:
            assert "uneven" in read_topography(tmp_path / "line.csv").notes[0]


def test_what_is_left_out_below_the_heights_is_said(subtests, tmp_path):
    """A footer, a mean or another table may be part of the scan: all faces say that it was not read."""
    heights = synthetic_topography(SelfAffine(1e-6, 2e4, 3e6, 0.8, 1e5), (40, 40), 1e-6, 5).heights
    matrix = "\n".join(" ".join(f"{v * 1e9:.4f}" for v in row) for row in heights)
    points = "\n".join(["x (um);y (um);z (nm)", *(f"{x:g};{y:g};{z * 1e9:.4f}" for x, y, z in grid_rows(heights, 1))])
    for body, options in ((matrix, {"unit": "nm", "spacing": "1 um"}), (points, {})):
        last = body.count("\n") + 1
        mark = ";" if body is points else " "
        of_points = ["5", "Sa;0.41;nm\nSq;0.5;nm", "filter;0.8;mm"] if body is points else []
        statistics = (mark.join(row.split()) for row in ("Sa 0.41", "Sq 0.5 nm", "mean 5", f"Max.: {' 3' * 40}", "Ra[um] 1"))
        footers = "end of data", "mean\n5", "Sa;Sq\n1;2\n3;4"
        for footer in (*footers, *statistics, *of_points):
            with subtests.test(first=body[:8], footer=footer):
                path = tmp_path / "scan.txt"
                path.write_text(f"{body}\n{footer}\n# a comment is none\n")
                count = footer.count("\n") + 1
                numbers = ", ".join(str(last + k + 1) for k in range(count))
                said = f"{count} row{'s' * (count > 1)} below the numbers left out: {numbers}."
                read = read_topography(path, **options)
                assert read.heights.size == heights.size and read.notes == (said,)
    surface = analyse(read)
    assert said in surface.notes and said in surface.to_dict()["notes"] and said in str(surface)


TEXTS = {
    "no unit": ("1,2\n2,3.5\n3,4\n", {}, "does not declare the unit of its heights; add --unit um"),
    "contradiction": (
        "x (um);z (nm)\n1;2\n2;3\n",
        {"height_unit": "um"},
        "declares its heights in nm, but height_unit = 'um'",
    ),
    "wrong unit": ("1;2\n2;3\n", {"unit": "kg"}, "expected a length such as"),
    "unknown unit in the header": ("x (um);z (foo)\n1;2\n2;3\n", {}, "unit of heights"),
    "ragged": ("1;2\n2;3\n3;4;5\n", {"unit": "um"}, "row 3 has 3 cells where the rows above have 2"),
    "word": ("1;2\n2;oops\n3;4\n", {"unit": "um"}, "line 2, column 2 is 'oops', not a number"),
    "word before the last row": ("1;2\nPeak;0.4\n3;4\n", {"unit": "um"}, "line 2, column 1 is 'Peak', not a number"),
    "no numbers": ("hello\nworld\n", {"unit": "um"}, "no line of numbers"),
    "empty": ("", {"unit": "um"}, "holds no data; give lines of heights"),
    "no position": ("1;2\n;3\n3;4\n", {"unit": "um"}, "line 2 has no position"),
    "same position": ("1;2\n2;3\n2;4\n", {"unit": "um"}, "line 3 has the same position"),
    "no spacing": ("1\n2\n3\n", {"unit": "um"}, "give the distance between points with --spacing"),
    "spacing twice": ("1;2\n2;3\n", {"unit": "um", "spacing": "1 um"}, "has positions"),
    "no grid": ("0;0;1\n1;0;1\n2;0;1\n3.4;0;1\n0;1;2\n", {"unit": "um"}, "line 4 does not lie on an even grid in x"),
    "same point": ("0;0;1\n1;0;1\n0;1;1\n1;1;2\n1;1;3\n", {"unit": "um"}, "line 5 repeats the position"),
    "no area": ("0;0;1\n0;0;1\n", {"unit": "um"}, "all points have the same x"),
    "either comma": ("1,5\n2,5\n", {"unit": "um"}, "may be two columns or one number"),
    "scattered points": (
        "0;0;1\n1;0;1\n2;0;1\n3;0;1\n4;0;1\n0;1;1\n0;2;1\n0;3;1\n0;9;1\n",
        {"unit": "um"},
        "most of the grid empty",
    ),
    "hardly a height": ("0.00;1\n1.00;---\n3.00;---\n4.00;---\n", {"unit": "um"}, "75 % of the points are missing"),
    "two spacings of a line": (
        "1\n2\n3\n",
        {"unit": "um", "spacing": "1 um x 2 um"},
        "give one distance, or one for each axis",
    ),
    "two points": ("1;2\n2;3\n", {"unit": "um"}, "2 points are too few"),
    "binary": ("1\0;2\n", {"unit": "um"}, "is not text"),
    "channel": ("1;2\n", {"channel": "Height"}, "plain text without channels"),
}


def test_text_that_is_no_topography_is_refused_by_line(subtests, tmp_path):
    for case in TEXTS:
        with subtests.test(case=case):
            text, options, words = TEXTS[case]
            (tmp_path / "scan.csv").write_text(text)
            with pytest.raises(sb.InputError, match=words) as caught:
                read_topography(tmp_path / "scan.csv", **options)
            assert "\n" not in str(caught.value)


# --- what a topography is ---


def test_heights_that_have_no_spectrum_are_refused(subtests):
    for z, spacing, words in [
        (np.ones(100), (1e-6,), "all heights are the same"),
        (np.arange(20.0), (1e-6,), "too few for a spectrum"),
        (np.where(np.arange(100) % 4, np.arange(100.0), np.nan), (1e-6,), "25 % of the points are missing"),
        (np.arange(100.0), (0.0,), "spacing = 0.0 is not a positive number"),
        (np.arange(100.0), (1e-6, 1e-6), "neither a profile nor a map"),
    ]:
        with subtests.test(z=z, spacing=spacing, words=words), pytest.raises(sb.InputError, match=words):
            Topography(z, spacing)


def test_dead_points_are_filled_by_the_plane_around_them():
    x, y = np.meshgrid(np.arange(40.0), np.arange(36.0), indexing="ij")
    plane = 2 * x - y
    holes = plane.copy()
    holes[10:13, 20:24] = np.nan
    holes[0, 0] = np.nan
    filled = Topography(holes, (1.0, 1.0)).repaired(keep_spikes=True)
    inner = filled.heights[10:13, 20:24]
    assert inner == pytest.approx(plane[10:13, 20:24], abs=1e-12)
    assert filled.missing == 0
    assert filled.notes == ("13 of 1440 points are without a height, filled from the neighbours.",)


def test_a_saturated_point_counts_as_dead_and_roughness_does_not():
    rough = synthetic_topography(SelfAffine(1e-6, 2e4, 3e6, 0.8, 1e5), (64, 64), 1e-6, 5)
    assert rough.repaired().notes == ()
    z = rough.heights.copy()
    z[30, 31] = 1e-4
    spiked = Topography(z, rough.spacing)
    assert spiked.repaired().notes == (
        "1 point is a spike, far above or below all neighbours, and replaced by their heights.",
    )
    assert abs(spiked.repaired().heights[30, 31] - rough.heights[30, 31]) < 5e-7
    assert spiked.repaired(keep_spikes=True).heights[30, 31] == 1e-4


def test_rough_surfaces_have_no_spikes(subtests):
    for points in [(64, 64), (512,)]:
        for hurst in [0.3, 1.0]:
            with subtests.test(points=points, hurst=hurst):
                for seed in range(2):
                    for surface in (SelfAffine(1e-6, 1e4, 3e6, hurst, 1e5), SelfAffine(1e-6, 1e4, 1e6, hurst)):
                        assert synthetic_topography(surface, points, 1e-6, seed).repaired().notes == ()


def bumps(width, seed):
    """Return asperities of this width in points, on a plain that is nearly flat."""
    random = np.random.default_rng(seed)
    z = 0.01 * random.standard_normal((128, 128))
    x, y = np.indices(z.shape)
    for cx, cy, height in zip(*random.uniform(0, 128, (2, 40)), random.exponential(3.0, 40), strict=True):
        z += height * np.exp(-((x - cx) ** 2 + (y - cy) ** 2) / (2 * width**2))
    return Topography(z * 1e-8, (1e-6, 1e-6))


def test_summits_on_a_plain_are_no_spikes(subtests):
    for width in [0.8, 1.5, 3.0]:
        with subtests.test(width=width):
            # Against the scatter of the whole scan, hundreds of their points are outliers.
            for seed in range(3):
                scan = bumps(width, seed)
                assert scan.repaired().notes == ()
                assert scan.repaired().heights.std() == scan.heights.std()


def test_planted_spikes_are_replaced_and_nothing_else(subtests):
    for hurst in [0.3, 0.8]:
        for points in [(64, 64), (512,)]:
            with subtests.test(hurst=hurst, points=points):
                whole = synthetic_topography(SelfAffine(1e-6, 1e4, 3e6, hurst, 1e5), points, 1e-6, 17)
                z = whole.heights.copy()
                rms = float(z.std())
                places = np.random.default_rng(18).choice(z.size // 16, 12, replace=False) * 16 + 3
                z.ravel()[places] += 12 * rms * np.array([1, -1] * 6)
                repaired = Topography(z, whole.spacing).repaired()
                changed = np.flatnonzero((repaired.heights != z).ravel())
                assert set(changed) <= set(places) and changed.size >= 11
                assert abs(repaired.heights.std() / rms - 1) < (0.005 if changed.size == 12 else 0.1)


def test_two_points_beside_each_other_are_an_asperity():
    z = np.array(synthetic_topography(SelfAffine(1e-6, 1e4, 3e6, 0.8, 1e5), (64, 64), 1e-6, 19).heights)
    z[20:22, 20] += 1e-5
    assert Topography(z, (1e-6, 1e-6)).repaired().notes == ()


def test_a_synthetic_surface_has_the_moments_of_its_spectrum():
    surface = SelfAffine(1e-6, 1e5, 1.2e6, 0.8, 2e5)
    maps = [synthetic_topography(surface, (128, 128), 1e-6, seed, oversize=1).heights for seed in range(30)]
    assert np.mean([np.mean(z**2) for z in maps]) == pytest.approx(1e-12, rel=0.03, abs=0)
    slope = [(np.roll(z, -1, 0) - np.roll(z, 1, 0)) / 2e-6 for z in maps]
    assert np.mean([2 * np.mean(s**2) for s in slope]) == pytest.approx(surface.spectrum.moment(2), rel=0.15, abs=0)
