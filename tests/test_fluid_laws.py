"""Laws of fluids by themselves: closed forms, derivatives against differences, the flow across a film, limits, refusals."""

import json
from pathlib import Path

import numpy as np
import pytest
from numpy.polynomial import legendre
from scipy.integrate import quad, solve_bvp
from scipy.optimize import brentq

import stribeck as sb
from stribeck.equations.point.column import column
from stribeck.fluids import (
    Barus,
    Carreau,
    Cross,
    DowsonHigginson,
    EffectiveMedium,
    Eyring,
    PatirCheng,
    PowerLaw,
    Roelands,
    local_flow,
)
from stribeck.fluids.effective_medium import PERCOLATION
from stribeck.fluids.flow_factors import MIN_FLOW_FACTOR, mean_inverse_width, mean_width, nominal_separation
from stribeck.fluids.laws import FilmUnits
from stribeck.fluids.newtonian import Newtonian
from stribeck.fluids.shear_thinning import ShearThinning
from stribeck.numerics.dual import with_slope
from stribeck.numerics.trace import Trace

REFERENCE = json.loads((Path(__file__).parent / "data" / "fluids.json").read_text())
RNG_SEED = 4711
ROUGH = FilmUnits(1.0, 1.0, 1.0, 1.0, decay_length=0.3)
OIL = {"viscosity": Roelands(1.5, 5.0, 0.01), "density": DowsonHigginson(3.0)}
FILMS = {
    "plain": Newtonian(),
    "oil": Newtonian(**OIL, slide=0.4),
    "barus": Newtonian(Barus(2.0)),
    "patir-cheng": Newtonian(**OIL, flow=PatirCheng(1.0, 1.0, 0.1, friction_factors=True).scaled(ROUGH), slide=0.7),
    "longitudinal": Newtonian(flow=PatirCheng(1.0, 6.0, 1.0).scaled(ROUGH)),
    "effective-medium": Newtonian(flow=EffectiveMedium(1.0).scaled(ROUGH), slide=-0.3),
    "carreau": ShearThinning(Carreau(3.0, 0.4, 0.02), slide=0.6),
    "carreau-oil": ShearThinning(Carreau(3.0, 0.4, 0.02), **OIL, slide=0.6),
    "cross": ShearThinning(Cross(5.0, 0.8), Barus(1.0), slide=0.0),
    "eyring": ShearThinning(Eyring(0.2), **OIL, slide=0.1),
    "power-law": ShearThinning(PowerLaw(2.0, 0.6), slide=1.0),
}
CURVES = [
    Carreau(1.0, 0.5),
    Carreau(1.0, 0.2, 0.01),
    Cross(1.0, 0.7),
    Cross(1.0, 0.4, 0.1),
    Eyring(1.0),
    PowerLaw(1.0, 0.3),
]


def some_films():
    """Return gaps, pressures and a flux gap of a film that carries fluid and is sucked dry behind."""
    gap = np.array([0.31, 0.5, 0.8, 0.97, 1.02, 1.4, 3.0, 20.0])
    return gap, np.array([0.9, 0.5, 0.2, 0.1, -0.02, 0.05, 0.01, 0.0]), 1.0


def differences(function, at, step=1e-6):
    """Return the central difference of a function of one number or array."""
    return (function(at + step) - function(at - step)) / (2 * step)


# Films


FUNCTIONS = {
    "gradient": lambda film, *of: film.gradient(*of),
    "drag on the substrate": lambda film, *of: film.tractions(*of)[0],
    "drag on the cylinder": lambda film, *of: film.tractions(*of)[1],
    "drag in the cavity": lambda film, *of: film.cavity_traction(*of),
}


@pytest.mark.quick
def test_flow_factors_show_their_numbers_and_their_roughness_where_it_is_known():
    factors = PatirCheng(2.0, 3.0, 0.5)
    known = {"gamma": 3, "substrate_share": 0.5, "friction_factors": "false", "argument": "nominal"}
    assert factors.parameters == known
    assert factors.scaled(FilmUnits(1, 1, 1, 1, decay_length=0.1)).parameters == known | {"sigma": pytest.approx(0.2)}


