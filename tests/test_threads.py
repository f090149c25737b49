"""Threads: those of BLAS, of which a solve uses one, and those of the caller, who may solve in several."""

import os
import threading
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest
from command_line import run_python
from fit_data import TRUE, measured
from scipy.linalg import lapack
from threadpoolctl import threadpool_info, threadpool_limits

import stribeck as sb
from stribeck.numerics.threads import one_blas_thread

pytestmark = pytest.mark.quick

GROUPS = sb.Groups(1e-4, 0.1, 1e-3)


def blas_threads():
    """Return the numbers of threads of the BLAS libraries in this process."""
    return {pool["num_threads"] for pool in threadpool_info() if pool["user_api"] == "blas"}


@pytest.fixture
def two_threads():
    """Let BLAS use two threads, whatever the environment says."""
    with threadpool_limits(2, user_api="blas"):
        assert blas_threads() == {2}
        yield


class FactorisedError(Exception):
    """The first factorisation was reached: no need to solve on."""


def fit_solved():
    data = measured(np.geomspace(1e-3, 1e-1, 5), np.full(5, 0.5))
    return sb.fit(data, TRUE.replace(law=sb.contact_laws.GreenwoodTripp(), alpha=1.0), intervals=False)


def test_matrices_are_factorised_with_one_blas_thread(subtests, two_threads, monkeypatch):
    for call in [
        lambda: sb.solve(GROUPS),
        lambda: sb.stribeck_curve(GROUPS, speed=(1e-4, 1e-3)),
        lambda: sb.solve_batch(sb.Groups([1e-4, 1e-3], 0.1, 1e-3)),
        lambda: sb.phase_diagram(TRUE),
        fit_solved,
    ]:
        with subtests.test(call=call):
            during = []

            def spied(matrix, **options):
                during.append(blas_threads())
                raise FactorisedError

            monkeypatch.setattr(lapack, "dgetrf", spied)
            with pytest.raises(FactorisedError):
                call()
            assert during[0] == {1}
            assert blas_threads() == {2}


def test_calls_that_overlap_keep_one_blas_thread_until_the_last_ends(two_threads):
    first_in, second_in, first_out = threading.Event(), threading.Event(), threading.Event()
    seen = {}

    @one_blas_thread
    def first():
        first_in.set()
        assert second_in.wait(10)

    @one_blas_thread
    def second():
        second_in.set()
        assert first_out.wait(10)
        seen["alone"] = blas_threads()

    def run_first():
        first()
        seen["after the first"] = blas_threads()
        first_out.set()

    with ThreadPoolExecutor(2) as pool:
        calls = [pool.submit(run_first)]
        assert first_in.wait(10)
        calls.append(pool.submit(second))
        for call in calls:
            call.result(30)
    assert seen == {"after the first": {1}, "alone": {1}}
    assert blas_threads() == {2}


def test_eight_threads_give_the_bits_of_one(two_threads):
    problems = [sb.Groups(speed, 0.1, 1e-3) for speed in np.geomspace(1e-5, 1e-1, 8)]
    start = threading.Barrier(8)

    def solve(problem, wait=start.wait):
        wait()
        state = sb.solve(problem)
        return state, state.profile(np.linspace(-2, 2, 50))

    alone = [solve(problem, lambda: None) for problem in problems]
    with ThreadPoolExecutor(8) as pool:
        together = list(pool.map(solve, problems))
    for (one, its_profile), (other, its_own) in zip(alone, together, strict=True):
        assert np.array_equal(one.nodal_gap, other.nodal_gap)
        assert np.array_equal(one.observables.array(), other.observables.array(), equal_nan=True)
        assert np.array_equal(one.relative_errors, other.relative_errors, equal_nan=True)
        for name in ("gap", "fluid_pressure", "contact_pressure"):
            assert np.array_equal(getattr(its_profile, name), getattr(its_own, name)), name
    assert blas_threads() == {2}


FORKED = """
import os, signal, threading, time
import numpy as np
import stribeck as sb

reached, go = threading.Event(), threading.Event()

def phi(s):
    if threading.current_thread() is not threading.main_thread():
        reached.set()
        go.wait(60)
    return -s

def curve():
    law = sb.contact_laws.FunctionLaw(phi, lambda s: -np.ones_like(s))
    return sb.stribeck_curve(sb.Groups(1e-3, 0.1, 1e-2, law=law), speed=(1e-3, 1e-2), points=2, rtol=1e-3)

curves = curve(), curve()
# A thread solves for the fields of one curve while the process is forked.
at_work = threading.Thread(target=lambda: curves[0].solutions[0].gap)
at_work.start()
assert reached.wait(60)
child = os.fork()
if child == 0:
    os._exit(0 if curves[1].solutions[0].gap.min() > 0 else 1)
end, code = time.monotonic() + 60, None
while code is None and time.monotonic() < end:
    found, status = os.waitpid(child, os.WNOHANG)
    code = os.waitstatus_to_exitcode(status) if found else None
    time.sleep(0.05)
if code is None:
    os.kill(child, signal.SIGKILL)
go.set()
at_work.join()
print(code)
"""


@pytest.mark.skipif(not hasattr(os, "fork"), reason="no processes are forked here")
def test_a_child_that_is_forked_while_a_thread_solves_does_not_hang():
    assert run_python(FORKED).out == "0\n"
