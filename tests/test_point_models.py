"""A ball with fluids and bodies beyond those of the article: flow, slopes, limits, and what is refused."""

import dataclasses

import numpy as np
import pytest
from scipy.special import j0, jv

import stribeck as sb
from stribeck import Groups
from stribeck.contact_laws.exponential import ExponentialLaw
from stribeck.equations.point.planes import plane_of
from stribeck.equations.point.system import Equations, Linear, Operators, Unknowns
from stribeck.fluids import Barus, DowsonHigginson, EffectiveMedium, PatirCheng
from stribeck.fluids.laws import FilmUnits
from stribeck.fluids.newtonian import Newtonian
from stribeck.numerics.fourier_panels import PolarMesh
from stribeck.solids import Layer
from stribeck.solids.layer import transfer
from stribeck.solids.layer_plane import layer_by_mode
from stribeck.solver.point.solve import solve_cold

EDGES = np.array([0.0, 0.5, 1.0, 1.5, 2.0, 4.0, 10.0, 50.0])
MIXED = Groups(0.1, 1e-3, 1e-3, geometry="point")
UNITS = FilmUnits(1.0, 1.0, 1.0, 1.0, 0.05, 2.0)
FILMS = {
    "barus": Newtonian(Barus(2.0)),
    "density": Newtonian(Barus(1.0), DowsonHigginson().scaled(FilmUnits(1e8, 1.0, 1.0, 1.0))),
    "patir-cheng": Newtonian(flow=PatirCheng(substrate_share=0.9).scaled(UNITS), slide=0.7),
    "effective-medium": Newtonian(flow=EffectiveMedium().scaled(UNITS)),
    "both": Newtonian(Barus(1.0), flow=EffectiveMedium().scaled(UNITS)),
}


def with_part(name, value, groups=MIXED, rtol=1e-6):
    return sb.solve(groups, rtol=rtol, **{name: value})


@pytest.mark.quick
def test_the_film_of_barus_under_a_rigid_ball_is_that_of_the_reduced_pressure():
    mesh = PolarMesh(EDGES, 5, 12, 8)
    speed, height, a = 0.3, 0.5, 3.0
    gap = np.tile(height + 0.5 * mesh.radii**2, (8, 1))
    reduced = -0.2 * speed * mesh.radii * np.cos(mesh.angles)[:, None] / gap**2
    pressure = -np.log(1 - a * reduced) / a
    law = ExponentialLaw(1e-3, 0.1)

    def residual(film, p):
        return Equations(Operators(mesh), speed, law, plane_of(film)).flow(gap, p, height)[:, mesh.radii < 1.9]

    exact, plain = residual(Newtonian(Barus(a)), pressure), residual(Newtonian(Barus(a)), reduced)
    assert np.abs(exact).max() < 1e-6 * np.abs(plain).max()


@pytest.mark.quick
@pytest.mark.parametrize("name", FILMS)
def test_slopes_of_the_flow_are_its_derivatives(name):
    mesh = PolarMesh(EDGES, 5, 8, 6)
    rng = np.random.default_rng(3)
    y = Unknowns(
        0.2 + 0.5 * mesh.radii**2 + 0.02 * rng.random((6, mesh.rings)), 0.1 * rng.standard_normal((6, mesh.rings)), 0.2
    )
    y.fluid[:, -1] = 0.0  # the rim is taken for one at ambient pressure
    dh, dp = 0.1 * y.gap * rng.standard_normal(y.gap.shape), 0.1 * rng.standard_normal(y.gap.shape)
    equations = Equations(Operators(mesh), 0.3, ExponentialLaw(1e-3, 0.1), plane_of(FILMS[name]))
    expected = Linear(equations, y).flow(dp, dh)
    step = 1e-6
    more, less = (equations.flow(y.gap + s * dh, y.fluid + s * dp, y.offset) for s in (step, -step))
    found = (more - less) / (2 * step)
    scale = np.abs(expected).max(axis=0)
    assert (np.abs(found - expected)[:, :-1] <= 1e-6 * scale[:-1]).all()


