"""A new case file: every key with its unit, its usual range and where a value may come from."""

import math
from collections.abc import Iterable
from importlib.resources import files

from stribeck.cases.case import DEFAULT_POINTS_AND_RTOL, FACTS, MOTIONS
from stribeck.cases.law import INPUTS_OF_SURFACES, LAWS, NEEDED_TABLE, Law
from stribeck.cases.model_parts import FLUID_KINDS
from stribeck.contacts.geometries import INPUT_TABLES
from stribeck.contacts.groups import Geometry, check_geometry
from stribeck.contacts.parts import KINDS, LAW_NUMBERS
from stribeck.fluids.presets import PRESETS
from stribeck.quantities.formats import format_si
from stribeck.quantities.keywords import answers_typos
from stribeck.quantities.schema import Input, needed_of, numbers_of
from stribeck.quantities.units import DIMENSIONS, InputError, show

SEALS = ("o-ring", "u-cup", "shaft")  # Kinds of seals, whose cases are files of the folder `seals`


MODEL_TEXT = """
# A fluid that is not Newtonian, a film that breaks, a thin layer: remove the # of a table and of what you know.
# [fluid]
# preset = "water"   # or {presets}: gives the viscosity too, at temperature = "25 degC"
{laws}
# [cavitation]
# model = "exit"   # the film ends at ambient pressure behind the contact; or "reform"
# [flow_factors]
# model = {flow_factors}
# [solid]
{bodies}

# A line contact may have a profile in the place of its radius.
# [profile]
{shapes}
"""

OPTIONS_TEXT = """
[curve]
# What varies: "speed", "load" or "roughness"; range = ["1 mm/s", "1 m/s"] if the automatic one does not fit.
over = "speed"
points = {points}
{stroke}
[solver]
# Relative error of each state, {smallest} to 1e-2.
rtol = {usual}
# Which friction force: "balanced" (on the substrate) or "published" (as printed in the article).
definition = "balanced"
"""

STROKE_TEXT = """
# How the contact moves, for stribeck stroke; the checks take its length.
# [stroke]
{}
"""

MIN_RTOL = {"line": "1e-11", "point": "1e-8"}  # By geometry

# The end of [contact] by geometry, with the contact law that holds for its load.
SURFACE_TEXT = {
    "line": """# In the place of alpha, beta and roughness a table [surface] may stand:
# h_rms = "1 um", hurst = 0.8, longest_wavelength = "150 um", shortest_wavelength = "1.5 um".
# The exponential law is the article's. It holds for load groups below 1 and gaps of 0.4 to 2 roughness heights, as at this
# speed. The minimum of friction lies beyond, at higher speeds: stribeck check says by how much it may be off.
law = "exponential"
""",
    "point": """law = "persson"

# The roughness of both surfaces together. Its spectrum gives alpha, beta and the contact law, which holds for any load; a ball
# presses too hard for the exponential law, with numbers alpha, beta and roughness in [contact] in the place of this table.
[surface]
h_rms = "1 um"
hurst = 0.8
longest_wavelength = "150 um"
shortest_wavelength = "1.5 um"
""",
}


