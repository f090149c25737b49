"""One open page: what the user does on it, and the answers that follow.

One answer is on its way, and what takes longer comes when the inputs rest. What changes meanwhile is asked next, so that the
last value wins and a slow machine shows fewer pictures instead of late ones.
"""

from __future__ import annotations

import asyncio
import gc
import inspect
import time
import weakref
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from pathlib import PurePath
from typing import Any

from nicegui import background_tasks, events

from stribeck.cases.reading import load_case
from stribeck.explorer import downloads as files
from stribeck.explorer import uploads
from stribeck.explorer.answer import Answer, Answerer
from stribeck.explorer.charts import residual_chart
from stribeck.explorer.inputs import choices, inputs, url
from stribeck.explorer.inputs.inputs import History, Inputs
from stribeck.explorer.page import UPDATING_TEXT, Page, Problems, form_of, parts_of
from stribeck.explorer.table import without_rtol
from stribeck.explorer.uploads import Measured, Scan
from stribeck.files.writing import MissingExtraError
from stribeck.numerics.newton import ended_by
from stribeck.quantities.units import InputError
from stribeck.solver.solve_error import SolveError

FILES = ThreadPoolExecutor(2, "explorer-files")
"""Of all pages: addresses and files."""


class Threads:
    """The threads of one page, which wait for no other page; they start when they are first needed."""

    def __init__(self) -> None:
        self.live = ThreadPoolExecutor(1, "explorer-live")
        self.slow = ThreadPoolExecutor(1, "explorer-slow")

    def close(self) -> None:
        """Drop what waits, and end with what runs."""
        for pool in (self.live, self.slow):
            pool.shutdown(wait=False, cancel_futures=True)


async def run(
    pool: ThreadPoolExecutor, function: Callable[..., Any], *arguments: Any, watch: Callable[[], object] = lambda: None
) -> Any:
    """Return what a function gives, computed in a thread; what ``watch`` raises between two steps of iterations ends it."""

    def watched() -> Any:
        watch()
        with ended_by(watch):
            return function(*arguments)

    return await asyncio.get_running_loop().run_in_executor(pool, watched)


# Open pages, by the names of their clients; a page that is closed drops out.
TABS: weakref.WeakValueDictionary[str, Tab] = weakref.WeakValueDictionary()

MAX_MEASURED = 3  # Files of measured curves that a page shows.

MARK_AFTER_SECONDS = 0.15  # Wait for an answer after which the old one is marked as old [s].

# Age at which an unfinished answer is ended when the inputs change; a younger one is still shown [s].
CANCEL_AFTER_SECONDS = 1.0

IDLE_SECONDS = 0.4  # Pause after the last change before slow work begins [s].


class Superseded(Exception):  # noqa: N818
    """The inputs changed, or the page was closed, while something slow was computed for them."""


def reason(problem: Exception) -> str:
    """Return in a sentence why something could not be computed."""
    if isinstance(problem, MissingExtraError):
        return str(problem)
    if isinstance(problem, InputError | SolveError):
        return without_rtol(str(problem))
    return f"Internal error ({' '.join(repr(problem).split())[:300]})."


def _filled(texts: dict[str, str]) -> dict[str, str]:
    """Return those texts that are not empty."""
    return {str(name): str(text).strip() for name, text in texts.items() if str(text).strip()}


