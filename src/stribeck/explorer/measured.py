"""Measured curves to draw over the model: what fits read from a laboratory's file, as friction over speed."""

from __future__ import annotations

import tempfile
from dataclasses import dataclass
from pathlib import Path

from stribeck._types import Array
from stribeck.contacts.line import LineContact
from stribeck.fits.measurements import read_measurements
from stribeck.quantities.units import InputError

__all__ = ["Measured", "read_measured"]


@dataclass(frozen=True, eq=False)
class Measured:
    """A measured Stribeck curve.

    Attributes
    ----------
    name : str
        Name of its file, and of the curve where that holds several.
    speed : ndarray, shape (n,)
        Sliding speed, ascending [m/s].
    friction : ndarray, shape (n,)
        Friction coefficient [-].
    """

    name: str
    speed: Array
    friction: Array


def read_measured(name: str, content: bytes, contact: LineContact) -> list[Measured]:
    r"""Return the measured curves of a file, over the speed.

    .. math:: U = \frac{(\eta U)}{\eta}, \qquad U = \mathrm{Hs} \, \frac{F_N}{\eta}

    Parameters
    ----------
    name : str
        Name of the file, for sentences.
    content : bytes
        A table as :func:`stribeck.measurements.read_measurements` reads it.
    contact : LineContact
        Whose viscosity and load hold where the file has viscosity times speed or the Hersey number, and does not give them.

    Returns
    -------
    list of Measured
        The curves.

    Raises
    ------
    InputError
        Where the file cannot be read; the sentence names row and column.
    """
    with tempfile.TemporaryDirectory(prefix="stribeck-") as folder:
        path = Path(folder) / "curve.csv"  # never under the name that came with it
        path.write_bytes(content)
        try:
            data = read_measurements(path)
        except InputError as problem:
            raise InputError(str(problem).replace(str(path), name)) from None
    found = []
    for k, (curve, inputs) in enumerate(zip(data.curves, data.inputs, strict=True)):
        viscosity, load = inputs.get("viscosity", contact.viscosity), inputs.get("load", contact.load)
        factor = {"speed": 1.0, "speed_viscosity": 1 / viscosity, "hersey_number": load / viscosity}[data.abscissa]
        mine = data.curve == k
        label = name if len(data.curves) == 1 else f"{name}: {curve}"
        found.append(Measured(label, data.values[mine] * factor, data.friction[mine]))
    return found
