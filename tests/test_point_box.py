"""A small part of the benchmark of random cold states of the ball; the whole of it is in docs/numerics_tables.md."""

import json

import pytest


@pytest.fixture
def box(load_benchmark):
    return load_benchmark("point_box")


@pytest.mark.slow
def test_random_cold_states_are_solved_and_their_errors_covered(box):
    rows = [box.judged(7, number, 1e-4) for number in range(20)]
    assert [row["outcome"] for row in rows] == ["CONVERGED"] * 20
    assert max(row["load_error"] for row in rows) < 1e-8
    assert max(row["ratio"] for row in rows) < 10
    assert sum(row["ratio"] <= 1 for row in rows) >= 18


@pytest.mark.quick
def test_a_state_of_the_box_does_not_depend_on_the_others_and_none_is_solved_twice(box, tmp_path, monkeypatch, capsys):
    kind, groups = box.draw(14, 5)
    assert (kind, float(groups.speed)) == ("rest", 0.0)
    kept = tmp_path / "kept.jsonl"
    rows = [box.judged(14, 5, 1e-4) | {"number": number} for number in (0, 1)]
    kept.write_text("".join(json.dumps(row) + "\n" for row in rows))
    monkeypatch.setattr("sys.argv", ["point_box.py", "--number", "2", "--rtol", "1e-4", "--out", str(kept)])
    monkeypatch.setattr(box, "solve_cold", None)
    box.main()
    assert "| rest | 2 | 2 | 2 | 100.0% |" in capsys.readouterr().out
