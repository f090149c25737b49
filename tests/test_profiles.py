"""Bodies that are no cylinder: their states against other discretisations, their limits and what is refused."""

import json
from dataclasses import dataclass, replace
from functools import cache

import numpy as np
import pytest
from command_line import call
from scipy.optimize import fsolve

import stribeck as sb

LOAD, KAPPA = 0.1, 1e-3
COSINES = np.cos((np.arange(4000) + 0.5) * np.pi / 4000)


@dataclass(frozen=True)
class Smooth:
    """A worn cylinder, a lip or a cylinder with grooves, by its name."""

    kind: str
    numbers: tuple[float, ...] = ()
    places = ()

    @property
    def parameters(self):
        return dict(zip("abcd", self.numbers, strict=False))

    def gap(self, x):
        if self.kind == "worn":
            depth, sharpness = self.numbers
            return sharpness * np.logaddexp(0, (x**2 / 2 - depth) / sharpness)
        if self.kind == "lip":
            ratio, rounding, tip, slope = self.numbers
            rise = np.hypot(x - tip, rounding) - rounding
            return slope * ((1 - ratio) / 2 * (x - tip) + (1 + ratio) / 2 * rise)
        depth, pitch = self.numbers
        return x**2 / 2 + depth * (1 - np.cos(2 * np.pi * x / pitch)) / 2 * np.exp(-((np.clip(x, -9, 9) / 1.3) ** 8))

    def slope(self, x):
        if self.kind == "worn":
            depth, sharpness = self.numbers
            return x / (1 + np.exp(-np.clip((x**2 / 2 - depth) / sharpness, -700, 700)))
        if self.kind == "lip":
            ratio, rounding, tip, slope = self.numbers
            return slope * ((1 - ratio) / 2 + (1 + ratio) / 2 * (x - tip) / np.hypot(x - tip, rounding))
        depth, pitch = self.numbers
        y = np.clip(x, -9, 9)
        decay, wave = np.exp(-((y / 1.3) ** 8)), 2 * np.pi / pitch
        wavy = wave * np.sin(wave * x) - (1 - np.cos(wave * x)) * 8 * (y / 1.3) ** 7 / 1.3
        return x + depth / 2 * wavy * decay


@dataclass(frozen=True)
class Land:
    """A land of half-width b whose edges are parabolas of a curvature."""

    b: float
    curvature: float = 1.0
    parameters = {}

    @property
    def places(self):
        return (-self.b, self.b)

    def gap(self, x):
        return self.curvature * np.maximum(np.abs(x) - self.b, 0.0) ** 2 / 2

    def slope(self, x):
        return self.curvature * np.sign(x) * np.maximum(np.abs(x) - self.b, 0.0)


def of_unit_width(make, start):
    """Return the shape with the numbers for which a load of pi/2 makes a dry contact of half-width one about zero."""

    def wrong(numbers):
        slope = make(*numbers).slope(COSINES)
        return [slope.mean(), np.pi * (COSINES * slope).mean() - np.pi / 2][-len(start) :]

    return make(*map(float, fsolve(wrong, start, xtol=1e-12)))


WORN, GROOVED = Smooth("worn", (0.125, 0.02)), Smooth("grooved", (0.01, 0.3))
LAND = of_unit_width(lambda c: Land(0.8, c), [10.0])
LIP = of_unit_width(lambda tip, slope: Smooth("lip", (3.0, 0.1, tip, slope)), [-0.3, 0.4])


def groups(speed, curvature=1.0):
    """Return groups of the load and roughness of all these values, in units where the parabola far away has a curvature."""
    return sb.Groups(speed / curvature, LOAD * curvature, KAPPA * LOAD * curvature)


@cache
def solved(speed, shape, cavitation, rtol=1e-3, curvature=1.0):
    return sb.solve(groups(speed, curvature), profile=shape, cavitation=cavitation, rtol=rtol)


