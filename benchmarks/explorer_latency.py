"""The explorer: time from moving a slider to the drawn chart, in headless Chromium through the real server.

Needs the extras ``app`` and ``browser`` and Debian's ``chromium`` (or CHROMIUM=/path/to/it); without them it says so.
For each slider the arrow key is pressed with rests between; the clock runs in the page, from the event of the key to the first
frame after all charts, numbers and fields show the answer; beyond the atlas, to that which shows the solved curve.
"""

from __future__ import annotations

import argparse
import os
import platform
import re
import shutil
import statistics
import subprocess
import sys
from pathlib import Path

MOVES = 25

CASES = [Path(__file__).parents[1] / "examples" / name for name in ("pdms_cylinder.toml", "rubber_ball.toml")]
"""A cylinder that the atlas covers, and a ball whose film re-forms, whose curve is solved."""

SOLVED = {
    "Greenwood and Williamson": ("law", "greenwood-williamson"),
    "both surfaces move": ("motion", "rolling"),
    "Barus": ("viscosity_law", "barus"),
    "Eyring": ("fluid", "eyring"),
    "bonded layer": ("solid", "layer"),
}
"""What is chosen for the cylinder where the curve is solved."""

HEAD = "| {} | median, ms | 90 % within, ms | worst, ms |\n|---|---|---|---|"

CLOCK = """() => {
  window.moves = [];
  window.solved = false;
  addEventListener('keydown', () => { window.pressed = performance.now(); }, true);
  document.addEventListener('shown', ({ detail }) => {
    const start = window.pressed, source = document.querySelector('.friction .source').textContent;
    if (detail.numbers && start && (!window.solved || source.startsWith('solved'))) {
      window.pressed = 0;
      requestAnimationFrame(() => { window.moves.push(performance.now() - start); });
    }
  });
}"""


def main() -> None:
    arguments = argparse.ArgumentParser(description="Time from moving a slider to the drawn chart.")
    arguments.add_argument("--number", type=int, default=MOVES, help=f"moves of each slider (default {MOVES})")
    number = arguments.parse_args().number
    chromium = os.environ.get("CHROMIUM") or shutil.which("chromium")
    try:
        from playwright.sync_api import sync_playwright
    except ImportError:
        print("not run: pip install 'stribeck[app,browser]'")
        return
    if chromium is None:
        print("not run: there is no chromium; apt-get install chromium, or say where it is with CHROMIUM=")
        return
    print(f"{platform.python_version()}, {platform.machine()}, {os.cpu_count()} cores")
    with sync_playwright() as play:
        browser = play.chromium.launch(executable_path=chromium, args=["--no-sandbox"])
        for case in CASES:
            command = [sys.executable, "-m", "stribeck", "explore", str(case), "--no-browser"]
            with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as server:
                try:
                    assert server.stdout is not None
                    address = re.search(r"http://\S+", server.stdout.readline())
                    assert address is not None
                    print(f"\n{case.name}\n")
                    measure(browser.new_page(viewport={"width": 1440, "height": 900}), address[0], number)
                    if case is CASES[0]:
                        measure_solved(browser.new_page(viewport={"width": 1440, "height": 900}), address[0], number)
                finally:
                    server.terminate()
        browser.close()


def measure(page, address: str, number: int) -> None:
    page.goto(address)
    page.wait_for_selector(".chart-diagram canvas")
    page.evaluate("document.querySelectorAll('details.fold').forEach(each => { each.open = true; })")
    page.wait_for_timeout(3000)
    page.evaluate(CLOCK)
    print(HEAD.format("slider"))
    for name in ("speed", "load", "roughness", "boundary_friction", "load_group"):
        print(row(name, moved(page, name, number, 200)))


def measure_solved(page, address: str, number: int) -> None:
    """Move the load of contacts whose curve is solved."""
    page.goto(address)
    page.wait_for_selector(".chart-diagram canvas")
    page.evaluate("document.querySelectorAll('details.fold').forEach(each => { each.open = true; })")
    page.wait_for_timeout(3000)
    page.evaluate(CLOCK)
    print("\n" + HEAD.format("solved curve"))
    for name, (choice, value) in SOLVED.items():
        select = page.locator(f"[data-choice={choice}] select").first
        first = select.input_value()
        select.select_option(value)
        page.wait_for_function("document.querySelector('.friction .source').textContent.startsWith('solved')")
        page.evaluate("window.solved = true")
        print(row(name, moved(page, "load", number, 400)))
        page.evaluate("window.solved = false")
        select.select_option(first)
        page.wait_for_timeout(1000)


def moved(page, name: str, number: int, rest: int) -> list[float]:
    """Return the times after so many keys on a slider, ascending [ms]."""
    page.evaluate("window.moves = []")
    page.focus(f"[data-row={name}] input.slider")
    for move in range(number):
        page.keyboard.press("ArrowRight")
        page.wait_for_function("drawn => window.moves.length > drawn", arg=move)
        page.wait_for_timeout(rest)
    return sorted(page.evaluate("window.moves"))


def row(name: str, found: list[float]) -> str:
    """Return a row of a table."""
    return f"| {name} | {statistics.median(found):.0f} | {found[int(0.9 * len(found))]:.0f} | {found[-1]:.0f} |"


if __name__ == "__main__":
    main()
