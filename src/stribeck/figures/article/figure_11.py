"""Figure 11: the regimes over speed, load and roughness as solved, and the formulas for their ends, printed and corrected."""

from __future__ import annotations

from stribeck.figures import style
from stribeck.figures.job import FigureJob
from stribeck.figures.style import DataArray, Dataset, Figure
from stribeck.plot.phase_diagram import draw_phase_diagram, draw_phase_space
from stribeck.quantities.outcome import Outcome
from stribeck.regimes.phase_diagram import phase_diagram
from stribeck.solver.solve_error import SolveError

TITLE = "Regimes over speed, load and roughness"
CLAIM = (
    "three regimes follow one another with speed; the formulas for both transitions separate them, and their lines "
    "merge at large roughness."
)
SIZE = 13.0, 6.6

LOADS = (0.01, 0.1)  # Load groups: the back and the front of the paper.

ROUGHNESSES = (1e-6, 1e-5, 1e-4, 1e-3, 3e-3, 1e-2, 3e-2)  # Roughness groups, denser where the lines meet.

SPEED_RANGE = 1e-9, 1e2  # Speed groups of the curves.
CURVE_RTOL = 1e-6  # Relative tolerance of the curves.

MAX_COMPARED_ROUGHNESS = 1e-3  # Roughness group up to which the lines are far enough apart to be compared with formulas.

MERGING_FIELDS = ("roughness_without_minimum", "formula_roughness_without_minimum")


def compute(work: FigureJob) -> Dataset:
    """Solve the phase diagram."""
    found = phase_diagram(
        load=LOADS,
        roughness=ROUGHNESSES,
        speed=SPEED_RANGE,
        points={"load": 2, "speed": 34},
        rtol=CURVE_RTOL,
        definition="published",
        merging=True,
        on_point=work.report,
    )
    if found.attrs["outcome"] == Outcome.INTERRUPTED.value:
        raise KeyboardInterrupt
    if not found.attrs["complete"]:
        reasons = {text for text in found.message.values.ravel() if text}
        raise SolveError(Outcome.PATH_LOST, None, " ".join(sorted(reasons)) or found.attrs["outcome"])
    attributes = {
        name: found.attrs[name] for name in ("rtol", "boundary_friction", "beta", "definition", "complete", "outcome")
    }
    attributes |= {"error_estimate": float(found.error_estimate.max()), "finding": _finding(found)}
    found = found.drop_vars(["message", "outcome"])
    found.attrs = attributes
    return found


def _finding(data: Dataset) -> str:
    smooth = data.sel(roughness=slice(None, MAX_COMPARED_ROUGHNESS))
    corrected, printed = (
        smooth[f"{name}_speed_boundary_to_mixed"] / smooth.speed_at_5_percent_fluid for name in ("formula", "printed")
    )
    half = smooth.formula_speed_boundary_to_mixed / smooth.speed_at_half_fluid
    minimum, ours = (smooth[f"{name}_speed_at_minimum"] / smooth.speed_at_minimum for name in ("printed", "formula"))
    five = smooth.formula_speed_at_5_percent_fluid / smooth.speed_at_5_percent_fluid
    off = 100 * max(float(abs(ratio - 1).max()) for ratio in (ours, five))
    merging, formula = (", ".join(f"{value:.2g}" for value in data[name].values) for name in MERGING_FIELDS)
    finding = (
        f"up to roughness {MAX_COMPARED_ROUGHNESS:g} the criterion of the paper, with phi corrected, gives "
        f"{_span(corrected)} times the "
        f"speed at which the fluid carries 5 % of the load and {_span(half)} times that of one half; as printed "
        f"{_span(printed)} times the former, deep in the boundary regime. The printed speed of minimum friction is "
        f"{_span(minimum)} times the solved; our formulas for the 5 % and the minimum are within {off:.0f} %. Falling "
        f"friction ends at roughness {merging} for loads {LOADS[0]}, {LOADS[1]}, by our formula at {formula}."
    )
    return finding


def _span(ratio: DataArray) -> str:
    return f"{float(ratio.min()):.2g} to {float(ratio.max()):.2g}"


def draw(figure: Figure, data: Dataset) -> None:
    """Draw the space of states and a plane of it for each load."""
    grid = figure.add_gridspec(2, 2, width_ratios=[1.35, 1], height_ratios=[1, 1])
    space = figure.add_subplot(grid[:, 0], projection="3d")
    draw_phase_space(space, data)
    space.set_title("front: load 0.1, back: load 0.01; full lines and surfaces solved", loc="left", size=9.5, color=style.INK)
    for row, load in enumerate((LOADS[1], LOADS[0])):
        axes = figure.add_subplot(grid[row, 1])
        style.house_style(axes)
        draw_phase_diagram(axes, data, load)
        style.panel(axes, "+", f"load {load:g}, with what the paper prints")
    space.set_box_aspect((1.5, 1.1, 0.95), zoom=1.04)
    handles, labels = figure.axes[1].get_legend_handles_labels()
    # Our formulas have one style and one label for three lines.
    unique = dict(zip(labels, handles, strict=True))
    style.small_legend(space, handles=list(unique.values()), labels=list(unique), loc="upper left", ncols=2)
