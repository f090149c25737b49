"""Make the pictures of docs/explorer.md from the running explorer, in headless Chromium: make screenshots."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

from playwright.sync_api import Page, sync_playwright

IMAGES = Path(__file__).parent / "images"

DESK = {"viewport": {"width": 1440, "height": 900}}
PHONE = {"viewport": {"width": 390, "height": 780}, "device_scale_factor": 2, "is_mobile": True, "has_touch": True}

SOLVED = ".ways tr[data-key=roughness] td[data-value]"  # What to change, which is solved last


def main() -> None:
    """Start the server, take the pictures, and stop it."""
    chromium = os.environ.get("CHROMIUM") or shutil.which("chromium")
    if chromium is None:
        raise SystemExit("there is no chromium: apt-get install chromium, or say where it is with CHROMIUM=")
    command = [sys.executable, "-m", "stribeck", "explore", "--no-browser"]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as server, sync_playwright() as play:
        try:
            assert server.stdout is not None
            address = re.findall(r"http://\S+", server.stdout.readline())[0]
            browser = play.chromium.launch(executable_path=chromium, args=["--no-sandbox"])
            light = opened(browser.new_page(**DESK), address)
            compare(light)
            light.screenshot(path=IMAGES / "explorer.png", full_page=True)
            dark = opened(
                browser.new_page(color_scheme="dark", **DESK), address + "&speed=20+µm/s&roughness=2+nm&alpha=2&beta=0.1"
            )
            dark.screenshot(path=IMAGES / "explorer_dark.png", full_page=True)
            phone = opened(browser.new_page(**PHONE), address)
            phone.locator("[data-row=roughness]").scroll_into_view_if_needed()
            phone.screenshot(path=IMAGES / "explorer_phone.png")
            browser.close()
        finally:
            server.terminate()


def opened(page: Page, address: str) -> Page:
    """Open the page and wait until it rests."""
    page.set_default_timeout(120_000)  # of a machine with other work
    page.goto(address)
    page.wait_for_selector(SOLVED)
    page.wait_for_timeout(1000)
    return page


def compare(page: Page) -> None:
    """Pin the curve and a second one, and move to a third."""
    page.keyboard.press("p")
    page.locator("[data-row=roughness] input.field").fill("0.5")
    page.locator("[data-row=roughness] input.field").press("Enter")
    page.wait_for_timeout(1500)
    page.evaluate("document.activeElement.blur()")
    page.mouse.move(0, 0)
    page.wait_for_selector(SOLVED)
    page.wait_for_timeout(1000)


if __name__ == "__main__":
    main()
