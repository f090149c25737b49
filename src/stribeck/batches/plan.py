"""Which of many states are solved together: those that are close, those that are scattered but alike, and those alone."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from stribeck._types import Array, Indices
from stribeck.batches.guess import column_groups
from stribeck.contacts.line import Groups
from stribeck.solver.cold_start import SATURATED_LOAD

CLOSE = 1.0
"""Extent of states that are reached from one of them, in units of :data:`STRETCH`."""

STRETCH = np.array([0.6, 1.0, 1.0])
"""How much a decade of speed, relative roughness and load changes the gap: films grow as speed**0.6."""

LEAST_CLOSE, LEAST_DESCENT = 6, 8
"""States that a batch of each kind must have: for fewer, single solves are faster."""

MOST_CLOSE, MOST_DESCENT = 256, 64
"""States that it may have."""

ALIKE = 10.0
"""Ratio of the widths of the layers at the edge of the contact that a descent spans: one mesh has to resolve both."""


def coordinates(groups: Groups) -> Array:
    """Return where states lie, such that neighbours have like gaps, shape (rows, 3)."""
    kappa = np.asarray(groups.relative_roughness)
    speed, load = np.asarray(groups.speed), np.asarray(groups.load)
    return np.asarray(np.log(np.concatenate([speed, np.where(kappa > 0, kappa, 1.0), load], axis=1)) * STRETCH)


def middle(groups: Groups) -> int:
    """Return the row of the state nearest to the middle of all."""
    points = coordinates(groups)
    return int(np.argmin(((points - 0.5 * (points.min(axis=0) + points.max(axis=0))) ** 2).sum(axis=1)))


def planned(groups: Groups) -> tuple[list[Indices], list[Indices], Indices]:
    """Return the rows of states that are close, of scattered ones that are alike, and of those to be solved one by one."""
    speed, load, kappa = (np.asarray(a)[:, 0] for a in (groups.speed, groups.load, groups.relative_roughness))
    moving, smooth = speed > 0, kappa == 0
    layer = np.maximum(kappa ** (2 / 3), speed**0.4)
    close: list[Indices] = []
    scattered: list[Indices] = []
    single = [np.flatnonzero(~moving)]
    for kind in (smooth, ~smooth):
        rows = np.flatnonzero(moving & kind)
        if not len(rows):
            continue
        loose: list[Indices] = []
        for part in _bisected(coordinates(column_groups(groups, rows)), np.arange(len(rows))):
            (close if len(part) >= LEAST_CLOSE else loose).append(rows[part])
        rest = np.concatenate(loose) if loose else rows[:0]
        single.append(rest[load[rest] > SATURATED_LOAD])  # whose paths from the rigid contact are of another kind
        rest = rest[load[rest] <= SATURATED_LOAD]
        rest = rest[np.argsort(layer[rest])]
        while len(rest):
            alike = int((layer[rest[:MOST_DESCENT]] <= ALIKE * layer[rest[0]]).sum())
            batch, rest = rest[:alike], rest[alike:]
            (scattered if alike >= LEAST_DESCENT else single).append(batch)
    return close, scattered, np.concatenate(single)


def _bisected(points: Array, rows: Indices) -> Iterator[Indices]:
    """Yield parts of the rows whose points are close, halved in the middle of their longest extent until they are."""
    waiting = [rows]
    while waiting:
        rows = waiting.pop()
        here = points[rows]
        extent = here.max(axis=0) - here.min(axis=0)
        axis = int(np.argmax(extent))
        if extent[axis] <= CLOSE and len(rows) <= MOST_CLOSE:
            yield rows
        elif extent[axis] == 0.0:  # one state many times over
            waiting += np.array_split(rows, 2)
        else:
            above = here[:, axis] > here[:, axis].min() + 0.5 * extent[axis]
            waiting += [rows[above], rows[~above]]
