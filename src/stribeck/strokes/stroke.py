"""From a contact and a motion to friction and films in time."""

import math
from collections.abc import Callable, Sequence
from dataclasses import replace
from itertools import pairwise
from typing import Any, Literal, TypeAlias, get_args

import numpy as np

from stribeck._types import Array
from stribeck.asperity_friction.coulomb import needs_area
from stribeck.contacts.geometries import LineContact
from stribeck.contacts.groups import Groups
from stribeck.contacts.with_parts import with_parts
from stribeck.equations.operators import Operators
from stribeck.equations.state import State
from stribeck.fluids.fluid import Cavitation
from stribeck.motions.motion import Motion, checked_motion
from stribeck.numerics.panels import Mesh
from stribeck.numerics.settings import COARSE_ORDER, COARSE_RTOL, LEAST_DEGREE, NEGLIGIBLE, SAFETY
from stribeck.numerics.threads import one_blas_thread
from stribeck.quantities.formats import format_si
from stribeck.quantities.outcome import Outcome
from stribeck.quantities.units import InputError, checked_callback, checked_count, checked_word, show
from stribeck.solids.solid import lengths_of
from stribeck.solver.solve import solved_point
from stribeck.solver.solve_error import SolveError, describe
from stribeck.strokes.march import March, StepLost
from stribeck.strokes.result import Stroke

Inlet: TypeAlias = Literal["flooded", "own-wake"]

TOO_THIN = " The wake may be thinner than the gap that asperities hold open, which no film spans: give inlet = 'flooded'."

MIN_STEPS, MAX_STEPS = 16, 100_000  # Steps of a cycle that may be asked for