def test_a_traced_film_has_the_differences_of_what_it_returns(subtests):
    for name in FILMS:
        for function in FUNCTIONS:
            with subtests.test(name=name, function=function):
                given = dict(zip(("gap", "pressure", "flux_gap"), some_films(), strict=True)) | {"speed": np.array(1.3)}
                if not FILMS[name].uses_pressure:
                    given["pressure"] = None
                if not FILMS[name].uses_speed:
                    del given["speed"]

                def values(speed=1.3, **at):
                    return FUNCTIONS[function](FILMS[name].at(speed), *at.values())

                traced = {
                    each: None if value is None else Trace.number(each, np.asarray(value)) for each, value in given.items()
                }
                found, plain = values(**traced), values(**given)
                np.testing.assert_allclose(
                    found.value, plain, rtol=1e-13, atol=1e-14 * np.abs(plain).max()
                )  # walls differ by rounding
                tolerance = {"rtol": 2e-6, "atol": 1e-7 * (1 + np.abs(plain).max())}
                for each, value in given.items():
                    if value is not None:
                        expected = differences(lambda x, each=each: values(**given | {each: x}), value)
                        np.testing.assert_allclose(
                            np.broadcast_to(found.columns.get(each, 0.0), plain.shape), expected, **tolerance
                        )


@pytest.mark.quick
def test_tractions_differ_by_the_pull_of_the_pressure_gradient(subtests):
    for name in FILMS:
        with subtests.test(name=name):
            film = FILMS[name].at(1.3)
            h, p, m = some_films()
            p = p if film.uses_pressure else None
            substrate, cylinder = film.tractions(h, p, m)
            if name != "patir-cheng":  # whose friction factors are fits that need not balance
                np.testing.assert_allclose(substrate - cylinder, 6 * h * film.gradient(h, p, m), rtol=1e-10, atol=1e-13)


# Shear thinning


@pytest.mark.quick
def test_a_carreau_film_has_the_gradient_of_its_solved_profile(subtests):
    for row in REFERENCE["generalised_newtonian_local"]["carreau"]:
        with subtests.test(row=row):
            film = ShearThinning(Carreau(row["W"], row["n"]), slide=row["s"])
            assert film.gradient(np.array([row["h"]]), None, row["m"])[0] == pytest.approx(row["G"], rel=1e-12)


def test_the_local_flow_is_that_of_the_boundary_value_problem_across_the_film(subtests):
    for law in [Carreau(4.0, 0.5, 0.05), Cross(4.0, 0.6, 0.01), Eyring(0.5)]:
        with subtests.test(law=law):
            h, m, s = 1.5, 1.0, 0.8
            film = ShearThinning(law, slide=s)
            expected = film.gradient(np.array([h]), None, m)[0]
            t, g = film.tractions(np.array([h]), None, m), 6 * expected
            stress = [-t[0][0], -t[1][0]]
            assert stress[1] - stress[0] == pytest.approx(g * h, rel=1e-12)

            def rate(tau):
                return np.sign(tau) * law.rate(np.abs(tau) * law.time) / law.time

            # Velocity and volume carried from wall to wall: unknown are the stress in the middle and its gradient.
            def profile(z, y, unknown):
                return np.stack([rate(unknown[0] + unknown[1] * (z - h / 2)), y[0]])

            def ends(a, b, unknown):
                return np.array([a[0] - s, b[0], a[1], b[1] - (m - h) / 2 - s * h / 2])

            z = np.linspace(0, h, 40)
            start = np.stack([s * (1 - z / h), z * 0])
            solved = solve_bvp(profile, ends, z, start, p=[-s / h, 0.1], tol=1e-9, max_nodes=20000)
            assert solved.success
            assert solved.p[1] == pytest.approx(g, rel=1e-7)


@pytest.mark.quick
def test_flows_between_walls_at_rest_have_their_closed_forms():
    def flux(law, gradient):
        film = ShearThinning(law, slide=0.0)
        m = brentq(lambda m: 6 * film.gradient(np.array([1.0]), None, m)[0] + gradient, 1.0 + 1e-9, 30.0, xtol=1e-14)
        return (m - 1) / 2

    assert flux(PowerLaw(1.0, 0.5), 1.0) == pytest.approx(0.03125, rel=1e-11)
    for n in (0.2, 0.7):
        exact = 2 * n / (2 * n + 1) * 2.0 ** (1 / n) * 0.5 ** (2 + 1 / n)
        assert flux(PowerLaw(1.0, n), 2.0) == pytest.approx(exact, rel=1e-10)
    assert flux(Carreau(1.0, 0.5, 0.01), 10.0) == pytest.approx(2.969607, rel=2e-7)
    x = 2.0  # half the wall stress over Eyring's
    assert flux(Eyring(1.0), 4.0) == pytest.approx((x * np.cosh(x) - np.sinh(x)) * 2 / 16, rel=1e-11)


