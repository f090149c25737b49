"""Running the command: arguments, exit codes, and errors as sentences."""

from __future__ import annotations

import os
import signal
import sys
import threading
import warnings
from collections.abc import Callable, Sequence

from cyclopts import App, CycloptsError, MissingArgumentError, Parameter, UnusedCliTokensError

import stribeck as sb
from stribeck.cli import measured, solving, strokes, studies
from stribeck.cli.exits import (
    EXIT_BAD_INPUT,
    EXIT_BROKEN_PIPE,
    EXIT_FAILED,
    EXIT_INTERRUPTED,
    Interrupted,
    OutputError,
    complain,
    prepare_streams,
    redirect_to_null,
)
from stribeck.files.writing import reason_of
from stribeck.quantities.outcome import Outcome
from stribeck.quantities.units import InputError, show

HELP = """Friction and film thickness of lubricated rough contacts, from a TOML file with units.

Example: stribeck curve examples/pdms_cylinder.toml -o curve.nc --plot curve.png

Exit codes: 0 success, 1 the solve failed or the output could not be written, 2 bad input, 130 interrupted."""


COMMANDS: dict[str, Callable[..., int]] = {
    command.__name__.removesuffix("_command"): command
    for command in (
        *(studies.new_command, solving.check_command, solving.solve_command, solving.curve_command, solving.regimes_command),
        *(solving.figures_command, studies.sweep_command, studies.surface_command, strokes.stroke_command),
        *(strokes.leak_command, measured.bench_command, measured.fit_command, measured.loop_command, measured.next_command),
        *(measured.compare_command, measured.master_command, measured.experiment_command, studies.report_command),
        studies.explore_command,
    )
}

MIN_TERMINAL_WIDTH = 20  # Smallest plausible width of a terminal [columns].

MAX_WIDTH_DIGITS = 4  # Digits of the largest plausible width of a terminal.


def main(tokens: Sequence[str] | None = None) -> int:
    """Run the command and return its exit code; errors become sentences on stderr."""
    if tokens is None:
        tokens = sys.argv[1:]
        _adapt_process()
    interrupted = Interrupted()
    heeds = (
        threading.current_thread() is threading.main_thread() and signal.getsignal(signal.SIGINT) is signal.default_int_handler
    )
    if heeds:
        signal.signal(signal.SIGINT, interrupted)
    try:
        return _run(list(tokens), interrupted)
    finally:
        if heeds:
            signal.signal(signal.SIGINT, signal.default_int_handler)


def _run(tokens: list[str], interrupted: Interrupted) -> int:
    """Run the command and turn exceptions into sentences."""
    try:
        result = make_app()(
            tokens,
            print_error=False,
            exit_on_error=False,
            help_on_error=False,
            result_action="return_value",
        )
        sys.stdout.flush()
        return result if isinstance(result, int) else 0
    except CycloptsError as problem:
        if isinstance(problem.__cause__, InputError):  # of a word that an option does not take
            return complain(str(problem.__cause__), EXIT_BAD_INPUT)
        return complain(f"{_parsing(problem)} See {_command(tokens)} --help.", EXIT_BAD_INPUT)
    except InputError as problem:
        return complain(str(problem), EXIT_BAD_INPUT)
    except KeyboardInterrupt:
        return complain("Interrupted; nothing was written.", EXIT_INTERRUPTED)
    except (BrokenPipeError, SystemExit):  # the reader, such as head, had enough, for which the help leaves the process
        redirect_to_null(sys.stdout)
        return EXIT_BROKEN_PIPE
    except OutputError as problem:
        redirect_to_null(sys.stdout)
        return complain(f"The output could not be printed ({problem}); the requested files were written.", EXIT_FAILED)
    except MemoryError:
        return complain("Out of memory; ask for fewer points or a larger rtol.", EXIT_FAILED)
    except OSError as problem:  # a name of 300 letters, no file handles, a full disk
        where = f" of {show(os.fsdecode(problem.filename))}" if isinstance(problem.filename, str | bytes) else ""
        return complain(f"The system refused the use{where}: {reason_of(problem)}.", EXIT_FAILED)
    except sb.SolveError as problem:
        if problem.outcome is Outcome.ROUNDING and problem.solution is not None:
            return complain(f"rtol = {problem.solution.rtol:g} cannot be reached at {problem}", EXIT_BAD_INPUT)
        return complain(str(problem), EXIT_FAILED)
    except sb.SweepError as problem:
        return complain(str(problem), EXIT_FAILED)
    except Exception as problem:
        if interrupted.pressed:
            return complain("Interrupted; nothing was written.", EXIT_INTERRUPTED)
        if os.environ.get("STRIBECK_DEBUG"):
            raise
        return complain(
            f"Internal error ({type(problem).__name__}: {_line(problem)}) "
            "Please report it, with the output after setting STRIBECK_DEBUG=1 in the environment.",
            EXIT_FAILED,
        )


def make_app() -> App:
    """Return the command line for cyclopts."""
    app = App(
        name="stribeck",
        help=HELP,
        version=lambda: sb.__version__,
        help_format="plaintext",
        default_parameter=Parameter(negative="", show_default=False),
        suppress_keyboard_interrupt=False,
    )
    for name, command in COMMANDS.items():
        app.command(command, name=name)
    app.register_install_completion_command()
    return app


def _parsing(problem: CycloptsError) -> str:
    """Return the sentence for incompatible arguments."""
    if isinstance(problem, UnusedCliTokensError) and problem.unused_tokens:
        return f"unexpected argument {problem.unused_tokens[0]!r}."
    if isinstance(problem, MissingArgumentError) and problem.argument is not None:
        if problem.keyword is None:
            return f"{problem.argument.name.lstrip('-')} is missing; give it as in: {_example(problem)}."
        count = problem.argument.token_count()[0]
        wanted = f"{count} values" if count > 1 else "a value"
        return f"{problem.keyword} needs {wanted}, but {len(problem.tokens_so_far)} given."
    option = str(problem).removeprefix("Unknown option: ").strip('".')  # the quotes come and go with its versions
    if option in ("-o", "--output") and list(problem.command_chain or ()) == ["new"]:
        return f"Unknown option: {option}. The file is given without an option, as in stribeck new case.toml."
    return _line(problem)


def _example(problem: CycloptsError) -> str:
    """Return the first example in the help of the command that was called."""
    [command] = problem.command_chain or ()
    return (COMMANDS[command].__doc__ or "").partition("Example: ")[2].partition("\n")[0]


def _line(problem: BaseException) -> str:
    text = " ".join(str(problem).split())
    return text if not text or text.endswith((".", "?", "!")) else f"{text}."


def _command(tokens: Sequence[str]) -> str:
    return " ".join(["stribeck", *(token for token in tokens[:1] if token in COMMANDS)])


def _adapt_process() -> None:
    """Set what belongs to a process of our own: letters that any terminal takes, warnings only on demand."""
    prepare_streams()
    columns = os.environ.get("COLUMNS", "80")
    if not (columns.isdecimal() and len(columns) <= MAX_WIDTH_DIGITS and int(columns) >= MIN_TERMINAL_WIDTH):
        del os.environ["COLUMNS"]  # in no columns nothing is shown, and the help never ends; in 1e9 it fills the memory
    os.environ["MPLBACKEND"] = (
        "agg"  # pictures need no display; matplotlib refuses to be imported with a name that it does not know
    )
    if not sys.warnoptions and not os.environ.get("STRIBECK_DEBUG"):
        warnings.simplefilter("ignore")
