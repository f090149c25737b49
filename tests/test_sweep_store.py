"""The store of a sweep: an SQLite file that one sweep at a time fills, that others read, and what it is exported to."""

import functools
import os
import re
import resource
import shutil
import signal
import sqlite3
import sys
from contextlib import closing

import numpy as np
import pandas as pd
import pytest
import xarray as xr
from command_line import call
from sweep_files import GRID, RANDOM, kept, lose, same_states, write

import stribeck as sb

SMALL = GRID.replace("17", "3")
DIMS = {"load_group": 2, "roughness_group": 2, "speed_group": 3}


@pytest.fixture(scope="module")
def filled(tmp_path_factory):
    """Return a sweep of 12 states that nobody changes."""
    folder = tmp_path_factory.mktemp("filled")
    return sb.sweep(write(folder, SMALL), folder / "store")


@pytest.fixture
def copy(filled, tmp_path):
    """Return a copy of its store, and its file."""
    shutil.copy(filled.path, tmp_path / "store")
    return tmp_path / "store", write(tmp_path, SMALL)


# --- what is in it ---


def test_sqlite_reads_what_was_written(filled):
    with closing(sqlite3.connect(filled.path)) as db:
        query = "SELECT speed_group, friction_balanced, outcome FROM inputs JOIN states USING (state) ORDER BY state"
        speed, friction, outcome = zip(*db.execute(query), strict=True)
        (design,) = db.execute("SELECT value FROM about WHERE name = 'design'").fetchone()
    assert np.array_equal(speed, filled.columns["speed_group"]) and np.array_equal(
        friction, filled.columns["friction_balanced"]
    )
    assert outcome == ("CONVERGED",) * 12
    assert "roughness = [1e-4, 1e-3]" in design and filled.about["design"] == SMALL
    assert os.listdir(filled.path.parent) in (["store", "sweep.toml"], ["sweep.toml", "store"])  # one file


def test_the_dataset_holds_what_solve_gives(filled):
    found = filled.to_dataset(grid=False)
    assert set(found.outcome.values) == {"CONVERGED"}
    assert ((found.error_estimate > 0) & (found.error_estimate <= 1e-6)).all()
    for i in (0, 5, 10):
        groups = sb.Groups(*(float(found[f"{name}_group"][i]) for name in ("speed", "load", "roughness")))
        state = sb.solve(groups)
        for name in ("contact_load_share", "central_gap", "minimum_gap", "flux_gap", "offset"):
            assert float(found[name][i]) == pytest.approx(getattr(state, name), rel=2e-6, abs=2e-6)
        for definition in ("published", "balanced"):
            friction = state.friction(0.8, 0.05, definition)
            assert float(found[f"friction_{definition}"][i]) == pytest.approx(friction.total, rel=2e-6)
            assert float(found[f"friction_{definition}_fluid"][i]) == pytest.approx(friction.fluid, rel=2e-6)
        assert float(found.hersey_number[i]) == pytest.approx(groups.hersey_number(0.05))
        assert found.regime[i] == sb.regime_of(state.fluid_load_share, state.friction(0.8, 0.05).contact_share)


def test_a_grid_has_its_dimensions_and_the_last_axis_is_the_fastest(filled):
    found, flat = filled.to_dataset(), filled.to_dataset(grid=False)
    assert (dict(found.sizes), dict(flat.sizes)) == (DIMS, {"state": 12})
    assert found.load_group.values.tolist() == [0.1, 0.2]
    stacked = flat.set_index(state=list(DIMS)).unstack("state")
    assert np.array_equal(found.central_gap, stacked.central_gap.transpose(*DIMS))


def test_states_that_are_no_grid_are_along_their_number(tmp_path):
    found = sb.sweep(write(tmp_path, RANDOM.format(kind="random", points=3)), tmp_path / "store").to_dataset()
    assert dict(found.sizes) == {"state": 3} and found.state.values.tolist() == [0, 1, 2]


