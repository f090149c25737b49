"""The picture of a report: friction against speed with measured points, and films against speed."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from stribeck.contacts.contact import Contact
from stribeck.contacts.friction_rules import RULES
from stribeck.curves.plot import hatch_law_in_doubt
from stribeck.data_sheet.content import Content
from stribeck.files.pictures import CONTACT, FLUID, GREY, INK, MARK, TINTS, add_legend, make_logarithmic, new_figure
from stribeck.fits.measurements import Measurements

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from stribeck._types import Array

__all__ = ["draw_report"]


def draw_report(content: Content) -> Figure:
    """Draw friction and films against speed, with the contact's own speed marked."""
    curve = content.curve
    figure, (left, right) = new_figure((10.5, 4.4), [], columns=2, top=0.6, title="Friction and film over the speed")
    speed = curve.values
    contact = curve.contact
    assert contact is not None
    for axes in (left, right):
        make_logarithmic(axes, "x", speed)
        hatch_law_in_doubt(axes, curve, speed)
        axes.set_xlabel("speed $U$ (m/s)")
        for regime, low, high in curve.regime_ranges:
            axes.axvspan(low, high, color=TINTS[regime], lw=0, zorder=0)
        if contact.speed > 0:
            axes.axvline(contact.speed, color=MARK, lw=1.2, ls=(0, (4, 2)), label="this contact", zorder=2)
    left.plot(speed, np.abs(curve.friction.total), color=INK, lw=2, label="friction")
    left.plot(speed, np.abs(curve.friction_contact), color=CONTACT, lw=1.2, label="from asperities")
    left.plot(speed, np.abs(curve.friction_viscous), color=FLUID, lw=1.2, label="from the fluid")
    shown, is_signed = [np.abs(curve.friction.total)], bool((curve.friction.total < 0).any())
    if content.uncertainty is not None:
        middle = abs(content.uncertainty["friction"].value)
        low, high = sorted(map(abs, content.uncertainty["friction"].interval_95))
        left.errorbar(
            [contact.speed],
            [middle],
            [[max(0.0, middle - low)], [max(0.0, high - middle)]],
            color=MARK,
            capsize=3,
            fmt="o",
            ms=4,
        )
        shown.append(np.array([low, high]))
    if content.data is not None:
        at, found, error = _points(content.data, contact)
        left.errorbar(at, found, error, fmt=".", color=GREY, ms=5, lw=0.8, label="measured", zorder=1)
        shown.append(found)
    values = np.concatenate(shown)
    make_logarithmic(left, "y", values)
    left.set_ylim(0.3 * values[values > 0].min(), 2 * values.max())
    left.set_ylabel(r"size of friction coefficient $|\mu|$" if is_signed else r"friction coefficient $\mu$")
    height = 1e6 * contact.hertz.indentation
    right.plot(speed, height * curve.observable("central_gap"), color=INK, lw=2, label="central film")
    right.plot(speed, height * curve.observable("minimum_gap"), color=INK, lw=1.2, ls=(0, (5, 2)), label="minimum film")
    if contact.roughness > 0:
        right.axhline(1e6 * contact.roughness, color=GREY, lw=1, ls=":", label="roughness $h_\\mathrm{rms}$")
    make_logarithmic(right, "y", height * curve.observable("central_gap"))
    right.set_ylabel("film thickness (µm)")
    add_legend(figure, (left, right), columns=5)
    return figure


def _points(data: Measurements, contact: Contact) -> tuple[Array, Array, Array | None]:
    """Return measured speed, friction and error; points measured against another quantity are converted to speed."""
    speed = data.values * RULES[contact.groups.geometry].speed_per(data.abscissa, contact)
    return speed, data.friction, data.error