@one_blas_thread
def stroke(
    contact: LineContact,
    motion: Motion,
    *,
    cycles: int | None = None,
    steps: int = 400,
    inlet: Inlet = "flooded",
    on_step: Callable[[int, int], None] | None = None,
    **parts: Any,
) -> Stroke:
    r"""Solve a stroke, a start or a stop of a line contact in time.

    The film swallows and releases liquid as the gap changes,

    .. math:: \partial_x \left(\tfrac12 U h - \frac{h^3}{12 \eta} p_f'\right) + \partial_t h = 0

    and all else is as in steady sliding, :func:`stribeck.solve`: any fluid, with its own law of flow; a film that ends
    (``cavitation="exit"``) does so where its pressure would fall below the ambient one, on the side that trails.

    Parameters
    ----------
    contact : LineContact
        The contact; its own speed is not used.
    motion : Motion
        The sliding speed over time: ``Sine``, ``Ramp``, ``Stop`` or ``Table`` of :mod:`stribeck.motions`, or a class of yours
        with the members of :class:`stribeck.motions.motion.Motion`.  It begins with the steady state of its first speed, which
        must be above zero.
    cycles : int, optional
        Times that a motion which repeats is done, 2 by default: the first one still knows how it began.
    steps : int
        Steps of a cycle, even, from 16 to 100000.
    inlet : {"flooded", "own-wake"}
        Whether there is always enough liquid before the contact, or after a reversal what it has left behind itself; the
        latter needs a film that ends.
    on_step : callable, optional
        ``on_step(done, steps)`` is called after each step, for progress.
    **parts
        ``cavitation``, ``solid``, ``profile`` and ``law`` as in :class:`stribeck.LineContact`, in the place of its own.

    Returns
    -------
    Stroke
        Over time: speed, position, friction and its parts, share of asperities, films, with errors; work of a cycle.

    Raises
    ------
    InputError
        If an argument is outside its range, or the model has what is not solved in time: a film that re-forms, a ball, bodies
        that remember, smooth surfaces.
    SolveError
        If a step or the first state fails.

    Notes
    -----
    With ``inlet="own-wake"`` the liquid that passes the edges of the dry contact is counted.  What has passed the trailing one
    stays on the surface where it passed, until the contact comes back; of that no more is drawn in, and what is not is pushed
    ahead.  A starved film begins where it draws in what arrives.  Surface that the contact has not passed is flooded.

    Errors are those of time steps and mesh: twice the largest difference
    nearby from a march with half of the steps and fewer nodes; they cover the difference from one with four times the
    steps at 95 % of instants (``tests/test_strokes.py``).  A slow stroke tends to the row of steady states as the inverse
    of its length.

    Source: theory.md, Eqs. (1)-(5), with the squeeze term of Reynolds' equation; strokes.md.

    Examples
    --------
    >>> import stribeck as sb
    >>> contact = sb.LineContact(
    ...     radius="20 mm", modulus="2 MPa", load="100 N/m", viscosity="10 mPa*s", speed="0.1 m/s", roughness="2 um",
    ...     boundary_friction=0.5, alpha=1.0, beta=1.0,
    ... )
    >>> found = sb.stroke(contact, sb.motions.Sine(stroke="20 mm", frequency="1 1/s"), cycles=1, steps=40)
    >>> bool(found.largest_contact_load_share < 1)
    True
    """
    contact = _checked_contact(with_parts(contact, **parts) if parts else contact)
    checked_callback("on_step", on_step)
    checked_word("inlet", inlet, get_args(Inlet))
    motion = checked_motion(motion)
    count = _checked_cycles(motion, cycles)
    if isinstance(steps, bool) or not isinstance(steps, int) or steps % 2 or not MIN_STEPS <= steps <= MAX_STEPS:
        raise InputError(f"steps = {show(steps)}; it must be an even number from {MIN_STEPS} to {MAX_STEPS}.")
    first, one = float(motion.speed(np.zeros(1))[0]), motion.times(steps)
    largest = float(np.abs(motion.speed(one)).max())
    if not first > 0:
        raise InputError(
            f"the motion begins with the speed {first:g} m/s; it must begin with a speed above zero, whose steady film is "
            "there at the start. Begin a start from rest with a slow speed; turn a motion that begins on the way back, and "
            "with it the profile (reversed=True)."
        )
    contact = contact.replace(speed=largest)
    groups = contact.groups
    _check_model(groups, inlet)
    time = np.concatenate([[0.0], *(one[1:] + k * motion.duration for k in range(count))])
    unit = 2 * contact.hertz.half_width / largest
    within = np.concatenate([one, *([one[1:]] * (count - 1))])
    speed = np.asarray(motion.speed(within), dtype=float)
    path = np.asarray(motion.position(within), dtype=float)

    advance = float(np.ptp(motion.position(np.array([0.0, motion.duration]))))

    def moving(t: float) -> tuple[float, float]:
        # The end of a cycle is told from the start of the next, which rounding may take for one another.
        inside = t * unit
        passed = min(np.floor(inside / motion.duration), count - 1)
        at = np.clip(np.array([inside - motion.duration * passed]), 0.0, motion.duration)
        place = motion.position(at)[0] + passed * advance
        return float(motion.speed(at)[0] / largest), float(place / contact.hertz.half_width)

    total = len(time) - 1 + (len(time) - 1) // 2
    states = _states(groups, first / largest)
    ends = groups.model.cavitation is Cavitation.EXIT
    model = replace(groups.model, cavitation=Cavitation.NONE)  # The mesh of a stroke is that of a full film
    marches = []
    done = 0
    for order, instants in ((COARSE_ORDER, time), (LEAST_DEGREE + 1, time[::2])):
        operators = Operators(shared_mesh(states, order), model)
        march = March(operators, groups, ends, needs_area(contact.friction_of_asperities), inlet == "own-wake")
        before = done

        def note(k: int, before: int = before) -> None:
            if on_step is not None:
                on_step(before + k, total)

        try:
            marches.append(march.over(states[0], instants / unit, moving, note))
        except StepLost as lost:
            raise SolveError(
                Outcome.STALLED,
                None,
                f"{describe(groups)}: the step from t = {lost.time * unit:.4g} s does not arrive, however short. Ask "
                f"for more steps, or for a motion whose speed changes more slowly.{TOO_THIN if inlet == 'own-wake' else ''}",
            ) from None
        done += len(instants) - 1
    return _result(contact, motion, inlet, count, time, speed, path, marches)


