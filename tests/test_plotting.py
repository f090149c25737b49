"""Pictures: they show the solved numbers, say where they are not to be trusted, and can be read."""

import sys
import textwrap
from functools import cache

import matplotlib
import numpy as np
import pytest
from ball_data import BALL
from command_line import HEAVY, PDMS, run_python

import stribeck as sb


def curve_of(path, **arguments):
    return sb.stribeck_curve(sb.load_case(path).contact, **arguments)


@pytest.fixture(scope="module")
def curve():
    return curve_of(PDMS, points=9)


@pytest.fixture(scope="module")
def heavy():
    return curve_of(HEAVY, speed=("1 mm/s", "100 m/s"), points=5)


@pytest.fixture(scope="module")
def solution():
    return sb.solve(sb.load_case(PDMS).contact)


CURVES = {
    "over speed": lambda: curve_of(PDMS, points=5),
    "over load": lambda: curve_of(PDMS, load=("5 N/m", "200 N/m"), points=4),
    "over roughness": lambda: curve_of(PDMS, roughness=("0.1 um", "10 um"), points=4),
    "of groups": lambda: sb.stribeck_curve(load=0.1, roughness=1e-3, speed=(1e-5, 10), points=4),
    "without any friction": lambda: sb.stribeck_curve(sb.Groups(0, 0.1, 1e-3), load=(0.1, 1), points=2, boundary_friction=0),
}


@cache
def curve_of_kind(kind):
    return CURVES[kind]()


PICTURES = {}


def picture(result, **options):
    """Return the picture of a result, drawn once for all tests that only look at it."""
    key = (id(result), *options.items())
    if key not in PICTURES:
        PICTURES[key] = result, result.plot(**options)  # the result too, so that no other gets its number
    return PICTURES[key][1]


def line(axes, label):
    [found] = [each for each in axes.lines if each.get_label().startswith(label)]
    return found


def texts(figure):
    found = list(figure.texts)
    for axes in figure.axes:
        found += [*axes.texts, axes.title, axes.xaxis.label, axes.yaxis.label]
        for child in axes.child_axes:
            found.append(child.xaxis.label)
    for legend in figure.legends:
        found += legend.get_texts()
    return [text for text in found if text.get_text() and text.get_visible()]


def words(figure):
    return "\n".join(text.get_text() for text in texts(figure))


# --- the numbers ---


def test_the_first_panel_shows_friction_and_its_parts(curve):
    axes = picture(curve, abscissa="hersey").axes[0]
    for label, values in (("from asperities", curve.friction.asperities), ("from the fluid", curve.friction.fluid)):
        np.testing.assert_array_equal(line(axes, label).get_ydata(), values)
    drawn = set(zip(*line(axes, "friction").get_data(), strict=True))
    assert set(zip(curve.hersey_number, np.asarray(curve.friction), strict=True)) <= drawn
    assert (axes.get_xscale(), axes.get_yscale()) == ("log", "log")
    assert len({str(each.get_linestyle()) for each in axes.lines[:3]}) == 3  # not by colour alone


def test_the_second_panel_shows_the_films_and_the_roughness_in_si_units(curve):
    axes = picture(curve).axes[1]
    assert axes.get_ylabel() == "film thickness (µm)" and axes.get_xlabel() == "sliding speed $U$ (m/s)"
    films = curve.to_si()
    for label, name in (("central film", "central_film_thickness"), ("minimum film", "minimum_film_thickness")):
        np.testing.assert_array_equal(line(axes, label).get_xdata(), curve.values)
        np.testing.assert_allclose(line(axes, label).get_ydata(), 1e6 * films[name], rtol=1e-12)
    np.testing.assert_allclose(line(axes, "roughness").get_ydata(), 1e6 * curve.contact.roughness, rtol=1e-9)


