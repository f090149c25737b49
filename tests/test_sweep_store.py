"""The store of a sweep: what is in it is whole, what is torn counts as not done, and one sweep at a time works on it."""

import json
import os
import re
import shutil
import struct
import subprocess
import sys
import threading
import time

import numpy as np
import pytest
import xarray as xr
import zarr
from command_line import call
from filelock import SoftFileLock
from sweep_files import GRID, chunks, done_rows, write

import stribeck as sb
from stribeck.files.writing import MissingExtraError
from stribeck.sweeps import rows as sweep_rows
from stribeck.sweeps import store as sweep_store
from stribeck.sweeps.columns import OUTCOMES, columns_of
from stribeck.sweeps.lock import LOCK_FILE, hold_lock
from stribeck.sweeps.seal import SEALED_FILES, SUMS_FILE

PHYSICS = sb.Groups(0.0, 1.0, 0.0).physics
SMALL = GRID.replace("17", "3")


@pytest.fixture(scope="module")
def filled(tmp_path_factory):
    """Return a sweep of 12 states that nobody changes."""
    folder = tmp_path_factory.mktemp("filled")
    return sb.sweep(write(folder, SMALL), folder / "store")


@pytest.fixture
def copy(filled, tmp_path):
    """Return a copy of its store, and its file."""
    shutil.copytree(filled.path, tmp_path / "store")
    return tmp_path / "store", write(tmp_path, SMALL)


# --- what is in it ---


def test_zarr_reads_what_was_written(filled):
    group = zarr.open_group(str(filled.path), mode="r", use_consolidated=False)
    assert np.array_equal(group["values"][:], filled.rows.values)
    assert (group["done"][:] > 0).all()
    assert group["values"].attrs["columns"] == list(columns_of(si=False, physics=PHYSICS))
    assert group["values"].chunks == (1, len(columns_of(si=False, physics=PHYSICS)))
    texts = [bytes(row).rstrip(b"\0").decode() for row in group["text"][:]]
    assert texts == list(filled.rows.texts)
    assert group.attrs["design"] == SMALL == (filled.path / "sweep.toml").read_text()
    assert group.attrs["outcomes"] == list(OUTCOMES)
    names = group["inputs"].attrs["columns"]
    assert group["inputs"][:, names.index("boundary_friction")].tolist() == [0.8] * 12


def test_the_dataset_holds_what_solve_gives(filled):
    found = filled.to_dataset()
    for i in range(12):
        groups = sb.Groups(*(float(found[f"{name}_group"][i]) for name in ("speed", "load", "roughness")))
        state = sb.solve(groups)
        for name in ("contact_load_share", "central_gap", "minimum_gap", "flux_gap", "offset"):
            assert float(found[name][i]) == pytest.approx(getattr(state, name), rel=2e-6, abs=2e-6)
        for definition in ("published", "balanced"):
            friction = state.friction(0.8, 0.05, definition)
            assert float(found[f"friction_{definition}"][i]) == pytest.approx(friction.total, rel=2e-6)
            assert float(found[f"friction_{definition}_viscous"][i]) == pytest.approx(friction.viscous, rel=2e-6)
        assert float(found.hersey_number[i]) == pytest.approx(groups.hersey_number(0.05))
        assert found.regime[i] == sb.regime_of(state.fluid_load_share, friction_share(state))
        assert str(found.outcome[i].item()) == "CONVERGED"
        assert 0 < found.error_estimate[i] <= 1e-6


def friction_share(state):
    friction = state.friction(0.8, 0.05)
    return friction.contact / friction.total


def test_every_variable_has_a_unit_and_a_long_name_and_survives_netcdf(filled, tmp_path):
    filled.to_netcdf(tmp_path / "sweep.nc")
    with xr.open_dataset(tmp_path / "sweep.nc", engine="netcdf4") as found:
        made = filled.to_dataset()
        assert set(found.variables) == set(made.variables)
        for name, variable in found.variables.items():
            assert variable.attrs["units"] and variable.attrs["long_name"]
            assert variable.values.tolist() == made[name].values.tolist()
        assert (found.attrs["complete"], found.attrs["failed"], found.attrs["rtol"]) == (1, 0, 1e-6)
        assert found.attrs["design"] == SMALL


