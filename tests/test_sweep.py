"""Many states: the numbers, their failures, and that neither Ctrl-C, kill -9, a full disk nor a second sweep harms them."""

import json
import os
import re
import resource
import shutil
import signal
import sqlite3
import subprocess
import sys
import threading
import time
from contextlib import closing, contextmanager
from dataclasses import replace

import numpy as np
import pytest
import xarray as xr
from command_line import SCRIPT, call, environment
from sweep_files import CONTACT, GRID, RANDOM, finish, kept, same_states, write

import stribeck as sb
from stribeck import Outcome
from stribeck.cli import progress as progress_module
from stribeck.solver import neighbours
from stribeck.sweeps import store as sweep_store

SMALL = GRID.replace("17", "3")
LONG = RANDOM.format(kind="sobol", points=1024)
"""Enough states to be stopped in the middle of."""


# --- the numbers ---


def groups_at(table, i):
    return sb.Groups(*(float(table[f"{name}_group"][i]) for name in ("speed", "load", "roughness")))


def test_zero_speed_and_zero_roughness_are_ordinary_states(tmp_path):
    text = "[groups]\n[vary]\nload = [0.1, 0.2]\nroughness = [0, 1e-3]\nspeed = [0, 1e-4, 1e-3]\n"
    found = sb.sweep(write(tmp_path, text), tmp_path / "store").to_dataset(grid=False)
    assert set(found.outcome.values) == {"CONVERGED"}
    for i in (0, 2, 4, 9):
        state = sb.solve(groups_at(found, i))
        assert float(found.central_gap[i]) == pytest.approx(state.central_gap, rel=2e-6)
        assert float(found.contact_load_share[i]) == pytest.approx(state.contact_load_share, abs=2e-6)


def test_a_contact_has_its_films_in_si_units_and_its_notes(tmp_path):
    text = CONTACT + '[vary]\nload = ["30 N/m"]\nroughness = ["1 um"]\nspeed = ["1 mm/s", "1 m/s"]\n'
    found = sb.sweep(write(tmp_path, text), tmp_path / "store").to_dataset(grid=False)
    for i, speed in enumerate((1e-3, 1.0)):
        contact = sb.LineContact(**{name: float(found[name][i]) for name in sb.LineContact.INPUTS.names})
        assert contact.speed == speed
        state = sb.solve(contact)
        assert float(found.central_film_thickness[i]) == pytest.approx(state.central_gap * contact.hertz.indentation, rel=2e-6)
        assert float(found.friction_balanced[i]) == pytest.approx(state.friction().total, rel=2e-6)
        assert found.message[i].item() == "\n".join(state.notes)


def test_the_numbers_do_not_depend_on_the_workers(tmp_path):
    file = write(tmp_path, RANDOM.format(kind="random", points=16))
    alone = sb.sweep(file, tmp_path / "one")
    together = sb.sweep(file, tmp_path / "two", workers=2)
    assert (alone.computed, together.computed) == (16, 16)
    assert same_states(alone, together)


# --- failures ---


def fail_at(monkeypatch, when, how):
    """Let the solver fail wherever ``when(groups)`` holds."""
    solved = neighbours.Neighbours.at

    def failing(self, groups):
        if when(groups):
            how()
            return replace(solved(self, groups), state=None, outcome=Outcome.PATH_LOST)
        return solved(self, groups)

    monkeypatch.setattr(neighbours.Neighbours, "at", failing)


@pytest.mark.quick
def test_a_failed_state_keeps_its_outcome_costs_no_other_and_is_not_tried_again(capsys, tmp_path, monkeypatch):
    file = write(tmp_path, GRID.replace("17", "9"))
    with monkeypatch.context() as patch:
        fail_at(patch, lambda groups: 2e-4 < groups.speed < 9e-4, lambda: None)
        answer = call(capsys, "sweep", file, "--out", tmp_path / "store")
    said = "stribeck: 4 of 36 states did not converge; each has its outcome in the store.\n"
    assert (answer.code, answer.err) == (1, said)
    assert f"4 PATH_LOST: {Outcome.PATH_LOST.value}" in answer.out
    found = sb.sweep(file, tmp_path / "store")
    assert (found.computed, found.failed, found.outcomes) == (0, 4, {"CONVERGED": 32, "PATH_LOST": 4})
    table = found.to_dataset(grid=False)
    hit = (table.speed_group.values > 2e-4) & (table.speed_group.values < 9e-4)
    assert set(table.outcome.values[hit]) == {"PATH_LOST"}
    assert np.isnan(table.friction_published.values[hit]).all()
    assert np.isfinite(table.friction_published.values[~hit]).all()
    assert all(Outcome.PATH_LOST.value in text for text in table.message.values[hit])


