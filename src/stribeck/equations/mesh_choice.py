"""The mesh that resolves a guess of a state: what of it, and of what is read off it, each panel must resolve."""

import math
from dataclasses import replace

import numpy as np

from stribeck._types import Array
from stribeck.contact_laws.law import ContactLaw
from stribeck.contacts.groups import Groups
from stribeck.equations.film import closed_gap, decay_of, is_rough, is_thinning, jump_of
from stribeck.equations.state import Guess, State
from stribeck.fluids.fluid import Cavitation, Film
from stribeck.numerics.newton import root_between
from stribeck.numerics.panels import Mesh, adapt, base_edges, graded, highest_degree, reference
from stribeck.numerics.settings import (
    COARSE_RTOL,
    COARSE_STEP,
    EPSILON,
    HALF_DIGITS,
    NEGLIGIBLE,
    ROUNDING,
    SAFETY,
    SAME_PLACE,
    SHARE,
)
from stribeck.solids.solid import Lengths


def kinks_of(guess: Guess, film: Film, x: Array, at_gap: float | None) -> Array:
    """Return where there is a kink, between the places ``x`` of a guess."""
    # With flow factors that is at a gap, where the last path of the flow closes or liquid ceases to fill the gap; a fluid
    # without a plateau has kinks where a wall is not sheared.

    def crossing(x: Array) -> Array:
        found = guess.fields(x)
        if at_gap is not None:
            return found[:1] - math.log(at_gap)
        pressure = found[1] if film.uses_pressure else None
        return np.stack(film.tractions(np.exp(found[0]), pressure, np.array(guess.flux_gap)))

    def kink(row: int, k: int) -> float | None:
        ends = float(x[k]), float(x[k + 1])
        return root_between(lambda place: float(crossing(np.array([place]))[row, 0]), *ends, near)

    near = SAME_PLACE * float(np.abs(x).max())
    found = [kink(int(row), int(k)) for row, k in np.argwhere(np.diff(np.signbit(crossing(x)), axis=1))]
    return np.array([place for place in found if place is not None])


def error_of(tail: float) -> float:
    """Return the error that a Legendre tail of the fields on each panel leaves: about its square."""
    return (tail / (SAFETY * NEGLIGIBLE)) ** 2


def halvings_for(gain: float) -> float:
    """Return how many halvings of the panels beside an exit gain a factor: its error falls with their square at least."""
    return 0.5 * math.log2(gain)