def test_a_grid_unstacks_by_its_inputs(filled):
    found = filled.to_dataset().set_index(state=["load_group", "roughness_group", "speed_group"]).unstack("state")
    assert dict(found.sizes) == {"load_group": 2, "roughness_group": 2, "speed_group": 3}


def test_states_not_computed_say_so(copy):
    store, _ = copy
    (store / "done" / "c.4").unlink()
    found = sb.open_sweep(store).to_dataset()
    assert found.outcome.values.tolist() == ["CONVERGED"] * 4 + ["NOT_COMPUTED"] + ["CONVERGED"] * 7
    assert np.isnan(found.friction_published[4]) and found.regime[4] == ""
    assert found.attrs["complete"] == 0


# --- torn writes ---


@pytest.mark.quick
@pytest.mark.parametrize("damage", ["no values", "short values", "other values", "empty flag", "other flag", "other text"])
def test_a_torn_state_is_not_done_and_is_computed_again(copy, filled, damage):
    store, file = copy
    said = next(row for row, text in enumerate(filled.rows.texts) if text)
    values, done, text = store / "values" / f"c.{said}.0", store / "done" / f"c.{said}", store / "text" / f"c.{said}.0"
    if damage == "no values":
        values.unlink()
    elif damage == "short values":
        values.write_bytes(values.read_bytes()[:100])
    elif damage == "other values":
        values.write_bytes(b"\1" + values.read_bytes()[1:])
    elif damage == "empty flag":
        done.write_bytes(b"")
    elif damage == "other flag":
        done.write_bytes(struct.pack("<I", 1))
    else:
        text.write_bytes(b"X" + text.read_bytes()[1:])
    before = chunks(store)
    assert sb.open_sweep(store).rows.done.tolist() == [row != said for row in range(12)]
    again = sb.sweep(file, store)
    assert (again.computed, again.finished) == (1, 12)
    after = chunks(store)
    assert {path for path in after if after[path] != before.get(path)} <= {
        f"values/c.{said}.0",
        f"text/c.{said}.0",
        f"done/c.{said}",
    }
    # Now it began cold: its mesh is another one, its numbers agree within the tolerance.
    numbers = [k for k, name in enumerate(columns_of(si=False, physics=PHYSICS)) if name not in ("nodes", "newton_steps")]
    assert again.rows.values[said, numbers] == pytest.approx(filled.rows.values[said, numbers], rel=2e-6, abs=2e-6)


@pytest.mark.quick
def test_a_state_without_its_flag_and_temporary_files_are_cleared_away(copy):
    store, file = copy
    (store / "done" / "c.7").unlink()
    (store / "values" / ".c.7.0-0123abcd").write_bytes(b"half")
    (store / "text" / "c.7.0").write_bytes(b"left by a run that was killed".ljust(sweep_store.TEXT_BYTES, b"\0"))
    assert sb.sweep(file, store).computed == 1
    assert not list((store / "values").glob(".*"))
    assert sb.open_sweep(store).finished == 12


@pytest.mark.quick
def test_data_come_before_the_flag_and_whole(tmp_path, monkeypatch):
    order, there = [], []
    replace = os.replace

    def noted(a, b):
        if b.name.startswith("c."):
            order.append(b.parent.name)
            there.append(b.exists())
        replace(a, b)

    monkeypatch.setattr(sweep_rows.os, "replace", noted)
    sb.sweep(write(tmp_path, SMALL), tmp_path / "store")
    assert not any(there)  # a chunk written in place would be seen half by a reader
    states = "".join(name[0] for name in order).split("d")
    assert len(states) == 13
    assert set(states) == {"v", "tv", ""}