@pytest.mark.quick
def test_a_law_that_does_little_changes_a_state_in_proportion():
    plain = solve_cold(MIXED, 1e-6).values["contact_load_share"]
    less, more = (plain - with_part("fluid", Barus(a)).contact_load_share for a in (0.01, 0.1))
    assert less == pytest.approx(5.86e-5, rel=0.02)
    assert np.log10(more / less) == pytest.approx(1.0, abs=0.01)


@pytest.mark.quick
def test_rough_flow_lifts_the_ball_and_goes_with_the_roughness():
    rough = with_part("flow_factors", PatirCheng(2.0))
    assert rough.contact_load_share == pytest.approx(0.9698562, abs=2e-6)
    assert rough.identity_error < 1e-7


@pytest.mark.parametrize(("thickness", "ratio"), [(3.0, 0.5), (0.5, 0.3)])
def test_the_layer_deflects_as_hankels_transform_says(thickness, ratio):
    mesh = PolarMesh(np.array([0, 0.25, 0.5, 0.75, 1, 1.25, 1.5, 2.0, 10.0, 50.0]), 7, 12, 3)
    by_mode = layer_by_mode(mesh, Layer(thickness, ratio))
    s, r = 0.3, mesh.radii
    q, w = np.polynomial.legendre.leggauss(2000)
    q, w = 25 * (1 + q), 25 * w
    spectrum = 4 / np.pi * transfer(q * thickness, ratio) * s**2 * np.exp(-((q * s) ** 2) / 2)
    bump = np.exp(-(r**2) / (2 * s**2))
    assert by_mode[0] @ bump == pytest.approx(j0(np.outer(r, q)) @ (w * spectrum), abs=1e-9)
    assert by_mode[1] @ (r * bump) == pytest.approx(s**2 * jv(1, np.outer(r, q)) @ (w * spectrum * q), abs=1e-9)


@pytest.mark.quick
def test_a_thick_layer_is_a_half_space_but_for_the_third_power_of_its_thickness():
    groups = dataclasses.replace(MIXED, speed=0.01, roughness=1e-4)
    half_space = solve_cold(groups, 1e-5).values["central_gap"]
    thick, thicker = (half_space - with_part("solid", Layer(d), groups, 1e-5).central_gap for d in (5.0, 10.0))
    assert np.log2(thick / thicker) == pytest.approx(3.0, abs=0.1)


@pytest.mark.quick
@pytest.mark.parametrize("ratio", [0.3, 0.5])
def test_a_thin_layer_gives_way_as_springs_and_an_incompressible_one_as_the_bend_of_the_pressure(ratio):
    # w = (2/pi) d (1 - 2 nu)/(1 - nu)**2 p, and -(8/3 pi) d**3 times the Laplacian of p, but for (d/s)**2.
    left = {0: [], 1: []}
    for d in (0.2, 0.1):
        edges = np.concatenate([np.arange(0.0, 4.6, 2 * d), [8.0, 12.0]])
        mesh = PolarMesh(edges, edges.size - 3, 6, 2)
        r, by_mode = mesh.radii, layer_by_mode(mesh, Layer(d, ratio))
        bump = np.exp(-(r**2) / 2)
        for mode, pressure, bend in ((0, bump, (r**2 - 2) * bump), (1, r * bump, r * (r**2 - 4) * bump)):
            springs = 2 / np.pi * d * (1 - 2 * ratio) / (1 - ratio) ** 2 * pressure
            limit = -8 / (3 * np.pi) * d**3 * bend if ratio == 0.5 else springs
            left[mode].append(np.abs(by_mode[mode] @ pressure - limit)[r < 2].max() / np.abs(limit).max())
    for thick, thin in left.values():
        assert thin < (0.1 if ratio == 0.5 else 3e-3)
        assert 1.6 < np.log2(thick / thin) < 2.1


