"""From groups to a state of the point contact that holds its tolerance: cold, or from a neighbour.

A dry contact in which a cushion, as thick as the film, helps the asperities has about the shape of the lubricated one, and
the pressure of the cushion is the first guess of the film pressure.  So elastic shape and load hold from the beginning.
If Newton's iteration does not converge from there, the film comes from that of a Newtonian fluid.
"""

import math
from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

import numpy as np

from stribeck._types import Array
from stribeck.contact_laws.law import ContactLaw
from stribeck.contacts.groups import BASE_MODEL, Groups, Model, contact_law
from stribeck.equations.point.dry import dry_contact, hertz_gap
from stribeck.equations.point.films import is_isotropic
from stribeck.equations.point.iteration import Iterated
from stribeck.equations.point.mesh_choice import (
    MeshTooLargeError,
    Resolution,
    film_scale,
    film_speed,
    is_too_thin,
    operators_of,
    resolution,
    split_where_poor,
)
from stribeck.equations.point.observables import OBSERVABLES, identity_error
from stribeck.equations.point.planes import PLANES
from stribeck.equations.point.system import Equations, Unknowns
from stribeck.fluids.fluid import Cavitation, Film
from stribeck.fluids.laws import RateLaw
from stribeck.fluids.newtonian import Newtonian, blend
from stribeck.fluids.rheology.viscosity import Constant, Incompressible
from stribeck.fluids.shear_thinning import ShearThinning
from stribeck.numerics.continuation import Steps, extrapolation_weights
from stribeck.numerics.settings import (
    COARSE_RTOL,
    LEAST_DEGREE,
    LEAST_MODES,
    MAX_DEGREE,
    MAX_REFINEMENTS,
    MAX_RTOL,
    MIN_RTOL_OF_BALLS,
    NEGLIGIBLE,
)
from stribeck.quantities.outcome import Outcome
from stribeck.quantities.units import InputError, show
from stribeck.solids.plane import BODIES, MIN_LAYER_THICKNESS
from stribeck.solver.at_rest import effective_model, with_positive_gap
from stribeck.solver.point.estimate import Pair, pair_of
from stribeck.solver.point.level import Level, extrapolate_levels, solve_level
from stribeck.solver.point.refinement import follow, follow_reforming, full_model, holds, refine, refine_reforming
from stribeck.solver.point.state import PointFields, PointState
from stribeck.solver.refinement import newton_tolerance

TOLERANCE = NEGLIGIBLE * COARSE_RTOL  # Relative error of the gap that the iteration of a first state may leave


@dataclass(frozen=True)
class WithCushion:
    """A contact law, and a cushion that gives way at a film thickness, as a film does."""

    law: ContactLaw
    film: float
    name: str = "with cushion"
    constant_decay: bool = False

    @property
    def own_decay(self) -> float:
        """The decay of the cushion: what flows in a film goes as the third power of its thickness."""
        return self.film / 3.0

    @property
    def decay_length(self) -> float:
        """The longer of the two decays."""
        return max(float(np.max(self.law.decay_length)), self.own_decay)

    def cushion(self, gap: Array) -> Array:
        """Return the pressure of the cushion, one at the film thickness."""
        return np.asarray(np.exp((self.film - gap) / self.own_decay))

    def pressure(self, gap: Any) -> Any:
        """Return the sum of both pressures."""
        return np.exp(self.log_pressure(gap))

    def log_pressure(self, gap: Any) -> Any:
        """Return its logarithm."""
        return np.logaddexp(self.law.log_pressure(gap), (self.film - gap) / self.own_decay)


def first_guess(found: Resolution, speed: float, law: ContactLaw) -> Unknowns | None:
    """Return the first guess on a mesh; None if the dry contact fails."""
    cushioned = WithCushion(law, film_scale(film_speed(speed, found.model)))
    dry = dry_contact(operators_of(found), cushioned, TOLERANCE)
    if not dry.outcome.ok or not dry.gap.min() > 0:
        return None
    gap, fluid = (np.tile(each, (found.modes, 1)) for each in (dry.gap, cushioned.cushion(dry.gap)))
    return Unknowns(gap, fluid, dry.offset)


