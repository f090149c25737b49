"""Write the table of docs/checks.md: the limits by which ``stribeck.checks`` judges.

``python docs/limits.py`` rewrites the table between the marks of the page; ``tests/test_docs.py`` compares them.
"""

import re
from pathlib import Path

from stribeck.checks import body, film, law
from stribeck.checks.table import ROWS
from stribeck.contacts.cut_off import FAR_FILM_MIN_RADIUS
from stribeck.contacts.notes import (
    ATMOSPHERE,
    LAW_RANGE,
    MAX_CONTACT_SLOPE,
    MAX_FILM_SLOPE,
    MAX_PRESSURE_EXPONENT,
    OIL_COEFFICIENT,
)
from stribeck.quantities.formats import format_si

PAGE = Path(__file__).parent / "checks.md"
HEAD = ("Check", "Value", "Fine up to", "Outside beyond")


def rows():
    """Return by name of a check: the value, up to where it is fine, beyond what it is outside, and where it is explained."""
    per_gpa, gel = f"{OIL_COEFFICIENT * 1e9:g} 1/GPa", format_si(body.GEL_MODULUS_PA, "pressure")
    return {
        "inputs": (
            "factor beyond the usual range", f"{body.USUAL_RANGE_FACTOR:g}", "never", "",
        ),
        "Hertz pressure": (
            rf"$\alpha_p \, p_\mathrm{{Hz}}$, `pressure_coefficient`, else {per_gpa}", f"{body.STIFFENING_FINE:g}",
            f"{MAX_PRESSURE_EXPONENT:g}", "when_not_to_use.md#steel-in-oil-pressure-makes-the-fluid-stiff",
        ),
        "stiffness": (
            "$E^*$", format_si(body.MODULUS_FINE_PA, "pressure"), format_si(body.MODULUS_OUTSIDE_PA, "pressure"),
            "when_not_to_use.md",
        ),
        "contact width": (
            "$a/R$", f"{MAX_CONTACT_SLOPE:g}", f"{body.WIDTH_RATIO_OUTSIDE:g}",
            "#what-a-wide-contact-costs",
        ),
        "shape": (
            'steepest slope of a profile; `cavitation = "none"` is doubtful', f"{MAX_CONTACT_SLOPE:g}",
            f"{body.WIDTH_RATIO_OUTSIDE:g}", "fluids.md#profiles",
        ),
        "adhesion": (
            r"pull-off force, $\tfrac32 \pi w R$ (ball) or $\tfrac34 (4 \pi E^* R w^2)^{1/3}$, over load; "
            f"`work_of_adhesion` $w$, asked for below $E^*$ = {gel}", f"{body.PULL_OFF_FINE:g}", f"{body.PULL_OFF_OUTSIDE:g}",
            "when_not_to_use.md#gels-and-tissue",
        ),
        "pores": (
            rf"$U a/D$, $D = k E^*/\eta$; `diffusivity` $D$ or `permeability` $k$, asked for below {gel}",
            f"{body.PECLET_FINE:g}", f"{body.PECLET_OUTSIDE:g}", "when_not_to_use.md#gels-and-tissue",
        ),
        "layer": (
            "$a$ over `layer_thickness`", f"{body.LAYER_RATIO_FINE:g}", f"{body.LAYER_RATIO_OUTSIDE:g}",
            "when_not_to_use.md#thin-layers-and-wide-contacts",
        ),
        "loss tangent": (
            "`loss_tangent` at $U/a$", f"{body.LOSS_TANGENT_FINE:g}", f"{body.LOSS_TANGENT_OUTSIDE:g}",
            "when_not_to_use.md#viscoelastic-solids",
        ),
        "rms slope": (
            r"$h'_\mathrm{rms}$ of the law's spectrum, or `rms_slope`", f"{law.RMS_SLOPE_FINE:g}",
            f"{law.RMS_SLOPE_OUTSIDE:g}", "#how-steep-is-too-steep",
        ),
        "stroke": (
            "`stroke`, from stop to stop, over $a$", f"from {film.STROKE_FINE:g}", f"below {film.STROKE_OUTSIDE:g}",
            "when_not_to_use.md#strokes-starts-and-stops",
        ),
        "viscous heating": (
            r"viscosity lost, $\beta_T \eta (u_1 - u_2)^2/(8 k)$; `thermal_conductivity` $k$, `thermal_thinning` $\beta_T$",
            f"{film.HEATING_FINE:g}", f"{film.HEATING_OUTSIDE:g}", "when_not_to_use.md#hot-or-thinning-fluids",
        ),
        "contact law at the centre": (
            r"gap over $h_\mathrm{rms}$", f"{LAW_RANGE[0]:g} to {LAW_RANGE[1]:g}", f"below {LAW_RANGE[0]:g}",
            "contact_laws.md",
        ),
        "suction": (
            "pressure below ambient", format_si(ATMOSPHERE, "pressure"), "never",
            "when_not_to_use.md#cavitation-behind-the-contact",
        ),
        "laws of the fluid": (
            "laws used outside their range", "0", "never", "fluids.md",
        ),
        "film over radius": (
            "central gap of a ball over $R$", f"{MAX_FILM_SLOPE:g}", "never", "",
        ),
        "edge of the liquid": (
            "`wetted_radius` of a ball over $a$", f"from {FAR_FILM_MIN_RADIUS:g}", "never",
            "for_ball_on_disc.md#4-how-far-does-the-liquid-reach",
        ),
        "shear rate": (
            r"$U/h_\mathrm{min}$, or of the sliding speed if larger",
            f"`thinning_rate`, else {film.OIL_THINNING_RATE:.0e} 1/s, or {film.WATER_THINNING_RATE:.0e} 1/s up to "
            f"{1e3 * film.SMALL_MOLECULE_VISCOSITY:g} mPa s",
            f"{film.THINNING_OUTSIDE_RATIO:g} times a given rate",
            "when_not_to_use.md#hot-or-thinning-fluids",
        ),
        "supply": (
            "$h^*/2$ over `supply_film`", f"{film.SUPPLY_FINE:g}", f"{film.SUPPLY_OUTSIDE:g}",
            "when_not_to_use.md#too-little-fluid",
        ),
        "film against molecules": (
            r"$h_\mathrm{min}$ over `molecular_size` "
            f"({1e9 * film.OIL_MOLECULE_SIZE:g} nm, up to {1e3 * film.SMALL_MOLECULE_VISCOSITY:g} mPa s "
            f"{1e9 * film.WATER_MOLECULE_SIZE:g} nm)",
            f"from {film.MOLECULES_FINE:g}", f"below {film.MOLECULES_OUTSIDE:g}", "",
        ),
        "inertia": (
            r"$\varrho U h^{*2}/(\eta a)$, `density` $\varrho$", f"{film.REYNOLDS_FINE:g}", f"{film.REYNOLDS_OUTSIDE:g}", "",
        ),
        "contact law at the minimum": (
            r"gap over $h_\mathrm{rms}$ at the minimum of friction", f"{LAW_RANGE[1]:g}", "never",
            "contact_laws.md#the-tail-decides-the-minimum",
        ),
        "tail of the contact law": (
            "largest move of minimum and transitions", f"{law.TAIL_CHANGE_FINE:.0%}".replace("%", " %"), "never",
            "#how-the-tail-is-varied",
        ),
    }  # fmt: skip


def limits():
    """Return the table of limits, a row for each check in their order."""
    found = rows()
    lines = [HEAD, ("---",) * len(HEAD)]
    for row in ROWS:
        *cells, page = found[row.name]
        lines.append((f"[{row.name}]({page})" if page else row.name, *cells))
    return "".join(f"| {' | '.join(line)} |\n" for line in lines)


def with_table(text):
    """Return the text of the page with the table of now."""
    marked = re.compile(r"(<!-- limits -->\n\n).*?(\n<!-- end of limits -->)", re.DOTALL)
    text, count = marked.subn(lambda found: found[1] + limits() + found[2], text)
    if count != 1:
        raise ValueError(f"{PAGE.name} has {count} places for the table of limits")
    return text


if __name__ == "__main__":
    PAGE.write_text(with_table(PAGE.read_text()))