# Speed and share of the load on asperities of full films, by today's solver with the profile put in and, but for the last
# digits, by finite volumes.
FULL_FILMS = {
    "worn": (WORN, 1.0, {1e-4: 0.3477630, 1e-3: 0.0046608}),
    "grooved": (GROOVED, 1.0, {1e-4: 0.3783868, 1e-3: 0.0113364}),
    "land": (Land(LAND.b * LAND.curvature**0.5), LAND.curvature, {1e-4: 1.0740281}),
    "lip": (LIP, 1.0, {1e-4: 0.8169361}),
}


def test_full_films_have_the_shares_of_other_discretisations(subtests):
    for name in FULL_FILMS:
        with subtests.test(name=name):
            shape, curvature, shares = FULL_FILMS[name]
            for speed, share in shares.items():
                found = solved(speed, shape, "none", 1e-6, curvature)
                assert 1 - found.fluid_load_share == pytest.approx(share, abs=1e-6)


def test_the_stated_error_covers_a_finer_solution(subtests):
    for speed, shape, cavitation in ((1e-3, LAND, "exit"), (1e-4, LIP, "none")):
        with subtests.test(shape=shape, cavitation=cavitation):
            coarse, fine = (solved(speed, shape, cavitation, rtol) for rtol in (1e-3, 1e-6))
            for name, error in coarse.errors.items():
                exact = getattr(fine, name)
                scale = 1.0 if name.endswith(("share", "position")) else abs(exact)
                assert abs(getattr(coarse, name) - exact) <= error * scale, name


def test_published_friction_projects_the_pressure_on_the_slope_of_the_body():
    found = solved(1e-4, LIP, "none")
    x = np.linspace(-6, 6, 60001)
    moment = np.trapezoid(LIP.slope(x) * found.profile(x).fluid_pressure, x)
    assert found.viscous_published == pytest.approx(found.viscous_upper - 4 * LOAD**0.5 / np.pi * moment, rel=1e-2)


@dataclass(frozen=True)
class Reversed(Smooth):
    """A shape seen from behind."""

    reversed: bool = True


# Shape and its friction at speeds 1e-4 and 1e-3 with mu_0 = 0.5 and u_0/L = 0.1, by finite volumes that conserve mass; where
# a film breaks inside the contact too, none.
FRICTION = {
    "cylinder": (None, 0.157, 0.0049),
    "narrow land": (of_unit_width(lambda c: Land(0.5, c), [2.0]), 0.273, 0.0219),
    "land": (LAND, None, 0.142),
    "lip": (LIP, 0.304, 0.0323),
    "reversed lip": (Reversed("lip", LIP.numbers), 0.061, 0.0059),
}


def test_films_that_end_have_the_friction_of_finite_volumes(subtests):
    for name in FRICTION:
        with subtests.test(name=name):
            shape, *values = FRICTION[name]
            for speed, value in zip((1e-4, 1e-3), values, strict=True):
                if value is not None:
                    found = solved(speed, shape, "exit")
                    assert float(found.friction(0.5, 0.1 / (2 * LOAD**0.5))) == pytest.approx(value, rel=5e-3, abs=5e-5)


def test_a_shape_that_is_a_parabola_is_the_cylinder():
    @dataclass(frozen=True)
    class Round:
        places = ()
        parameters = {}

        def gap(self, x):
            return x**2 / 2

        def slope(self, x):
            return x

    for cavitation in ("none", "exit"):
        found, cylinder = (
            sb.solve(groups(1e-3), cavitation=cavitation, profile=shape, rtol=1e-8) for shape in (Round(), None)
        )
        assert found.friction(0.5, 0.1) == pytest.approx(cylinder.friction(0.5, 0.1), rel=1e-8)
        assert found.minimum_gap == pytest.approx(cylinder.minimum_gap, rel=1e-8)


