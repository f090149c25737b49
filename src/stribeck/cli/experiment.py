"""The command ``stribeck experiment``: a folder of a published experiment in, measured over predicted out."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

from stribeck.cli.arguments import Verbose
from stribeck.cli.exits import answer
from stribeck.cli.progress import interruptible
from stribeck.quantities.formats import format_percent
from stribeck.quantities.units import checked_word

if TYPE_CHECKING:
    from stribeck.experiments.experiment import Experiment, Prediction


def experiment_command(
    folder: Path,
    /,
    *,
    model: str | None = None,
    verbose: Verbose = False,
    json: bool = False,
) -> int:
    """Predict a published experiment without a fit and report measured over predicted, the model's error first.

    Example: stribeck experiment tests/data/experiments/oring

    The folder holds experiment.toml, in which every input has a value, an error and a source, and a table of what was
    measured.  --model predicts by one of its models instead of all.
    """
    from stribeck.experiments.experiment import load_experiment, predict_experiment

    experiment = load_experiment(folder)
    names = list(experiment.models) if model is None else [checked_word("model", model, experiment.models)]
    with interruptible() as progress:
        found = [predict_experiment(experiment, name, progress) for name in names]
    answer(json, lambda: _content(experiment, found), lambda: _lines(experiment, found, verbose))
    return 0


def _content(experiment: Experiment, found: list[Prediction]) -> dict[str, Any]:
    numbers = ("predicted", "predicted_error", "measured", "measured_error", "ratio", "ratio_error", "agrees")
    models = {each.model: {name: getattr(each, name).tolist() for name in numbers} for each in found}
    about = {name: getattr(experiment, name) for name in ("title", "source", "licence", "relative_to")}
    return about | {"unknown": list(experiment.unknown), "rows": list(experiment.labels), "models": models}


def _lines(experiment: Experiment, found: list[Prediction], verbose: bool) -> Iterator[str]:
    """Yield each model's answer, then what is not known, and with all the inputs and their sources."""
    for each in found:
        yield str(each)
    yield from (f"Not known: {sentence}" for sentence in experiment.unknown)
    yield f"{experiment.title}. Source: {experiment.source} ({experiment.licence})."
    if not verbose:
        yield "-v shows every input with its error and source."
        return
    for stated in dict.fromkeys(stated for each in found for stated in experiment.inputs[each.model]):
        error = "error not known" if stated.error is None else f"± {format_percent(stated.error)}"
        yield f"{stated.name} = {stated.value} {error}: {stated.source}"