def _checked_contact(contact: Any) -> LineContact:
    """Return a line contact, or refuse what is none."""
    if not isinstance(contact, LineContact):
        raise InputError(
            f"contact = {show(contact)}; strokes are solved of a LineContact: not of balls, nor of groups, which know no time."
        )
    return contact


def _check_model(groups: Groups, inlet: Inlet) -> None:
    """Refuse by name what is not solved in time."""
    model = groups.model
    if model.cavitation is Cavitation.REFORM:
        raise InputError(
            "cavitation = 'reform': strokes are solved of films that end at ambient pressure, cavitation = 'exit', or that "
            "never end, 'none': a cavity that closes again behind the contact would have an edge more."
        )
    if inlet == "own-wake" and model.cavitation is Cavitation.NONE:
        raise InputError(
            "inlet = 'own-wake' needs a film that ends, cavitation = 'exit': a full film has liquid everywhere, and no wake."
        )
    if model.film.slide != 1.0:
        raise InputError("slide_to_roll: strokes are solved in pure sliding, slide_to_roll = 2.")
    if lengths_of(model.solid).memories or getattr(model.solid, "uses_speed", False):
        raise InputError(
            f"solid = {model.solid.name}: the body remembers the pressure that has passed; strokes are solved of bodies "
            "without memory."
        )
    if groups.roughness == 0:
        raise InputError("roughness is zero: smooth surfaces touch where the speed turns; give a small roughness.")


def _checked_cycles(motion: Motion, cycles: int | None) -> int:
    """Return how often a motion is done."""
    if cycles is None:
        return 2 if motion.repeats else 1
    checked_count("cycles", cycles, 1)
    if cycles > 1 and not motion.repeats:
        raise InputError(f"cycles = {cycles}: a {type(motion).__name__} does not end as it begins; leave cycles out.")
    return cycles


def _states(groups: Groups, first: float) -> list[State]:
    """Return steady states of the first and of slower speeds, whose meshes the stroke shares."""
    found = []
    for part in (first, 1.0, NEGLIGIBLE, NEGLIGIBLE**2):
        state = solved_point(replace(groups, speed=groups.speed * part), COARSE_RTOL).state
        if state is None:
            raise SolveError(Outcome.PATH_LOST, None, f"{describe(groups)}: {Outcome.PATH_LOST.value}")
        found.append(state)
    return found


