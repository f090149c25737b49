"""A sweep on a real Dask cluster: a scheduler and workers in processes of their own, of which some are killed."""

import json
import signal
import subprocess
import sys
import time
from contextlib import ExitStack, contextmanager
from pathlib import Path

import pytest
from command_line import call, environment
from sweep_files import RANDOM, finish, kept, write
from test_sweep import right, start, until

import stribeck as sb

DASK = str(Path(sys.executable).with_name("dask"))


class Cluster:
    """A scheduler and workers, each a process."""

    def __init__(self, folder):
        self.folder = folder
        self.file = folder / "scheduler.json"
        self.log = (folder / "cluster.log").open("w")
        self.scheduler = self._start("scheduler", "--port", "0", "--host", "127.0.0.1", "--no-dashboard")
        until(self.file.exists)
        until(lambda: self.file.read_text().endswith("}"))
        self.address = json.loads(self.file.read_text())["address"]
        self.workers = []

    def _start(self, kind, *options):
        command = [DASK, kind, "--scheduler-file", str(self.file), *options]
        return subprocess.Popen(command, stdout=self.log, stderr=self.log, cwd=self.folder, env=environment(PYTHONWARNINGS=""))

    def add_worker(self):
        options = ("--nthreads", "1", "--no-nanny", "--no-dashboard", "--local-directory", str(self.folder))
        self.workers.append(self._start("worker", *options))

    def close(self):
        for process in (*self.workers, self.scheduler):
            process.kill()
            process.wait()
        self.log.close()


@contextmanager
def cluster(folder, workers):
    made = Cluster(folder)
    with ExitStack() as stack:
        stack.callback(made.close)
        for _ in range(workers):
            made.add_worker()
        yield made


def lose_a_worker(tmp_path, total, kill_at):
    """Kill one of three workers in the middle of a sweep; return it and what it held when that happened."""
    file, store = write(tmp_path, RANDOM.format(kind="sobol", points=total)), tmp_path / "store"
    with cluster(tmp_path, 3) as made:
        process = start(file, store, "--scheduler", made.address)
        try:
            until(lambda: len(kept(store)) >= kill_at)
            made.workers[1].send_signal(signal.SIGKILL)
            before = kept(store)
            out, err = finish(process, 300)
        finally:
            process.kill()
        assert made.workers[1].wait() == -signal.SIGKILL
        assert [worker.poll() for worker in (made.workers[0], made.workers[2])] == [None, None]
    assert (process.returncode, err) == (0, "")
    assert f"Computed now: {total}, " in out
    return store, before


def check_after_the_loss(store, before, total):
    found = sb.open_sweep(store)
    assert found.outcomes == {"CONVERGED": total}
    # Each state was written once: those before the loss are untouched.
    after = kept(store)
    assert 0 < len(before) < total
    assert {state: after[state] for state in before} == before
    right(found)


@pytest.mark.slow  # four processes of Dask; a lost worker process of our own is tested in test_sweep.py
def test_a_cluster_that_loses_one_of_three_workers_finishes_the_sweep(tmp_path):
    store, before = lose_a_worker(tmp_path, 256, 40)
    check_after_the_loss(store, before, 256)


@pytest.mark.slow
def test_killing_the_run_keeps_the_states_and_another_goes_on_without_the_cluster(tmp_path):
    file, store = write(tmp_path, RANDOM.format(kind="sobol", points=256)), tmp_path / "store"
    with cluster(tmp_path, 1) as made:
        process = start(file, store, "--scheduler", made.address)
        try:
            until(lambda: 10 <= len(kept(store)))
            process.kill()
            process.communicate(timeout=60)
            before = kept(store)
        finally:
            process.kill()
        # A second run may use the same workers at once, and Ctrl-C stops it too.
        process = start(file, store, "--scheduler", made.address)
        try:
            until(lambda: len(kept(store)) >= len(before) + 10)
            process.send_signal(signal.SIGINT)
            out, err = finish(process, 60)
        finally:
            process.kill()
    assert process.returncode == 130, err
    assert "was taken over" in out and "run the same command again to resume" in err
    found = sb.open_sweep(store).finished
    last = sb.sweep(file, store)
    assert (last.finished, last.computed) == (256, 256 - found)
    after = kept(store)
    assert {state: after[state] for state in before} == before


def test_a_cluster_keeps_the_states_that_one_process_finds(tmp_path):
    from distributed import LocalCluster

    file = write(tmp_path, RANDOM.format(kind="sobol", points=4))
    with LocalCluster(n_workers=1, threads_per_worker=1, processes=False, protocol="tcp://", dashboard_address=None) as made:
        found = sb.sweep(file, tmp_path / "there", scheduler=made.scheduler_address)
    here = sb.sweep(file, tmp_path / "here")
    assert (found.computed, found.outcomes) == (4, here.outcomes)
    assert found.to_dataset().equals(here.to_dataset())


def test_where_no_scheduler_answers_is_a_sentence(capsys, tmp_path, monkeypatch):
    monkeypatch.setattr("stribeck.batches.executors.CONNECTION_TIMEOUT", 0.5)
    file = write(tmp_path, RANDOM.format(kind="sobol", points=4))
    began = time.monotonic()
    answer = call(capsys, "sweep", file, "--out", tmp_path / "store", "--scheduler", "tcp://127.0.0.1:9")
    assert time.monotonic() - began < 20
    assert answer.code == 2
    assert "no scheduler answers at tcp://127.0.0.1:9 (" in answer.err
    assert answer.err.endswith("start one with: dask scheduler.\n")


@pytest.mark.slow
def test_a_scheduler_that_is_lost_ends_the_sweep_with_a_sentence(tmp_path):
    file, store = write(tmp_path, RANDOM.format(kind="sobol", points=1024)), tmp_path / "store"
    with cluster(tmp_path, 1) as made:
        process = start(file, store, "--scheduler", made.address)
        try:
            until(lambda: len(kept(store)) >= 5)
            made.scheduler.kill()
            _, err = finish(process, 120)
        finally:
            process.kill()
    assert process.returncode == 1, err
    assert "stribeck: The cluster failed (the connection to its scheduler was lost); run the same sweep" in err
    assert 5 <= sb.open_sweep(store).finished < 1024