def test_the_films_over_a_load_are_lengths_and_those_of_groups_are_over_the_indentation():
    curve = curve_of_kind("over load")
    drawn = line(picture(curve).axes[1], "central film").get_ydata()
    np.testing.assert_allclose(
        drawn / curve.to_si()["central_film_thickness"], drawn[0] / curve.to_si()["central_film_thickness"][0]
    )
    groups = sb.stribeck_curve(load=0.1, roughness=1e-3, speed=(1e-3, 1), points=5)
    axes = picture(groups).axes[1]
    assert axes.get_ylabel() == r"film thickness ($u_\mathrm{Hz}$)"
    np.testing.assert_array_equal(line(axes, "minimum film").get_ydata(), groups.observable("minimum_gap"))


def test_the_second_panel_shows_friction_against_the_hydrodynamic_law_beside_the_law_itself(curve):
    axes = picture(curve, panel="hydrodynamic").axes[1]
    drawn = set(zip(*line(axes, "friction").get_data(), strict=True))
    assert set(zip(curve.hydrodynamic_friction, np.asarray(curve.friction), strict=True)) <= drawn
    law = line(axes, "as smooth surfaces")
    np.testing.assert_array_equal(law.get_xdata(), law.get_ydata())


def test_the_axis_that_is_wanted_is_below_and_the_other_one_above(curve, subtests):
    speed = "sliding speed $U$ (m/s)", curve.values
    hersey = "Hersey number $ηU/F_N$", curve.hersey_number
    for abscissa, (own, x), (other, places) in (("speed", speed, hersey), ("hersey", hersey, speed)):
        with subtests.test(abscissa=abscissa):
            axes = picture(curve, abscissa=abscissa).axes[0]
            axes.figure.canvas.draw()
            [upper] = axes.child_axes
            assert (axes.get_xlabel(), upper.get_xlabel()) == (own, other)
            np.testing.assert_array_equal(line(axes, "from the fluid").get_xdata(), x)
            np.testing.assert_allclose(upper.get_xlim(), places[[0, -1]], rtol=1e-12)
    with pytest.raises(sb.InputError, match=r"abscissa = 'sped'; it must be 'speed' or 'hersey'\.$"):
        picture(curve, abscissa="sped")


def test_the_hersey_number_of_a_ball_has_its_radius():
    ball = sb.stribeck_curve(BALL, speed=(0.7 * BALL.speed, 1.4 * BALL.speed), points=2, rtol=1e-2)
    axes = ball.plot(abscissa="hersey").axes[0]
    assert axes.get_xlabel() == "Hersey number $ηUR/F_N$"
    np.testing.assert_array_equal(line(axes, "from the fluid").get_xdata(), ball.hersey_number)


def test_minimum_and_equal_shares_are_marked_where_they_were_located(curve):
    axes = picture(curve, abscissa="hersey").axes[0]
    mark = line(axes, "minimum")
    hersey = curve.contact.viscosity * curve.minimum.value / curve.contact.load
    np.testing.assert_allclose(mark.get_xdata(), hersey, rtol=1e-12)
    assert mark.get_ydata() == pytest.approx([curve.minimum.friction])
    assert mark.get_label().endswith("at 27.6 mm/s")
    assert line(axes, "fluid carries half the load").get_label().endswith("at 2.79 mm/s")


def test_regimes_are_shaded_between_the_transitions(curve):
    axes = picture(curve, abscissa="hersey").axes[0]
    assert [text.get_text() for text in axes.texts] == ["boundary", "mixed", "hydrodynamic"]
    spans = [patch for patch in axes.patches if patch.get_zorder() == 0]
    per_hersey = curve.contact.load / curve.contact.viscosity
    edges = [patch.get_x() * per_hersey for patch in spans]
    np.testing.assert_allclose(edges, [low for _, low, _ in curve.regime_ranges], rtol=1e-9)


def test_a_curve_over_load_or_roughness_has_it_as_abscissa():
    for over, unit in (("load", "N/m"), ("roughness", "m")):
        curve = curve_of_kind(f"over {over}")
        axes = picture(curve).axes[0]
        assert set(curve.values) <= set(line(axes, "friction").get_xdata())
        assert axes.get_xlabel().startswith(over) and axes.get_xlabel().endswith(f"({unit})")