def test_a_reversed_shape_is_its_mirror_image():
    @dataclass(frozen=True)
    class Mirrored:
        of: Smooth
        places = ()
        parameters = {}

        def gap(self, x):
            return self.of.gap(-x)

        def slope(self, x):
            return -self.of.slope(-x)

    mirrored, turned = (solved(1e-3, shape, "exit") for shape in (Mirrored(LIP), Reversed("lip", LIP.numbers)))
    assert turned.minimum_gap == pytest.approx(mirrored.minimum_gap, rel=1e-12)


def test_a_body_with_grooves_is_not_reversed_by_itself():
    """Its grooves took it as if it were not reversed: friction of a lip was that of the other direction, 0.18 for 0.12."""
    grooves = {"groove_depth": "0.2 um", "groove_pitch": "30 um", "grooved_width": "0.4 mm"}
    lip, oil_first = sb.profiles.Lip("45 deg", "25 deg", "50 um"), sb.profiles.Lip("25 deg", "45 deg", "50 um")
    mirrored, turned = (
        sb.profiles.dry_contact(each, 200.0, 1e7)
        for each in (
            sb.profiles.Grooved(body=oil_first, **grooves),
            sb.profiles.Grooved(body=lip, reversed=True, **grooves),
        )
    )
    assert (turned.left_edge, turned.right_edge) == pytest.approx((mirrored.left_edge, mirrored.right_edge))
    with pytest.raises(sb.InputError, match="give reversed = True to the grooves"):
        sb.profiles.Grooved(body=replace(lip, reversed=True), **grooves)


def test_what_is_made_for_the_parabola_refuses_a_shape():
    state = solved(1e-3, WORN, "none", 1e-6).groups
    assert "profile" in repr(state.model)
    with pytest.raises(sb.InputError, match="Smooth"):
        sb.asymptotics.FORMULAS[0](state)
    with pytest.raises(sb.InputError, match="'reform' with profile"):
        sb.solve(groups(1e-3), profile=WORN, cavitation="reform", cavity_pressure=-0.01)
    with pytest.raises(sb.InputError, match="closed form"):
        sb.solve(sb.Groups(0.0, LOAD, 0.0), profile=WORN)
    with pytest.raises(sb.InputError, match="profiles are those of a line contact"):
        replace(state, geometry="point")


def test_a_shape_that_contradicts_itself_is_refused():
    @dataclass(frozen=True)
    class Wrong:
        places = ()
        parameters = {}

        def gap(self, x):
            return x**2 / 2

        def slope(self, x):
            return 2 * x

    with pytest.raises(sb.InputError, match="not the derivative of its gap"):
        sb.solve(groups(1e-3), profile=Wrong())
    with pytest.raises(sb.InputError, match="give one of sb.profiles"):
        sb.solve(groups(1e-3), profile=object())


CONTACT = {
    "modulus": "2.1 MPa",
    "load": "50 N/m",
    "viscosity": "10 mPa*s",
    "speed": "50 mm/s",
    "roughness": "1 um",
    "alpha": 2.0,
    "beta": 0.05,
    "boundary_friction": 0.8,
}


def test_the_cylinder_as_a_profile_is_the_radius_to_the_bit():
    by_radius = sb.LineContact(radius="10 mm", **CONTACT)
    by_profile = sb.LineContact(profile=sb.profiles.Cylinder("10 mm"), **CONTACT)
    assert by_profile.profile.gap(1e-4) == pytest.approx(0.5e-6) and by_profile.profile.slope(1e-4) == pytest.approx(0.01)
    assert by_profile.groups == by_radius.groups
    assert by_profile.radius == by_radius.radius
    assert sb.solve(by_profile).friction() == sb.solve(by_radius).friction()


