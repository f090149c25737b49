"""Where a Stribeck curve begins and ends: the speeds of the boundary plateau and of the hydrodynamic branch."""

import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np

from stribeck._types import Array
from stribeck.asymptotics import hydrodynamic
from stribeck.contacts.friction import Definition, friction_share
from stribeck.contacts.groups import BASE_MODEL, Groups, contact_law
from stribeck.equations.observables import ROW
from stribeck.equations.operators import LOAD
from stribeck.numerics.continuation import follow
from stribeck.numerics.dual import Dual
from stribeck.numerics.events import first_zero
from stribeck.quantities.outcome import Outcome
from stribeck.solids import hertz
from stribeck.solver.neighbours import Neighbours
from stribeck.solver.path.hermite_path import HermitePath, Knot
from stribeck.solver.path.line_knots import LineKnots
from stribeck.solver.path.line_path import LineProblem
from stribeck.solver.path.path import Expansion, SolvedPath
from stribeck.solver.point.solution import solution_of
from stribeck.solver.point.state import PointState
from stribeck.solver.solve_error import SolveError, describe

SPEEDS = (1e-12, 1e12)  # Smallest and largest speed group of a curve that chooses its own range
SMOOTH = (1e-9, 10.0)  # Speed groups of curves of smooth surfaces, which have no plateau

PLATEAU = 1e-3  # Change of the fluid's share of the load over a decade of speed below which it is a plateau
# Part of the friction from asperities at which the branch is hydrodynamic; on the plateau ten times as much may be the fluid's
BRANCH = 1e-2

BELOW, BEYOND = 10.0, 30.0  # Factors by which the curve extends below the first state on the plateau, and beyond the branch

BALL_SPEEDS = (1e-8, 1e3)  # Speed groups between which a curve of a ball chooses its own range
BALL_RTOL = 1e-3  # Tolerance of the states on which that is found

LONGEST_EXTENSION = 2  # Most extensions of a curve whose fast end is not hydrodynamic yet

COARSE = 2e-4  # Tolerance of a curve that is followed for its ends alone
LOCATED = 1e-6  # Tolerance of the start of the plateau, in the logarithm of the speed

REACH, PLACES = 8.0, 161  # Half-widths within which asperities count, of a contact that the film widens, and places there


def fastest(groups: Groups, boundary_friction: float, beta: float) -> float:
    """Return the speed group up to which a curve runs, by the smooth film and the asperities that still touch at it."""
    law = contact_law(groups)
    x = np.linspace(-REACH, REACH, PLACES)

    def above(log_speed: float) -> float:
        film = replace(groups, speed=math.exp(log_speed), roughness=0.0, model=BASE_MODEL, law=None)
        gap = float(hydrodynamic.central_gap.function(film))
        wide = x * math.sqrt(1 + gap)
        pressure = law.pressure(gap + hertz.gap(wide))
        share = 0.5 * (pressure[1:] + pressure[:-1]) @ np.diff(wide) / LOAD
        contact = (boundary_friction or 1.0) * min(1.0, float(share))
        return contact / (contact + float(hydrodynamic.friction.function(film, beta)) + 1e-300) - BRANCH

    ends = np.log(SPEEDS)
    values = np.array([above(end) for end in ends.tolist()])
    event = first_zero(above, ends, values, LOCATED)
    return BEYOND * math.exp(ends[int(values[-1] > 0)] if event is None else event.place)


