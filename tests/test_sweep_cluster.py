"""A sweep on a real Dask cluster: a scheduler and workers in processes of their own, of which some are killed."""

import json
import signal
import subprocess
import sys
import time
from contextlib import ExitStack, contextmanager
from pathlib import Path

import numpy as np
import pytest
from command_line import call, environment
from sweep_files import RANDOM, chunks, done_rows, finish, write
from test_sweep import right, start, until

import stribeck as sb
from stribeck.sweeps.lock import LOCK_FILE

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


def rows_in(store):
    return len(done_rows(store)) if (store / "done").exists() else 0


def last_run(store):
    return json.loads((store / "runs.jsonl").read_text().splitlines()[-1])


def lose_a_worker(tmp_path, total, kill_at):
    """Kill one of three workers in the middle of a sweep; return it and what it held when that happened."""
    file, store = write(tmp_path, RANDOM.format(kind="sobol", points=total)), tmp_path / "store"
    with cluster(tmp_path, 3) as made:
        process = start(file, store, "--scheduler", made.address)
        try:
            until(lambda: rows_in(store) >= kill_at)
            made.workers[1].send_signal(signal.SIGKILL)
            before = chunks(store)
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
    # Each state was written once: those before the loss are untouched, and the run reports each state once.
    after = chunks(store)
    kept = [path for path in before if path.startswith("done/")]
    assert 0 < len(kept) < total
    assert {path: after[path] for path in kept} == {path: before[path] for path in kept}
    assert (last_run(store)["reported"], last_run(store)["computed"]) == (total, total)
    right(found)


@pytest.mark.slow  # four processes of Dask; a lost worker process of our own is tested in test_sweep.py
def test_a_cluster_that_loses_one_of_three_workers_finishes_the_sweep(tmp_path):
    store, before = lose_a_worker(tmp_path, 256, 40)
    check_after_the_loss(store, before, 256)


@pytest.mark.slow
def test_a_large_sweep_on_a_cluster_that_loses_one_of_three_workers(tmp_path):
    store, before = lose_a_worker(tmp_path, 4096, 1000)
    check_after_the_loss(store, before, 4096)
    (tmp_path / "one").mkdir()
    alone = sb.sweep(tmp_path / "sweep.toml", tmp_path / "one" / "store", workers=2)
    assert np.array_equal(alone.rows.values, sb.open_sweep(store).rows.values)


@pytest.mark.slow
def test_killing_the_run_keeps_the_states_and_another_goes_on_without_the_cluster(tmp_path):
    file, store = write(tmp_path, RANDOM.format(kind="sobol", points=256)), tmp_path / "store"
    with cluster(tmp_path, 1) as made:
        process = start(file, store, "--scheduler", made.address)
        try:
            until(lambda: 10 <= rows_in(store))
            process.kill()
            process.communicate(timeout=60)
            before = chunks(store)
        finally:
            process.kill()
        # A second run may use the same workers at once, and Ctrl-C stops it too.
        process = start(file, store, "--scheduler", made.address)
        try:
            until(lambda: rows_in(store) >= len(before) // 3 + 10)
            process.send_signal(signal.SIGINT)
            _, err = finish(process, 60)
        finally:
            process.kill()
    assert process.returncode == 130, err
    assert "the lock was taken over" in err and "run the same command again to resume" in err
    assert not (store / LOCK_FILE).exists()
    kept = sb.open_sweep(store).finished
    last = sb.sweep(file, store)
    assert (last.finished, last.computed) == (256, 256 - kept)
    after = chunks(store)
    done = [path for path in before if path.startswith("done/")]
    assert {path: after[path] for path in done} == {path: before[path] for path in done}


def test_where_no_scheduler_answers_is_a_sentence(capsys, tmp_path, monkeypatch):
    monkeypatch.setattr("stribeck.sweeps.workers.CONNECTION_TIMEOUT", 0.5)
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
            until(lambda: rows_in(store) >= 5)
            made.scheduler.kill()
            _, err = finish(process, 120)
        finally:
            process.kill()
    assert process.returncode == 1, err
    assert "stribeck: The cluster failed (the connection to its scheduler was lost); run the same sweep" in err
    assert 5 <= sb.open_sweep(store).finished < 1024
    assert not (store / LOCK_FILE).exists()