def test_a_contact_with_a_profile_has_the_scales_of_its_dry_contact():
    land = sb.profiles.Land("0.4 mm", "1 mm")
    contact = sb.LineContact(profile=land, **CONTACT)
    dry = sb.profiles.dry_contact(land, contact.load, contact.modulus)
    assert contact.hertz.half_width == pytest.approx(dry.half_width, rel=1e-12)
    assert contact.hertz.indentation == pytest.approx(4 * contact.load / (np.pi * contact.modulus), rel=1e-12)
    assert contact.cavitation == "exit"
    assert contact.replace(cavitation="none").cavitation == "none"
    assert "radius=" not in repr(contact).replace("edge_radius=", "")
    heavier = contact.replace(load="100 N/m")
    assert heavier.hertz.half_width > contact.hertz.half_width
    assert contact.replace(land_width="0.2 mm").hertz.half_width < contact.hertz.half_width
    assert eval(repr(contact), {"LineContact": sb.LineContact, "Land": sb.profiles.Land}) == contact


def test_a_contact_takes_a_radius_or_a_profile_and_a_ball_takes_none():
    land = sb.profiles.Land("0.4 mm", "1 mm")
    with pytest.raises(sb.InputError, match="are both given"):
        sb.LineContact(radius="10 mm", profile=land, **CONTACT)
    with pytest.raises(sb.InputError, match="curve over the load"):
        sb.stribeck_curve(sb.LineContact(profile=land, **CONTACT), load=("10 N/m", "100 N/m"))


def test_replace_of_dataclasses_takes_the_radius_of_the_changed_contact():
    land = sb.profiles.Land(land_width="0.5 mm", edge_radius="1 mm")
    numbers = {"modulus": 5e6, "viscosity": 0.04, "speed": 0.1, "roughness": 1e-6, "alpha": 2.0, "beta": 0.03}
    contact = sb.LineContact(profile=land, load=100.0, boundary_friction=0.3, **numbers)
    heavier = replace(contact, load=400.0)
    assert heavier == contact.replace(load=400.0) and heavier.radius < contact.radius
    with pytest.raises(sb.InputError, match="both given"):
        replace(contact, radius=1e-3)


def test_dry_contacts_have_the_edges_of_closed_forms_and_tables(subtests):
    edges = {"cylinder": (sb.profiles.Cylinder(1.0), 2**0.5, 2**0.5), "land": (LAND, 5.566, 5.566), "lip": (LIP, 2.528, 0.430)}
    for name, (shape, left, right) in edges.items():
        with subtests.test(name=name):
            found = sb.profiles.dry_contact(shape, np.pi / 2, 2.0)
            assert found.centre == pytest.approx(0.0, abs=1e-6)
            assert found.half_width == pytest.approx(1.0, rel=1e-6)
            assert (found.left_edge, found.right_edge) == pytest.approx((left, right), rel=2e-4)


def test_a_shape_from_its_pressure_has_that_contact():
    x = np.cos(np.linspace(np.pi, 0, 41))
    pressure = (1 - x**2) ** 0.5 * (1 + 0.3 * x)
    pressure[[0, -1]] = 0.0
    shape = sb.profiles.from_pressure(x, pressure, modulus=2.0)
    load = np.pi / 2
    found = sb.profiles.dry_contact(shape, load, 2.0)
    assert (found.centre, found.half_width) == pytest.approx((0.0, 1.0), abs=1e-6)
    assert (found.left_edge, found.right_edge) == pytest.approx((0.7 * 2**0.5, 1.3 * 2**0.5), rel=1e-6)
    contact = sb.LineContact(
        profile=shape,
        load=1.0,
        modulus=2.0,
        viscosity=1e-3,
        speed=1e-3,
        roughness=1e-3,
        alpha=1,
        beta=1,
        boundary_friction=0.5,
    )
    for each in (shape, contact.groups):
        assert "20 terms from -1 to 1 m" in repr(each)
        assert len(repr(each)) < 1000
    assert "41 points from -1 to 1 m" in repr(sb.profiles.Table(x, x**2))


