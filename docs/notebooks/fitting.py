# ---
# jupyter:
#   jupytext:
#     text_representation:
#       extension: .py
#       format_name: percent
#   kernelspec:
#     display_name: Python 3
#     language: python
#     name: python3
# ---

# %% [markdown]
# # Fitting a measured curve
#
# From friction against speed to roughness, modulus and dry friction coefficient, with intervals and with what the data
# cannot determine. The data are synthetic, with 4 % of noise: friction coefficient 0.62, roughness 1.3 µm, modulus 2.3 MPa.

# %%
# %matplotlib inline
import matplotlib.pyplot as plt

import stribeck as sb
from stribeck.plot.fit import plot_fit

data, case = "../../examples/pdms_measured.csv", "../../examples/pdms_fit.toml"
fit = sb.fit(data, case)
print(fit.outcome.name)
truth = {"boundary_friction": 0.62, "roughness": 1.3e-6, "modulus": 2.3e6}
for name, value in truth.items():
    low, high = fit[name].interval_95
    print(f"{name:22} {fit[name].value:.4g}  95 %: {low:.4g} to {high:.4g}  made with {value:.4g}")
    assert low < value < high

# %%
plot_fit(fit)

# %% [markdown]
# ## Noise or misfit?
#
# No interval covers a wrong model. The order of the residuals along each curve shows a misfit; the number is the probability
# that chance alone gives such an order.

# %%
print(f"{100 * fit.quality.structure_probability:.0f} of 100")
assert fit.quality.structure_probability > 0.01

# %% [markdown]
# ## Which inputs are correlated
#
# The data determine a product of roughness and modulus better than either: a softer, rougher contact looks nearly the same.

# %%
print(fit.correlation)
print(*fit.notes, sep="\n")

# %% [markdown]
# ## What the data cannot determine
#
# Free `alpha` beside the roughness: friction depends on their quotient alone. The fit says so instead of printing a number.

# %%
loose = sb.fit(data, case, free=["boundary_friction", "roughness", "alpha"])
for weak in loose.undetermined:
    print(weak.message)
assert loose.undetermined and loose["alpha"].interval_95 == (0.0, float("inf"))

# %% [markdown]
# ## A prediction
#
# The fitted contact is an ordinary contact. This is its solved minimum of friction in the first fluid:

# %%
curve = sb.stribeck_curve(fit.contact)
figure, axes = plt.subplots()
axes.loglog(1e3 * curve.values, curve.friction)
axes.plot(1e3 * curve.minimum.speed, curve.minimum.friction, "o")
axes.set(xlabel="speed [mm/s]", ylabel="friction coefficient")
print(f"minimum friction {curve.minimum.friction:.4f} at {1e3 * curve.minimum.speed:.1f} mm/s")
