"""How far a reader walks: the files between a call and the first residual."""

from collections import Counter


def test_a_call_reaches_the_first_residual_through_few_files(subtests, load_benchmark):
    for walk, files in [("in_python", 12), ("on_the_command_line", 16)]:
        with subtests.test(walk=walk, files=files):
            found = getattr(load_benchmark("walk"), walk)()
            assert found[-1] == "equations/line.py"
            assert len(set(found)) <= files
            assert max(Counter(found).values()) <= 8  # a path asks its corrector, and this one the rigid guess, in turns