def test_an_error_of_the_program_is_an_outcome_with_its_words(tmp_path, monkeypatch):
    def broken():
        raise ZeroDivisionError("division by zero")

    fail_at(monkeypatch, lambda groups: groups.roughness == 1e-3 and groups.speed < 3e-5, broken)
    found = sb.sweep(write(tmp_path, SMALL), tmp_path / "store")
    assert found.outcomes == {"CONVERGED": 10, "ERROR": 2}
    assert all("ZeroDivisionError: division by zero" in text for text in found.message if "Zero" in text)


def test_a_state_that_rounding_bounds_keeps_its_value_with_its_error(tmp_path):
    text = "[groups]\nload = 0.1\nroughness = 1e-9\n[vary]\nspeed = [1e-11]\n[solver]\nrtol = 1e-11\n"
    found = sb.sweep(write(tmp_path, text), tmp_path / "store").to_dataset(grid=False)
    bounded = found.outcome.values == "ROUNDING"
    assert bounded.any()
    assert (found.error_estimate.values[bounded] > 1e-11).all()
    assert np.isfinite(found.friction_published.values[bounded]).all()
    assert all("Double precision keeps the error" in text for text in found.message.values[bounded])


# --- the command ---


def test_the_command_says_what_it_did(capsys, tmp_path):
    store, data = tmp_path / "store", tmp_path / "sweep.nc"
    file = write(tmp_path, 'title = "Of groups"' + SMALL)
    answer = call(capsys, "sweep", file, "--out", store, "--export", data)
    assert (answer.code, answer.err) == (0, "")
    lines = answer.out.splitlines()
    assert lines[0] == "Of groups"
    assert lines[1] == f"12 of 12 states are finished in {store}; load, roughness, speed varied, grid."
    assert re.fullmatch(r"Computed now: 12, [0-9.]+ per second; found in the store: 0\.", lines[2])
    assert lines[3:] == ["12 CONVERGED: Converged.", f"Written: {data}"]
    with xr.open_dataset(data, engine="netcdf4") as found:
        assert dict(found.sizes) == {"load_group": 2, "roughness_group": 2, "speed_group": 3}
    again = json.loads(call(capsys, "sweep", file, "--out", store, "--json").out)
    assert (again["states"], again["finished"], again["computed"], again["outcomes"]) == (12, 12, 0, {"CONVERGED": 12})


WRONG = [
    ("", "SWEEP is missing; give it as in: stribeck sweep examples/sweep.toml --out sweep.sqlite"),
    ("sweep.toml", "out is missing; give it as in: stribeck sweep"),
    ("sweep.toml --out s --workers two", "workers = 'two' is not a whole number; write, for example, 101."),
    ("sweep.toml --out s --workers 0", "workers = 0; it must be a whole number from 1 to 1024."),
    ("sweep.toml --out s --export a.txt", "the name of this file must end in .nc, .csv, .zarr or .parquet."),
    ("sweep.toml --out s --export old.nc", "old.nc exists already and is kept"),
    ("sweep.toml --out sweep.toml", "sweep.toml is a file of something else; give the file of a store, or the name"),
    ("no.toml --out s", "no.toml cannot be read (No such file or directory); give the path of a TOML sweep file."),
    ("sweep.toml --out s --scheduler nonsense://x", "no scheduler answers at nonsense://x"),
]