def first_state(speed: float, law: ContactLaw, model: Model = BASE_MODEL) -> Level | Outcome:
    """Return a coarse state at a speed, or the outcome of the failure."""
    if is_too_thin(speed, law):
        return Outcome.MESH_LIMIT
    try:
        found, level = resolution(speed, law, LEAST_DEGREE, LEAST_MODES, model), None
        for _ in range(MAX_REFINEMENTS):
            guess, mesh = first_guess(found, speed, law), operators_of(found).mesh
            if guess is None:
                break
            level = solve_level(found, speed, law, guess, mesh, TOLERANCE)
            better = split_where_poor(found, mesh, guess.fluid, law.pressure(guess.gap))
            if level.outcome.ok or better == found:
                break
            found = better  # the pressure on a thin layer is steeper than that on a half-space
        if level is None or not level.outcome.ok:
            level = _from_newtonian(speed, law, model) or level
    except MeshTooLargeError as problem:
        return problem.outcome
    if level is None:
        return Outcome.STALLED
    return level if level.outcome.ok else level.outcome


def _from_newtonian(speed: float, law: ContactLaw, model: Model) -> Level | None:
    """Return the state at the end of the path from a Newtonian fluid between smooth walls to the film of the model."""
    if model.film == BASE_MODEL.film:
        return None
    here = resolution(speed, law, LEAST_DEGREE, LEAST_MODES, model)

    def correct(part: float, history: Sequence[tuple[float, Level]]) -> Level | None:
        if not history:
            plain = first_state(speed, law, replace(model, film=BASE_MODEL.film))
            return plain if isinstance(plain, Level) else None
        weights = extrapolation_weights([at for at, _ in history], part)
        on = replace(here, splits=history[-1][1].resolution.splits, model=replace(model, film=blend(model.film, part)))
        mesh = operators_of(on).mesh
        guess = extrapolate_levels(weights, [level for _, level in history], mesh)
        return solve_level(on, speed, law, guess, mesh, TOLERANCE)

    found = Steps(correct).to(1.0, 0.0)
    if not found.outcome.ok:
        return None
    last = found.states[-1]
    return replace(last, resolution=replace(last.resolution, model=model))


RTOL_RANGE = (MIN_RTOL_OF_BALLS, MAX_RTOL)
MIN_ESTIMATE_RTOL_FRACTION = NEGLIGIBLE**2  # Least stated error over rtol


def solve_cold(groups: Groups, rtol: float = 1e-6) -> PointState:
    """Return the state of ``groups``, from the dry contact or the rigid ball."""
    check(groups, rtol)
    if groups.is_hertzian:
        return _hertz(groups, rtol)
    if groups.speed == 0:
        return _at_rest(groups, rtol)
    speed, law = float(groups.speed), contact_law(groups)
    model = effective_model(groups.model)
    full = full_model(model)
    if model.cavitation is Cavitation.EXIT:  # the suction of a full film may be far from any state of one that breaks
        full = replace(full, film=_of_constant_viscosity(model.film))
    first = first_state(speed, law, full)
    if isinstance(first, Outcome):
        return _failed(groups, rtol, first)
    return _state(groups, rtol, _methods(model)[0](speed, law, first, rtol, model))


def _methods(model: Model) -> tuple[Callable[..., Pair | Outcome], Callable[..., Pair | None]]:
    """Return how states of a model are refined and followed."""
    return (refine_reforming, follow_reforming) if model.cavitation is Cavitation.REFORM else (refine, follow)


def _of_constant_viscosity(film: Film) -> Film:
    """Return the film of a fluid whose viscosity and density are constant, through the same roughness."""
    if isinstance(film, Newtonian):
        return replace(film, viscosity=Constant(), density=Incompressible())
    return BASE_MODEL.film


def solve_from(
    neighbour: PointState,
    groups: Groups,
    rtol: float = 1e-6,
    prediction: Unknowns | None = None,
) -> PointState:
    """Return the state of ``groups`` from that of a neighbour, on its mesh while this serves, or from cold if that fails."""
    # The prediction lies on the neighbour's finer mesh.
    check(groups, rtol)
    pair = neighbour.work
    if groups.speed == 0 or not isinstance(pair, Pair) or not pair.fine.equations.speed > 0:
        return solve_cold(groups, rtol)
    speed, law, model = float(groups.speed), contact_law(groups), effective_model(groups.model)
    if same_kinds(pair.fine.resolution.model, model):
        pair = pair.relabelled(model)
    warm = None
    if pair.fine.resolution.model == model:
        refined, followed = _methods(model)
        with suppress(MeshTooLargeError):
            found = followed(speed, law, pair, rtol, prediction)
            if found is not None:
                held = holds(found, rtol)
                warm = _state(groups, rtol, found if held else refined(speed, law, found.fine, rtol, model, found))
    if warm is not None and warm.outcome.ok:
        return warm
    cold = solve_cold(groups, rtol)
    return cold if cold.outcome.ok or warm is None else warm