def _result(
    contact: LineContact,
    motion: Motion,
    inlet: Inlet,
    cycles: int,
    time: Array,
    speed: Array,
    path: Array,
    marches: list[Array],
) -> Stroke:
    """Return two marches as a result in SI units: the first one, and its difference from the second."""
    scales = contact.hertz
    fine, coarse = (
        _columns(rows, v, _rubbing(contact, v), contact.beta, scales.indentation, 0.5 * contact.speed * scales.indentation)
        for rows, v in zip(marches, (speed, speed[::2]), strict=True)
    )
    errors = {name: _error(fine[name], coarse[name]) for name in fine}
    last = (len(time) - 1) // cycles
    work, coarse_work = (
        contact.load * float(np.trapezoid((values["friction"] * v)[-n - 1 :], t[-n - 1 :]))
        for values, v, t, n in ((fine, speed, time, last), (coarse, speed[::2], time[::2], last // 2))
    )
    return Stroke(
        contact=contact,
        motion=motion,
        cycles=cycles,
        hertz_half_width=scales.half_width,
        time=time,
        speed=speed,
        position=path,
        **fine,
        errors=errors,
        work=work,
        work_error=SAFETY * abs(work - coarse_work),
        notes=_notes(contact, inlet),
    )


def _notes(contact: LineContact, inlet: Inlet) -> tuple[str, ...]:
    """Return how the film ends and is fed, and how asperities rub where it is not known."""
    ends = contact.groups.model.cavitation is Cavitation.EXIT
    end = (
        "The film ends where its pressure would fall below the ambient one"
        if ends
        else "The film is full: it holds any suction"
    )
    fed = "has what the contact has left behind itself" if inlet == "own-wake" else "is flooded, after a reversal too"
    notes = [f"{end}; its inlet {fed}."]
    slowest = contact.friction_of_asperities.known_speeds[0]
    if slowest > 0:
        notes.append(f"Slower than {format_si(slowest, 'speed')} the shear stress is the first one of its table.")
    return tuple(notes)


def _rubbing(contact: LineContact, speed: Array) -> Array:
    """Return the factor on load or area of the asperities at each speed."""
    friction, sliding = contact.friction_of_asperities, np.abs(speed)
    # Where the body rests the factor does not count; it may be infinite there.
    return friction.factors(contact, np.maximum(sliding, max(sliding[sliding > 0].min(), friction.known_speeds[0])))


def _columns(rows: Array, speed: Array, rubbing: Array, beta: float, indentation: float, flow: float) -> dict[str, Array]:
    """Return the numbers of a march by name, in SI units."""
    share, amount, viscous, central, minimum, left, right = rows.T
    asperities, fluid = rubbing * np.sign(speed) * amount, beta * viscous
    return {
        "friction": asperities + fluid,
        "friction_asperities": asperities,
        "friction_fluid": fluid,
        "contact_load_share": share,
        "central_film_thickness": central * indentation,
        "minimum_film_thickness": minimum * indentation,
        "left_flow": left * flow,
        "right_flow": right * flow,
    }


def _error(fine: Array, coarse: Array) -> Array:
    """Return the difference of two marches, the largest nearby: where it passes zero both err alike."""
    known = SAFETY * np.abs(fine[::2] - coarse)
    # A step takes from two instants before it, so that errors reach over two on either side.
    padded = np.pad(known, 2, mode="edge")
    widest = np.max([padded[k : k + len(known)] for k in range(5)], axis=0)
    found = np.empty_like(fine)
    found[::2] = widest
    found[1::2] = np.maximum(widest[:-1], widest[1:])
    return found


def shared_mesh(states: Sequence[State], order: int) -> Mesh:
    """Return a mesh that is as fine as those of several states and their mirror images, which shares its places with them."""
    known = [state.mesh.edges + state.exit for state in states]
    reach = max(float(edges[-1]) for edges in known)
    sides = [np.sort(sign * edges) for edges in known for sign in (1.0, -1.0)]
    ends = np.unique([x for edges in sides for x in edges if 0 < x < reach])
    ends = np.concatenate([[0.0], ends, [reach]])
    # Panels for a length, between one edge and the next: as many as the finest mesh has there.
    middles = 0.5 * (ends[1:] + ends[:-1])
    finest = np.full(middles.size, math.inf)
    for edges in sides:
        row = np.searchsorted(edges, middles)
        inside = (row > 0) & (row < len(edges))
        finest[inside] = np.fmin(finest[inside], np.diff(edges)[row[inside] - 1])
    count = np.append(0.0, np.cumsum(np.diff(ends) / finest))
    model = states[0].groups.model
    places = np.unique(np.abs(model.profile.places))
    found = [0.0]
    for start, end in pairwise(np.interp([0.0, *places[(places > 0) & (places < reach)], reach], ends, count)):
        found.extend(np.interp(np.linspace(start, end, math.ceil(end - start) + 1)[1:], count, ends))
    positive = np.array(found)
    return Mesh(np.append(-positive[:0:-1], positive), order, states[0].mesh.scale)