@pytest.mark.quick
def test_far_panels_on_a_layer_act_on_the_contact_as_finer_ones():
    """As springs, panels of 3.3 thicknesses to a side left fast films wrong by 1e-6 at a stated 2e-7."""
    ends = []
    for split in (1, 3):  # the former has panels of 0.9 to 3.6 thicknesses to a side
        mesh = PolarMesh(np.append([0.0, 2.0], np.geomspace(4.0, 24.0, 5 * split + 1)), 2, 12, 2)
        at_edges = np.array([1, *range(2, 3 + 4 * split, split)]) * mesh.degree
        ends.append((layer_by_mode(mesh, Layer(1.0, 0.5))[0] @ (1 / (1 + mesh.radii**2 / 8) ** 2))[at_edges])
    np.testing.assert_allclose(*ends, rtol=0, atol=1e-9)


@pytest.mark.slow
def test_at_rest_a_thin_layer_bears_the_load_as_springs_do():
    # p = (b**2 - r**2)/2 k with b**4 = 8 k/3.
    layer = Layer(0.3, 0.0)
    springs = 2 / np.pi * layer.layer_thickness
    found = with_part("solid", layer, Groups(0.0, 1e-3, 1e-5, geometry="point"), 1e-3).central_pressure
    assert found == pytest.approx(np.sqrt(8 * springs / 3) / (2 * springs), rel=5e-3)


@pytest.mark.quick
def test_at_rest_a_layer_bears_the_load_with_more_pressure():
    groups = Groups(0.0, 1e-3, 1e-4, geometry="point")
    thick, thin = (with_part("solid", Layer(d), groups, 1e-3).central_pressure for d in (100.0, 1.0))
    assert thick == pytest.approx(solve_cold(groups, 1e-3).values["central_pressure"], rel=1e-5)
    assert thin > 1.02 * thick


@pytest.mark.quick
@pytest.mark.parametrize(
    ("parts", "sentence"),
    [
        ({"flow_factors": PatirCheng(2.0, gamma=3)}, "flow_factors = patir-cheng: on a ball they must be those of isotropic"),
        ({"solid": Layer(0.01)}, "solid = bonded layer: its thickness is 0.01 of the Hertz radius"),
    ],
)
def test_what_a_ball_does_not_have_is_refused_by_name(parts, sentence):
    with pytest.raises(sb.InputError, match=sentence):
        sb.solve(MIXED, **parts)


@pytest.mark.quick
@pytest.mark.parametrize(
    ("groups", "parts", "said"),
    [
        (Groups(1e-3, 0.1, 0.03, geometry="point"), {"flow_factors": PatirCheng(2.0)}, "fits above 0.5"),
        (Groups(0.1, 0.1, 1e-3, geometry="point"), {"fluid": DowsonHigginson(1.0, 1.34)}, "no liquid is stretched so far"),
    ],
)
def test_a_ball_says_where_its_film_leaves_the_range_of_a_law(groups, parts, said):
    notes = sb.solve(groups, rtol=1e-2, **parts).notes
    assert [said in note for note in notes if note.startswith("The fluid leaves the range of its laws")] == [True]


def test_contacts_hold_fluid_and_cavitation_and_friction_names_the_wake():
    ball = sb.PointContact(
        radius="10 mm", modulus="2 MPa", load="10 mN", viscosity="0.1 Pa*s", entrainment_speed="0.1 m/s", slide_to_roll=1.0,
        roughness="1 um", alpha=2.0, beta=0.1, boundary_friction=0.5, cavitation="exit", fluid=Barus("20 1/GPa"),
    )  # fmt: skip
    assert ball.groups.model.film.slide == 0.5
    assert ball.groups.model.film.viscosity.pressure_coefficient == pytest.approx(2e-8 * ball.hertz.pressure)
    solution = sb.solve(ball, rtol=1e-3)
    assert solution.fluid_pressure.min() >= 0.0
    assert any("streaks of liquid" in note for note in solution.notes)
    friction = solution.friction()
    assert friction.error < 0.01 * friction
    assert ball.replace(cavitation="none", fluid="newtonian").groups.model.film.is_plain
