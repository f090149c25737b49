"""Fluid, cavitation, flow factors, solid and motion as users give them: units, scaling, names, refusals."""

import pickle
import re

import numpy as np
import pytest
from fit_data import TRUE

import stribeck as sb


@pytest.mark.quick
def test_without_parts_a_contact_has_the_model_of_the_article():
    assert TRUE.groups.model == sb.Groups(1e-3, 0.1, 1e-3).model
    plain = TRUE.replace(fluid="newtonian", cavitation="none", flow_factors="none", slide_to_roll=2)
    assert plain.groups.model == TRUE.groups.model
    assert TRUE == TRUE.replace(fluid=None)


@pytest.mark.quick
def test_laws_of_a_contact_are_scaled_from_si_units():
    c = TRUE.replace(fluid=sb.fluids.Fluid(sb.fluids.Carreau("1 ms", 0.5, "10 mPa*s"), sb.fluids.Barus("20 1/GPa")))
    film, u_hz = c.groups.model.film, c.hertz.indentation
    assert film.law.time * c.groups.speed == pytest.approx(1e-3 * c.speed / u_hz, rel=1e-12)  # t U/u_Hz
    assert film.law.infinite_viscosity == pytest.approx(0.01 / c.viscosity)
    assert film.viscosity.pressure_coefficient == pytest.approx(2e-8 * c.hertz.pressure)
    eyring = TRUE.replace(fluid=sb.fluids.Eyring("1 kPa"))
    stress = eyring.groups.model.film.law.eyring_stress / eyring.groups.speed
    assert stress == pytest.approx(1e3 * u_hz / (c.viscosity * c.speed), rel=1e-12)  # tau0 u_Hz/(eta0 U)
    hertz = 6 * (1e3 / c.hertz.pressure) * (c.radius / c.hertz.half_width) / c.groups.speed
    assert stress == pytest.approx(hertz, rel=1e-12)
    rough = TRUE.replace(flow_factors="effective-medium").groups.model.film.flow
    assert rough.sigma == pytest.approx(c.roughness / u_hz)
    assert TRUE.replace(solid=sb.solids.Layer("2 mm")).groups.model.solid.layer_thickness == pytest.approx(
        2e-3 / c.hertz.half_width
    )
    assert TRUE.replace(slide_to_roll=0.5).groups.model.film.slide == 0.25


@pytest.mark.quick
def test_a_change_of_load_scales_the_laws_anew_and_keeps_them():
    c = TRUE.replace(fluid=sb.fluids.Carreau("1 ms", 0.5), slide_to_roll=1.0)
    heavier = c.replace(load="100 N/m")
    assert heavier.fluid == c.fluid
    assert heavier.slide_to_roll == 1.0
    ratio = heavier.groups.model.film.law.time * heavier.groups.speed / (c.groups.model.film.law.time * c.groups.speed)
    assert ratio == pytest.approx(c.hertz.indentation / heavier.hertz.indentation)
    assert pickle.loads(pickle.dumps(c)) == c


@pytest.mark.quick
def test_flow_between_smooth_surfaces_has_no_factors():
    """A contact without roughness was lost: its gap over the roughness has no bound."""
    plain = TRUE.replace(cavitation="exit").replace(roughness=0.0)
    for factors in ("patir-cheng", "effective-medium"):
        smooth = plain.replace(flow_factors=factors)
        assert smooth.groups.model == plain.groups.model
    assert sb.solve(smooth, rtol=1e-4).outcome.ok


@pytest.mark.quick
def test_outputs_of_groups_hold_the_numbers_as_they_are_given():
    """The rate law had those of the speed group one, a rolling substrate the memory of a sliding one."""
    given = sb.fluids.Fluid(sb.fluids.Carreau(0.05, 0.5, 0.02), sb.fluids.Barus(0.5))
    solid = sb.solids.StandardLinearSolid(0.3, 3.0)
    found = sb.solve(sb.Groups(1e-3, 0.1, 1e-3), fluid=given, solid=solid, slide_to_roll=0.5, rtol=1e-3).to_dataset().attrs
    assert found["fluid_relaxation_time"] == pytest.approx(0.05)
    assert found["fluid_infinite_viscosity"] == 0.02 and found["fluid_pressure_coefficient"] == 0.5
    assert found["solid_retardation_time"] == 0.3
    stress = sb.solve(sb.Groups(1e-3, 0.1, 1e-3), fluid=sb.fluids.Eyring(30.0), rtol=1e-3).to_dataset().attrs
    assert stress["fluid_eyring_stress"] == pytest.approx(30.0)