def test_a_table_of_a_shape_is_that_shape_wherever_its_heights_are_counted_from(tmp_path):
    x = np.linspace(-2e-3, 2e-3, 401)
    worn = sb.profiles.Worn("10 mm", "2 um")
    (tmp_path / "worn.csv").write_text(
        "x [mm], z [um]\n" + "\n".join(f"{1e3 * a:.17g}, {1e6 * b - 1000:.17g}" for a, b in zip(x, worn.gap(x), strict=True))
    )
    table = sb.profiles.Table(str(tmp_path / "worn.csv"))
    by_table, by_formula = (sb.solve(sb.LineContact(profile=shape, **CONTACT), rtol=1e-5) for shape in (table, worn))
    assert float(by_table.friction()) == pytest.approx(float(by_formula.friction()), rel=1e-4)
    with pytest.raises(sb.InputError, match="ascending"):
        sb.profiles.Table(x[::-1], x)


def test_a_file_of_a_shape_may_go_backwards_and_wrong_rows_are_named(tmp_path):
    path = tmp_path / "lip.csv"
    rows = ["2;200", "1;50", "0;0", "-1;50", "-2;210"]
    path.write_text("\n".join(["x [mm];z [um]", *rows]))
    table = sb.profiles.Table(path)
    assert table.x == pytest.approx((-2e-3, -1e-3, 0, 1e-3, 2e-3)) and table.z == pytest.approx((2.1e-4, 5e-5, 0, 5e-5, 2e-4))
    for wrong in (["2;200", "0;50", "1;0", "-1;50", "-2;210"], ["-2;200", "0;50", "0;0", "1;50", "2;210"]):
        path.write_text("\n".join(["# a comment", "x [mm];z [um]", *wrong]))
        with pytest.raises(sb.InputError, match=r"lip\.csv: row 5 has a position of .* in row 4; sort the rows"):
            sb.profiles.Table(path)


def test_slow_smooth_films_follow_the_edge_of_the_dry_pressure(subtests):
    """The film of a smooth soft body by its inlet: 0.4458 lambda^(3/5) (k^2/2)^(-2/5), which lands and cylinders share."""
    for shape in (None, of_unit_width(lambda c: Land(0.5, c), [2.0]), LAND):
        with subtests.test(shape=shape):
            known = sb.profiles.dry_contact(sb.profiles.Cylinder(1.0) if shape is None else shape, np.pi / 2, 2.0)
            films = [
                sb.solve(sb.Groups(speed, 1e-4, 1e-8), profile=shape, cavitation="none", rtol=1e-4).flux_gap
                / (0.4458 * speed**0.6 * (known.left_edge**2 / 2) ** -0.4)
                for speed in (3e-3, 3e-4)
            ]
            assert abs(films[1] - 1) < abs(films[0] - 1)
            assert films[1] == pytest.approx(1.0, abs=0.02)


def test_a_case_names_a_shape_and_its_check_says_how_steep_it_is_and_why_the_film_ends(capsys, tmp_path):
    lines = "\n".join(f"{name} = {value!r}".replace("'", '"') for name, value in CONTACT.items())
    case = tmp_path / "lip.toml"
    lip = 'shape = "lip"\nangle_oil = "15 deg"\nangle_air = "8 deg"\ntip_radius = "0.5 mm"\n'
    case.write_text(f"[contact]\n{lines}\n[profile]\n{lip}reversed = true\n")
    contact = sb.load_case(case).contact
    assert contact.profile == sb.profiles.Lip("15 deg", "8 deg", "0.5 mm", reversed=True)
    assert contact.cavitation == "exit"
    checks = {each["name"]: each for each in json.loads(call(capsys, "solve", case, "--json").out)["checks"]}
    assert checks["shape"]["value"] == pytest.approx(0.202, abs=2e-3)
    assert "ends at the exit" in checks["shape"]["sentence"]
    assert "contact width a/R" not in checks
    grooves = "groove_depth = 1e-6\ngroove_pitch = 5e-5\ngrooved_width = 1e-3\n"
    for text, sentence in (
        (f"[contact]\nradius = 0.01\n{lines}\n[profile]\n{lip}", "are both given"),
        (f'[contact]\n{lines}\n[profile]\nshape = "wedge"\n', "shape = 'wedge'"),
        (f'[contact]\n{lines}\n[profile]\nshape = "grooved"\n{grooves}', "base_radius is missing"),
        (f"[contact]\n{lines}\n[profile]\ntip_radius = 1e-3\n", "shape is missing"),
    ):
        case.write_text(text)
        with pytest.raises(sb.InputError, match=sentence):
            sb.load_case(case)