def test_bad_input_is_a_sentence_and_exit_code_2_before_anything_is_solved(subtests, capsys, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    write(tmp_path, GRID)
    (tmp_path / "old.nc").write_text("mine")
    for arguments, sentence in WRONG:
        with subtests.test(arguments):
            answer = call(capsys, "sweep", *arguments.split())
            assert answer.code == 2
            assert sentence in answer.err and answer.err.startswith("stribeck: ") and answer.err.endswith("\n")
            assert kept(tmp_path / "s") == {}
    assert (tmp_path / "old.nc").read_text() == "mine"


def test_progress_tells_rate_and_time_left_also_in_lines_of_a_batch_job(tmp_path, capsys, monkeypatch):
    seen, file = [], write(tmp_path, SMALL)
    sb.sweep(file, tmp_path / "store", on_progress=seen.append)
    assert [state.done for state in seen] == list(range(1, 13))
    assert {state.total for state in seen} == {12}
    assert seen[-1].seconds_left == 0 and seen[-1].rate > 0
    for state in seen[1:]:
        assert state.seconds_left == pytest.approx((12 - state.done) / state.rate)
    monkeypatch.setattr("stribeck.cli.progress.LINE_INTERVAL", 0.0)
    answer = call(capsys, "sweep", file, "--out", tmp_path / "another")
    assert answer.code == 0
    assert re.fullmatch(r"stribeck: [0-9.e+]+ states/s, state 12 of 12, 0:00:00 left", answer.err.splitlines()[-1])


# --- stopped ---


def start(file, store, *arguments, **options):
    """Start the command in a process of its own, in which Ctrl-C is not ignored."""

    def heed():
        signal.signal(signal.SIGINT, signal.default_int_handler)

    options = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, "text": True, "preexec_fn": heed} | options
    return subprocess.Popen([SCRIPT, "sweep", str(file), "--out", str(store), *arguments], env=environment(), **options)


def until(condition, seconds=240):
    """Wait for a condition."""
    end = time.monotonic() + seconds
    while not condition():
        assert time.monotonic() < end
        time.sleep(0.01)


def children_of(pid):
    """Return the processes that a process has started."""
    with open(f"/proc/{pid}/task/{pid}/children") as file:
        return [int(child) for child in file.read().split()]


def open_text(path):
    with open(path, errors="replace") as file:
        return file.read()


def workers_of(pid):
    """Return those of its children that solve states."""
    return [child for child in children_of(pid) if "spawn_main" in open_text(f"/proc/{child}/cmdline")]


def lives(pid):
    try:
        with open(f"/proc/{pid}/stat") as file:
            return file.read().rpartition(")")[2].split()[0] not in "ZX"
    except FileNotFoundError:
        return False


SLOW = pytest.mark.slow


@pytest.mark.parametrize(
    ("workers", "number"),
    [
        (1, signal.SIGTERM),
        *(pytest.param(*each, marks=SLOW) for each in ((1, signal.SIGINT), (2, signal.SIGINT), (2, signal.SIGTERM))),
    ],
)
def test_ctrl_c_keeps_what_is_finished_and_the_same_command_goes_on(capsys, tmp_path, workers, number):
    file, store = write(tmp_path, LONG), tmp_path / "store"
    process = start(file, store, "--workers", str(workers), start_new_session=True)
    try:
        until(lambda: len(kept(store)) > 20)
        second = call(capsys, "sweep", file, "--out", store)
        assert process.poll() is None and second.code == 2
        assert f"{store} is in use by process {process.pid} on this machine" in second.err
        assert 0 < sb.open_sweep(store).finished < 1024  # reading is free
        if number == signal.SIGINT:
            os.killpg(process.pid, number)  # as a terminal does
        else:
            process.send_signal(number)
        out, err = finish(process, 60)
    finally:
        process.kill()
    assert process.returncode == 130
    found = sb.open_sweep(store)
    assert 20 < found.finished < 1024
    assert err == (
        f"stribeck: Interrupted after {found.finished} of 1024 states; they are stored in {store}; "
        "run the same command again to resume.\n"
    )
    assert f"Computed now: {found.finished}, " in out
    assert sorted(os.listdir(tmp_path)) == ["store", "sweep.toml"]

    def enough(progress):
        if progress.done >= found.finished + 5:
            raise KeyboardInterrupt

    before = kept(store)
    assert sb.sweep(file, store, on_progress=enough).computed == 5
    after = kept(store)
    assert {state: after[state] for state in before} == before


@pytest.mark.slow
def test_ctrl_c_while_the_workers_start_is_quiet(tmp_path):
    file, store = write(tmp_path, LONG), tmp_path / "store"
    process = start(file, store, "--workers", "2", start_new_session=True)
    try:
        until(lambda: len(workers_of(process.pid)) == 2)
        time.sleep(0.3)  # now they import, where an interrupt would be a traceback
        os.killpg(process.pid, signal.SIGINT)
        _, err = finish(process, 60)
    finally:
        process.kill()
    assert process.returncode == 130
    assert re.fullmatch(r"stribeck: Interrupted after [0-9]+ of 1024 states; .* run the same command again to resume\.\n", err)