class Tab:
    """One open page."""

    def __init__(self, opened: url.Opened, start: Inputs) -> None:
        self.start, self.inputs, self.pins = start, opened.inputs, list(opened.pins)
        self.measured: list[Measured] = []
        self.file = "", b""  # The last file of measured curves, as long as the page is open
        self.problems: Problems = {key: {"typed": text, "sentence": said} for key, (text, said) in opened.problems.items()}
        self.model, self.threads, self.history = Answerer(), Threads(), History(self.inputs)
        self.answer: Answer | None = None
        self.message = self.progress = ""
        self.is_requested = self.working = self.closed = False
        self.changes = self.answered_changes = 0
        self.resting: asyncio.Task[Any] | None = None
        self.page = Page()
        self.page.on("act", self.act)
        self.page.client.on_delete(self.close)
        self.page.client.on_connect(self.rest)
        self.actions: dict[str, Callable[..., Any]] = {
            "slide": lambda name, place: self.attempt(name, "", place, inputs.with_slider, name, float(place)),
            "type": lambda name, text: self.attempt(name, "", text, choices.typed, name, str(text)),
            "unit": lambda name, unit: self.attempt(name, "", unit, inputs.in_unit, name, str(unit)),
            "pick": lambda name, value: self.attempt(name, "", "", choices.choose, name, str(value)),
            "detail": lambda name, key, text: self.attempt(name, key, text, choices.with_detail, name, key, str(text)),
            "choose": lambda name, value: self.change(self.inputs.replace(**{name: value})),
            "undo": lambda: self.step(-1),
            "redo": lambda: self.step(1),
            "retry": self.request,
            **{name: getattr(self, name) for name in ("restore", "back", "pin", "remove", "example", "fit")},
            **{name: getattr(self, name) for name in ("show_fit", "ask_columns", "read_columns", "code")},
        }
        TABS[self.page.client.id] = self

    async def act(self, event: events.GenericEventArguments) -> None:
        """Do what the user means."""
        what, *given = event.args
        done = self.actions[what](*given)
        if inspect.isawaitable(done):
            await done

    # --- what the user does ---

    def attempt(self, name: str, key: str, text: Any, action: Callable[..., Inputs], *given: Any) -> None:
        """Change the inputs, or mark the field with the reason why not."""
        try:
            changed = action(self.inputs, *given)
        except InputError as problem:
            of = "choice" if action is choices.choose else "field"
            self.problems[name] = {"typed": str(text), "sentence": str(problem), "wrong": key, "of": of}
            self.show_form()
            return
        # The list of a refused choice has gone back: why it was refused may no longer be true.
        self.problems = {each: problem for each, problem in self.problems.items() if problem.get("of") != "choice"}
        self.restore(name)
        self.change(changed)

    def restore(self, name: str) -> None:
        """Show a field anew, without mark."""
        self.problems.pop(name, None)
        self.page.renew()

    def change(self, changed: Inputs) -> None:
        """Take new inputs and ask for their answer."""
        self.inputs = changed
        self.changes += 1
        self.request()

    def back(self) -> None:
        """Return to the inputs that are shown, and from these to those before."""
        self.problems.clear()
        if self.answer is None or self.inputs is self.answer.inputs:
            self.step(-1)
        else:
            self.change(self.answer.inputs)

    def step(self, way: int) -> None:
        """Undo or redo."""
        found = self.history.step(way, self.inputs)
        if found is not None:
            self.problems.clear()
            self.change(found)
        self.page.show(**self.history.steps)

    def pin(self) -> None:
        """Keep the present curve."""
        name = files.pin_name(self.inputs, self.start, [pin.case.title for pin in self.pins])
        pins = [*self.pins, self.inputs.replace(title=name)]
        try:
            if len(pins) > url.MAX_PINS:
                raise InputError(f"Up to {url.MAX_PINS} curves can be pinned; remove one first.")
            url.check_length(self.inputs, pins)
        except InputError as problem:
            self.complain(str(problem))
            return
        self.pins = pins
        self.request()

    def remove(self, place: int) -> None:
        """Drop a pinned or a measured curve."""
        if place < len(self.pins):
            del self.pins[place]
        else:
            self.show_measured([each for k, each in enumerate(self.measured, len(self.pins)) if k != place])
        self.request()

    def show_measured(self, measured: list[Measured]) -> None:
        """Show other measured curves, of the last files; a fit that stands there may belong to one that goes."""
        files = list(dict.fromkeys(each.file for each in measured))[-MAX_MEASURED:]
        self.measured = [each for each in measured if each.file in files]
        self.page.show(fitting=None, fitted=None)

    async def example(self, title: str) -> None:
        """Show an example."""
        path = files.examples()[title]
        self.begin(await run(FILES, lambda: inputs.from_case(load_case(path))))

    def begin(self, found: Inputs) -> None:
        """Show the inputs of a case."""
        self.start = found
        self.problems.clear()
        self.change(replace(found, abscissa=self.inputs.abscissa))

    async def take_file(self, name: str, content: bytes, **asked: dict[str, str]) -> None:
        """Take a case, a measured curve or a surface that the browser sent; undo brings back the inputs before."""
        kinds: dict[str, Any] = {".toml": "case"} | dict.fromkeys(uploads.SCAN_ENDINGS, "scan")
        kind = kinds.get(PurePath(name.lower()).suffix, "measured")
        self.page.show(message=f"Reading {name} ...", failed=False)
        table = self.inputs.tables.get("fit", {})
        table |= {key: table.get(key, {}) | each for key, each in asked.items()}
        try:
            found = await run(FILES, uploads.read_file, kind, name, content, self.inputs.contact, table)
            if kind == "case":
                self.begin(found)
            elif isinstance(found, Scan):
                self.change(uploads.with_scan(self.inputs, found))
                self.message = found.report
            else:
                self.file = name, content
                self.show_measured([*(each for each in self.measured if each.file != name), *found])
                self.page.show(mapping=None)
                self.message = uploads.reading(found[0])
                self.request()
        except InputError as problem:
            self.file = name, content
            if kind != "measured" or not await self.ask_columns(str(problem)):
                self.complain(str(problem))
        self.page.show(message="")

    async def ask_columns(self, said: str = "") -> bool:
        """Ask what the columns of the last file are; False where it has none."""
        name, content = self.file
        try:
            headers = await run(FILES, uploads.read_file, "headers", name, content, self.inputs.contact)
        except InputError:
            return False
        wrong = said.partition("; say which")[0].removesuffix(".")
        self.page.show(mapping={"file": name, "said": wrong, "headers": headers, "meanings": uploads.MEANINGS})
        return len(headers) > 1

    async def read_columns(self, columns: dict[str, str], units: dict[str, str]) -> None:
        """Read the last file with columns that the user named."""
        await self.take_file(*self.file, columns=_filled(columns), units=_filled(units))

    def show_fit(self) -> None:
        """Show what may be fitted to the measured curves of the last file."""
        last = self.measured[-1]
        taken = uploads.reading_for_fit(self.inputs, last)
        self.page.show(fitting={"file": last.file, "inputs": uploads.free_inputs(self.inputs), "taken": taken})

    async def fit(self, *free: str) -> None:
        """Fit inputs to the measured curves of the last file; undo brings back those before."""
        now, last = self.inputs, self.measured[-1]
        self.page.show(message=f"Fitting to {last.file} ...", failed=False)

        def step(*_: Any) -> None:
            if self.closed or self.inputs is not now:
                raise Superseded

        try:
            fitted = await run(self.threads.slow, uploads.fit_measured, now, last, step, free, watch=step)
        except Superseded:
            self.page.show(message="The fit was given up, as the inputs changed.")
        except Exception as problem:
            self.page.show(message=f"No fit: {reason(problem)}")
        else:
            self.change(fitted.inputs)
            self.message = fitted.report
            self.page.show(fitted=fitted.shown, charts={"residuals": residual_chart(fitted.found)})

    async def content(self, kind: str) -> tuple[str, bytes] | None:
        """Return name and content of a file of what is shown, or None after saying why there is none."""
        try:
            answer = self.answer or await run(self.threads.live, self.model, self.inputs, watch=self.while_open)
            found: bytes = await run(FILES, files.content, kind, answer, watch=self.while_open)  # no curve is waited for
        except Superseded:
            return None
        except Exception as problem:
            self.complain(reason(problem))
            return None
        return files.name_of(kind, answer.inputs.case.title), found

    def code(self, kind: str) -> None:
        """Show the present state as a program or as commands, to be copied."""
        if self.answer is not None:
            self.page.show(code=files.CODES[kind](self.answer))

    def complain(self, text: str) -> None:
        """Show sentences about a file until they are read."""
        self.page.show(complaint=text.splitlines())

    # --- what follows ---

    def request(self) -> None:
        """Ask for the answer to the present inputs; only one is on its way."""
        self.is_requested = True
        if not self.working:
            self.working = True
            background_tasks.create(self.work(), name="explorer answers")

    async def work(self) -> None:
        """Answer until nothing is asked any more, the last inputs last."""
        try:
            while self.is_requested and not self.closed:
                self.is_requested = False
                now, changes = self.inputs, self.changes
                try:
                    self.answer = await self.compute(now, changes)
                    await self.draw(message=self.message or self.other_problems(), failed=False)
                    self.message = ""
                except Superseded:
                    continue
                except Exception as problem:  # a page that silently no longer follows would be worse
                    await self.keep_last_answer(problem)
                self.answered_changes = changes
        finally:
            self.working = False
        self.rest()

    async def keep_last_answer(self, problem: Exception) -> None:
        """Keep the last answer, with all that belongs to it, and say why the next one is not there."""
        if not isinstance(problem, InputError | SolveError):
            self.model = Answerer()  # what the failure left in the old one is not to be trusted
        try:
            if self.answer is None:
                self.answer = await run(self.threads.live, self.model, self.start, watch=self.while_open)
            await self.draw(message=f"{reason(problem)} What is shown belongs to the inputs before.", failed=True)
        except Exception as again:
            self.page.show(message=f"{reason(again)} Reload the page.", failed=True)

    async def compute(self, now: Inputs, changes: int) -> Answer:
        """Return the answer; where that takes longer than a moment, mark what is shown."""
        began = time.monotonic()

        def watch() -> None:
            self.while_open()
            if self.changes != changes and time.monotonic() - began > CANCEL_AFTER_SECONDS:
                raise Superseded

        work = asyncio.ensure_future(self.answer_to(now, watch))
        done, _ = await asyncio.wait({work}, timeout=MARK_AFTER_SECONDS)
        if not done:
            self.page.show(working=True, **form_of(now, self.problems))
        return await work

    async def answer_to(self, now: Inputs, watch: Callable[..., None]) -> Answer:
        """Return the answer to inputs with the pinned and measured curves."""
        found: Answer = await run(self.threads.live, self.model, now, tuple(self.pins), tuple(self.measured), watch=watch)
        return found

    async def draw(self, **others: Any) -> None:
        """Send what changed, and wait until the browser has drawn it."""
        self.while_open()
        assert self.answer is not None
        parts = {"working": False, "source": self.progress or UPDATING_TEXT} | parts_of(self.answer)
        try:
            await self.page.show(**parts, **form_of(self.inputs, self.problems), **others)
        except TimeoutError:  # a tab in the background answers when it is looked at
            pass

    def show_form(self) -> None:
        """Show fields, lists and what is wrong with them."""
        self.page.show(**form_of(self.inputs, self.problems))

    def other_problems(self) -> str:
        """Return what is wrong with what has no field."""
        known = (*self.inputs.fields, *inputs.GROUP_FIELDS, *choices.CHOICES)
        return "\n".join(problem["sentence"] for name, problem in self.problems.items() if name not in known)

    def is_shown(self, now: Inputs) -> bool:
        """Whether the page shows the answer to these inputs, and no others were asked for since."""
        same = self.answer is not None and self.answer.inputs is now
        return same and self.answered_changes == self.changes and not self.closed

    # --- when the inputs rest ---

    def rest(self) -> None:
        """Wait for a while without change, then do what takes longer."""
        if self.closed or self.answer is None:
            return
        if self.resting is not None:
            self.resting.cancel()
        self.resting = background_tasks.create(self.settle(self.answer.inputs), name="explorer rests")

    async def settle(self, now: Inputs) -> None:
        """Solve the curve outside the atlas at once; at rest put the state into the address and do what takes longer."""

        def go_on(*_: Any) -> None:
            # What a browser left is given up at once, and done anew if it comes back.
            if not self.is_shown(now) or not self.page.client.has_socket_connection:
                raise Superseded

        def report(part: float) -> None:
            go_on()
            self.progress = f"{UPDATING_TEXT} {100 * part:.0f} %"

        self.progress = ""
        idle = asyncio.ensure_future(self.remember(now))
        try:
            for part in self.model.at_rest(now, tuple(self.pins)):
                await self.finish(part(report), now, go_on)
                await idle
        except Superseded:
            return
        finally:
            idle.cancel()

    async def finish(self, steps: Any, now: Inputs, go_on: Callable[..., None]) -> None:
        """Do a part of the slow work, and show what it finds step by step; its failure holds up no other."""
        while True:
            step = asyncio.ensure_future(run(self.threads.slow, next, steps, False, watch=go_on))
            step.add_done_callback(lambda task: task.cancelled() or task.exception())
            try:
                while not (await asyncio.wait({step}, timeout=IDLE_SECONDS))[0]:
                    if self.answer is not None and "curve" in self.answer.stale and self.progress:
                        self.page.show(source=self.progress)
                if step.result() is False:
                    return
                if not self.is_shown(now) or self.working:
                    raise Superseded
                found = await self.answer_to(now, go_on)
                if not self.is_shown(now) or self.working:
                    raise Superseded
                self.answer = found
                await self.draw()
            except Superseded:
                raise
            except Exception as problem:
                self.page.show(message=reason(problem), failed=True)
                return

    async def remember(self, now: Inputs) -> None:
        """Put the inputs that rest into the address and among the steps of undo."""
        await asyncio.sleep(IDLE_SECONDS)
        if self.is_shown(now):
            self.history.rest(now)
            self.page.show(address=f"?{url.encode(now, self.pins)}", **self.history.steps)

    # --- the browser ---

    def while_open(self, *_: Any) -> None:
        """End slow work of a page that is gone."""
        if self.closed:
            raise Superseded

    def close(self) -> None:
        """Stop what runs for a page that is gone."""
        self.closed = True
        self.threads.close()
        FILES.submit(gc.collect)  # a page is a net of objects that refer to each other, which Python finds seldom
        if self.resting is not None:
            self.resting.cancel()

    async def open(self) -> None:
        """Wait for the browser, and show the first answer."""
        try:
            await self.page.client.connected(timeout=30)
        except TimeoutError:  # the browser went away at once
            if not self.closed:
                self.page.client.delete()
        if not self.closed:
            self.show_form()
            self.request()
