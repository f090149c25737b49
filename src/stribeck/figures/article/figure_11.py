"""Figure 11: the regimes over speed, load and roughness as solved, and the formulas for their ends, printed and corrected."""

from typing import Any

from stribeck.figures import style
from stribeck.figures.job import FigureJob
from stribeck.figures.style import DataArray, Dataset, Panels
from stribeck.plot.phase_diagram import draw_phase_diagram, draw_phase_space
from stribeck.quantities.outcome import Outcome
from stribeck.regimes.phase_diagram import phase_diagram
from stribeck.solver.solve_error import SolveError

LOADS = (0.01, 0.1)  # Load groups: the back and the front of the paper.
ROUGHNESSES = (1e-6, 1e-5, 1e-4, 1e-3, 3e-3, 1e-2, 3e-2)  # Roughness groups, denser where the lines meet.
SPEED_RANGE = 1e-9, 1e2  # Speed groups of the curves.
MAX_COMPARED_ROUGHNESS = 1e-3  # Roughness group up to which the lines are far enough apart to be compared with formulas.

KEPT_ATTRIBUTES = ("rtol", "boundary_friction", "beta", "definition", "complete", "outcome")


def compute(work: FigureJob) -> Dataset:
    """Solve the phase diagram."""
    found = phase_diagram(
        load=LOADS,
        roughness=ROUGHNESSES,
        speed=SPEED_RANGE,
        points={"load": 2, "speed": 34},
        rtol=work.rtol,
        definition="published",
        merging=True,
        on_point=work.report,
    )
    if found.attrs["outcome"] == Outcome.INTERRUPTED.value:
        raise KeyboardInterrupt
    if not found.attrs["complete"]:
        reasons = {text for text in found.message.values.ravel() if text}
        raise SolveError(Outcome.PATH_LOST, None, " ".join(sorted(reasons)) or found.attrs["outcome"])
    smooth = found.sel(roughness=slice(None, MAX_COMPARED_ROUGHNESS))
    five = smooth.formula_speed_at_5_percent_fluid / smooth.speed_at_5_percent_fluid
    minimum = smooth.formula_speed_at_minimum / smooth.speed_at_minimum
    finding = work.finding(
        roughness=MAX_COMPARED_ROUGHNESS,
        corrected=_span(smooth.formula_speed_boundary_to_mixed / smooth.speed_at_5_percent_fluid),
        half=_span(smooth.formula_speed_boundary_to_mixed / smooth.speed_at_half_fluid),
        printed=_span(smooth.printed_speed_boundary_to_mixed / smooth.speed_at_5_percent_fluid),
        minimum=_span(smooth.printed_speed_at_minimum / smooth.speed_at_minimum),
        off=max(float(abs(ratio - 1).max()) for ratio in (minimum, five)),
        load=LOADS,
        merging=found.roughness_without_minimum.values,
        formula=found.formula_roughness_without_minimum.values,
    )
    attributes = {name: found.attrs[name] for name in KEPT_ATTRIBUTES}
    attributes |= {"error_estimate": float(found.error_estimate.max()), "finding": finding}
    found = found.drop_vars(["message", "outcome"])
    found.attrs = attributes
    return found


def _span(ratio: DataArray) -> str:
    return f"{float(ratio.min()):.2g} to {float(ratio.max()):.2g}"


def draw(panels: Panels, data: Dataset) -> None:
    """Draw the space of states and a plane of it for each load."""
    space: Any = panels["space"]
    draw_phase_space(space, data)
    space.set_title("front: load 0.1, back: load 0.01; full lines and surfaces solved", loc="left", size=9.5, color=style.INK)
    space.set_box_aspect((1.5, 1.1, 0.95), zoom=1.04)
    for name, load in zip(("back", "front"), LOADS, strict=True):
        draw_phase_diagram(panels[name], data, load)
    handles, labels = panels["front"].get_legend_handles_labels()
    # Our formulas have one style and one label for three lines.
    unique = dict(zip(labels, handles, strict=True))
    style.small_legend(space, handles=list(unique.values()), labels=list(unique), loc="upper left", ncols=2)