@pytest.mark.quick
def test_a_rate_law_its_slope_its_inverse_and_its_moments_belong_together(subtests):
    for law in CURVES:
        with subtests.test(law=law):
            rate = np.array([1e-6, 1e-3, 0.1, 0.7, 1.0, 3.0, 50.0, 1e5, 1e9])
            stress, slope = with_slope(law.stress, rate)
            step = 1e-6 * rate
            np.testing.assert_allclose((law.stress(rate + step) - law.stress(rate - step)) / (2 * step), slope, rtol=1e-8)
            np.testing.assert_allclose(law.rate(stress), rate, rtol=1e-11)
            for x, first, second in zip(rate, *law.moments(rate, stress), strict=True):
                for weight, found in ((lambda g: 1.0, first), (lambda g: g, second)):

                    def integrand(v, weight=weight):
                        g, slope = with_slope(law.stress, [np.exp(v)])
                        return float(np.exp(2 * v) * slope[0] * weight(float(g[0])))

                    expected = quad(integrand, np.log(x) - 60, np.log(x), epsabs=0, epsrel=1e-12, limit=400)[0]
                    assert found == pytest.approx(expected, rel=1e-10)


def test_the_local_flow_is_found_for_all_rates_slips_and_fluxes(subtests):
    for law in CURVES:
        with subtests.test(law=law):
            rng = np.random.default_rng(RNG_SEED)
            size = 10 ** rng.uniform(-8, 8, 3000)
            r_0 = size * rng.choice([0, 1, 1, 1e-3, -1, 1e-6], 3000)
            r_1 = size * 10 ** rng.uniform(-6, 1, 3000) * rng.choice([-1, 1], 3000)
            flow = local_flow.profile(law, r_0, r_1)
            walls = np.stack(flow[:2])
            (i_0, i_1), _ = local_flow._integrals(law, walls, np.sign(walls) * law.stress(np.abs(walls)))
            scale = np.abs(r_0) + 6 * np.abs(r_1)
            assert np.abs((i_0 - r_0) / scale).max() < 1e-12
            assert np.abs((i_1 - r_1) / scale).max() < 1e-12


# Pressure and density


@pytest.mark.quick
def test_roelands_viscosity_has_its_published_form_and_barus_at_small_pressures():
    eta_0, alpha, p = 0.08, 2e-8, np.array([1e5, 1e8, 5e8])
    z = alpha * 1.96e8 / (np.log(eta_0) + 9.67)
    expected = (np.log(eta_0) + 9.67) * (-1 + (1 + p / 1.96e8) ** z)
    law = Roelands("20 1/GPa").scaled(FilmUnits(1e8, 1.0, 1.0, eta_0))
    np.testing.assert_allclose(law.log(p / 1e8), expected, rtol=1e-4)
    np.testing.assert_allclose(law.log(p / 1e8)[0], Barus(alpha).scaled(FilmUnits(1e8, 1, 1, 1)).log(p / 1e8)[0], rtol=1e-3)


@pytest.mark.quick
def test_dowson_and_higginsons_density_has_its_published_form():
    p = np.array([0.0, 1e8, 4e8])
    law = DowsonHigginson().scaled(FilmUnits(2e8, 1.0, 1.0, 1.0))
    np.testing.assert_allclose(law.ratio(p / 2e8), (0.59e9 + 1.34 * p) / (0.59e9 + p), rtol=1e-14)
    end = (
        -0.059e9 / 2e8
    )  # beyond a tenth of 0.59 GPa of suction the volume goes on as its parabola, and its pole is not reached
    suction = end * (1 + 1e-3 * np.arange(-2, 4))
    ratio, slope = with_slope(law.ratio, suction)
    volume = 1 / ratio
    np.testing.assert_allclose(np.diff(volume, 2), np.diff(volume, 2)[0], rtol=1e-2)
    np.testing.assert_allclose((slope * volume**2)[1:-1], -np.gradient(volume, suction)[1:-1], rtol=1e-5)
    assert (law.ratio(end * np.array([4.0, 10.0, 40.0])) > 0).all()