def same_kinds(model: Model, other: Model) -> bool:
    """Return whether models have the same film, solid and cavitation but for their numbers."""
    kinds = ((each.cavitation, type(each.film), each.film.name, type(each.solid)) for each in (model, other))
    return len(set(kinds)) == 1


def check(groups: Groups, rtol: float) -> None:
    """Refuse anything but one state of a ball, and tolerances out of range."""
    if not isinstance(groups, Groups) or groups.geometry != "point" or groups.shape != ():
        raise InputError(f"groups = {show(groups)}; it must be one state, Groups(speed, load, roughness, geometry='point').")
    check_model(groups.model)
    low, high = RTOL_RANGE
    if isinstance(rtol, bool) or not isinstance(rtol, int | float) or not low <= rtol <= high:
        raise InputError(f"rtol = {show(rtol)}; for a ball it must be a number from {low:g} to {high:g}.")


def check_model(model: Model) -> None:
    """Refuse films, solids and flow factors that the equations of a ball do not have."""
    if type(model.film) not in PLANES:
        raise InputError(f"fluid = {model.film.name}: its flow in the plane under a ball is not implemented.")
    if isinstance(model.film, ShearThinning) and not has_plateau(model.film.law):
        raise InputError(
            f"fluid = {model.film.name}: around a ball every film is sheared slowly somewhere, where a pure power law grows "
            "without bound; the viscosity at low rates must be that of the contact. Give Carreau(relaxation_time, exponent) "
            "with the same exponent, or Cross; their viscosity has a plateau below the rate 1/relaxation_time."
        )
    if isinstance(model.film, Newtonian) and not is_isotropic(model.film.flow):
        raise InputError(
            f"flow_factors = {model.film.flow.name}: on a ball they must be those of isotropic roughness, gamma = 1, without "
            "friction factors."
        )
    if type(model.solid) not in BODIES:
        raise InputError(
            f"solid = {model.solid.name}: in the contact of a ball the soft body must be a half-space or a bonded layer. "
            "Other bodies are solved under a cylinder only."
        )
    thickness = getattr(model.solid, "layer_thickness", math.inf)
    if thickness < MIN_LAYER_THICKNESS:
        raise InputError(
            f"solid = {model.solid.name}: its thickness is {thickness:.3g} of the Hertz radius on a half-space; under a ball "
            f"it must be {MIN_LAYER_THICKNESS:g} or more. Thinner layers are solved under a cylinder only."
        )


def has_plateau(law: RateLaw) -> bool:
    """Return whether the viscosity of a fluid at low rates is that of the contact."""
    slow = np.array([np.finfo(float).tiny])
    return bool(np.isclose(law.stress(slow), slow, atol=0.0)[0])


def _state(groups: Groups, rtol: float, pair: Pair | Outcome, shift: float = 0.0) -> PointState:
    """Return a refined pair as a state."""
    if isinstance(pair, Outcome):
        return _failed(groups, rtol, pair)
    fine, values = pair.fine, dict(pair.values)
    rtol = max(rtol, fine.equations.finest)
    for name in ("central_gap", "minimum_gap", "minimum_gap_on_axis", "offset"):
        values[name] += shift
    y = fine.unknowns
    contact = fine.equations.law.pressure(y.gap)
    smallest = MIN_ESTIMATE_RTOL_FRACTION * rtol
    errors = {name: max(error, smallest * pair.scales[name]) for name, error in pair.errors.items()}
    if groups.roughness == 0 and groups.speed > 0:  # smooth surfaces in a film touch nowhere
        errors["contact_load_share"] = 0.0
    return PointState(
        groups=groups,
        rtol=rtol,
        outcome=pair.outcome,
        values=values,
        absolute_errors=errors,
        scales=pair.scales,
        identity_error=identity_error(values, float(groups.speed), fine.equations.far),
        load_error=values["contact_load_share"] + values["fluid_load_share"] - 1.0,
        mesh=fine.mesh,
        nodal_gap=y.gap + shift,
        nodal_contact_pressure=contact,
        nodal_fluid_pressure=y.fluid,
        fields=partial(fields_at, fine.without_operators(), shift),
        newton_steps=pair.steps,
        krylov_steps=pair.krylov_steps,
        work=pair,
    )


