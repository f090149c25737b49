"""Colours of the page, by light and by dark: those of Okabe and Ito, which most colour-blind readers can distinguish."""

from __future__ import annotations

from dataclasses import dataclass

from stribeck.plot.style import CONTACT, FLUID, GREY, INK, MARK, TINTS

__all__ = ["DARK", "LIGHT", "PIN_DASHES", "Palette"]


@dataclass(frozen=True)
class Palette:
    """Colours of charts."""

    ink: str  # Lines and text
    grey: str  # Secondary lines
    grid: str  # Grids
    card: str  # Ground
    contact: str  # Parts from asperities
    fluid: str  # Parts from the fluid
    mark: str  # The minimum
    point: str  # The present state
    thin: str  # Formulas
    tints: dict[str, str]  # Ground of each regime
    pins: tuple[str, ...]  # Of pinned curves


LIGHT = Palette(
    ink=INK,
    grey=GREY,
    grid="#e7eaee",
    card="#ffffff",
    contact=CONTACT,
    fluid=FLUID,
    mark=MARK,
    point="#e69f00",
    thin="#009e73",
    tints=TINTS,
    pins=("#009e73", "#a6761d", "#7b52ab", "#5e7c99", "#b2457d", "#4d4d4d"),
)

DARK = Palette(
    ink="#e8ecf1",
    grey="#96a0ab",
    grid="#2b323b",
    card="#181c22",
    contact="#ff8c52",
    fluid="#5ab4f0",
    mark="#e59fc4",
    point="#f0b429",
    thin="#35c9a0",
    tints={"boundary": "#33251f", "mixed": "#2b2920", "hydrodynamic": "#1a2a38"},
    pins=("#35c9a0", "#d6a54c", "#b491e0", "#9db4cc", "#ea8fbd", "#bdbdbd"),
)

# Dashes of pinned curves, so that they differ without colours too.
PIN_DASHES = ([8, 4], [2, 3], [10, 3, 2, 3], [5, 2], [12, 4], [3, 6])