def test_regimes_and_notes_are_by_the_coefficients_and_definition_of_the_file(tmp_path):
    text = (
        "[solver]\ndefinition = 'published'\n[groups]\nload = 0.1\nroughness = 1e-3\nboundary_friction = 2e-4\nbeta = 0.05\n"
    )
    found = sb.sweep(write(tmp_path, text + "[vary]\nspeed = [1e-3, 2e-3, 3e-2]\n"), tmp_path / "store")
    data = found.to_dataset()
    shares = [(data.friction_asperities / data[f"friction_{each}"]).values for each in ("balanced", "published")]
    assert (shares[0][:2] > 0.1).all() and (shares[1] < 0.1).all()
    assert data.regime.values.tolist() == ["hydrodynamic"] * 3
    state = sb.solve(sb.Groups(3e-2, 0.1, 1e-3))
    assert data.message.values[2] == state.notes_for(2e-4, 0.05, "published")[0] != state.notes[0]
    assert data.attrs["definition"] == found.to_dict()["definition"] == "published"
    assert found.plot().axes[0].lines[0].get_ydata().tolist() == data.friction_published.values.tolist()


def test_states_not_computed_say_so(copy):
    store, _ = copy
    lose(store, 4)
    found = sb.open_sweep(store)
    assert (found.finished, found.outcomes) == (11, {"CONVERGED": 11})
    table = found.to_dataset(grid=False)
    assert table.outcome.values.tolist() == ["CONVERGED"] * 4 + ["NOT_COMPUTED"] + ["CONVERGED"] * 7
    assert np.isnan(table.friction_published[4]) and table.regime[4] == "" and table.attrs["complete"] == 0
    assert found.to_dataset().outcome.values[0, 1, 1] == "NOT_COMPUTED"


@pytest.mark.quick
def test_what_is_missing_alone_is_computed(copy, filled):
    store, file = copy
    lose(store, 4, 7)
    before = kept(store)
    again = sb.sweep(file, store)
    assert (again.computed, again.finished, again.note) == (2, 12, "")
    after = kept(store)
    assert {state: after[state] for state in before} == before
    # Its chain began cold: the mesh is another one, the numbers agree within the tolerance.
    for name in ("central_gap", "friction_balanced", "contact_load_share"):
        assert again.columns[name] == pytest.approx(filled.columns[name], rel=2e-6, abs=2e-6)


def test_a_finished_sweep_computes_nothing_also_with_other_comments(copy, tmp_path):
    store, _ = copy
    again = sb.sweep(write(tmp_path, "# why\n" + SMALL, "why.toml"), store)
    assert (again.computed, again.finished, again.failed) == (0, 12, 0)


# --- exports ---


def read(path):
    """Return what a file of an export holds, as rows along its first column or as a dataset."""
    if path.suffix == ".csv":
        return pd.read_csv(path, comment="#", keep_default_na=False).rename(columns=lambda name: name.partition(" [")[0])
    if path.suffix == ".parquet":
        return pd.read_parquet(path)
    return (xr.open_zarr if path.suffix == ".zarr" else xr.open_dataset)(path).load()


@pytest.mark.filterwarnings("error")
def test_the_command_exports_every_number_text_and_unit(subtests, copy, filled, tmp_path, capsys):
    for ending in [".nc", ".zarr", ".csv", ".parquet"]:
        with subtests.test(ending=ending):
            store, file = copy
            path = tmp_path / f"sweep{ending}"
            answer = call(capsys, "sweep", file, "--out", store, "--export", path)
            assert (answer.code, answer.err) == (0, "") and f"Written: {path}" in answer.out
            found, made = read(path), filled.to_dataset()
            if ending in (".nc", ".zarr"):
                assert dict(found.sizes) == DIMS
                assert all(value.attrs["units"] and value.attrs["long_name"] for value in found.variables.values())
                assert (found.attrs["complete"], found.attrs["rtol"], found.attrs["design"]) == (1, 1e-6, SMALL)
            for name, value in made.variables.items():
                is_table = ending in (".csv", ".parquet")
                expected = made[name].broadcast_like(made.central_gap).transpose(*DIMS) if is_table else value
                assert np.asarray(found[name]).ravel().tolist() == expected.values.ravel().tolist(), name
            kept_as_it_is = call(capsys, "sweep", file, "--out", store, "--export", path)
            assert kept_as_it_is.code == 2 and "exists already and is kept" in kept_as_it_is.err
            assert call(capsys, "sweep", file, "--out", store, "--export", path, "--force").code == 0