def mesh_for(
    guess: Guess,
    groups: Groups,
    law: ContactLaw,
    order: int,
    tolerance: float,
    gap_tolerance: float = 1e-2,
    profile_tolerance: float = np.inf,
    halvings: int = 0,
    spread: float = 0.0,
    anew: bool = True,
) -> Mesh:
    """Return the coarsest mesh that resolves a guess; where a film re-forms its panels halve towards that place."""
    error = error_of(tolerance)
    cavitation = groups.model.cavitation
    film = groups.model.film
    plateau, fractional = decay_of(film, float(groups.speed))
    turns_sharply = is_thinning(film) or (is_rough(film) and tolerance < COARSE_RTOL)
    jump, closed_at = jump_of(film), closed_gap(film)
    ends, reformation = cavitation is not Cavitation.NONE, math.inf
    if cavitation is Cavitation.REFORM:
        reformation = _cavity_on_mesh(guess)
    to_guess = guess.reformation / reformation if reformation < math.inf else 1.0
    centre = -guess.exit / (guess.cavity_stretch * to_guess) if ends else 0.0
    central_gap = np.exp(guess.fields(np.array([centre * to_guess]))[0])
    width = np.sqrt(1.0 + central_gap)
    scale = 2.0 ** round(float(np.log2(width).mean()))
    minimum_position = guess.minimum_position / to_guess
    # Along a path the gap must be resolved where its minimum moves to, as far as rounding allows.
    strict = gap_tolerance
    if spread > 0:
        strict = max(SHARE * NEGLIGIBLE * gap_tolerance, min(gap_tolerance, ROUNDING / float(central_gap.min())))
    pressure_scale = 1.0
    if turns_sharply and isinstance(guess, State):  # where no load feels it flux and drag do
        pressure_scale = 1 / min(1.0, max(float(np.abs(guess.fluid_pressure).max()), 1e-100))
    highest, to_exit = highest_degree(order), reference(order).left_end[::-1]
    # At the exit, where the film has one; a rigid guess has no gradient there.
    at_exit = pressure_scale * guess.fields(np.array([np.nextafter(0.0, -1.0)]))[1:].sum() if ends else 0.0
    thickness, memories = getattr(groups.model.solid, "lengths", Lengths())
    sheared = 0.0
    if closed_at is not None and tolerance < COARSE_RTOL and isinstance(guess, State) and float(guess.gap.min()) < closed_at:
        sheared = float(guess.mesh.weights @ (1 / guess.gap))

    def asked(lengths: Array) -> Array:
        """Return a field that panels resolve if they are not longer than allowed: ``lengths`` over that."""
        size = tolerance * np.minimum(lengths, 2.0) ** (order - 1)
        return np.asarray((size[:, None] * highest)[None])

    def fields(x: Array, half_widths: Array, stretch: Array) -> Array:
        flat = x.ravel()
        found = guess.fields(flat * to_guess if ends else flat)
        gap = np.exp(found[0])
        if len(found) == 2:
            fluid = found[1]
        else:
            slopes = groups.speed * (gap - guess.flux_gap) / gap**3
            fluid = slopes * np.repeat(half_widths, x.shape[1])
            if ends and stretch[0, 0] == 1.0:
                fluid = np.where(flat > 0, 0.0, fluid)
        edge_scale = np.minimum(1.0, half_widths / width) ** 0.5
        pressures = (
            width
            / np.repeat(edge_scale, x.shape[1], axis=-1)
            * np.stack([law.pressure(gap), fluid if stretch[0, 0] != 1.0 else pressure_scale * fluid])
        )
        nodal = (*gap.shape[:-1], *x.shape)
        shape = (found[0] - np.log(scale**2 + flat * flat)).reshape(nodal)
        centres = x.mean(axis=1)
        at_centre = np.abs(centres - centre) <= (1 + HALF_DIGITS) * half_widths
        from_minimum = np.abs(centres - minimum_position) - half_widths
        read_off = (at_centre | (from_minimum <= spread)) & (stretch[:, 0] == 1.0)
        weight = max(0.1, tolerance / profile_tolerance)
        parts = tolerance / np.where(from_minimum <= min(spread, NEGLIGIBLE), strict, gap_tolerance)
        shape = shape * np.where(read_off, np.maximum(weight, parts), weight)[..., None]
        shear = (np.exp(-found[0]) * central_gap).reshape(nodal)
        fields = [stretch * pressures.reshape(2, *nodal), shape[None], shear[None]]
        if ends and stretch[0, 0] == 1.0:  # the pressure may turn to that of the cavity in a layer between the last nodes
            before_exit = np.abs(centres + half_widths) <= HALF_DIGITS * half_widths
            missed = np.abs(fields[0][1] @ to_exit - at_exit * width / edge_scale)
            fields.append(((before_exit * missed)[:, None] * highest)[None])
        if fractional and stretch[0, 0] != 1.0:  # what falls off with a broken power is no polynomial in 1/x
            fields[0] /= NEGLIGIBLE
        jumps = jump(gap, fluid) if jump is not None and stretch[0, 0] == 1.0 else None
        if jumps is not None:
            wrong = groups.speed * half_widths * jumps.reshape(x.shape)[:, :-1].max(axis=1) / x.shape[1]
            wrong /= np.fmax(np.abs(fluid).max(), 1e-300)
            fields.append(asked(wrong / error))
        # Beside the place where the last path closes no load feels the gradient, but drag does.
        if sheared and stretch[0, 0] == 1.0:
            full = (flat < 0) | (flat > reformation) if ends else np.ones_like(flat, dtype=bool)
            pressure = fluid if film.uses_pressure else None
            stress = gap * film.at(groups.speed).gradient(gap, pressure, np.array(guess.flux_gap))
            fields.append((np.repeat(half_widths, x.shape[1]) * np.where(full, stress, 0.0) / sheared).reshape(nodal)[None])
        return np.concatenate(fields)

    reach = 8 * scale
    if thickness < math.inf:
        # Beyond the panels in x a layer is felt only where it is pressed, and what it feels falls off with the distance in
        # thicknesses.  The gap turns from that of a half-plane to that of the layer: what a polynomial in the inverse distance
        # misses of the drag falls with the fourth power of the distance.
        decay = -math.log(error) * thickness
        carried = 0.5 * math.sqrt(float(groups.speed) / error)
        dragged = reach * (NEGLIGIBLE * min(1.0, float(central_gap.max())) / error) ** 0.25
        reach = max(reach, min(reach + decay, carried), min(decay, dragged))
    if tolerance < COARSE_RTOL:
        # Beyond it pressures that fall with the third power of the distance are known to no digit beside those of the contact.
        reach = max(reach, plateau, HALF_DIGITS ** (-1 / 3) * scale if fractional else 0.0)
    if memories:  # where the panel through infinity begins, all is forgotten
        reach = max(reach, -math.log(EPSILON) * max(memories))
    places: list[float] = []
    start = guess.mesh if anew and isinstance(guess, State) else None
    if ends:
        places = [0.0] if reformation == math.inf else [0.0, reformation]
        reach = 2 * max(reach, places[-1])
    if ends and start is not None:
        edges = start.edges if start.coarse_edges is None else start.coarse_edges
        start = replace(start, edges=edges / to_guess)
    kinks = centre + groups.model.profile.places
    reach = max([reach, *np.abs(kinks).tolist()])
    if tolerance < COARSE_RTOL:
        about = Mesh(base_edges(scale, reach), order) if start is None else start
        x = np.sort(about.nodes[: -about.order])
        in_cavity = (x > 0) & (x < reformation) & ends
        if fractional or closed_at is not None:
            of_film = kinks_of(guess, film.at(groups.speed), x[~in_cavity] * to_guess, closed_at)
            kinks = np.append(kinks, of_film / to_guess)
        if ends and jump is not None:  # the liquid behind the exit fills the gap up to a kink
            of_liquid = kinks_of(guess, film, x[in_cavity] * to_guess, guess.flux_gap)
            kinks = np.append(kinks, of_liquid / to_guess)
    mesh = adapt(fields, scale, reach, order, tolerance, start, anew, kinks)
    if not ends:
        return mesh
    # Panels that do not halve leave the ends with the error of a coarse state.
    levels = halvings + max(0, round(halvings_for(COARSE_STEP / error)))
    return replace(graded(mesh, places, levels), reformation=reformation, origin=-centre)


def _cavity_on_mesh(guess: Guess) -> float:
    """Return the length of the cavity on a mesh for a guess: the nearest power of two."""
    return 2.0 ** round(math.log2(guess.cavity_stretch * guess.reformation))