def grown(
    problem: LineProblem | LineKnots,
    start: float,
    bottom: float,
    contact_part: Callable[[Array], float],
    on_interval: Callable[[float, float], object] | None = None,
) -> tuple[SolvedPath | HermitePath, float]:
    """Return a path from the hydrodynamic branch down to the boundary plateau, and its lower end, found on the way."""
    share = ROW["fluid_load_share"]

    def height(slope: float, row: Array) -> float:
        """Return how far a state is above the plateau, negative on it."""
        return max(abs(slope) * math.log(10) - PLATEAU, 1 - 10 * BRANCH - contact_part(row))

    def of_state(here: Expansion | Knot) -> float:
        return height(float(here.slopes[share]), here.values)

    def at(s: float) -> float:
        found = path.smooth(Dual(np.array([s]), np.ones(1)))
        return height(float(found.slope[0, share]), found.value[0])

    path = follow(problem, start, bottom, problem.tolerance, on_interval, until=lambda path: of_state(path.expansions[0]) < 0)
    if not path.outcome.ok:
        return path, float(path.coordinates[0]) if path.expansions else math.nan
    event = first_zero(at, path.coordinates, np.array([of_state(each) for each in path.expansions]), LOCATED)
    below = float(path.coordinates[0]) if event is None else event.place
    margin = math.log(BELOW)
    low = max(bottom, below - margin)
    if low < path.coordinates[0]:
        path = follow(problem, path, low, problem.tolerance, on_interval)
    for _ in range(LONGEST_EXTENSION):
        if not path.outcome.ok or contact_part(path.expansions[-1].values) < 0.1 * BRANCH:
            break
        end = float(path.coordinates[-1]) + margin
        path = follow(problem, path, end, problem.tolerance, on_interval)
    return path, max(low, float(path.coordinates[0]))


def part_of_contact(boundary_friction: float, beta: float, definition: Definition) -> Callable[[Array], float]:
    """Return the function that takes a row of observables to the part of the friction caused by asperities."""

    def part(row: Array) -> float:
        contact = (boundary_friction or 1.0) * float(row[ROW["contact_load_share"]])
        return float(friction_share(contact, beta * float(row[ROW[f"viscous_{definition}"]])))

    return part


def no_range(outcome: Outcome, groups: Groups) -> SolveError:
    """Return the error for a curve without a first state."""
    return SolveError(outcome, None, f"{describe(groups)}: no starting speed was found for the curve; give a range of speeds.")


def automatic_speed_range(
    groups: Groups, boundary_friction: float, beta: float, definition: Definition
) -> tuple[float, float]:
    """Return the speed groups from plateau to hydrodynamic branch, of a coarse curve with the model of the article."""
    if groups.geometry == "point":
        return _speeds_of_ball(groups, boundary_friction, beta, definition)
    groups = replace(groups, model=BASE_MODEL)
    if groups.roughness == 0:
        return SMOOTH
    problem = LineProblem(lambda s: replace(groups, speed=math.exp(s)), (1.0, 0.0, 0.0), COARSE)
    top = math.log(fastest(groups, boundary_friction, beta))
    path, lowest = grown(problem, top, math.log(SPEEDS[0]), part_of_contact(boundary_friction, beta, definition))
    if path.outcome is Outcome.INTERRUPTED:
        raise KeyboardInterrupt
    if not path.expansions:
        raise no_range(path.outcome, groups)
    return math.exp(lowest), math.exp(float(path.coordinates[-1]))


def _speeds_of_ball(groups: Groups, boundary_friction: float, beta: float, definition: Definition) -> tuple[float, float]:
    """Return the speed groups from the boundary plateau of a ball to its hydrodynamic branch, by states a decade apart."""
    kappa = float(groups.relative_roughness)
    if kappa == 0:
        return BALL_SPEEDS[0], 10.0
    # From where the smooth film is thirty times the roughness, or from the first below that is solved.
    neighbours = Neighbours(BALL_RTOL)
    highest, low, share = BALL_SPEEDS[1], min(BALL_SPEEDS[1], max(1e-6, (30 * kappa / 0.42) ** (1 / 0.6))), None
    high = low

    def contact_part(state: PointState) -> float:
        return solution_of(state, None).friction(boundary_friction, beta, definition).contact_share

    while low > BALL_SPEEDS[0]:
        state = neighbours.at(replace(groups, speed=low))
        if not state.outcome.ok:
            if share is not None:  # slower ones are not solved
                low *= 10
                break
            highest = low = high = low / 10
            continue
        if contact_part(state) < BRANCH:
            high = low
        found = float(state.values["fluid_load_share"])
        if share is not None and abs(share - found) < PLATEAU and state.values["contact_load_share"] > 0.1:
            break
        share, low = found, low / 10
    return max(low, BALL_SPEEDS[0]), min(10 * high, highest)