def test_ctrl_c_does_not_stop_the_export_of_a_finished_sweep(copy, filled, tmp_path, capsys, monkeypatch):
    store, file = copy
    lose(store, 5)
    dataset = type(filled).to_dataset

    def interrupted(sweep):  # "Interrupted; nothing was written." stood there, with all states in the store
        signal.raise_signal(signal.SIGINT)
        return dataset(sweep)

    monkeypatch.setattr(type(filled), "to_dataset", interrupted)
    answer = call(capsys, "sweep", file, "--out", store, "--export", tmp_path / "sweep.csv")
    assert (answer.code, answer.err) == (0, "") and len(read(tmp_path / "sweep.csv")) == 12


@pytest.mark.quick
def test_what_lacks_its_library_is_one_sentence(filled, tmp_path, monkeypatch):
    sweep = functools.partial(sb.sweep, write(tmp_path, SMALL), tmp_path / "store", scheduler="tcp://127.0.0.1:1")
    for library, extra, ask in [
        ("zarr", "data", lambda: filled.to_zarr(tmp_path / "sweep.x")),
        ("pyarrow", "parquet", lambda: filled.to_parquet(tmp_path / "sweep.x")),
        ("netCDF4", "data", lambda: filled.to_netcdf(tmp_path / "sweep.x")),
        ("xarray", "data", filled.to_dataset),
        ("distributed", "cluster", sweep),
    ]:
        with monkeypatch.context() as patch:
            patch.setitem(sys.modules, library, None)
            with pytest.raises(sb.InputError, match=rf"needs {library}; install it with: pip install 'stribeck\[{extra}\]'\."):
                ask()


def test_a_folder_that_is_no_zarr_is_never_replaced(filled, tmp_path):
    (tmp_path / "mine.zarr").mkdir()
    (tmp_path / "mine.zarr" / "mine").write_text("mine")
    with pytest.raises(sb.InputError, match="exists already and is kept"):
        filled.to_zarr(tmp_path / "mine.zarr", force=True)
    assert (tmp_path / "mine.zarr" / "mine").read_text() == "mine"


# --- damage ---


def sentence_of(action, *arguments):
    """Return the sentence by which an action is refused, empty where it is not."""
    try:
        action(*arguments)
    except sb.InputError as problem:
        assert re.fullmatch(r"[^\n]+\.", str(problem))
        return str(problem)
    return ""


@pytest.mark.filterwarnings("ignore")  # numbers that a flipped bit makes are odd
def test_a_damaged_store_is_refused_with_a_sentence_or_opens(copy, filled):
    """SQLite finds pages that are no pages; a bit within a number is for the disk to keep."""
    store, file = copy
    content = store.read_bytes()
    refused = 0
    for at in range(0, len(content), 509):
        bad = bytearray(content)
        bad[at] ^= 0x55
        store.write_bytes(bad)
        refused += bool(sentence_of(lambda: sb.open_sweep(store).to_dataset()))
        if refused and at % 4 == 0:
            sentence_of(sb.sweep, file, store)
    assert refused > 5
    for bad in (
        content[: len(content) // 2],
        content[:-4096],
        bytes(len(content)),
        content[:4096] + bytes(4096) + content[8192:],
    ):
        store.write_bytes(bad)
        assert re.search("damaged|cannot be read|something else|another version", sentence_of(sb.open_sweep, store))
    page = content.rindex(b"CONVERGED") // 4096 * 4096  # two rows of a page change places, which no reader would see
    assert content[page] == 0x0D
    store.write_bytes(
        content[: page + 8] + content[page + 10 : page + 12] + content[page + 8 : page + 10] + content[page + 12 :]
    )
    assert "damaged" in sentence_of(sb.open_sweep, store) and "damaged" in sentence_of(sb.sweep, file, store)
    store.write_bytes(content)
    assert same_states(sb.open_sweep(store), filled)


# --- what is refused ---


def test_another_design_is_refused(copy, tmp_path):
    store, _ = copy
    before = kept(store)
    for name, changed in (
        ("a", SMALL.replace("0.8", "0.9")),
        ("b", SMALL + "[solver]\nrtol = 1e-5\n"),
        ("c", SMALL + "[solver]\ndefinition = 'published'\n"),
    ):
        with pytest.raises(
            sb.InputError, match=r"store contains a different sweep from .*: the states or \[solver\] differ\."
        ):
            sb.sweep(write(tmp_path, changed, f"{name}.toml"), store)
    assert kept(store) == before


def test_a_place_that_is_no_store_is_refused_and_kept(subtests, tmp_path):
    file, mine = write(tmp_path, SMALL), tmp_path / "mine"
    mine.write_text("mine")
    (tmp_path / "folder").mkdir()
    os.mkfifo(tmp_path / "pipe")
    with closing(sqlite3.connect(tmp_path / "base")) as db:
        db.execute("CREATE TABLE mine (mine)")
    before = sorted(os.listdir(tmp_path))
    for place, what in {
        "mine": "is a file of something else",
        "folder": "is a folder",
        "base": "is a database of something else",
        "pipe": "is no ordinary file",
        "no/out": "does not exist",
    }.items():
        with subtests.test(place):
            out = tmp_path / place
            assert what in sentence_of(sb.sweep, file, out) and what in sentence_of(sb.open_sweep, out)
    assert mine.read_text() == "mine" and sorted(os.listdir(tmp_path)) == before
    assert "cannot be written" in sentence_of(sb.sweep, file, "/proc/store")


def test_of_a_store_for_which_the_disk_has_no_room_nothing_is_left(tmp_path):
    file, limits = write(tmp_path, SMALL), resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (1, limits[1]))
    try:
        said = sentence_of(sb.sweep, file, tmp_path / "store")
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, limits)
    assert "store cannot be written" in said and os.listdir(tmp_path) == [file.name]