def test_where_the_hydrodynamic_law_says_nothing_the_shares_of_the_load_are_at_hand():
    curve = curve_of_kind("over roughness")
    with pytest.raises(sb.InputError, match="take 'shares'"):
        picture(curve, panel="hydrodynamic")
    with pytest.raises(sb.InputError, match="panel = 'films'; it must be 'film' or 'hydrodynamic' or 'shares'"):
        picture(curve, panel="films")
    axes = picture(curve, panel="shares").axes[1]
    np.testing.assert_array_equal(line(axes, "from the fluid").get_ydata(), curve.observable("fluid_load_share"))
    assert axes.get_ylabel() == "share of the load"


def test_a_profile_shows_the_fields_in_si_units(solution):
    above, below = picture(solution).axes
    gap = line(above, "gap")
    fields = solution.to_si(gap.get_xdata() * 1e-6)
    assert above.get_ylabel() == "gap $h$ (µm)"
    np.testing.assert_allclose(gap.get_ydata(), fields.gap * 1e6, rtol=1e-9)
    assert below.get_ylabel() == "pressure (kPa)"
    np.testing.assert_allclose(line(below, "from asperities").get_ydata(), fields.contact_pressure / 1e3, atol=1e-6)
    np.testing.assert_allclose(line(below, "from the fluid").get_ydata(), fields.fluid_pressure / 1e3, atol=1e-6)
    np.testing.assert_allclose(line(below, "total").get_ydata(), fields.pressure / 1e3, atol=1e-6)


# --- what a reader must know ---


def test_the_footer_holds_inputs_law_tolerance_and_version(curve):
    found = words(picture(curve, title="A title"))
    for part in ("A title", "$R$ = 10 mm", "= 2.7 MPa", "$F_N$ = 30 N/m", "= 50 mPa·s", "exponential contact law"):
        assert part in found
    for part in ("viscous friction: balanced", "rtol 1e-06", "estimated error", "9 points", "stribeck 0."):
        assert part in found
    assert "$U$ =" not in found  # it varies


def test_the_footer_gives_numbers_of_a_contact_law_with_their_units():
    law = sb.surfaces.persson_law(sb.surfaces.SelfAffine(h_rms=2e-6, hurst=0.8, q0=1e4, roll_off=3e4, q1=1e8))
    solved = sb.solve(sb.load_case(PDMS).contact.replace(law=law, roughness=2e-6), rtol=1e-3)
    assert "(alpha 1.915, beta 0.04689, rms height 2 µm, rms slope 0.4564, gamma 0.45)" in words(picture(solved))


def test_where_the_law_is_beyond_its_range_the_picture_says_so(curve, heavy):
    hatched = [patch.get_label() for patch in picture(heavy).axes[0].collections]
    assert "contact law outside its range" in hatched
    assert "outside its range, as asperities cannot carry this load" in words(picture(heavy))
    [strip] = [c for c in picture(curve, abscissa="speed").axes[0].collections if "outside" in c.get_label()]
    low, high = strip.get_datalim(strip.axes.transData).intervalx
    beyond = curve.values[np.array([any("beyond" in note for note in each.notes) for each in curve.solutions])]
    assert low < beyond.min() <= beyond.max() < high < 3 * beyond.max()
    inside = curve_of(PDMS, speed=("0.1 mm/s", "3 mm/s"), points=3)
    assert not any("outside" in c.get_label() for c in inside.plot().axes[0].collections)


def test_an_interrupted_curve_says_how_many_points_it_has():
    def stop(done, total):
        if done == 2:
            raise KeyboardInterrupt

    found = words(sb.stribeck_curve(load=0.1, roughness=1e-3, speed=(1, 10), points=5, on_point=stop).plot())
    assert "2 of 5 points" in found
    assert "Interrupted; the finished points are kept" in found


