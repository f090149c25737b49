"""What several test modules share: solved states, and what a finer and wider mesh makes of them."""

import dataclasses
import importlib.util
import math
import sys
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from hypothesis import settings

import stribeck as sb
from stribeck.contact_laws.scaled import ShiftedLaw
from stribeck.contacts.groups import contact_law
from stribeck.equations.line import Equations
from stribeck.equations.observables import observables
from stribeck.equations.operators import Operators
from stribeck.fluids import newtonian as reynolds
from stribeck.numerics.newton import StepControl, root_find
from stribeck.numerics.panels import Mesh
from stribeck.quantities.outputs import NAMES

# The same examples on every machine, so that a change is judged by what it changes; `make slow` searches for new ones.
settings.register_profile("repeated", derandomize=True)
settings.register_profile("search", max_examples=1000)
settings.load_profile("repeated")


@pytest.hookimpl(optionalhook=True)
def pytest_xdist_make_scheduler(config, log):
    """Keep the tests of a module in one worker, as they share solved states.

    The golden values share nothing, and take longest: each of their parts goes to any worker.

    Marks cannot say so: pytest-xdist 3.8 ignores ``xdist_group`` under pytest 9.2 (its issue 1386).
    """
    from xdist.scheduler import LoadFileScheduling

    class Together(LoadFileScheduling):
        def _split_scope(self, nodeid):
            if "/test_golden.py::" in f"/{nodeid}":
                return nodeid
            return super()._split_scope(nodeid)

    return Together(config, log)


BENCHMARKS = Path(__file__).parents[1] / "benchmarks"

LIFT = 5.0
"""Separations by which states at rest are lifted under laws that go on below zero."""


@cache
def _solved(speed, load, roughness, rtol):
    return sb.solve(sb.Groups(speed, load, roughness), rtol=rtol)


@pytest.fixture(scope="session")
def solved():
    """Return a function that solves ``(speed, load, roughness)`` once for all tests."""

    def solve(speed, load, roughness, rtol=1e-6):
        return _solved(float(speed), float(load), float(roughness), rtol)

    return solve


def values_of(equations, y, load):
    """Return the observables in the order of NAMES."""
    found = observables(equations, y, load)
    return np.array([getattr(found, name) for name in NAMES])


def _refined_values(solution, extra_nodes=6, doublings=5):
    """Observables on a mesh with more nodes on each panel and with panels much farther out."""
    coarse, groups = solution.mesh, solution.groups
    out = coarse.edges[-1] * 2.0 ** np.arange(1, doublings + 1)
    edges = np.concatenate([-out[::-1], coarse.edges, out])
    mesh = Mesh(edges, coarse.order + extra_nodes, coarse.scale)
    # At speed zero a light load keeps all gaps positive; a heavier one only shifts them.
    if groups.law is None:
        light = min(groups.load, 1e-2) if groups.speed == 0 else groups.load
        shift = -0.5 * groups.relative_roughness * math.log(groups.load / light)
        base = sb.Groups(groups.speed, light, light * groups.relative_roughness)
    else:
        light, lift = groups.load, LIFT if groups.speed == 0 and math.isinf(groups.law.lowest) else 0.0
        shift = -lift * groups.relative_roughness
        base = dataclasses.replace(groups, law=ShiftedLaw(groups.law, lift))
    gap = np.maximum(solution.profile(mesh.nodes).gap - shift, 1e-3 * solution.nodal_gap.min())
    flux_gap = reynolds.flux_gap(gap, mesh.weights)
    equations = Equations(Operators(mesh), base.speed, contact_law(base), flux_gap**2)
    start = np.concatenate([gap, [solution.offset - shift, flux_gap]])
    root = root_find(equations, start, StepControl(1e-12))
    assert root.outcome.name in ("CONVERGED", "ROUNDING")
    values = values_of(equations, root.x, light)
    if shift:
        values[[NAMES.index(name) for name in ("central_gap", "minimum_gap", "offset")]] += shift
        shifted = root.x[equations.layout.gap] + shift
        values[NAMES.index("flux_gap")] = reynolds.flux_gap(shifted, mesh.weights) if shifted.min() > 0 else math.nan
    return values


def _true_errors(solution):
    """Errors of the observables as the estimate means them: relative, those of the load shares absolute.

    Where an observable crosses zero they are relative to its scale there: the offset to the central gap.
    """
    exact = _refined_values(solution)
    found = np.array([getattr(solution.observables, name) for name in NAMES])
    scales = np.abs(exact)
    scales[:2] = 1.0
    offset, central_gap = NAMES.index("offset"), NAMES.index("central_gap")
    scales[offset] = max(scales[offset], scales[central_gap])
    if solution.groups.speed == 0:
        scales[2:4] = np.maximum(scales[2:4], 1e-3 * solution.groups.relative_roughness)
    scales[scales == 0] = 1.0
    return np.abs(found - exact) / scales


@pytest.fixture(scope="session")
def true_errors():
    """Return the function that measures the errors of a solution on a finer and wider mesh."""
    return _true_errors


@pytest.fixture
def load_benchmark(monkeypatch):
    """Return a function that imports a script of the benchmarks."""
    monkeypatch.syspath_prepend(BENCHMARKS)

    def module(name):
        spec = importlib.util.spec_from_file_location(name, BENCHMARKS / f"{name}.py")
        module = importlib.util.module_from_spec(spec)
        monkeypatch.setitem(sys.modules, name, module)
        spec.loader.exec_module(module)
        return module

    return module
