"""Laws that users write, as for_developers.md shows: right ones give right films, others are refused with what is wrong."""

from dataclasses import dataclass, replace

import numpy as np
import pytest
from fit_data import TRUE
from yasuda import Yasuda

import stribeck as sb
from stribeck.fluids.laws import FlowFactors, RateLaw, ViscosityLaw
from stribeck.solids.solid import Lengths

CONTACT = TRUE.replace(speed="100 mm/s", roughness="0.1 um")


@dataclass(frozen=True)
class Stiffening(ViscosityLaw):
    coefficient: float
    name = "stiffening"

    @property
    def parameters(self):
        return {"coefficient": self.coefficient}

    def scaled(self, units):
        return replace(self, coefficient=self.coefficient * units.pressure)

    def log(self, pressure):
        return self.coefficient * pressure


@dataclass(frozen=True)
class StiffeningLate(Stiffening):
    name = "stiffening late"

    def scaled(self, units):
        return replace(self, coefficient=self.coefficient * units.pressure**2)

    def log(self, pressure):
        return self.coefficient * pressure**2


@dataclass(frozen=True)
class Grooves(FlowFactors):
    depth: float
    name = "grooves"

    @property
    def parameters(self):
        return {"depth": self.depth}

    def scaled(self, units):
        return replace(self, depth=self.depth / units.gap)

    def pressure(self, gap):
        return 1 + (self.depth / gap) ** 2

    def shear(self, gap):
        return np.zeros_like(gap)


def other(law, **members):
    """Return the law with some of its members in another form."""
    return type(law.__name__, (law,), members)


def film(fluid):
    return sb.solve(CONTACT, fluid=fluid).central_gap


def test_laws_that_are_those_of_the_package_give_their_films():
    assert film(Yasuda(1e-4, 0.5)) == pytest.approx(film(sb.fluids.Carreau("0.1 ms", 0.5)), rel=1e-6)
    assert film(Stiffening(2e-8)) == pytest.approx(film(sb.fluids.Barus("20 1/GPa")), rel=1e-9)


@dataclass(frozen=True)
class Slip(FlowFactors):
    """Both walls let the fluid slip by a length b times the shear rate there (Navier)."""

    length: float
    name = "slip"

    @property
    def parameters(self):
        return {"length": self.length}

    def scaled(self, units):
        return replace(self, length=self.length / units.gap)

    def pressure(self, gap):
        return 1 + 6 * self.length / gap

    def shear(self, gap):
        return np.zeros_like(gap)

    def friction(self, gap):
        return gap / (gap + 2 * self.length), np.zeros_like(gap), np.ones_like(gap)  # of shear, valleys, pressure


def test_a_film_between_walls_that_slip_is_as_if_they_lay_farther_back():
    contact = CONTACT.replace(roughness="1 um")
    slipping, plain = sb.solve(contact, flow_factors=Slip(20e-9)), sb.solve(contact)
    assert (plain.central_film_thickness - slipping.central_film_thickness) / 40e-9 == pytest.approx(1, rel=0.01)
    assert slipping.friction().total < plain.friction().total


def refused(said, call, *given):
    """Check that a call is refused with words."""
    with pytest.raises(sb.InputError, match=said):
        call(*given)


def test_the_laws_of_the_package_pass_the_check_of_others():
    for kind, law, *given in (
        ("rheology", "Carreau", "1 ms", 0.5, "1 mPa*s"),
        ("rheology", "Cross", "1 ms", 0.4),
        ("rheology", "PowerLaw", "1 ms", 0.7),
        ("rheology", "Eyring", "5 kPa"),
        ("viscosity", "Barus", "20 1/GPa"),
        ("viscosity", "Roelands", "20 1/GPa"),
        ("density", "DowsonHigginson"),
    ):
        sb.fluids.Fluid(**{kind: other(getattr(sb.fluids, law))(*given)})
    for factors in (sb.fluids.PatirCheng, sb.fluids.EffectiveMedium):
        assert sb.solve(CONTACT, flow_factors=other(factors)()).central_gap > 0
    for body in (
        other(sb.solids.HalfPlane)(),
        other(sb.solids.Layer)("2 mm"),
        other(sb.solids.Layer)("1 um", 0.3),
        other(sb.solids.StandardLinearSolid)("10 ms", 3.0),
        other(sb.solids.StandardLinearSolid)("1 s", 3.0, sb.solids.Layer("2 mm")),
        other(sb.solids.Prony)(["1 ms", "10 ms"], [1.0, 0.5]),
        other(sb.solids.TwoBodies)(sb.solids.Layer("1 mm"), None, 0.3),
    ):
        assert CONTACT.replace(solid=body).solid == body