@answers_typos
def new_case(geometry: Geometry = "line", seal: str | None = None) -> str:
    """Return the text of a case file with every key, a typical value, its unit and its usual range.

    Parameters
    ----------
    geometry : {"line", "point"}
        A cylinder, or a ball.
    seal : {"o-ring", "u-cup", "shaft"}, optional
        A seal with the numbers of catalogues, in the place of the file with every key.

    Returns
    -------
    str
        The file, which :func:`stribeck.load_case` reads as it stands; what is optional is commented out.

    Raises
    ------
    InputError
        If it is no geometry or no kind of seal.
    """
    if seal is not None:
        if not isinstance(seal, str) or seal not in SEALS:
            raise InputError(f"seal = {show(seal)}; it must be one of {', '.join(SEALS)}.")
        if geometry != "line":
            raise InputError(f"geometry = {show(geometry)}: a seal is a line contact; leave geometry out.")
        return files("stribeck.data_sheet").joinpath("seals", f"{seal}.toml").read_text(encoding="utf-8")
    table = INPUT_TABLES[check_geometry(geometry)]
    body, (points, rtol) = "ball" if geometry == "point" else "cylinder", DEFAULT_POINTS_AND_RTOL[geometry]
    lines = [
        f"# A lubricated rough {body}. Replace the values by yours; a bare number is in SI units. A value may carry its",
        '# standard error, as in "1.0 +- 0.2 um" or "46 cSt +- 5 %". Then: stribeck check, solve, curve, regimes, report.',
        "",
        'title = "My contact"',
        "",
        "[contact]",
        *([f'geometry = "{geometry}"', ""] if geometry != "line" else []),
    ]
    motion = {"slide_to_roll": table.kept.get("slide_to_roll", LAW_NUMBERS["slide_to_roll"])}
    for row in (table.kept | motion).values():
        left_out = row.optional or (geometry == "point" and row.name in INPUTS_OF_SURFACES)
        lines += [_about(row), f"{'# ' if left_out else ''}{row.name} = {row.example}"]
        for form in reversed(table.forms):
            if table.stands_for.get(form.inputs[0].name) != row.name:
                continue
            if form.joins:
                lines.append(f"# {_values(form.inputs)}   # {form.inputs[0].label}; {form.inputs[0].source}")
                continue
            formula = f"   ({form.formula})" if form.formula else ""
            lines.append(f"# Or instead: {_values(form.inputs)}{formula}")
            if form.second:
                lines.append(f"#   and, if the other body is not rigid, {_values(form.second)}")
        lines.append("")
    lines += [
        f"# Contact law: {', '.join(map(_law, LAWS))}.",
        SURFACE_TEXT[geometry].rstrip(),
        _parts().rstrip(),
        OPTIONS_TEXT.format(
            points=points,
            stroke=_stroke() if geometry == "line" else "",
            smallest=MIN_RTOL[geometry],
            usual=f"{rtol:g}".replace("e-0", "e-"),
        ),
        "[check]",
        "# Used by the checks alone; remove the # of what you know.",
    ]
    lines += [f"# {fact.name} = {fact.example}   # {fact.label}; {fact.source}" for fact in FACTS.values()]
    return "\n".join(lines) + "\n"


def _law(name: Law) -> str:
    return f'"{name}" (with [{NEEDED_TABLE[name]}])' if name in NEEDED_TABLE else f'"{name}"'


def _parts() -> str:
    """Return the optional tables, with all laws that there are."""
    laws = []
    for kind in FLUID_KINDS.values():
        needed = {name: _needed(law) for name, law in kind.laws.items() if law is not None}
        said = (f'{kind.key} = "{name}"{f"   # with {numbers}" if numbers else ""}' for name, numbers in needed.items())
        laws.append(_alternatives(said))
    factors = [f'"{name}"' for name, law in KINDS["flow_factors"].laws.items() if law is not None]
    bodies = [law for law in KINDS["solid"].laws.values() if law is not None]
    shapes = [(name, law) for name, law in KINDS["profile"].laws.items() if law is not None and needed_of(law)]
    return MODEL_TEXT.format(
        presets=", ".join(name for name in PRESETS if name != "water"),
        laws="\n".join(laws),
        flow_factors=f"{factors[0]}   # or {' or '.join(factors[1:])}",
        bodies=_alternatives(f"{_needed(law)}   # {law.label}" for law in bodies),
        shapes=_alternatives(f'shape = "{name}"; {_needed(law)}   # {law.label}' for name, law in shapes),
    )


def _stroke() -> str:
    """Return the table of a stroke, with all motions."""
    needed = {name: _needed(motion) for name, motion in MOTIONS.items()}
    return STROKE_TEXT.format(_alternatives(f'motion = "{name}"; {each}' for name, each in needed.items() if each))


def _alternatives(lines: Iterable[str]) -> str:
    """Return lines of which one is to be taken, all of them comments."""
    return "\n".join(f"# {'# or ' if k else ''}{line}" for k, line in enumerate(lines))


def _needed(law: type) -> str:
    """Return the numbers that a law needs, with examples."""
    return "; ".join(f"{key} = {numbers_of(law)[key].example}" for key in needed_of(law))


def _about(row: Input) -> str:
    low, high = row.usual
    unit = DIMENSIONS[row.dimension].unit or "no unit"
    usual = f", usually {format_si(low, row.dimension)} to {format_si(high, row.dimension)}" if high < math.inf else ""
    return f"# {row.label[0].upper()}{row.label[1:]} [{unit}]{usual}. Here: {row.source}."


def _values(rows: tuple[Input, ...]) -> str:
    return "; ".join(f"{row.name} = {row.example}" for row in rows)
