"""What surrounds the command: streams that take no more, Ctrl-C at any time, too little memory, odd files."""

import functools
import os
import re
import resource
import signal
import socket
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest
from command_line import FEW, PDMS, call, environment, main

import stribeck as sb

COMMAND = (sys.executable, "-m", "stribeck")
SOLVE = (*COMMAND, "solve", "--groups", "1e-4", "0.1", "1e-3")


def heed():
    """Begin as a shell's foreground job, in which Ctrl-C is not ignored."""
    signal.signal(signal.SIGINT, signal.default_int_handler)


def run(*tokens, prepare=heed, stdout=subprocess.PIPE, **extra):
    found = subprocess.run(
        tokens, stdout=stdout, stderr=subprocess.PIPE, preexec_fn=prepare, env=environment(**extra), text=True, timeout=60
    )
    return found.returncode, found.stdout, found.stderr


def test_the_installed_command_is_the_one_that_is_tested_here():
    project = tomllib.loads((Path(__file__).parents[1] / "pyproject.toml").read_text())
    assert project["project"]["scripts"] == {"stribeck": "stribeck.__main__:main"}


# --- streams ---


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="there is no full device here")
def test_what_a_full_disk_does_not_take_is_told_and_twenty_open_files_suffice_for_a_state():
    few_files = functools.partial(resource.setrlimit, resource.RLIMIT_NOFILE, (20, 20))
    with open("/dev/full", "w") as full:
        code, _, err = run(*SOLVE, stdout=full, prepare=few_files)
    reason = "No space left on device"
    assert (code, err) == (1, f"stribeck: The output could not be printed ({reason}); the requested files were written.\n")


def test_a_closed_stdout_is_told_and_its_number_given_to_no_file(tmp_path):
    picture = tmp_path / "a.svg"
    code, _, err = run(*SOLVE, "--plot", picture, stdout=None, prepare=lambda: os.close(1), MPLBACKEND="nonsense")
    assert (code, err[:41]) == (1, "stribeck: The output could not be printed")
    assert err.endswith("not be printed (Bad file descriptor); the requested files were written.\n")
    assert picture.read_text().rstrip().endswith("</svg>")


def test_a_stderr_that_takes_nothing_changes_no_exit_code(monkeypatch):
    class Full:
        def write(self, text):
            raise OSError(28, "No space left on device")

        def fileno(self):
            raise ValueError

        flush = write

    for stream in (Full(), None):
        monkeypatch.setattr(sys, "stderr", stream)
        assert main(["solve"]) == 2


def test_a_terminal_without_columns_gets_the_help():
    """It never ended."""
    code, out, err = run(*COMMAND, "solve", "--help", COLUMNS="0")
    assert (code, err) == (0, "") and "Example: stribeck solve" in out


def test_a_backend_that_matplotlib_does_not_know_is_a_sentence_in_python(monkeypatch):
    def unknown(name, *arguments, **options):
        if name.startswith("matplotlib"):
            raise ValueError("Key backend: 'nonsense' is not a valid value")
        return whole(name, *arguments, **options)

    state = sb.solve(sb.Groups(1.0, 0.1, 1e-3), rtol=1e-2)
    whole = __builtins__["__import__"] if isinstance(__builtins__, dict) else __builtins__.__import__
    monkeypatch.setattr("builtins.__import__", unknown)
    with pytest.raises(sb.InputError, match=r"matplotlib cannot be loaded \(Key backend: 'nonsense' is not a valid value\)\."):
        state.plot()


# --- Ctrl-C ---

PRESSED = """
import os, runpy, signal, sys
class Press:
    def find_spec(self, name, path=None, target=None):
        if name == {library!r}:
            os.kill(os.getpid(), signal.SIGINT)
            raise ImportError("as a library may say that was interrupted")
sys.meta_path.insert(0, Press())
sys.argv[0] = "stribeck"
runpy.run_module("stribeck", run_name="__main__")
"""


def test_ctrl_c_while_libraries_are_loaded_is_a_sentence_and_130():
    """The first is loaded before there is a command, the other by the command itself."""
    for library in ("cyclopts", "scipy"):
        found = run(sys.executable, "-c", PRESSED.format(library=library), "solve", PDMS)
        assert found == (130, "", "stribeck: Interrupted; nothing was written.\n")