@pytest.mark.slow
def test_workers_stop_at_once_and_what_they_have_sent_is_kept(tmp_path):
    told = []

    def stop(progress):
        if progress.done:
            told.append(progress.done)
            time.sleep(1.0)  # in which the workers go on with their chains
            raise KeyboardInterrupt

    found = sb.sweep(write(tmp_path, LONG), tmp_path / "store", workers=2, on_progress=stop)
    assert found.interrupted
    assert told[-1] < found.finished == found.computed <= 80  # two chains; five more were waiting


def kill_and_resume(tmp_path, text, total, kill_at, workers):
    """Kill a sweep at some number of states, resume it, and check that nothing is lost and nothing computed twice."""
    file, store = write(tmp_path, text), tmp_path / "store"
    process = start(file, store, "--workers", str(workers))
    try:
        until(lambda: len(kept(store)) >= kill_at)
        children = children_of(process.pid)
        process.kill()
        process.communicate(timeout=60)
        until(lambda: not any(map(lives, children)), 10)
    finally:
        process.kill()
    before, found = kept(store), sb.open_sweep(store)
    assert kill_at <= len(before) == found.finished < total
    again = sb.sweep(file, store)
    told = f"(process {process.pid} on this machine) ended without releasing it; it was taken over."
    assert again.note == f"An earlier sweep on this store {told}" and sb.sweep(file, store).note == ""
    assert (again.finished, again.computed) == (total, total - found.finished)
    after = kept(store)
    assert {state: after[state] for state in before} == before
    return again


@pytest.mark.parametrize("workers", [1, pytest.param(2, marks=SLOW)])
def test_kill_9_loses_nothing_and_computes_nothing_twice(tmp_path, workers):
    text = RANDOM.format(kind="sobol", points=32)
    again = kill_and_resume(tmp_path, text, 32, 8, workers)
    assert again.outcomes == {"CONVERGED": 32}
    right(again)


def right(sweep, step=32):
    """Check some of the states of a sweep against cold solves."""
    found = sweep.to_dataset()
    for i in range(0, len(sweep), step):
        state = sb.solve(groups_at(found, i))
        assert float(found.friction_balanced[i]) == pytest.approx(state.friction().total, rel=2e-6)


@pytest.mark.slow
def test_a_killed_worker_process_is_replaced(tmp_path):
    file, store = write(tmp_path, RANDOM.format(kind="sobol", points=32)), tmp_path / "store"
    process = start(file, store, "--workers", "2")
    try:
        until(lambda: len(kept(store)) > 4)
        before = kept(store)
        os.kill(workers_of(process.pid)[-1], signal.SIGKILL)
        _, err = finish(process, 120)
    finally:
        process.kill()
    assert (process.returncode, err) == (0, "")
    after = kept(store)
    assert {state: after[state] for state in before} == before
    assert sb.open_sweep(store).outcomes == {"CONVERGED": 32}


@pytest.mark.slow
def test_workers_that_die_again_and_again_end_the_sweep_with_a_sentence(tmp_path):
    """A script that lacks its `if __name__ == "__main__":`, so that each worker begins the sweep anew and is refused."""
    write(tmp_path, GRID)
    script = tmp_path / "script.py"
    script.write_text("import stribeck as sb\nsb.sweep('sweep.toml', 'store', workers=2)\n")
    run = subprocess.run(
        [sys.executable, script], capture_output=True, text=True, env=environment(), timeout=120, cwd=tmp_path
    )
    assert run.returncode == 1
    assert "SweepError: Worker processes died 4 times; is the memory of this machine large enough, " in run.stderr
    assert sb.sweep(tmp_path / "sweep.toml", tmp_path / "store").note == ""


# --- a full disk ---


@contextmanager
def small_disk(folder, kind):
    """Give a disk that holds some fifty states, where one is wanted and the system lets us mount it."""
    mounted = (
        kind == "mounted"
        and subprocess.run(["mount", "-t", "tmpfs", "-o", "size=320k", "none", folder], capture_output=True).returncode == 0
    )
    try:
        yield mounted
    finally:
        if mounted:
            subprocess.run(["umount", "-l", folder], check=True)