def test_a_law_of_shear_that_contradicts_itself_is_refused(subtests):
    for said, members in [
        ("scaled", {"scaled": lambda self, units: self}),
        ("scaled", {"scaled": lambda self, units: replace(self, relaxation_time=self.relaxation_time * units.time)}),
        ("slope", {"stress": lambda self, rate: Yasuda.stress(self, np.asarray(getattr(rate, "value", rate)))}),
        ("functions of numpy", {"stress": lambda self, rate: np.interp(rate, [0, 2e4], [0, 2e4])}),
        ("low rates", {"stress": lambda self, rate: 2 * Yasuda.stress(self, rate)}),
        ("rise", {"stress": lambda self, rate: rate / (1 + rate**2)}),
        ("rate", {"rate": lambda self, stress: stress}),
        ("moments", {"moments": lambda self, rate, stress: (rate * stress, rate * stress**2)}),
        ("exponent", {"shape": property(lambda self: ())}),
    ]:
        with subtests.test(said=said):
            refused(said, film, other(Yasuda, **members)(1e-4, 0.5))


def test_a_law_of_pressure_that_contradicts_itself_or_cannot_be_evaluated_is_refused(subtests):
    for said, members in [
        ("scaled", {"scaled": lambda self, units: self}),
        ("slope", {"log": lambda self, pressure: self.coefficient * np.asarray(getattr(pressure, "value", pressure))}),
        ("ambient", {"log": lambda self, pressure: 1 + self.coefficient * pressure}),
        ("log must return an array", {"log": lambda self, pressure: (self.coefficient * pressure, self.coefficient)}),
        ("log must return an array", {"log": lambda self, pressure: self.coefficient}),
        ("stiffening.*ZeroDivisionError", {"log": lambda self, pressure: 1 / 0}),
    ]:
        with subtests.test(said=said):
            refused(said, film, other(Stiffening, **members)(2e-8))
    assert film(StiffeningLate(1e-10)) > 1.03 * film(Stiffening(0.0))  # one that sets in as the square of the pressure
    refused("scaled", film, other(StiffeningLate, scaled=lambda self, units: self)(1e-10))


def test_flow_factors_that_contradict_themselves_are_refused(subtests):
    assert sb.solve(CONTACT, flow_factors=Grooves(1e-6)).central_gap > 0
    for said, members in [
        ("scaled", {"scaled": lambda self, units: self}),
        ("slope", {"pressure": lambda self, gap: 1 + (self.depth / np.asarray(getattr(gap, "value", gap))) ** 2}),
        ("shear", {"shear": lambda self, gap: self.depth**2 / np.asarray(getattr(gap, "value", gap))}),
        ("must return an array", {"shear": lambda self, gap: 0.0}),
    ]:
        with subtests.test(said=said):
            factors = other(Grooves, **members)(1e-6)
            refused(said, lambda factors=factors: sb.solve(CONTACT, flow_factors=factors))


def test_a_law_or_body_that_lacks_a_member_is_refused_with_its_name():
    for lacks in ("scaled", "stress", "time", "shape", "smallest"):
        members = {name: value for name, value in vars(Yasuda).items() if name != lacks and not name.startswith("__")}
        with pytest.raises(TypeError, match=lacks):
            type("Lacking", (RateLaw,), members | {"relaxation_time": 1e-4, "exponent": 0.5})()
    for lacks in ("name", "parameters", "scaled", "far_gap"):
        members = {name: value for name, value in vars(Pad).items() if name not in (lacks, "__dict__", "__weakref__")}
        body = type("Lacking", (), members)(1e-4)
        refused(f"lacks {lacks}", lambda body=body: CONTACT.replace(solid=body))


