"""Liquids with numbers: measured viscosities, ranges and sources."""

import numpy as np
import pytest

import stribeck as sb

# Dow Chemical, table of the viscosity of aqueous glycerine solutions [mPa s]: weight fraction against 0, 20 and 40 degC.
DOW = {
    0.0: (1.792, 1.005, 0.656),
    0.3: (5.14, 2.5, 1.46),
    0.5: (14.6, 6.0, 3.1),
    0.7: (76.0, 22.5, 9.4),
    0.8: (255.0, 60.1, 20.8),
    0.9: (1310.0, 219.0, 60.0),
    1.0: (12070.0, 1410.0, 284.0),
}


@pytest.mark.quick
def test_glycerol_in_water_is_that_of_the_measured_table():
    found = [[1e3 * sb.fluids.glycerol_water(part, T).viscosity for T in (0, 20, 40)] for part in DOW]
    assert np.array(found) == pytest.approx(np.array(list(DOW.values())), rel=0.035)


@pytest.mark.quick
def test_silicone_oil_has_the_density_of_data_sheets():
    silicone = sb.fluids.PRESETS["silicone-oil"]
    for grade, density in ((5, 915), (50, 960), (100, 964), (1000, 970)):
        assert silicone(grade=grade).viscosity == pytest.approx(1e-6 * grade * density, rel=0.01)


@pytest.mark.quick
def test_a_hot_oil_of_a_grade_is_as_thin_as_its_chart_says():
    def kinematic(grade, temperature, **index):
        density = 870 - 0.65 * (temperature - 15)
        return 1e6 * sb.fluids.iso_vg(grade, temperature, **index).viscosity / density

    assert kinematic(46, 40) == pytest.approx(46, rel=1e-9)
    assert all(kinematic(grade, 60) == kinematic(46, 60) for grade in ("46", "46 cSt", "46 mm2/s", "ISO-VG 46", "vg46"))
    assert kinematic("VG 46", 60) == pytest.approx(20.6, rel=0.005)  # a common chart of ISO grades of index 100
    # Typical hydraulic oils of data sheets, and their viscosity at 100 degC.
    for grade, index, at_100 in ((32, 102, 5.4), (46, 98, 6.7), (68, 97, 8.6)):
        assert kinematic(grade, 100, viscosity_index=index) == pytest.approx(at_100, rel=0.025)


@pytest.mark.quick
def test_the_viscosity_index_is_that_of_the_standards_examples():
    """ASTM D2270: 73.30 and 8.86 cSt have an index of 92, 22.83 and 5.05 cSt one of 156."""
    for at_40, at_100, index in ((73.30, 8.86, 92), (22.83, 5.05, 156)):
        by_index = sb.fluids.iso_vg(at_40, 100, viscosity_index=index).viscosity
        assert by_index == pytest.approx(sb.fluids.oil(at_40, at_100, "100 degC").viscosity, rel=0.003)
    thinner = [sb.fluids.oil(46, 6.8, T).viscosity for T in (-20, 0, 40, 70, 100, 150)]
    assert all(np.diff(thinner) < 0)


@pytest.mark.quick
def test_thicker_oils_go_over_from_one_piece_of_the_standards_table_to_the_next_without_a_step():
    at_40 = np.geomspace(12.0, 3200.0, 600)
    for index in (0.0, 100.0):
        at_100 = [sb.fluids.iso_vg(grade, 100, viscosity_index=index).viscosity for grade in at_40]
        slopes = np.diff(np.log(at_100)) / np.diff(np.log(at_40))
        assert 0.3 < slopes.min() and slopes.max() < 0.9


def test_an_oil_that_no_sheet_has_is_refused(subtests):
    for name, call, sentence in (
        ("grade", lambda: sb.fluids.iso_vg(1e5), "must lie between 5 and 3200 cSt"),
        ("words", lambda: sb.fluids.iso_vg("SAE 30"), "SAE 30"),
        ("index", lambda: sb.fluids.iso_vg(46, viscosity_index=400), "between 0 and 250"),
        ("thin", lambda: sb.fluids.iso_vg(5, viscosity_index=50), "give both viscosities"),
        ("order", lambda: sb.fluids.oil(6.8, 46), "at 100 and at 40 degC"),
        ("infinite", lambda: sb.fluids.oil(np.inf, 10), "viscosity_40 = inf; write a kinematic viscosity"),
        ("hot", lambda: sb.fluids.oil(46, 6.8, "500 degC"), "between -20 and 150 degC"),
        ("density", lambda: sb.fluids.iso_vg(46, density_15=8.7), "700 and 1100"),
    ):
        with subtests.test(name=name), pytest.raises(sb.InputError, match=sentence):
            call()


@pytest.mark.quick
def test_warm_silicone_oil_thins_less_than_mineral_oil():
    """1 - nu(99)/nu(38) is 0.60 +- 0.02 by makers' data sheets from 100 cSt on."""
    hot, warm = (sb.fluids.PRESETS["silicone-oil"](grade=350, temperature=T).viscosity for T in (99, 38))
    assert 1 - hot / warm * (1 - 9.6e-4 * 13) / (1 - 9.6e-4 * 74) == pytest.approx(0.60, abs=0.02)
    with pytest.raises(sb.InputError, match="below 50 cSt"):
        sb.fluids.PRESETS["silicone-oil"](grade=10, temperature=40)


@pytest.mark.quick
def test_a_grade_may_have_its_unit():
    oil = sb.fluids.PRESETS["silicone-oil"]
    for grade in ("100 cSt", "100 mm2/s", "100"):
        assert oil(grade=grade).viscosity == pytest.approx(oil(grade=100).viscosity, rel=1e-12)
    with pytest.raises(sb.InputError, match="grade = '1 cSt' must lie between 5 and 1000 cSt"):
        oil(grade="1 cSt")
    with pytest.raises(sb.InputError, match=r"grade = '1 Pa\*s'; write a kinematic viscosity"):
        oil(grade="1 Pa*s")


@pytest.mark.quick
def test_an_oil_has_the_kinematic_viscosity_of_its_data_sheet():
    """61.0 cSt at 40 degC, Synfluid PAO 10 cSt; PAO has 810 to 835 kg/m3 there."""
    assert 61.0e-6 * 810 < sb.fluids.PRESETS["pao-10"]().viscosity < 61.0e-6 * 835
    # PAO have 12 to 20 1/GPa there.
    assert 1.2e-8 < sb.fluids.PRESETS["pao-10"]().fluid.viscosity.pressure_coefficient < 2.0e-8


def test_a_condition_that_a_liquid_does_not_have_is_refused_with_those_that_it_has():
    with pytest.raises(sb.InputError, match="no condition of silicone oil; it has grade and temperature"):
        sb.fluids.PRESETS["silicone-oil"](weight_fraction=0.5)
    with pytest.raises(sb.InputError, match=r"no condition of saliva \(a model\); its numbers hold at 37 degC"):
        sb.fluids.PRESETS["saliva"](temperature="20 degC")
