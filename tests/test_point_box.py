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


def test_a_state_whose_judge_is_too_large_is_solved_and_judged_later(box, tmp_path, monkeypatch, capsys):
    kept = tmp_path / "kept.jsonl"
    here = ["point_box.py", "--number", "1", "--rtol", "1e-2", "--out", str(kept), "--largest"]
    for largest, judged in (("0", ""), ("1500", "| exponential | 1 | 1 | 1 | 100.0% |")):
        monkeypatch.setattr("sys.argv", [*here, largest])
        box.main()
        assert judged in capsys.readouterr().out
        assert ("ratio" in json.loads(kept.read_text().splitlines()[-1])) == bool(judged)
    assert len(kept.read_text().splitlines()) == 2


def test_balls_with_parts_are_drawn_one_by_one_and_judged_where_the_judge_is_not_too_large(
    load_benchmark, tmp_path, capsys, monkeypatch
):
    load_benchmark("point_box")
    parts = load_benchmark("point_parts")
    assert [parts.draw("combined", number, 15)[1]["cavitation"] for number in (0, 1, 2)] == ["exit", "none", "exit"]
    assert parts.draw("cavitated", 4, 15)[0].roughness == 0.0
    kept = tmp_path / "kept.jsonl"
    for largest in ("0", "7000"):
        here = ["point_parts.py", "cavitated", "--first", "3", "--number", "4", "--rtol", "1e-2", "--out", str(kept)]
        monkeypatch.setattr("sys.argv", [*here, "--largest", largest])
        kept.unlink(missing_ok=True)
        parts.main()
        row = json.loads(kept.read_text())
        assert row["outcome"] == "CONVERGED"
        assert ("ratios" in row) == (largest != "0")
    assert max(row["ratios"].values()) <= 1
    monkeypatch.setattr("sys.argv", [*here, "--table"])
    parts.main()
    assert "| 1 | 0 | 1 | 1 | 100.0% | 100.0% |" in capsys.readouterr().out