@dataclass(frozen=True)
class Kinked:
    """A rounded lip, blunt to one side, whose curvature jumps."""

    reversed: bool = True
    places = (0.44,)
    parameters = {}

    def gap(self, x):
        return 0.36 * (np.hypot(x, 0.18) - 0.18) - 0.23 * x + 0.08 * np.maximum(x - 0.44, 0) ** 2

    def slope(self, x):
        return 0.36 * x / np.hypot(x, 0.18) - 0.23 + 0.16 * np.maximum(x - 0.44, 0)


def test_a_film_that_ends_beside_a_lip_is_found_where_the_way_from_a_thick_film_is_lost():
    """A thick film may end in several places: from the one that the path leads to there is no way to the thin film."""
    numbers = {"modulus": 2.0, "load": 0.5 * np.pi, "viscosity": 1.41e-6, "speed": 1.0, "roughness": 0.0256}
    contact = sb.LineContact(profile=Kinked(), alpha=1.0, beta=6.38, boundary_friction=0.5, cavitation="exit", **numbers)
    found = sb.solve(contact, rtol=1e-3)
    assert found.outcome.ok
    assert found.contact_load_share + found.fluid_load_share == pytest.approx(1.0, abs=1e-3)


def test_a_fluid_that_sucks_within_a_land_adds_to_the_load_of_asperities_on_curves_too():
    """Its share of the load is below zero: curves and intervals had lost the sign, and friction was 7 % too low."""
    land = {"profile": sb.profiles.Land("0.5 mm", "1.765 mm"), "modulus": "7.3 MPa", "load": "100 N/m", "cavitation": "exit"}
    seal = sb.LineContact(
        **land, viscosity="40 mPa*s", speed=1e-3, roughness="1 um", alpha=2, beta=0.06, boundary_friction=0.3
    )
    curve = sb.stribeck_curve(seal, speed=(8e-4, 1e-3), points=2, rtol=1e-3)
    states = [sb.solve(seal.replace(speed=float(speed)), rtol=1e-3) for speed in curve.values]
    assert states[-1].fluid_load_share < -0.01
    assert curve.observable("fluid_load_share") == pytest.approx([each.fluid_load_share for each in states], abs=2e-3)
    assert curve.friction.total == pytest.approx([each.friction.total for each in states], rel=2e-3)
    spreads = sb.propagate(seal, {"boundary_friction": 0.1}, transitions=False)
    assert spreads["contact_load_share"].median == pytest.approx(states[-1].contact_load_share, rel=1e-3)
    assert spreads["friction"].median == pytest.approx(states[-1].friction.total, rel=1e-2)


def test_intervals_cross_a_share_of_the_fluid_that_is_zero():
    """Samples beyond it were clipped, however far from the middle: the median was 13 % too high."""
    land = {"profile": sb.profiles.Land("0.5 mm", "1.765 mm"), "modulus": "7.3 MPa", "load": "100 N/m", "cavitation": "exit"}
    seal = sb.LineContact(
        **land, viscosity="40 mPa*s", speed="7.5 mm/s", roughness="1 um", alpha=2, beta=0.06, boundary_friction=0.3
    )
    share = sb.propagate(seal, {"viscosity": 0.2}, transitions=False)["contact_load_share"]
    ends = [sb.solve(seal.replace(viscosity=0.04 * np.exp(each)), rtol=1e-3).contact_load_share for each in (0.392, -0.392)]
    assert ends[0] < share.value < 1.0 < ends[1]
    assert share.interval_95 == pytest.approx(ends, abs=0.05 * (ends[1] - ends[0]))
    assert share.median == pytest.approx(share.value, abs=2e-3)