@pytest.mark.parametrize(
    ("workers", "kind"),
    [(1, "mounted"), *(pytest.param(*pair, marks=SLOW) for pair in ((2, "mounted"), (1, "limited"), (2, "limited")))],
)
def test_a_full_disk_is_a_sentence_and_the_store_opens_and_goes_on(tmp_path, workers, kind):
    """Where no disk can or shall be mounted, the system refuses to let any file grow once there are some states."""
    disk = tmp_path / "disk"
    disk.mkdir()
    file, store = write(tmp_path, RANDOM.format(kind="sobol", points=64)), disk / "store"
    with small_disk(disk, kind) as mounted:
        process = start(file, store, "--workers", str(workers))
        try:
            if not mounted:
                until(lambda: len(kept(store)) > 20)
                for pid in (process.pid, *children_of(process.pid)):
                    resource.prlimit(pid, resource.RLIMIT_FSIZE, (0, resource.RLIM_INFINITY))
            _, err = finish(process, 120)
        finally:
            process.kill()
        assert process.returncode == 1, err
        assert re.fullmatch(
            rf"stribeck: {store} could not be written \((No space left on device|File too large)\); "
            r"the states finished until then are kept\. "
            r"Correct that and run the same sweep again to resume it\.\n",
            err,
        )
        found = sb.open_sweep(store)
        assert 0 < found.finished < 64
        assert found.outcomes == {"CONVERGED": found.finished}
        larger = tmp_path / "larger"
        shutil.copytree(disk, larger)
    again = sb.sweep(file, larger / "store")
    assert (again.finished, again.computed) == (64, 64 - found.finished)
    assert os.listdir(larger) == ["store"]


# --- the store and Ctrl-C, from within ---


@pytest.mark.quick
def test_of_many_who_want_a_store_one_has_it_at_a_time(tmp_path):
    """Also the store that a dead sweep has left, and the one that none of them has made yet."""
    design = sb.load_sweep(write(tmp_path, SMALL))
    inside, most, held = [], [], []

    def contend(number):
        for _ in range(20):
            try:
                with sweep_store.claimed_store(tmp_path / "store", design) as store:
                    inside.append(number)
                    most.append(len(inside))
                    store.keep([])
                    held.append(number)
                    inside.remove(number)
            except sb.InputError as problem:
                assert "in use" in str(problem)

    threads = [threading.Thread(target=contend, args=(k,)) for k in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert len(held) > 4 and max(most) == 1


def test_a_sweep_whose_store_was_taken_over_writes_no_more(tmp_path, monkeypatch):
    """As where a file system does not lock, or a machine slept in the moment between two transactions."""
    file, store = write(tmp_path, SMALL), tmp_path / "store"
    other = {"pid": 7, "host": "elsewhere", "key": ""}

    def steal(progress):
        if progress.done == 3:
            monkeypatch.setattr(sweep_store, "_writer", lambda db: other)

    with pytest.raises(sb.SweepError, match=r"was taken over by process 7 on elsewhere; this sweep ends\."):
        sb.sweep(file, store, on_progress=steal)
    assert len(kept(store)) == 4
    monkeypatch.undo()
    with closing(sqlite3.connect(store)) as db:  # the name of the other is not cleared away
        assert db.execute("SELECT value FROM about WHERE name = 'writer'").fetchone() != ("null",)


def test_a_store_of_another_version_is_refused(tmp_path, monkeypatch):
    file, store = write(tmp_path, SMALL), tmp_path / "store"
    sb.sweep(file, store)
    monkeypatch.setattr(sweep_store, "version", lambda name: "9.9.9")
    with pytest.raises(sb.InputError, match=r"was started with stribeck 0\.[0-9.]+, this is 9\.9\.9"):
        sb.sweep(file, store)


def test_ctrl_c_lets_several_processes_end_the_present_point_and_takes_effect_at_once_the_second_time():
    progress = progress_module.Progress(after_point=True)
    with pytest.raises(KeyboardInterrupt):
        progress.interrupt(signal.SIGINT, None)  # nothing to keep yet
    progress = progress_module.Progress(after_point=True)
    progress(1, 9)
    progress.interrupt(signal.SIGINT, None)
    with pytest.raises(KeyboardInterrupt):
        progress(2, 9)
    with pytest.raises(KeyboardInterrupt):
        progress.interrupt(signal.SIGINT, None)


def test_ctrl_c_does_not_stop_the_writing_and_a_failure_caused_by_it_counts_as_interruption():
    progress = progress_module.Progress()
    progress(9, 9)
    progress.writes = True
    progress.interrupt(signal.SIGINT, None)
    progress(9, 9)
    with pytest.raises(KeyboardInterrupt), progress_module.interruptible() as progress:
        progress.wanted = True
        raise sb.SolveError(Outcome.PATH_LOST, None, "lost")
