r"""Residuals of measured friction in units of their error, and what a fit minimises of them.

With :math:`r_i` the residual of a row over its standard error and priors normal in the logarithms,

.. math:: q(\theta) = \sum_i \rho(r_i) + \sum_k \left(\frac{\theta_k - m_k}{\tau_k}\right)^2

where :math:`\rho(r) = r^2`, or for outliers :math:`c^2 \ln(1 + r^2/c^2)` with c = 2.385, which loses 5 % of the information
where errors are normal (Holland and Welsch, Commun. Stat. A 6 (1977) 813).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from stribeck._types import Array
from stribeck.cases.fit_settings import FitSettings
from stribeck.fits.model import FrictionModel, Prediction
from stribeck.fits.states import States

__all__ = ["Objective", "objective"]

CAUCHY = 2.385  # Constant c of the robust loss, in standard errors


@dataclass(frozen=True)
class Objective:
    """What a fit minimises, for states from one source and one scale of the noise."""

    model: FrictionModel  # Predicts the friction of the rows
    states: States
    sigma: Array | None
    logarithmic: bool  # Whether residuals are of the logarithm of friction
    robust: bool  # Whether the loss is the robust one
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


def objective(model: FrictionModel, states: States, settings: FitSettings, robust: bool) -> Objective:
    """Return the objective that the data and the settings ask for."""
    data = model.data
    if data.error is not None:
        return Objective(model, states, data.error, False, robust)
    relative, absolute = settings.relative_error, settings.absolute_error
    if absolute is not None:
        return Objective(model, states, np.hypot((relative or 0.0) * data.friction, absolute), False, robust)
    if relative is not None:
        return Objective(model, states, np.full(len(data), relative), True, robust)
    return Objective(model, states, None, settings.noise == "relative", robust)