def test_ctrl_c_that_a_library_turns_into_another_error_is_an_interruption(capsys, monkeypatch):
    def solve(*arguments, **options):
        try:
            os.kill(os.getpid(), signal.SIGINT)
        except KeyboardInterrupt:
            raise ImportError("cannot import name") from None

    monkeypatch.setattr(sb, "solve", solve)
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    try:
        answer = call(capsys, "solve", "--groups", "1e-4", "0.1", "1e-3")
        assert signal.getsignal(signal.SIGINT) is signal.default_int_handler
    finally:
        signal.signal(signal.SIGINT, before)
    assert (answer.code, answer.err) == (130, "stribeck: Interrupted; nothing was written.\n")


# --- memory ---


def test_too_little_memory_is_told_before_libraries_crash():
    limit = functools.partial(resource.setrlimit, resource.RLIMIT_AS, (300_000_000, 300_000_000))
    code, out, err = run(*SOLVE, prepare=limit)
    assert (code, out) == (1, "")
    assert re.fullmatch(r"stribeck: The memory that this process may take does not suffice: 0\.5 GB are needed; .*\n", err)


# --- few open files, and the end of a batch job ---


TERMINATED = """
import os, signal, sys
import stribeck as sb
from stribeck.cli import main
whole = sb.stribeck_curve
def ended(*arguments, on_point, **options):
    def point(done, of):
        on_point(done, of)
        if done == 3:
            os.kill(os.getpid(), signal.SIGTERM)
    return whole(*arguments, on_point=point, **options)
sb.stribeck_curve = ended
sys.exit(main(sys.argv[1:]))
"""


def test_sigterm_on_a_curve_keeps_the_points_that_are_solved(tmp_path):
    file = tmp_path / "curve.csv"
    code, _, err = run(sys.executable, "-c", TERMINATED, "curve", PDMS, *FEW, "--rtol", "1e-3", "-o", file)
    assert code == 130
    told = f"stribeck: Interrupted after 3 of 6 points; {file} contain the points so far, marked as incomplete.\n"
    assert err.endswith(told), err
    assert len(sb.read_measurements(file).friction) == 3


# --- files ---


def test_what_is_no_ordinary_file_is_refused_and_not_waited_for(capsys, tmp_path, monkeypatch, subtests):
    monkeypatch.chdir(tmp_path)
    os.mkfifo("pipe.toml")
    Path("device.toml").symlink_to("/dev/zero")
    with socket.socket(socket.AF_UNIX) as made:
        made.bind("socket.toml")
    options = {"solve": (), "surface": (), "sweep": ("--out", "store"), "fit": (PDMS,)}
    for kind in ("pipe", "device", "socket"):
        odd = rf"it is a {kind}, not an ordinary file"
        reason = odd if kind != "socket" else f"No such device or address|{odd}"
        for command, more in options.items():
            with subtests.test(command, kind=kind):
                answer = call(capsys, command, f"{kind}.toml", *more)
                said = "is not a file; check the name" if command == "surface" else rf"cannot be read \(({reason})\); give"
                assert answer.code == 2 and re.fullmatch(rf"stribeck: {kind}.toml {said}.*\n", answer.err)


DEEP = {
    "dotted key": "a" + ".a" * 200_000 + " = 1",
    "dotted key in quotes": '"a"' + ' . "a"' * 100_000 + " = 1",
    "dotted table": "[a" + ".a" * 200_000 + "]",
    "inline table": "x = { a" + ".a" * 200_000 + " = 1 }",
    "lists": "x = " + "[" * 200 + "]" * 200,
    "more lists": "x = " + "[" * 100_000,
    "inline tables": "x = " + "{a=" * 100 + "1" + "}" * 100,
}


def test_a_case_file_that_is_too_deep_is_refused_before_it_takes_minutes(subtests, tmp_path):
    file = tmp_path / "deep.toml"
    for name, text in DEEP.items():
        with subtests.test(name):
            file.write_text(text)
            with pytest.raises(
                sb.InputError, match="deep.toml is not valid TOML: (a key has|tables or lists are|maximum rec)"
            ):
                sb.load_case(file)
    file.write_text(PDMS.read_text().replace("[contact]", f'notes = "{"e.g. " * 30}..."\n[contact]', 1))
    assert sb.load_case(file).notes.startswith("e.g. ")
