"""The explorer: memory that closed pages and moves of sliders leave in the server.

Pages are asked for and left, as by a browser that goes away at once; the server forgets them after half a minute. Moves are
those of a slider in headless Chromium and need the extra ``browser`` and Debian's ``chromium`` (or CHROMIUM=PATH). Linux:
the memory is what /proc says.
"""

from __future__ import annotations

import argparse
import http.client
import os
import platform
import re
import shutil
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

LOADS, MOVES = 500, 5000
FORGOTTEN = 60.0
"""Seconds after which no page that was left is kept."""

MOVE = """([name, place]) => {
  const slider = document.querySelector(`[data-row=${name}] input.slider`);
  slider.value = place;
  slider.dispatchEvent(new Event('input', {bubbles: true}));
}"""
PLACES = {"speed": (-4.0, -2.0), "load": (1.0, 2.0), "roughness": (-6.5, -5.5), "viscosity": (-2.0, -1.0)}


def main() -> None:
    arguments = argparse.ArgumentParser(description="Memory that closed pages and moves of sliders leave in the server.")
    arguments.add_argument("--loads", type=int, default=LOADS, help=f"pages that are opened and left (default {LOADS})")
    arguments.add_argument("--moves", type=int, default=MOVES, help=f"moves of sliders (default {MOVES})")
    chosen = arguments.parse_args()
    print(f"{platform.python_version()}, {platform.machine()}, {os.cpu_count()} cores")
    command = [sys.executable, "-m", "stribeck", "explore", "--no-browser"]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as server:
        try:
            assert server.stdout is not None
            found = re.search(r"http://127\.0\.0\.1:(\d+)/\?token=(\S+)", server.stdout.readline())
            assert found is not None
            time.sleep(2)
            port, token = int(found[1]), found[2]
            load(port, token, 30)
            print("| | memory before, MB | after, MB | left, MB |\n|---|---|---|---|", flush=True)
            # The first time the allocator grows to what the pages of half a minute need together, and keeps some of it.
            for which in ("pages", "more pages"):
                report(f"{chosen.loads} {which}", server.pid, lambda: load(port, token, chosen.loads))
            move(found[0], server.pid, chosen.moves)
        finally:
            server.terminate()


def report(name: str, pid: int, act: Callable[[], None]) -> None:
    """Do something and print what memory it left."""
    before = memory(pid)
    act()
    after = memory(pid)
    print(f"| {name} | {before:.0f} | {after:.0f} | {after - before:+.0f} |", flush=True)


def memory(pid: int) -> float:
    """Return the resident memory of a process [MB]."""
    pages = int(Path(f"/proc/{pid}/statm").read_text().split()[1])
    return pages * os.sysconf("SC_PAGE_SIZE") / 1e6


def load(port: int, token: str, number: int) -> None:
    for _ in range(number):
        connection = http.client.HTTPConnection("127.0.0.1", port, timeout=120)
        connection.request("GET", "/", headers={"Cookie": f"stribeck-explorer-{port}={token}"})
        answer = connection.getresponse()
        assert answer.status == 200, answer.status
        answer.read()
        connection.close()
    time.sleep(FORGOTTEN)


def move(address: str, pid: int, number: int) -> None:
    chromium = os.environ.get("CHROMIUM") or shutil.which("chromium")
    try:
        from playwright.sync_api import sync_playwright
    except ImportError:
        print("moves not run: pip install 'stribeck[app,browser]'")
        return
    if chromium is None:
        print("moves not run: there is no chromium; apt-get install chromium, or say where it is with CHROMIUM=")
        return
    with sync_playwright() as play:
        browser = play.chromium.launch(executable_path=chromium, args=["--no-sandbox"])
        page = browser.new_page(viewport={"width": 1440, "height": 900})
        page.goto(address)
        page.wait_for_selector(".chart-diagram canvas")
        page.evaluate("document.querySelectorAll('details.fold').forEach(each => { each.open = true; })")

        def moves(count: int) -> None:
            for i in range(count):
                name = list(PLACES)[i // 25 % len(PLACES)]
                low, high = PLACES[name]
                page.evaluate(MOVE, [name, low + (high - low) * (0.618034 * i % 1)])
                page.wait_for_timeout(60)
            page.wait_for_timeout(8000)

        moves(min(number, 300))
        report(f"{number} moves", pid, lambda: moves(number))
        browser.close()


if __name__ == "__main__":
    main()