# Rough surfaces


@pytest.mark.quick
def test_the_mean_gap_is_turned_into_the_nominal_one():
    H = np.array([-5.0, -1.0, 0.0, 0.5, 1.0, 3.0, 8.0])
    width = [quad(lambda u, d=d: u * np.exp(-((u - d) ** 2) / 2) / np.sqrt(2 * np.pi), 0, d + 12)[0] for d in H]
    np.testing.assert_allclose(nominal_separation(np.array(width)), H, atol=1e-7)
    # The trap: at a mean gap of 1.083 roughnesses the separation is one, and the flow goes as its third power too.
    phi = PatirCheng(1.0).scaled(FilmUnits(1, 1, 1, 1, decay_length=1.0)).pressure(1.083315)
    assert phi * 1.083315**3 == pytest.approx(1 - 0.9 * np.exp(-0.56), rel=1e-5)
    assert phi == pytest.approx(0.382, abs=5e-4)


@pytest.mark.quick
def test_the_effective_medium_has_the_values_of_an_independent_program(subtests):
    for row in REFERENCE["d_effective_medium_table"]["rows"]:
        with subtests.test(row=row):
            _, mean, _, phi = row
            factors = EffectiveMedium(2.0).scaled(FilmUnits(1, 1, 1, 1, decay_length=0.5))
            assert factors.pressure(np.array([mean]))[0] == pytest.approx(phi, abs=2e-5)


def test_the_effective_medium_conducts_from_its_threshold_on_and_as_tripp_says_when_wide():
    factors = EffectiveMedium(1.0).scaled(FilmUnits(1, 1, 1, 1, decay_length=1.0))
    closed, open_ = factors.pressure(np.array([0.99 * PERCOLATION, 1.5 * PERCOLATION]))
    assert closed == pytest.approx(MIN_FLOW_FACTOR)
    assert open_ > 100 * MIN_FLOW_FACTOR
    wide = np.array([10.0, 20.0, 40.0])
    np.testing.assert_allclose((1 - factors.pressure(wide)) * wide**2, 1.5, rtol=0.04)
    assert (1 - factors.pressure(wide[1:2])[0]) * 400 == pytest.approx(1.486, abs=1e-3)


def test_where_the_fits_end_flow_goes_on_and_a_wider_gap_carries_more(subtests):
    """Taken further the fits give a negative flow, and past a rough cylinder at rest less of it through a wider gap."""
    for gamma, least in [(1 / 9, 1.0), (1 / 6, 1.0), (1 / 3, 0.75), (1.0, 0.5), (3.0, 0.5), (9.0, 0.5)]:
        for argument in ["nominal", "mean"]:
            with subtests.test(gamma=gamma, least=least, argument=argument):
                factors = PatirCheng(1.0, gamma, 0.0, argument=argument).scaled(FilmUnits(1, 1, 1, 1, decay_length=1.0))
                end = least if argument == "mean" else mean_width(least)
                gap = end * np.array([0.3, 0.6, 0.9, 1 - 1e-9, 1 + 1e-9, 1.1, 1.5])
                (phi, phi_slope), (carried, slope) = with_slope(factors.pressure, gap), with_slope(factors.shear, gap)
                assert (phi > 0).all()
                assert (np.diff(phi * gap**3) > 0).all()
                if argument == "nominal":  # the mean gap taken for it may carry a little backwards
                    assert (np.diff(gap + carried) > 0).all()
                np.testing.assert_allclose((phi[3], carried[3]), (phi[4], carried[4]), rtol=1e-7)
                smooth = np.delete(gap, [3, 4])
                for of, found in ((factors.pressure, phi_slope), (factors.shear, slope)):
                    by_difference = (of(smooth + 1e-6) - of(smooth - 1e-6)) / 2e-6
                    np.testing.assert_allclose(np.delete(found, [3, 4]), by_difference, rtol=1e-5, atol=1e-8)


