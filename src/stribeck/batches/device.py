"""Array libraries that keep to the array API standard, and devices of theirs, for the linear algebra of batches.

Source: `the standard <https://data-apis.org/array-api/latest/>`_.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any

import numpy as np

from stribeck._types import Array
from stribeck.files.writing import MissingExtraError
from stribeck.quantities.units import InputError, show

BACKENDS = ("numpy", "torch", "cupy")
"""Array libraries by name; any other that keeps to the standard may be given as its namespace."""

CPU_MEMORY, DEVICE_MEMORY = 4e6, 1e9
"""Bytes that the Jacobians of a batch may fill: on a processor what its cache holds is fastest, elsewhere many at once."""

MATRICES = 3
"""Arrays of the size of the Jacobians that live at once."""


@dataclass(frozen=True)
class Device:
    """An array library that keeps to the standard, and a device of it.

    Attributes
    ----------
    xp : module
        Namespace of the array API standard.
    device : object
        Device as the library names it; None for its default.
    memory : float
        Bytes that one batch of Jacobians may fill.
    """

    xp: Any
    device: Any
    memory: float

    def put(self, values: Array) -> Any:
        """Return an array of the library from one of NumPy."""
        return self.xp.asarray(np.array(values, dtype=np.float64), dtype=self.xp.float64, device=self.device)

    def get(self, values: Any) -> Array:
        """Return an array of NumPy from one of the library."""
        if isinstance(values, np.ndarray):
            return values
        if self.device is not None and hasattr(values, "cpu"):
            values = values.cpu()
        elif hasattr(values, "get"):
            values = values.get()
        return np.array(np.from_dlpack(values))

    def chunks(self, rows: int, unknowns: int) -> Iterator[slice]:
        """Yield the rows by as many as the memory allows."""
        number = max(1, int(self.memory / (8 * MATRICES * unknowns**2)))
        for first in range(0, rows, number):
            yield slice(first, min(rows, first + number))

    def solved(self, matrices: Any, columns: Any) -> Any:
        """Return the solutions of batched linear systems; nan for a matrix that is singular."""
        try:
            return self.xp.linalg.solve(matrices, columns)
        except (np.linalg.LinAlgError, RuntimeError):  # libraries raise for the whole batch if one of it is singular
            rows = matrices.shape[0]
            if rows == 1:
                return columns * math.nan
            half = rows // 2
            parts = [self.solved(matrices[part, ...], columns[part, ...]) for part in (slice(0, half), slice(half, rows))]
            return self.xp.concat(parts, axis=0)


def device_for(backend: Any, device: Any, memory: float | None) -> tuple[Device, str]:
    """Return where the linear algebra runs, and the name of the library; refuse what is not there."""
    if memory is not None and (isinstance(memory, bool) or not isinstance(memory, int | float) or not 0 < memory < np.inf):
        raise InputError(f"memory = {show(memory)}; it must be a positive number of bytes, for example 1e9.")
    if isinstance(backend, str) and backend not in BACKENDS:
        known = ", ".join(repr(name) for name in BACKENDS)
        raise InputError(f"backend = {show(backend)}; it must be {known}, or a namespace of the array API standard.")
    xp: Any = _namespace(backend) if isinstance(backend, str) else backend
    if not hasattr(xp, "linalg") or not hasattr(xp, "asarray"):
        raise InputError(f"backend = {show(backend)}; it has no asarray or linalg, and is no namespace of the standard.")
    name = backend if isinstance(backend, str) else str(getattr(backend, "__name__", backend))
    try:
        one = xp.asarray(np.ones((1, 1, 1)), dtype=xp.float64, device=device)
        xp.linalg.solve(one, one)
    except Exception as error:  # each library has errors of its own for a device that is not there
        reason = str(error).strip().split("\n")[0]
        raise InputError(f"device = {show(device)}; {name} cannot compute on it in double precision: {reason}") from None
    elsewhere = name == "cupy" or (device is not None and "cpu" not in str(device).lower())
    return Device(xp, device, memory or (DEVICE_MEMORY if elsewhere else CPU_MEMORY)), name


def _namespace(backend: str) -> Any:
    """Return the namespace of a library that is known by name."""
    if backend == "numpy" and hasattr(np, "__array_api_version__"):
        return np
    from importlib import import_module  # noqa: PLC0415

    try:
        return import_module(f"array_api_compat.{backend}")
    except ImportError:
        if backend == "torch":
            raise MissingExtraError("the backend 'torch'", "gpu", "array-api-compat and torch") from None
        needs, packages = {
            "numpy": ("array-api-compat, as this NumPy is older than the standard", "array-api-compat"),
            "cupy": ("array-api-compat and a CuPy for your CUDA", "array-api-compat cupy-cuda12x"),
        }[backend]
        raise InputError(f"the backend {backend!r} needs {needs}; install with: pip install {packages}") from None


@contextmanager
def one_torch_thread(xp: Any) -> Iterator[None]:
    """Keep PyTorch to one thread on the processor: with two, its batched LU was seen to fail from 150 unknowns on."""
    if "torch" not in getattr(xp, "__name__", ""):
        yield
        return
    import torch  # noqa: PLC0415

    before = torch.get_num_threads()
    torch.set_num_threads(1)
    try:
        yield
    finally:
        torch.set_num_threads(before)
