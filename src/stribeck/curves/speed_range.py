"""Where a Stribeck curve begins and ends: the speeds of the boundary plateau and of the hydrodynamic branch."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from stribeck.contacts.groups import contact_law
from stribeck.contacts.line import Groups
from stribeck.contacts.model import ARTICLE
from stribeck.equations.guess import Guess
from stribeck.equations.line import Operators
from stribeck.equations.observables import observables
from stribeck.equations.prediction import extrapolate
from stribeck.equations.state import State, mesh_for, solve_state
from stribeck.numerics.continuation import Steps, march
from stribeck.numerics.panels import MeshTooLargeError
from stribeck.quantities.outcome import Outcome
from stribeck.solver.cold_start import MESH_TOLERANCE, NEWTON_TOLERANCE, ORDER, rigid_guess
from stribeck.solver.solve import SolveError, describe

FASTEST = 1e3
"""Speed group from which the branch is looked for; its film is the rigid one."""

MIN_SPEED = 1e-12
"""Speed group below which no curve begins by itself."""

PLATEAU = 1e-3
"""Change of the fluid's share of the load over a decade of speed below which it is a plateau."""

BRANCH = 1e-2
"""Part of the friction from asperities below which the branch is hydrodynamic."""

MARGIN = 10.0
"""Factor by which the curve goes on beyond plateau and branch."""


def automatic_speed_range(groups: Groups, boundary_friction: float, beta: float, definition: str) -> tuple[float, float]:
    """Return the speed groups from boundary plateau to hydrodynamic branch for the load and roughness of ``groups``.

    They are found on coarse states that come down in speed from the rigid film, with the fluid and the solid of the article:
    other parts change what the film carries by less than the margin.  Smooth surfaces have no plateau: their curve covers ten
    decades up to speed 10.
    """
    groups = replace(groups, model=ARTICLE)
    kappa = float(groups.relative_roughness)
    if kappa == 0:
        return 1e-9, 10.0
    top = math.log(max(FASTEST, (30 * min(kappa, 1e100)) ** 1.5 * math.sqrt(24)))
    plateau = False

    def correct(s: float, history: Sequence[tuple[float, State]]) -> State | None:
        here = replace(groups, speed=math.exp(-s))
        guess: Guess | None = rigid_guess(here) if not history else extrapolate(history, s)
        if guess is None:
            return None
        try:
            mesh = mesh_for(guess, here, contact_law(here), ORDER, MESH_TOLERANCE)
        except MeshTooLargeError:
            return None
        return solve_state(here, Operators(mesh, here.model), guess, NEWTON_TOLERANCE)

    shares: list[tuple[float, float, float]] = []

    def record(s: float, state: State) -> None:
        nonlocal plateau
        values = observables(state.equations, state.y, float(groups.load))
        viscous = beta * float(getattr(values, f"viscous_{definition}"))
        contact = boundary_friction * values.contact_load_share
        shares.append((-s, values.fluid_load_share, contact / max(contact + viscous, 1e-300)))
        if len(shares) > 1:
            (s0, f0, _), (s1, f1, _) = shares[-2:]
            plateau = abs(f1 - f0) < PLATEAU * (s0 - s1) / math.log(10) and values.contact_load_share > 0.1

    path = march(
        correct,
        -top,
        -math.log(MIN_SPEED),
        Steps(0.5, math.log(10), 1e-3),
        stop_when=lambda state: plateau,
        on_point=record,
    )
    if path.outcome is Outcome.INTERRUPTED:
        raise KeyboardInterrupt
    if not shares:
        raise SolveError(
            path.outcome, None, f"{describe(groups)}: no starting speed was found for the curve; give a range of speeds."
        )
    low = max(MIN_SPEED, math.exp(shares[-1][0]) / MARGIN)
    contact_part = np.array([part for _, _, part in shares])
    on_branch = np.nonzero(contact_part < BRANCH)[0]
    high = math.exp(shares[int(on_branch[-1])][0]) if len(on_branch) else math.exp(top)
    return low, MARGIN * high
