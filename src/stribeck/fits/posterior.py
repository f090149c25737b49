"""The posterior of a fit by the ensemble sampler of emcee, for cases in which intervals of single inputs are not enough.

Flat priors in the logarithms within the bounds, beside those given; where the size of the noise comes from the residuals it is
integrated over with the prior 1/sigma, and errors that were given count larger where the residuals say so, as in intervals.
All walkers are evaluated at once on the atlas.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Annotated, Any

import numpy as np

from stribeck._types import Array
from stribeck.files.results import json_of, ready_for_json
from stribeck.files.writing import need_extra
from stribeck.fits.intervals import information_of
from stribeck.fits.least_squares import Minimum
from stribeck.fits.result import Fit, FittedInput, format_value
from stribeck.quantities.docstrings import Described
from stribeck.quantities.formats import format_percent
from stribeck.quantities.results import table_lines
from stribeck.quantities.units import InputError, checked_count

SEED = 20_261_121
MIN_TIMES = 50  # Autocorrelation times after which emcee's documentation calls a chain long enough


@dataclass(frozen=True, eq=False)
class Posterior(Described):
    """Draws of the fitted inputs."""

    samples: Annotated[Array, "values of the inputs in SI units, or factors, shape (draws, p)"] = field(repr=False)
    interval_68: Annotated[tuple[tuple[float, float], ...], "central intervals of each input"]
    interval_95: Annotated[tuple[tuple[float, float], ...], "central intervals of each input"]
    acceptance: Annotated[float, "part of the steps that were accepted"]
    autocorrelation_time: Annotated[float, "longest integrated autocorrelation time [steps]"]
    converged: Annotated[bool, "whether the chain is longer than 50 of these times"]
    message: Annotated[str, "the same in words"]
    inputs: Annotated[tuple[FittedInput, ...], "the inputs of the fit"] = ()

    def __str__(self) -> str:
        """Return the intervals as a table, and how well they are known."""
        rows = [
            (each.label, *(" to ".join(format_value(each, end) for end in ends) for ends in intervals))
            for each, *intervals in zip(self.inputs, self.interval_68, self.interval_95, strict=True)
        ]
        return "\n".join([*table_lines([("posterior", "68 %", "95 %"), *rows]), self.message])

    def to_dict(self) -> dict[str, Any]:
        """Return intervals by input and how well they are known, ready for JSON."""
        labels = [each.label for each in self.inputs]
        ends = {name: dict(zip(labels, getattr(self, name), strict=True)) for name in ("interval_68", "interval_95")}
        names = "acceptance autocorrelation_time converged message"
        found: dict[str, Any] = ready_for_json(json_of(self, names, draws=len(self.samples), **ends))
        return found


def draw_posterior(fit: Fit, *, steps: int = 2000, on_step: Callable[[int, int], object] | None = None) -> Posterior:
    """Draw from the posterior of a fit whose contact the atlas covers."""
    check_posterior(steps, fit.robust)
    import emcee

    at: Minimum = fit._minimum
    if not fit.converged or not at.objective.states.uses_atlas:
        why = f"The atlas has no table for the law {fit.law} of this contact." if fit.converged else fit.outcome.value
        raise InputError(f"no posterior is drawn. {why}")
    p = len(at.theta)
    walkers = max(16, 4 * p)
    rng = np.random.RandomState(SEED)
    low, high = at.objective.bounds
    width = np.sqrt(np.diag(fit.covariance))
    width = np.where(np.isfinite(width), np.minimum(width, 0.3), 0.3)
    start = at.theta + 0.5 * width * rng.standard_normal((walkers, p))
    start = np.clip(start, low + 1e-6, high - 1e-6)
    sampler = emcee.EnsembleSampler(walkers, p, _log_density(fit), vectorize=True)
    sampler.random_state = rng.get_state()
    for done, _ in enumerate(sampler.sample(start, iterations=steps), 1):
        if on_step is not None:
            on_step(done, steps)
    burnt = steps // 5
    samples = np.exp(sampler.get_chain(discard=burnt, flat=True)) * np.array([free.start for free in at.objective.model.free])
    time = float(np.max(sampler.get_autocorr_time(tol=0, discard=burnt)))
    acceptance = float(np.mean(sampler.acceptance_fraction))
    converged = bool(np.isfinite(time) and steps - burnt >= MIN_TIMES * time)
    ends = [np.quantile(samples, [(1 - level) / 2, (1 + level) / 2], axis=0).T for level in (0.6827, 0.95)]
    how = "converged" if converged else f"did not converge: ask for at least {int(MIN_TIMES * time / 0.8) + 1} steps"
    return Posterior(
        samples=samples,
        interval_68=tuple((float(a), float(b)) for a, b in ends[0]),
        interval_95=tuple((float(a), float(b)) for a, b in ends[1]),
        acceptance=acceptance,
        autocorrelation_time=time,
        converged=converged,
        message=f"The posterior {how} ({walkers} walkers, {steps} steps, autocorrelation time {time:.3g} steps, "
        f"{format_percent(acceptance)} accepted).",
        inputs=fit.inputs,
    )


def check_posterior(steps: int, robust: bool) -> None:
    """Refuse a posterior that cannot be drawn whatever the fit gives."""
    need_extra("a posterior", "fit", "emcee")
    checked_count("steps", steps, 100)
    if robust:
        raise InputError("no posterior is drawn. A robust loss is not a likelihood.")


def _log_density(fit: Fit) -> Callable[[Array], Array]:
    """Return the logarithm of the posterior density of walkers in rows."""
    at: Minimum = fit._minimum
    goal, model = at.objective, at.objective.model
    low, high = goal.bounds
    rows, means = goal.priors
    _, inflation, _ = information_of(at)

    def density(theta: Array) -> Array:
        squares = (goal.misfit(model.read(theta, fit.definition)) ** 2).sum(axis=1)
        likelihood = -0.5 * len(model.data) * np.log(squares) if goal.sigma is None else -0.5 * squares / inflation
        inside = ((theta > low) & (theta < high)).all(axis=1) & np.isfinite(squares)
        return np.where(inside, likelihood - 0.5 * ((theta @ rows.T - means) ** 2).sum(axis=1), -np.inf)

    return density
