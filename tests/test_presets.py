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
def test_a_grade_may_have_its_unit():
    oil = sb.fluids.PRESETS["silicone-oil"]
    assert oil(grade="100 cSt").viscosity == pytest.approx(oil(grade=100).viscosity, rel=1e-12)
    with pytest.raises(sb.InputError, match="grade = '1 cSt' must lie between 5 and 1000 cSt"):
        oil(grade="1 cSt")
    with pytest.raises(sb.InputError, match=r"grade = '1 Pa\*s' is a (dynamic )?viscosity"):
        oil(grade="1 Pa*s")


@pytest.mark.quick
def test_every_liquid_has_a_source_and_a_range(subtests):
    for name in sorted(sb.fluids.PRESETS):
        with subtests.test(name=name):
            preset = sb.fluids.PRESETS[name]
            assert preset.source and preset.range
            assert preset().viscosity > 0


@pytest.mark.quick
def test_an_oil_has_the_kinematic_viscosity_of_its_data_sheet():
    """61.0 cSt at 40 degC, Synfluid PAO 10 cSt; PAO has 810 to 835 kg/m3 there."""
    assert 61.0e-6 * 810 < sb.fluids.PRESETS["pao-10"]().viscosity < 61.0e-6 * 835
    # PAO have 12 to 20 1/GPa there.
    assert 1.2e-8 < sb.fluids.PRESETS["pao-10"]().fluid.viscosity.pressure_coefficient < 2.0e-8


def test_a_condition_that_a_liquid_does_not_have_is_refused_with_those_that_it_has():
    with pytest.raises(sb.InputError, match="no condition of silicone oil; it has grade"):
        sb.fluids.PRESETS["silicone-oil"](temperature="20 degC")
    with pytest.raises(sb.InputError, match=r"no condition of saliva \(a model\); its numbers hold at 37 degC"):
        sb.fluids.PRESETS["saliva"](temperature="20 degC")