@pytest.mark.quick
def test_the_friction_factor_is_the_mean_of_one_over_the_width():
    z = np.array([1.1, 1.6, 3.0])  # closed form of Patir and Cheng above three roughnesses, in z = H/3
    closed = (1 - z * z) ** 3 * np.log((z + 1) / (z - 1)) + z / 15 * (66 + z * z * (30 * z * z - 80))
    np.testing.assert_allclose(3 * z * mean_inverse_width(3 * z)[0], 35 / 32 * z * closed, rtol=1e-8)
    z = np.array([0.2, 0.5, 0.9])  # and below, where they cut at a hundredth of the roughness
    polynomial = -55 + z * (132 + z * (345 + z * (-160 + z * (-405 + z * (60 + 147 * z)))))
    closed = (1 - z * z) ** 3 * np.log(300 * (z + 1)) + polynomial / 60
    np.testing.assert_allclose(3 * z * mean_inverse_width(3 * z)[0], 35 / 32 * z * closed, rtol=3e-3)


# Refusals


@pytest.mark.quick
def test_impossible_parameters_are_refused_by_name(subtests):
    for make, said in [
        (lambda: Carreau("1 ms", 1.5), "thicken"),
        (lambda: Carreau("1 ms", 0.5, "2 Pa*s").scaled(FilmUnits(1, 1, 1, 1.0)), "below the viscosity"),
        (lambda: Cross("1 ms", 1.0), "Carreau"),
        (lambda: Roelands(1e-8).scaled(FilmUnits(1, 1, 1, 1e-5)), "Barus"),
        (lambda: PatirCheng(2.0, gamma=2.0), "1/9, 1/6"),
        (lambda: PatirCheng(2.0, substrate_share=2), "substrate_share"),
        (lambda: PatirCheng(2.0, 3.0, friction_factors=True), "isotropic"),
        (lambda: PatirCheng(-2.0), "alpha"),
        (lambda: EffectiveMedium().scaled(FilmUnits(1, 1, 1, 1)), "need alpha"),
    ]:
        with subtests.test(make=make, said=said):
            with pytest.raises(sb.InputError, match=said):
                make()


# --- across the film of a ball ---

COLUMN_LAWS = {
    "carreau": Carreau(1.0, 0.5),
    "plateau": Carreau(1.0, 0.4, 0.05),
    "cross": Cross(1.0, 0.8),
    "eyring": Eyring(1.0),
}


def vectors(law, number=60):
    """Return pressure gradients and slips of all directions and of rates from 0.01 to 1000."""
    rng = np.random.default_rng(7)
    turn, other = rng.uniform(0, 2 * np.pi, (2, number))
    rates = 10 ** rng.uniform(-2, 3, (2, number))
    slope = 2 * law.stress(rates[0]) * np.stack([np.cos(turn), np.sin(turn)])
    return slope, rates[1] * np.stack([np.cos(other), np.sin(other)])


@pytest.mark.quick
def test_a_column_slips_and_carries_what_integrals_across_it_say(subtests):
    for name in COLUMN_LAWS:
        with subtests.test(name=name):
            law = COLUMN_LAWS[name]
            slope, slip = vectors(law)
            flow = column(law, slope, slip)
            # Gauss's rule on 400 strips, by the law itself: no table, no place of the smallest stress.
            nodes, weights = legendre.leggauss(6)
            strips = np.linspace(-0.5, 0.5, 401)
            zeta = (0.5 * (strips[1:] + strips[:-1])[:, None] + 0.00125 * nodes).ravel()
            weights = np.tile(0.00125 * weights, 400)
            stress = flow.mean[:, :, None] + slope[:, :, None] * zeta
            size = np.hypot(*stress)
            rate = stress * (law.rate(size.ravel()).reshape(size.shape) / size)
            largest = np.hypot(*rate).max(axis=-1)
            assert np.abs(rate @ weights - slip).max() <= 3e-7 * largest.max()
            assert (np.hypot(*(rate @ weights - slip)) <= 3e-7 * largest).all()
            assert (np.hypot(*(rate @ (weights * zeta) - flow.carried)) <= 3e-7 * largest).all()


def test_between_smooth_surfaces_roughness_changes_no_flow():
    flow, gap = sb.Groups(1e-3, 0.1, 0.0).model.film.flow, np.array([1e-3, 1.0])
    np.testing.assert_array_equal((flow.pressure(gap), flow.shear(gap)), ((1, 1), (0, 0)))