def test_an_empty_file_becomes_the_store(tmp_path):
    (tmp_path / "store").touch()
    assert "does not contain a sweep" in sentence_of(sb.open_sweep, tmp_path / "store")
    assert sb.sweep(write(tmp_path, SMALL), tmp_path / "store").finished == 12


def test_a_store_of_another_format_is_refused_and_kept(copy, tmp_path):
    store, file = copy
    with closing(sqlite3.connect(store)) as db:
        db.execute("PRAGMA user_version = 99")
    former = tmp_path / "sweep.zarr"
    former.mkdir()
    (former / "zarr.json").write_text('{"attributes": {"stribeck_sweep": 2}}')
    for place, said in {
        store: "has the format 99, of another version of stribeck",
        former: "is a folder; give the file of a store, or the name of a new one",
    }.items():
        for action in (lambda place=place: sb.open_sweep(place), lambda place=place: sb.sweep(file, place)):
            assert re.search(said, sentence_of(action))
    assert os.listdir(former) == ["zarr.json"]


def test_a_number_of_workers_that_is_none_is_refused(tmp_path):
    file, store = write(tmp_path, SMALL), tmp_path / "store"
    for workers in (0, -1, 1.5, True, "2", 100_000):
        with pytest.raises(sb.InputError, match=r"workers = .*; it must be a whole number from 1 to 1024\."):
            sb.sweep(file, store, workers=workers)
    with pytest.raises(sb.InputError, match=r"workers = 2 and scheduler = 'tcp://x:1' are both given"):
        sb.sweep(file, store, workers=2, scheduler="tcp://x:1")


# --- one writer ---


def test_a_second_sweep_in_the_same_process_is_refused(tmp_path):
    file, said = write(tmp_path, SMALL), []

    def second(progress):
        said.append(sentence_of(sb.sweep, file, tmp_path / "store"))

    assert sb.sweep(file, tmp_path / "store", on_progress=second).finished == 12
    assert len(said) == 12 and all(f"is in use by process {os.getpid()} on this machine; wait for it" in each for each in said)


def test_the_store_is_free_after_success_failure_and_interruption(tmp_path):
    file, store = write(tmp_path, SMALL), tmp_path / "store"

    def stop(progress):
        raise KeyboardInterrupt

    def fail(progress):
        raise ZeroDivisionError

    assert sb.sweep(file, store, on_progress=stop).interrupted
    with pytest.raises(ZeroDivisionError):
        sb.sweep(file, store, on_progress=fail)
    assert len(kept(store)) == 2
    found = sb.sweep(file, store)
    assert (found.computed, found.note) == (10, "")
    assert sorted(os.listdir(tmp_path)) == ["store", "sweep.toml"]