@pytest.mark.quick
def test_with_groups_the_numbers_are_in_hertz_units_at_their_speed():
    groups = sb.Groups(1e-3, 0.1, 1e-4)
    film = sb.solve(groups, fluid=sb.fluids.Carreau(0.057, 0.5), slide_to_roll=1.0, rtol=1e-3).groups.model.film
    assert film.law.time * groups.speed == pytest.approx(0.057)
    film = sb.solve(groups, fluid=sb.fluids.Eyring(58.0), rtol=1e-3).groups.model.film
    assert film.law.eyring_stress / groups.speed == pytest.approx(58.0)
    factors = sb.solve(groups, flow_factors=sb.fluids.PatirCheng(2.0), rtol=1e-3).groups.model.film.flow
    assert factors.sigma == pytest.approx(2.0 * groups.relative_roughness)
    with pytest.raises(sb.InputError, match="need alpha"):
        sb.solve(groups, flow_factors="patir-cheng")
    with pytest.raises(sb.InputError, match="cavity_pressure = '-0.1 MPa' is text; with groups it is a plain number"):
        sb.solve(groups, cavitation="reform", cavity_pressure="-0.1 MPa")


@pytest.mark.quick
def test_parts_that_are_none_or_do_not_go_together_are_refused_by_name(subtests):
    for parts, said in [
        ({"fluid": "carreau"}, "fluid = 'carreau'"),
        ({"fluid": sb.fluids.Carreau}, "give a law of sb.fluids"),
        ({"fluid": sb.fluids.Barus("200 1/MPa")}, "hard elastohydrodynamics"),
        ({"fluid": sb.fluids.Eyring("1 kPa"), "flow_factors": "patir-cheng"}, "Newtonian fluids only"),
        ({"flow_factors": "greenwood"}, "effective-medium"),
        ({"cavitation": "sommerfeld"}, "must be 'none', 'exit'"),
        ({"cavity_pressure": "-1 atm"}, "a full film has no cavity.* Give cavitation = 'reform', or cavity_pressure = 0"),
        ({"cavitation": "reform", "cavity_pressure": "-1e-30 Pa"}, "give 0, or -[0-9.]+e-1[0-9] Pa or less"),
        ({"solid": "rubber"}, "sb.solids"),
    ]:
        with subtests.test(said), pytest.raises(sb.InputError, match=said):
            _ = TRUE.replace(**parts).groups
    with pytest.raises(TypeError, match="did you mean slide_to_roll"):
        sb.solve(sb.Groups(1e-3, 0.1, 0), slide_to_rol=1.0)


@pytest.mark.quick
def test_a_refusal_shows_an_example_that_the_input_may_have():
    """It showed one of its dimension: 2.1 MPa for the pressure of a cavity, 10 mm for a roughness."""
    for parts, said in (
        ({"cavitation": "reform", "cavity_pressure": "1 m"}, "such as '-101 kPa'"),
        ({"roughness": "1 s"}, "such as '1 um'"),
        ({"solid": "Layer"}, "such as Layer\\('2 mm'\\)"),
    ):
        with pytest.raises(sb.InputError, match=said):
            TRUE.replace(**parts)
    for table in (sb.LineContact.INPUTS, sb.PointContact.INPUTS):
        for name, row in table.quantities.items():
            with pytest.raises(sb.InputError, match=re.escape(row.typical)):
                table.quantities[name].checked("what")
            assert row.typical_value > 0


# Presets


@pytest.mark.quick
def test_every_preset_is_a_fluid_of_a_contact_with_its_source():
    for preset in sb.fluids.PRESETS.values():
        liquid = preset()
        assert liquid.source == preset.source and preset.range
        c = TRUE.replace(**liquid.inputs)
        assert c.viscosity == liquid.viscosity and c.fluid == liquid.fluid and c.groups
        with pytest.raises(sb.InputError, match="no condition"):
            preset(pressure=1.0)


@pytest.mark.quick
def test_temperatures_are_in_degrees_or_kelvin():
    water = [sb.fluids.water(each).viscosity for each in ("25 degC", "25 °C", 25)]
    assert len(set(water)) == 1 and sb.fluids.water("298.15 K").viscosity == pytest.approx(water[0])
    for wrong in ("25", "77 F", True):
        with pytest.raises(sb.InputError):
            sb.fluids.water(wrong)
    with pytest.raises(sb.InputError, match="between 0 and 100"):
        sb.fluids.water("300 degC")


@pytest.mark.quick
def test_thinning_presets_have_the_viscosities_that_their_sources_say():
    for name, rate, viscosity in (("xanthan", 1.0, 0.7), ("xanthan", 100.0, 0.035), ("saliva", 10.0, 0.0106)):
        liquid = sb.fluids.PRESETS[name]()
        law = liquid.fluid.rheology
        shape = type(law)(1.0, law.exponent, law.infinite_viscosity / liquid.viscosity)
        x = law.relaxation_time * rate
        found = liquid.viscosity * shape.stress(np.array([x]))[0] / x
        assert found == pytest.approx(viscosity, rel=0.06)
