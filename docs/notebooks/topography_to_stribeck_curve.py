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
# # From a topography to a Stribeck curve
#
# From the profile of a profilometer to a friction curve with a band of uncertainty. The profile is synthetic, so the right
# answers are known: a cylinder of 8 mm with 0.6 µm of roughness, Hurst exponent 0.8, roll-off at 105 µm.

# %%
# %matplotlib inline
import matplotlib.pyplot as plt
import numpy as np

import stribeck as sb

scan = sb.surfaces.read_topography("../../examples/cylinder_profile.csv")
surface = sb.surfaces.analyse(scan)
found = surface.to_dict()
for name in ("body_radius", "h_rms", "hurst", "roll_off"):
    print(f"{name:12} {found[name]:.4g} +- {found[name + '_error']:.1g}")
for name in ("alpha", "beta"):
    low, high = found[name + "_low_95"], found[name + "_high_95"]
    print(f"{name:12} {found[name]:.4g}, {low:.3g} to {high:.3g} at 95 %")
assert abs(surface.roughness.hurst - 0.8) < 2 * surface.fit.errors["hurst"]

# %% [markdown]
# Heights, the spectrum with its fit, and the contact law that follows from it:

# %%
from stribeck.plot.surface import plot_surface

plot_surface(surface)

# %% [markdown]
# ## The contact
#
# The law gives `alpha`, `beta` and the roughness, the scan the radius, data sheets the rest.


# %%
def contact(law, radius=surface.shape.radius):
    return sb.LineContact(
        radius=radius,
        modulus="2.7 MPa",
        load="30 N/m",
        viscosity="50 mPa*s",
        speed="1 mm/s",
        boundary_friction=0.7,
        law=law,
        **law.coefficients,
    )


curve = sb.stribeck_curve(contact(surface.law), speed=("1 um/s", "1 m/s"), points=41)
print(f"load group {contact(surface.law).groups.load:.2f}")
print(f"minimum friction {curve.minimum.friction:.4f} at {1e3 * curve.minimum.speed:.2f} mm/s")

# %% [markdown]
# ## How certain is this?
#
# The fit of the spectrum gives errors. The two largest, of the height and of the roll-off, go through the whole chain one at a
# time and are added as if they were independent.

# %%
from dataclasses import replace

roughness, errors = surface.roughness, surface.fit.errors
band = []
for name in ("h_rms", "roll_off"):
    for sign in (-1, 1):
        moved = replace(roughness, **{name: getattr(roughness, name) + sign * errors[name]})
        law = sb.surfaces.persson_law(moved)
        band.append(sb.stribeck_curve(contact(law), speed=("1 um/s", "1 m/s"), points=41).friction)
band = np.array(band)
spread = np.sqrt(((band[0] - band[1]) ** 2 + (band[2] - band[3]) ** 2) / 4)

figure, axes = plt.subplots()
axes.fill_between(curve.values, curve.friction - spread, curve.friction + spread, alpha=0.3, label="standard error")
axes.loglog(curve.values, curve.friction, label="Persson's law")
axes.set(xlabel="speed [m/s]", ylabel="friction coefficient")
_ = axes.legend()
worst = (spread / curve.friction).max()
print(f"the scan leaves friction uncertain by {100 * worst:.0f} % at most")
assert 0.05 < worst < 0.5

# %% [markdown]
# ## What the exponential law would have said
#
# The exponential law is the limit of small pressure. With the same `alpha` and `beta`:

# %%
plain = sb.LineContact(
    radius=surface.shape.radius,
    modulus="2.7 MPa",
    load="30 N/m",
    viscosity="50 mPa*s",
    speed="1 mm/s",
    boundary_friction=0.7,
    **surface.law.coefficients,
)
other = sb.stribeck_curve(plain, speed=("1 um/s", "1 m/s"), points=41)
print(f"plateau: {other.friction[0]:.3f} by the exponential law, {curve.friction[0]:.3f} by Persson's")
print(*other.notes, sep="\n")