def test_a_long_text_is_cut_at_a_letter(tmp_path):
    cut = sweep_rows._text("µ" * 2000)
    assert len(cut) == sweep_store.TEXT_BYTES
    assert cut.rstrip(b"\0").decode().endswith("µ...")


def test_a_finished_sweep_computes_nothing(copy):
    store, file = copy
    before = chunks(store)
    again = sb.sweep(file, store)
    assert (again.computed, again.finished, again.failed) == (0, 12, 0)
    assert chunks(store) == before


def test_each_run_is_noted(copy):
    store, file = copy
    (store / "done" / "c.7").unlink()
    sb.sweep(file, store)
    runs = [json.loads(line) for line in (store / "runs.jsonl").read_text().splitlines()]
    assert [run["run"] for run in runs] == [1, 1, 2, 2]
    assert (runs[0]["done"], runs[1]["computed"], runs[1]["outcome"]) == (0, 12, "FINISHED")
    assert (runs[2]["done"], runs[3]["computed"], runs[2]["pid"]) == (11, 1, os.getpid())


# --- damage ---


def as_told(path):
    """Return what a store exports, or the sentence that refuses it."""
    try:
        return sb.open_sweep(path).to_dataset()
    except sb.InputError as problem:
        assert re.fullmatch(r"[^\n]+\.", str(problem))
        return str(problem)


def assert_right(found, good):
    """Check that an export holds what was computed; a state that is not whole counts as not computed."""
    there = found.outcome.values != "NOT_COMPUTED"
    for name in good:
        rows = slice(None) if name in INPUTS else there
        assert found[name].values[rows].tolist() == good[name].values[rows].tolist(), name
        assert found[name].attrs == good[name].attrs
    changing = {"finished", "complete"}
    assert {k: v for k, v in found.attrs.items() if k not in changing} == {
        k: v for k, v in good.attrs.items() if k not in changing
    }
    return int(there.sum())


INPUTS = ("mu0", "beta", "speed_group", "load_group", "roughness_group")