def fields_at(level: Level, shift: float, x: Array, y: Array) -> PointFields:
    """Return the fields at points of the plane, interpolated on the mesh and by the far field beyond its rim."""
    x, y = np.broadcast_arrays(np.asarray(x, dtype=float), np.asarray(y, dtype=float))
    mesh, unknowns = level.mesh, level.unknowns
    r = np.hypot(x, y)
    inside = np.minimum(1.0, mesh.rim / np.maximum(r, 1e-300))
    # Over the parabola of the lowest gap, which a thick film has: over that of the contact it would vary within a panel.
    square = max(1.0, 2.0 * float(unknowns.gap.min()))
    nodal = np.stack([unknowns.gap / (square + mesh.radii**2), unknowns.fluid])
    if unknowns.gap.min() > 0:
        nodal[0] = np.log(nodal[0])
    shape, fluid = mesh.interpolate(nodal, x * inside, y * inside)
    gap = (np.exp(shape) if unknowns.gap.min() > 0 else shape) * (square + r * r)
    contact = level.equations.law.pressure(gap)
    return PointFields(gap + shift, contact, np.maximum(fluid, level.equations.least) * inside**3)


def _failed(groups: Groups, rtol: float, outcome: Outcome) -> PointState:
    """Return a state without values."""
    nothing = dict.fromkeys(OBSERVABLES, math.nan)
    empty = np.zeros((0, 0))
    ones = dict.fromkeys(OBSERVABLES, 1.0)
    return PointState(groups, rtol, outcome, nothing, nothing, ones, math.nan, math.nan, None, empty, empty, empty, _nowhere)


def _nowhere(x: Array, y: Array) -> PointFields:
    nothing = np.full(np.broadcast_shapes(np.shape(x), np.shape(y)), np.nan)
    return PointFields(nothing, nothing, nothing)


def _at_rest(groups: Groups, rtol: float) -> PointState:
    """Return the dry contact, a problem in the radius that is refined in the degree alone."""
    base, shift = with_positive_gap(groups)
    law, model = contact_law(base), replace(BASE_MODEL, solid=groups.model.solid)
    coarse: Level | None = None
    outcome = Outcome.REFINEMENT_LIMIT
    found: Pair | None = None
    for degree in range(MAX_DEGREE // 2, MAX_DEGREE + 2, 2):  # a problem in the radius alone
        fine = _dry_level(law, degree, newton_tolerance(rtol), model)
        if not fine.outcome.ok:
            # A gap of order kappa is a difference of terms of order one.
            lost = float(np.finfo(float).eps / groups.relative_roughness)
            return _failed(groups, rtol, Outcome.ROUNDING if lost > MIN_ESTIMATE_RTOL_FRACTION * rtol else fine.outcome)
        if coarse is not None:
            found = pair_of(coarse, fine)
            if found.total <= rtol and found.minimum <= rtol:
                return _state(groups, rtol, found, shift)
        coarse = fine
    assert found is not None
    return _state(groups, rtol, replace(found, outcome=outcome), shift)


def _dry_level(law: ContactLaw, degree: int, tolerance: float, model: Model) -> Level:
    found = resolution(0.0, law, degree, 2, model)
    operators = operators_of(found)
    dry = dry_contact(operators, law, tolerance)
    y = Unknowns(np.tile(dry.gap, (2, 1)), np.zeros((2, dry.gap.size)), dry.offset)
    return Level(found, Equations(operators, 0.0, law), Iterated(y, dry.outcome, dry.steps, 0, 0, tolerance, None))


def _hertz(groups: Groups, rtol: float) -> PointState:
    """Return the closed form of the dry, smooth contact."""
    if groups.model.solid != BASE_MODEL.solid:
        raise InputError(
            f"speed and roughness are zero on a {groups.model.solid.name}: the dry contact of a smooth ball is known in "
            "closed form on the half-space alone; give a small speed or roughness."
        )
    law = contact_law(groups)
    found = resolution(1e-8, law, 10, 2)
    mesh = operators_of(found).mesh
    gap = np.tile(hertz_gap(mesh.radii), (2, 1))
    pressure = np.sqrt(np.maximum(1.0 - mesh.radii**2, 0.0))
    values = dict.fromkeys(OBSERVABLES, 0.0) | {"contact_load_share": 1.0, "central_pressure": 1.0, "offset": -1.0}
    tiny = dict.fromkeys(OBSERVABLES, float(np.finfo(float).eps))
    tiny["minimum_radius"] = 1.0
    ones = dict.fromkeys(OBSERVABLES, 1.0)
    contact = np.tile(pressure, (2, 1))
    return PointState(
        groups, rtol, Outcome.CONVERGED, values, tiny, ones, 0.0, 0.0, mesh, gap, contact, np.zeros_like(gap), _hertz_fields
    )


def _hertz_fields(x: Array, y: Array) -> PointFields:
    r = np.hypot(*np.broadcast_arrays(np.asarray(x, dtype=float), np.asarray(y, dtype=float)))
    return PointFields(hertz_gap(r), np.sqrt(np.maximum(1.0 - r * r, 0.0)), np.zeros_like(r))
