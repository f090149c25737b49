r"""Residuals of measured friction in units of their error, and the minimum of what a fit makes of them by least squares.

With :math:`r_i` the residual of a row over its standard error and priors normal in the logarithms,

.. math:: q(\theta) = \sum_i \rho(r_i) + \sum_k \left(\frac{\theta_k - m_k}{\tau_k}\right)^2

where :math:`\rho(r) = r^2`, or for outliers :math:`c^2 \ln(1 + r^2/c^2)` with c = 2.385, which loses 5 % of the information
where errors are normal (Holland and Welsch, Commun. Stat. A 6 (1977) 813).  Where no errors are known, the
size of the noise comes from the residuals.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from stribeck._types import Array, Flags, Indices
from stribeck.cases.fit_settings import FitSettings
from stribeck.fits.measurements import error_of
from stribeck.fits.model import FrictionModel, Prediction
from stribeck.fits.states import States
from stribeck.quantities.units import InputError
from stribeck.solver.solve_error import SolveError

CAUCHY = 2.385  # Constant c of the robust loss, in standard errors


@dataclass(frozen=True)
class Objective:
    """What a fit minimises, for states from one source and one scale of the noise."""

    model: FrictionModel  # Predicts the friction of the rows
    states: States
    sigma: Array | None
    logarithmic: bool  # Whether residuals are of the logarithm of friction
    robust: bool  # Whether the loss is the robust one
    # Relative and absolute part of sigma where it has both: those of measured friction would favour rows that noise made low.
    errors: tuple[float, float] | None = None
    scale: float = 1.0  # What the residuals are divided by: the noise where its size comes from the residuals, else 1

    def residuals(self, theta: Array) -> tuple[Array, Array, Prediction]:
        """Return the residuals of the data, their derivatives, and the prediction they come from."""
        predicted = self.model.predict(theta, self.states)
        J = predicted.jacobian / predicted.friction[:, None] if self.logarithmic else predicted.jacobian
        return self.misfit(predicted.friction), J / self.size[:, None], predicted

    def misfit(self, friction: Array) -> Array:
        """Return the residuals of the data at predicted friction, rows along the last axis."""
        measured = self.model.data.friction
        return np.asarray((np.log(friction / measured) if self.logarithmic else friction - measured) / self.size)

    @property
    def size(self) -> Array:
        """What the residual of each row is divided by."""
        return self.scale * (np.ones(len(self.model.data)) if self.sigma is None else self.sigma)

    @property
    def priors(self) -> tuple[Array, Array]:
        """Rows of the priors: their derivatives, shape (k, p), and means over widths, shape (k,)."""
        free = self.model.free
        rows, means = [], []
        for i, each in enumerate(free):
            if each.prior is not None:
                mean, width = each.prior
                rows.append(np.eye(len(free))[i] / width)
                means.append(mean / width)
        return np.array(rows).reshape(-1, len(free)), np.array(means)

    @property
    def bounds(self) -> tuple[Array, Array]:
        """Lowest and highest logarithms of the factors."""
        return np.array([f.low for f in self.model.free]), np.array([f.high for f in self.model.free])

    def loss(self, r: Array) -> Array:
        """Return rho(r) of every residual."""
        return np.asarray(CAUCHY**2 * np.log1p((r / CAUCHY) ** 2) if self.robust else r * r)

    def influence(self, r: Array) -> tuple[Array, Array]:
        """Return half the first and second derivative of rho(r)."""
        if not self.robust:
            return r, np.ones_like(r)
        w = 1 / (1 + (r / CAUCHY) ** 2)
        return r * w, (1 - (r / CAUCHY) ** 2) * w * w

    def value(self, theta: Array, r: Array) -> float:
        """Return q, given the residuals of the data."""
        rows, means = self.priors
        return float(self.loss(r).sum() + ((rows @ theta - means) ** 2).sum())


def objective(model: FrictionModel, states: States, settings: FitSettings) -> Objective:
    """Return the objective that the data and the settings ask for."""
    sigma, relative, robust = error_of(model.data, settings), settings.relative_error, settings.robust
    if sigma is None:
        return Objective(model, states, None, settings.noise == "relative", robust)
    if model.data.error is None and settings.absolute_error is None and relative is not None:
        return Objective(model, states, np.full(len(sigma), relative), True, robust)
    absolute = settings.absolute_error
    has_both = model.data.error is None and relative is not None and absolute is not None
    return Objective(model, states, sigma, False, robust, (relative or 0.0, absolute or 0.0) if has_both else None)


MAD = 1.482602218505602  # Standard deviation over median absolute deviation of a normal distribution

# Relative change of q and absolute change of a logarithm at which the least squares end; solved states are good to 1e-6.
VALUE_TOLERANCE, PLACE_TOLERANCE = 1e-8, 1e-7

MOST_EVALUATIONS = 200

# Singular value of the derivatives, over the largest, below which a direction is rounding and no step goes along it.
NO_INFORMATION = 1e-9

SETTLED = 1e-4  # Relative change of the scale of the noise below which it is settled

MOST_ROUNDS = 30

NEAR = 1e-2  # Distance to the optimum, in standard errors, below which a fit counts as converged

AT_BOUND = 1e-4  # Distance of the logarithm of a factor from its bound below which it is at it


@dataclass(frozen=True)
class Minimum:
    """Where the least squares converged or stopped."""

    theta: Array  # Logarithms of the factors
    value: float  # q there
    residuals: Array  # Residuals of the data over their errors
    jacobian: Array  # Their derivatives
    prediction: Prediction  # Friction there
    fall: float  # How far q is above its optimum, by its derivatives
    ended: bool  # Whether the iteration and the scale of the noise came to rest
    evaluations: int  # Predictions that were made
    objective: Objective  # What was minimised, with its final scale

    @property
    def distance(self) -> float:
        """Estimated distance to the optimum, in standard errors."""
        noise = noise_of(self) if self.objective.sigma is None else 1.0
        return math.sqrt(self.fall) / max(noise, 1e-300)

    @property
    def relative_noise(self) -> Array:
        """Standard error of each row over its friction."""
        size = self.objective.size
        return np.asarray(size if self.objective.logarithmic else size / self.prediction.friction)

    @property
    def converged(self) -> bool:
        """Whether this is the optimum, within a hundredth of a standard error or the error of the states."""
        known = float(np.sqrt(np.mean(self.doubt**2)))
        return self.ended and (self.distance < NEAR or math.sqrt(self.fall) < known)

    @property
    def doubt(self) -> Array:
        """Errors of the residuals by those of the states."""
        error = self.prediction.error / (self.prediction.friction if self.objective.logarithmic else 1.0)
        return np.asarray(error / self.objective.size)

    @property
    def at_bound(self) -> Flags:
        """Which logarithms of factors are at one of their bounds."""
        low, high = self.objective.bounds
        return np.asarray((self.theta - low < AT_BOUND) | (high - self.theta < AT_BOUND), dtype=bool)


def minimise(
    goal: Objective,
    start: Array,
    fixed: dict[int, float] | None = None,
    on_step: Callable[[], object] | None = None,
    tolerance: float = VALUE_TOLERANCE,
    flat: float = NO_INFORMATION,
    near: float = 0.0,
) -> Minimum:
    """Return the minimum of q near a start, where inputs stay along directions that change no residual."""
    from scipy.optimize import least_squares  # slow to import

    fixed = fixed or {}
    moving = np.array([i for i in range(len(start)) if i not in fixed], dtype=int)
    low, high = goal.bounds
    rows, means = goal.priors
    n = len(goal.model.data)
    kept: dict[bytes, tuple[Array, Array, Prediction]] = {}
    count = 0

    def whole(x: Array) -> Array:
        theta = np.asarray(start, dtype=float).copy()
        theta[list(fixed)] = list(fixed.values())
        theta[moving] = x
        return theta

    def evaluate(theta: Array) -> tuple[Array, Array, Prediction]:
        nonlocal count
        key = theta.tobytes()
        if key not in kept:
            count += 1
            kept.clear()
            kept[key] = goal.residuals(theta)
            if on_step is not None:
                on_step()
        return kept[key]

    def function(x: Array) -> Array:
        theta = whole(x)
        try:
            return np.concatenate([evaluate(theta)[0], rows @ theta - means, np.zeros(len(x))])
        except (SolveError, InputError):
            return np.full(n + len(means) + len(x), np.inf)  # the step is then made shorter

    def derivative(x: Array) -> Array:
        J = np.concatenate([evaluate(whole(x))[1], rows])[:, moving]
        return np.concatenate([J, _held(J, flat)])

    def loss(z: Array) -> Array:
        found = np.stack([z, np.ones_like(z), np.zeros_like(z)])
        data, c = z[:n], CAUCHY**2
        found[:, :n] = c * np.log1p(data / c), 1 / (1 + data / c), -1 / c / (1 + data / c) ** 2
        return found

    def reached(x: Array, ended: bool) -> Minimum:
        theta = whole(x)
        r, J, prediction = evaluate(theta)
        part = Minimum(theta, goal.value(theta, r), r, J, prediction, 0.0, ended, count, goal)
        return replace(part, fall=_step_left(part, moving)[1])

    chosen: Any = loss if goal.robust else "linear"
    x = np.clip(np.asarray(start, dtype=float)[moving], low[moving] + 1e-9, high[moving] - 1e-9)
    first = reached(x, True)  # a start that cannot be solved is an error of its own
    if len(moving) and first.fall >= near**2:
        found = least_squares(
            function,
            x,
            jac=derivative,
            bounds=(low[moving], high[moving]),
            loss=chosen,
            ftol=tolerance,
            xtol=PLACE_TOLERANCE,
            gtol=VALUE_TOLERANCE,
            max_nfev=MOST_EVALUATIONS,
        )
        here = reached(found.x, found.status > 0)
        # Where q jumps by the errors of the states, steps are refused that its derivatives show to be right.
        while here.ended and not here.converged and count < MOST_EVALUATIONS:
            step = _step_left(here, moving)[0]
            jump = 2.0 * float(np.abs(goal.influence(here.residuals)[0]) @ here.doubt)
            try:
                there = reached(np.clip(here.theta + step, low, high)[moving], True)
            except (SolveError, InputError):
                break
            if there.fall >= here.fall or there.value > here.value + jump:
                break
            here = there
        return here
    return first


def _held(J: Array, flat: float) -> Array:
    """Return rows, shape (p, p), of residuals that are zero, which hold a Gauss-Newton step where J has no information."""
    _, S, V = np.linalg.svd(J, full_matrices=True)
    S = np.append(S, np.zeros(len(V)))[: len(V)]
    size = float(S[0]) if S[0] > 0 else 1.0
    return np.asarray(np.where(S <= flat * S[0], size, 0.0)[:, None] * V)


def _step_left(at: Minimum, moving: Indices) -> tuple[Array, float]:
    """Return the Gauss-Newton step that is left within the bounds, and how far q falls along it, by its derivatives."""
    from scipy.optimize import lsq_linear

    step = np.zeros(len(at.theta))
    if not len(moving):
        return step, 0.0
    rows, means = at.objective.priors
    influence, _ = at.objective.influence(at.residuals)
    weights = np.sqrt(np.where(at.residuals == 0, 1.0, influence / np.where(at.residuals == 0, 1.0, at.residuals)))
    J = np.concatenate([weights[:, None] * at.jacobian, rows])[:, moving]
    r = np.concatenate([weights * at.residuals, rows @ at.theta - means])
    still = 1e-6 * np.linalg.norm(J) * np.eye(len(moving))  # Holds inputs that change no residual
    low, high = (each[moving] - at.theta[moving] for each in at.objective.bounds)
    held = np.concatenate([-r, np.zeros(len(moving))])
    step[moving] = lsq_linear(np.concatenate([J, still]), held, (np.minimum(low, 0.0), np.maximum(high, 1e-300)), "bvls").x
    return step, max(0.0, float(r @ r - np.sum((J @ step[moving] + r) ** 2)))


def _scaled(at: Minimum) -> Minimum:
    """Return the same minimum with its residuals in units of their own standard deviation."""
    noise = noise_of(at)
    if noise == 0:
        return at
    return replace(
        at,
        value=at.value / noise**2,
        fall=at.fall / noise**2,
        residuals=at.residuals / noise,
        jacobian=at.jacobian / noise,
        objective=replace(at.objective, scale=at.objective.scale * noise),
    )


def noise_of(at: Minimum) -> float:
    """Return the standard deviation of the residuals, by their median where the loss is robust."""
    n = len(at.residuals)
    effective = effective_parameters(at)
    if at.objective.robust:
        return float(MAD * np.median(np.abs(at.residuals)) * math.sqrt(n / max(n - effective, 1.0)))
    return float(math.sqrt((at.residuals @ at.residuals) / max(n - effective, 1.0)))


def effective_parameters(at: Minimum) -> float:
    """Return how many free inputs the data determine beside the priors: trace of (J'J + P)^-1 J'J."""
    rows, _ = at.objective.priors
    if not len(rows):
        return float(at.jacobian.shape[1])
    H = at.jacobian.T @ at.jacobian
    return float(np.trace(np.linalg.pinv(H + rows.T @ rows, rcond=1e-14) @ H))


def settle(goal: Objective, start: Array, on_step: Callable[[], object] | None = None) -> Minimum:
    """Return the minimum of q, with the scale of the noise found from its own residuals where it is not known."""
    found = minimise(goal, start, on_step=on_step)
    count = found.evaluations
    if goal.sigma is None and not goal.robust and not len(goal.priors[0]):
        return _scaled(found)  # a common factor on all residuals moves nothing
    for _ in range(MOST_ROUNDS):
        better = _goal_after(found)
        if better is None:
            return replace(found, evaluations=count)
        found = minimise(better, found.theta, on_step=on_step)
        count += found.evaluations
    return replace(found, ended=False, evaluations=count)


def _goal_after(found: Minimum) -> Objective | None:
    """Return the objective with the errors that a minimum shows, or None if it has these."""
    goal = found.objective
    if goal.errors is not None:
        sigma = np.hypot(goal.errors[0] * found.prediction.friction, goal.errors[1])
        return None if np.allclose(sigma, goal.size, rtol=SETTLED, atol=0) else replace(goal, sigma=sigma)
    if goal.sigma is not None:
        return None
    noise = noise_of(found)
    is_known = noise == 0 or not math.isfinite(noise) or abs(math.log(noise)) < SETTLED
    return None if is_known else replace(goal, scale=goal.scale * noise)