def damages(content, other):
    """Yield what can become of a file: single bits flipped, cut off, empty, zeros, another file, more at its end."""
    for at in sorted({0, len(content) // 3, len(content) // 2, 2 * len(content) // 3, len(content) - 1}):
        for bit in (1, 64):
            yield content[:at] + bytes([content[at] ^ bit]) + content[at + 1 :]
    yield from (content[: len(content) // 2], content[:-1], b"", bytes(len(content)), other, content + b"\0")


def test_whatever_happens_to_a_file_of_a_store_its_export_is_right_or_refused(copy, filled):
    """Every file that is read, a text and the chunks of two states among them."""
    store, _ = copy
    good = filled.to_dataset()
    said = next(row for row, text in enumerate(filled.rows.texts) if text)
    names = [*SEALED_FILES, SUMS_FILE, "values/c.3.0", "done/c.3", f"text/c.{said}.0", f"values/c.{said}.0", f"done/c.{said}"]
    refused = incomplete = 0
    for name in names:
        file = store / name
        content = file.read_bytes()
        kind = name.partition("/")[0]
        other = (store / {"values": "values/c.4.0", "done": "done/c.4"}.get(kind, "text/zarr.json")).read_bytes()
        for bad in damages(content, other):
            if bad == content:
                continue
            file.write_bytes(bad)
            found = as_told(store)
            if isinstance(found, str):
                refused += 1
            else:
                assert assert_right(found, good) == (12 if name == SUMS_FILE else 11), name  # more lines are no matter there
                incomplete += 1
        file.unlink()
        for odd in ("missing", "folder", "pipe"):
            if odd == "folder":
                file.mkdir()
            elif odd == "pipe":
                os.mkfifo(file)
            found = as_told(store)
            assert isinstance(found, str) or assert_right(found, good) >= 11, (name, odd)
            if file.is_dir():
                file.rmdir()
            else:
                file.unlink(missing_ok=True)
        file.write_bytes(content)
    assert refused > 100
    assert incomplete > 50
    assert assert_right(as_told(store), good) == 12


def test_a_flipped_bit_in_the_inputs_is_told_by_the_command_and_at_resume(copy, tmp_path, capsys):
    store, file = copy
    inputs = store / "inputs" / "c" / "0" / "0"
    content = bytearray(inputs.read_bytes())
    content[7] ^= 16
    inputs.write_bytes(content)
    found = call(capsys, "sweep", file, "--out", store, "--export", tmp_path / "sweep.nc")
    assert (found.code, found.out) == (2, "")
    assert found.err == (
        f"stribeck: {store} is damaged: inputs/c/0/0 in it has changed since it was written; restore it "
        f"from a copy, or run the sweep "
        "again into a new store.\n"
    )
    assert not (tmp_path / "sweep.nc").exists()


def test_sha256sum_checks_a_store(filled):
    if shutil.which("sha256sum") is None:
        pytest.skip("there is no sha256sum here")
    run = subprocess.run(["sha256sum", "--check", SUMS_FILE], cwd=filled.path, capture_output=True, text=True)
    assert run.stdout.splitlines() == [f"{name}: OK" for name in SEALED_FILES]


def test_chunks_of_two_states_that_changed_places_are_not_done(copy):
    store, _ = copy
    for array, ending in (("values", ".0"), ("done", "")):
        one, other = (store / array / f"c.{row}{ending}" for row in (1, 5))
        (store / "between").write_bytes(one.read_bytes())
        one.write_bytes(other.read_bytes())
        other.write_bytes((store / "between").read_bytes())
    assert not sb.open_sweep(store).rows.done[[1, 5]].any()


@pytest.mark.parametrize("array", ["values", "text", "done"])
@pytest.mark.parametrize("name", ["c.x", "c.12{}", "c.-1{}", "c.3 (copy){}", "c.03{}", "c.1.2.3", "c.9999999999999{}"])
def test_a_stray_chunk_is_a_sentence(copy, array, name):
    store, file = copy
    stray = store / array / name.format("" if array == "done" else ".0")
    stray.write_bytes(b"what")
    with pytest.raises(sb.InputError, match=r"belongs to no state of this sweep, which has 12; move it elsewhere\.") as caught:
        sb.sweep(file, store)
    assert str(stray) in str(caught.value)
    stray.rename(store / array / ".DS_Store")  # what systems leave is no matter
    assert sb.sweep(file, store).finished == 12


def test_a_chunk_that_cannot_be_removed_or_read_is_a_sentence(copy):
    store, file = copy
    (store / "done" / "c.7").unlink()
    (store / "values" / "c.7.0").unlink()
    (store / "values" / "c.7.0").mkdir()
    with pytest.raises(sb.InputError, match=r"cannot be cleared: .*values/c\.7\.0: .*; correct that, or choose a new store\."):
        sb.sweep(file, store)
    (store / "done" / "c.7").write_bytes(b"1234")
    with pytest.raises(sb.InputError, match=r"cannot be read: .*values/c\.7\.0: Is a directory; correct that, or choose"):
        sb.open_sweep(store)


@pytest.mark.parametrize("odd", ["5\n[]\nnull\n", "[" * 100_000, "\udcff", "a folder", "a pipe"])
def test_an_odd_log_of_runs_stops_nothing(copy, odd):
    store, file = copy
    log = store / "runs.jsonl"
    log.unlink()
    if odd == "a folder":
        log.mkdir()
    elif odd == "a pipe":
        os.mkfifo(log)
    else:
        log.write_bytes(odd.encode(errors="surrogateescape"))
    assert sb.sweep(file, store).finished == 12


def test_outcomes_are_those_that_the_store_names(copy, monkeypatch):
    """Another version may know more of them, in another order."""
    store, _ = copy
    found = sb.open_sweep(store)
    found.about["outcomes"] = ["FINE", *found.about["outcomes"][1:]]
    assert found.outcomes == {"FINE": 12}
    assert set(found.to_dataset().outcome.values) == {"FINE"}


# --- what is refused ---


def test_another_design_is_refused(copy, tmp_path):
    store, _ = copy
    before = chunks(store)
    for name, changed in (("a", SMALL.replace("0.8", "0.9")), ("b", SMALL + "[solver]\nrtol = 1e-5\n")):
        with pytest.raises(
            sb.InputError, match=r"store contains a different sweep from .*: the states or the tolerance differ\."
        ):
            sb.sweep(write(tmp_path, changed, f"{name}.toml"), store)
    assert chunks(store) == before


def test_another_version_is_refused(copy, monkeypatch):
    store, file = copy
    monkeypatch.setattr(sweep_store, "version", lambda name: "9.9.9")
    with pytest.raises(sb.InputError, match=r"was started with stribeck 0\.[0-9.]+, this is 9\.9\.9"):
        sb.sweep(file, store)


def test_the_same_design_with_other_comments_goes_on(copy, tmp_path):
    store, _ = copy
    assert sb.sweep(write(tmp_path, "# why\n" + SMALL, "why.toml"), store).finished == 12


@pytest.mark.parametrize("taken", ["file", "folder", "nowhere"])
def test_a_place_that_is_no_store_is_refused_and_kept(tmp_path, taken):
    out = tmp_path / "out"
    if taken == "file":
        out.write_text("mine")
    elif taken == "folder":
        out.mkdir()
        (out / "mine").write_text("mine")
    else:
        out = tmp_path / "no" / "out"
    what = {"file": "is a file", "folder": "does not contain a sweep", "nowhere": "does not exist"}[taken]
    with pytest.raises(sb.InputError, match=what):
        sb.sweep(write(tmp_path, SMALL), out)
    assert sorted(os.listdir(tmp_path)) == sorted(["sweep.toml", *(["out"] if taken != "nowhere" else [])])


def test_an_empty_folder_becomes_the_store(tmp_path):
    (tmp_path / "store").mkdir()
    assert sb.sweep(write(tmp_path, SMALL), tmp_path / "store").finished == 12


def test_a_store_of_a_later_format_is_refused(copy):
    store, _ = copy
    about = json.loads((store / "zarr.json").read_text())
    about["attributes"]["stribeck_sweep"] = 99
    (store / "zarr.json").write_text(json.dumps(about))
    with pytest.raises(sb.InputError, match="has the format 99, of another version of stribeck"):
        sb.open_sweep(store)


@pytest.mark.parametrize(("library", "extra"), [("zarr", "data"), ("distributed", "cluster"), ("xarray", "data")])
def test_a_missing_extra_is_one_sentence(tmp_path, monkeypatch, filled, library, extra):
    monkeypatch.setitem(sys.modules, library, None)
    with pytest.raises(MissingExtraError, match=rf"needs {library}; install it with: pip install 'stribeck\[{extra}\]'\."):
        if library == "xarray":
            filled.to_dataset()
        else:
            sb.sweep(write(tmp_path, SMALL), tmp_path / "store", scheduler="tcp://127.0.0.1:1" if extra == "cluster" else None)


@pytest.mark.parametrize("workers", [0, -1, 1.5, True, "2", 100_000])
def test_a_number_of_workers_that_is_none_is_refused(tmp_path, workers):
    with pytest.raises(sb.InputError, match=r"workers = .*; it must be a whole number from 1 to 1024\."):
        sb.sweep(write(tmp_path, SMALL), tmp_path / "store", workers=workers)
    with pytest.raises(sb.InputError, match=r"workers = 2 and scheduler = 'tcp://x:1' are both given"):
        sb.sweep(write(tmp_path, SMALL), tmp_path / "store", workers=2, scheduler="tcp://x:1")


# --- the lock ---


def lock_of(store, process=None, host=None, born=None):
    """Write the lock of a process into a store, as filelock does."""
    with SoftFileLock(str(store / LOCK_FILE)):
        record = (store / LOCK_FILE).read_text().splitlines()
    for place, value in enumerate((process, host, born)):
        if value is not None:
            record[place] = str(value)
    (store / LOCK_FILE).write_text("\n".join(record) + "\n")


def test_a_store_that_a_living_process_sweeps_on_is_refused(copy):
    store, file = copy
    lock_of(store)
    with pytest.raises(sb.InputError, match=rf"is in use by process {os.getpid()} on this machine; wait for it"):
        sb.sweep(file, store)
    assert (store / LOCK_FILE).exists()


def test_the_lock_of_another_machine_is_refused_with_what_to_do(copy):
    store, file = copy
    lock_of(store, host="node17", process=4711)
    with pytest.raises(sb.InputError, match=r"in use by process 4711 on node17, .*; if it does not, delete that file and run"):
        sb.sweep(file, store)
    (store / LOCK_FILE).unlink()
    assert sb.sweep(file, store).note == ""


def dead_process():
    with subprocess.Popen([sys.executable, "-c", ""]) as process:
        process.wait()
    return process.pid


# Quick, so that it runs with the oldest filelock, whose first attempt clears the lock away and does not take it.
@pytest.mark.quick
@pytest.mark.parametrize("how", ["ended", "number used again"])
def test_the_lock_of_a_dead_process_is_taken_over_with_a_note(copy, how):
    store, file = copy
    lock_of(store, **({"process": dead_process()} if how == "ended" else {"born": 17}))
    found = sb.sweep(file, store)
    assert re.fullmatch(
        r"An earlier sweep on this store \(process \d+\) ended without releasing its lock; .* over\.", found.note
    )
    assert not list(store.glob(f"*{LOCK_FILE}*"))


@pytest.mark.parametrize("odd", ["torn", "empty", "of another program", "not text", "huge", "a folder", "a pipe"])
def test_a_lock_that_no_sweep_has_written_is_refused_with_what_to_do(copy, odd):
    store, file = copy
    lock = store / LOCK_FILE
    if odd == "a folder":
        lock.mkdir()
    elif odd == "a pipe":
        os.mkfifo(lock)
    else:
        content = {"torn": b"12", "empty": b"", "not text": b"\xff\n\xfe\n", "huge": b"9" * 10_000 + b"\nhere\n"}
        lock.write_bytes(content.get(odd, b'{"host": "here"}'))
    long_ago = time.time() - 3600
    os.utime(lock, (long_ago, long_ago))
    with pytest.raises(sb.InputError, match="sweep.lock is not what a sweep writes .*, delete that file and run again"):
        sb.sweep(file, store)
    assert lock.exists()


def test_of_many_who_want_a_dead_lock_one_has_it_at_a_time(copy):
    store, _ = copy
    lock_of(store, process=dead_process())
    inside, most, held = [], [], []

    def contend(number):
        for _ in range(20):
            try:
                with hold_lock(store):
                    inside.append(number)
                    most.append(len(inside))
                    held.append(number)
                    inside.remove(number)
            except sb.InputError as problem:
                assert re.search(r"in use|is not what a sweep writes", str(problem))

    threads = [threading.Thread(target=contend, args=(k,)) for k in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert held and max(most) == 1
    assert not list(store.glob(f"*{LOCK_FILE}*"))


def test_the_lock_is_gone_after_success_failure_and_interruption(tmp_path):
    file = write(tmp_path, SMALL)

    def stop(progress):
        raise KeyboardInterrupt

    def fail(progress):
        raise ZeroDivisionError

    store = tmp_path / "store"
    assert sb.sweep(file, store, on_progress=stop).interrupted
    assert not (store / LOCK_FILE).exists()
    with pytest.raises(ZeroDivisionError):
        sb.sweep(file, store, on_progress=fail)
    assert not (store / LOCK_FILE).exists()
    assert len(done_rows(store)) == 2
    assert sb.sweep(file, store).computed == 10
    assert not (store / LOCK_FILE).exists()