def test_notes_stand_in_a_caption_of_the_colour_of_the_text_and_stay_away_if_not_wanted(heavy, solution):
    for result in (heavy, heavy.solutions[0]):
        said = [text for text in picture(result).texts if text.get_color() == "#1f2328" and text.get_size() == 8]
        assert len(said) >= len(result.notes) > 0
        assert "outside its range" in " ".join(text.get_text() for text in said)
        without = words(picture(result, notes=False))
        assert "outside its range," not in without and "stribeck 0." in without


def test_a_state_that_did_not_converge_says_so_in_its_picture(solution):
    failed = sb.solve(sb.Groups(1e-9, 0.5, 0.0), rtol=1e-11, on_failure="return")  # rounding leaves fewer digits
    for state in (failed, solution):
        said = words(picture(state))
        assert (failed.outcome.value[:40] in said) == ("not converged" in said) == (state is failed)


def test_the_contact_itself_is_marked_where_it_lies(subtests):
    for kind in ["over speed", "over load", "over roughness"]:
        with subtests.test(kind=kind):
            curve = curve_of_kind(kind)
            own = getattr(curve.contact, curve.over)
            axes = picture(curve, **({"abscissa": "speed"} if curve.over == "speed" else {})).axes[0]
            np.testing.assert_allclose(line(axes, "this contact, at ").get_xdata(), own, rtol=1e-9)
    beyond = curve_of_kind("over speed").contact.replace(speed=50.0)
    far = sb.stribeck_curve(beyond, speed=("1 mm/s", "1 m/s"), points=2).plot()
    assert not any(each.get_label().startswith("this contact") for each in far.axes[0].lines)


# --- legibility ---


# --- files ---


def test_the_ending_chooses_the_format(subtests, solution, tmp_path):
    for ending, begins in {".png": b"\x89PNG", ".svg": b"<?xml", ".pdf": b"%PDF"}.items():
        with subtests.test(ending=ending):
            solution.plot(tmp_path / f"profile{ending}")
            assert (tmp_path / f"profile{ending}").read_bytes().startswith(begins)
    assert b"/Type3" not in (tmp_path / "profile.pdf").read_bytes()  # fonts that journals refuse
    with pytest.raises(sb.InputError, match=r"must end in \.png, \.svg or \.pdf\.$"):
        solution.plot(tmp_path / "profile.bmp")


def test_an_existing_picture_is_kept_unless_forced(solution, tmp_path):
    path = tmp_path / "picture.png"
    path.write_text("precious")
    with pytest.raises(sb.InputError, match="exists already and is kept"):
        solution.plot(path)
    assert path.read_text() == "precious"
    solution.plot(path, force=True)
    assert path.read_bytes().startswith(b"\x89PNG")


def test_a_missing_matplotlib_is_one_sentence_with_the_remedy(curve, monkeypatch):
    monkeypatch.setitem(sys.modules, "matplotlib.figure", None)
    with pytest.raises(sb.InputError, match=r"needs matplotlib; install it with: pip install 'stribeck\[plot\]'\."):
        curve.plot()


def test_drawing_changes_no_settings(curve):
    before = dict(matplotlib.rcParams)
    curve.plot()
    assert dict(matplotlib.rcParams) == before


def test_drawing_needs_neither_pyplot_nor_a_display(tmp_path):
    code = """
        import sys
        import stribeck as sb
        sb.solve(sb.Groups(0, 0.1, 0)).plot(sys.argv[1])
        assert "matplotlib.pyplot" not in sys.modules
    """
    answer = run_python(textwrap.dedent(code), tmp_path / "curve.png", DISPLAY="", MPLBACKEND="TkAgg")
    assert answer.code == 0, answer.err


def test_a_title_is_taken_by_the_letter_and_cut_to_the_width_of_the_picture(solution):
    figure = solution.plot(title=r"costs $5 \frac{1$, # b % c & d" + 60 * "very\nlong ")
    figure.canvas.draw()
    [title] = [text for text in figure.texts if text.get_text().startswith(r"costs $5 \frac{1$, # b % c & dvery long")]
    assert title.get_text().endswith("…") and 0.5 < title.get_window_extent().x1 / figure.bbox.x1 < 1
