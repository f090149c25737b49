"""How good is the closed form for friction?
=========================================

The closed form for friction at every speed, theory.md section 10, against the solver, which uses no formula.
Runs in a second.
"""

import stribeck as sb
from stribeck.asymptotics import uniform

LOAD, ROUGHNESSES = 0.1, (1e-5, 1e-4, 1e-3)


def main():
    """Return, for each roughness group, the speeds and the relative errors of the formula."""
    curves = [sb.stribeck_curve(load=LOAD, roughness=r, speed=(1e-9, 10.0), points=61) for r in ROUGHNESSES]
    return {
        curve.groups.roughness.flat[0]: (
            curve.values,
            uniform.friction(curve.groups, definition="balanced") / curve.friction - 1,
        )
        for curve in curves
    }


def plot(errors):
    """Draw the errors against the speed group."""
    from matplotlib.figure import Figure

    axes = Figure(layout="constrained").subplots()
    for roughness, (speeds, error) in errors.items():
        axes.semilogx(speeds, 100 * error, label=f"roughness group {roughness:g}")
    axes.set(xlabel=r"speed group $\lambda$", ylabel="formula over solver, less one (%)")
    axes.legend()
    return axes.figure


if __name__ == "__main__":
    errors = main()
    for roughness, (speeds, error) in errors.items():
        worst = abs(error).argmax()
        print(f"roughness {roughness:g}: worst {100 * error[worst]:+.1f} % at speed {speeds[worst]:.1e}; stated 7.2 %")
    plot(errors).savefig("formula_against_solver.png")