def test_contact_laws_that_contradict_themselves_are_refused():
    class Own:
        name, parameters, lowest = "own", {}, 0.0

        def log_pressure(self, separation):
            return -separation

        def notes(self, separation):
            return ()

    plain = sb.solve(CONTACT).central_gap
    assert sb.solve(CONTACT, law=Own()).central_gap == pytest.approx(plain, rel=1e-6)
    wrong = type("Wrong", (Own,), {"log_pressure": lambda self, s: -np.interp(s, [0, 200], [0, 200])})
    rises = type("Rises", (Own,), {"log_pressure": lambda self, s: s})
    for law, said in ((wrong, "functions of numpy"), (rises, "fall")):
        with pytest.raises(sb.InputError, match=said):
            sb.solve(CONTACT, law=law())


@dataclass(frozen=True)
class Pad:
    length: float
    name = "pad"

    @property
    def parameters(self):
        return {"length": self.length}

    @property
    def lengths(self):
        return Lengths(self.length)

    def scaled(self, length, speed=1.0):
        return replace(self, length=self.length / length)

    def deflection(self, mesh):
        return sb.solids.HalfPlane().deflection(mesh) + self.length * np.eye(mesh.size)

    def far_gap(self, x):
        return sb.solids.HalfPlane().far_gap(x)


def test_a_body_of_ones_own_is_solved_and_nearly_a_half_plane_where_it_hardly_yields():
    assert sb.solve(CONTACT, solid=Pad(1e-9)).central_gap == pytest.approx(sb.solve(CONTACT).central_gap, rel=1e-4)


def test_a_body_that_contradicts_itself_is_refused_where_it_enters(subtests):
    for said, members in [
        ("scaled does not agree", {"scaled": lambda self, length, speed=1.0: self}),
        ("scaled does not agree", {"scaled": lambda self, length, speed=1.0: type(self)(self.length * length)}),
        ("scaled does not agree", {"scaled": lambda self, length, speed=1.0: self, "lengths": Lengths()}),
        ("far_gap does not agree", {"far_gap": lambda self, x: 0.5 * x**2}),
        ("far_gap does not agree", {"deflection": lambda self, mesh: -Pad(self.length).deflection(mesh)}),
        ("far_gap does not agree", {"deflection": lambda self, mesh: 2 * Pad(self.length).deflection(mesh)}),
        ("finite matrix", {"deflection": lambda self, mesh: np.zeros(mesh.size)}),
        ("finite matrix", {"deflection": lambda self, mesh: np.full((mesh.size, mesh.size), np.nan)}),
        ("pad.*ZeroDivisionError", {"deflection": lambda self, mesh: 1 / 0}),
        ("a number for each place", {"far_gap": lambda self, x: 0.0}),
        ("cannot be hashed", {"__hash__": None}),
    ]:
        with subtests.test(said=said, members=members):
            body = other(Pad, **members)(1e-4)
            for enter in (
                lambda: sb.solve(CONTACT, solid=body),
                lambda: CONTACT.replace(solid=body),
                lambda: sb.solids.TwoBodies(body),
            ):
                with pytest.raises(sb.InputError, match=said):
                    enter()


def test_a_film_and_an_end_of_it_are_not_given_as_classes():
    class Film:
        def gradient(self, gap, pressure, flux_gap):
            return gap

    for name in ("fluid", "cavitation"):
        for enter in (CONTACT.replace, lambda **part: sb.solve(CONTACT, **part)):
            with pytest.raises(sb.InputError, match=f"{name} = .*(give a law|must be 'none')"):
                enter(**{name: Film()})


def test_groups_take_no_film_of_ones_own_and_check_their_body():
    model = CONTACT.groups.model
    film = type("Film", (type(model.film),), {})()
    pad = other(Pad, scaled=lambda self, length, speed=1.0: self)(1.0)
    for said, part in (
        ("films are those of the package", {"film": film}),
        ("must be 'none', 'exit' or 'reform'", {"cavitation": "ends"}),
        ("scaled does not agree", {"solid": pad}),
    ):
        with pytest.raises(sb.InputError, match=said):
            replace(model, **part)
