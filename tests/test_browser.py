"""The explorer in real browsers, through the real server: `make browser`.

Needs the extra ``browser``, and Debian's ``chromium`` and ``firefox-esr``, or CHROMIUM=/path/to/it and FIREFOX=/path/to/it.
"""

import contextlib
import json
import os
import re
import shutil
import subprocess
import sys
import threading
import time
from pathlib import Path
from urllib.parse import parse_qsl, urlparse

import numpy as np
import pytest

import stribeck as sb
from stribeck.explorer import server
from stribeck.explorer.downloads import KINDS, name_of
from stribeck.explorer.inputs import inputs, url

pytestmark = pytest.mark.browser

EXAMPLES = Path(__file__).parents[1] / "examples"
LONG = 30_000  # ms; a shared machine may be slow

CHART = "name => document.querySelector('.chart-' + name).chart.options ?? {series: []}"
NUMBERS = """() => Object.fromEntries([...document.querySelectorAll('[data-error]')].map(
    row => [row.dataset.key, [row.dataset.value, Number(row.dataset.error)]]))"""


@pytest.fixture(scope="module")
def address(tmp_path_factory):
    """Start the server as a user does and return its address; it must have written nothing but that."""
    environment = {key: value for key, value in os.environ.items() if not key.startswith(("PYTEST", "NICEGUI"))}
    path = tmp_path_factory.mktemp("server") / "errors"
    command = [sys.executable, "-m", "stribeck", "explore", "--no-browser"]
    with (
        path.open("w") as log,
        subprocess.Popen(command, stdout=subprocess.PIPE, stderr=log, text=True, env=environment) as process,
    ):
        line = process.stdout.readline()
        yield re.fullmatch(r"stribeck explorer: (http://127\.0\.0\.1:\d+/\?token=\S+) \(Ctrl-C ends it\)\n", line)[1]
        assert process.poll() is None, "the server died"
        process.terminate()
        process.wait(20)
    assert path.read_text() == ""


@pytest.fixture(scope="module")
def chromium():
    from playwright.sync_api import sync_playwright

    path = os.environ.get("CHROMIUM") or shutil.which("chromium")
    assert path, "there is no chromium: apt-get install chromium, or say where it is with CHROMIUM="
    with sync_playwright() as play:
        browser = play.chromium.launch(executable_path=path, args=["--no-sandbox"])
        yield browser
        browser.close()


@pytest.fixture(scope="module")
def context_of(chromium):
    """Return what gives a browser with settings, which keeps what it has loaded for the next test."""
    contexts = {}

    def context(settings):
        key = json.dumps(settings, sort_keys=True)
        if key not in contexts:
            contexts[key] = chromium.new_context(**({"viewport": {"width": 1440, "height": 900}} | settings))
        return contexts[key]

    return context


@pytest.fixture
def open_page(context_of, address):
    """Return what opens a page; at the end no page may have failed, or asked for anything outside this machine."""
    pages, faults, asked = [], [], []

    def go(query="", unfolded=True, **settings):
        page = context_of(settings).new_page()
        pages.append(page)
        page.set_default_timeout(LONG)
        page.on("pageerror", lambda error: faults.append(str(error)))
        page.on("console", lambda message: faults.append(message.text) if message.type == "error" else None)
        page.on("request", lambda request: asked.append(request.url))
        page.goto(f"{address}&{query.lstrip('?')}")
        page.wait_for_selector("[data-key=regime]")
        page.wait_for_function("location.search.includes('abscissa=')")  # it rests
        if unfolded:
            page.evaluate("document.querySelectorAll('details.fold').forEach(each => { each.open = true; })")
        return page

    yield go
    for page in pages:
        page.close()
    assert faults == []
    hosts = {urlparse(each).hostname for each in asked if urlparse(each).scheme in ("http", "https", "ws", "wss")}
    assert hosts == {"127.0.0.1"}


def address_of(page):
    """Return the address as the page has it: `page.url` hears of a change by `history.replaceState` only later."""
    return page.evaluate("location.href")


def contact_of(page):
    """Return the contact that the address of a page holds."""
    items = parse_qsl(urlparse(address_of(page)).query, keep_blank_values=True)
    opened = url.decode(items, server.example())
    assert opened.problems == {}
    return opened.inputs


def at_rest(page, action):
    """Do something, wait until the page has rested with new inputs, and return them."""
    before = page.evaluate("location.search")
    action()
    page.wait_for_function("before => location.search !== before", arg=before)
    return settled(page)


def settled(page):
    """Wait until the address stays, as on a slow machine a page may rest between two moves, and return its inputs."""
    last = None
    while last != (last := page.evaluate("location.search")):
        page.wait_for_timeout(700)
    return contact_of(page)


def check_numbers(page, now):
    """Compare all numbers of a page with a cold solve of its contact."""
    shown = page.evaluate(NUMBERS)
    solution = sb.solve(now.contact)
    friction = {kind: solution.friction(definition=kind) for kind in ("published", "balanced")}
    chosen = friction[now.case.definition]
    expected = {
        "friction_published": friction["published"].total,
        "friction_balanced": friction["balanced"].total,
        "contact_friction_share": chosen.asperities / chosen.total,
        "fluid_load_share": solution.fluid_load_share,
        "contact_load_share": solution.contact_load_share,
        "central_film_thickness": solution.central_gap * now.contact.hertz.indentation,
        "minimum_film_thickness": solution.minimum_gap * now.contact.hertz.indentation,
        "lambda_ratio": solution.lambda_ratio,
        "hersey_number": solution.hersey_number,
    }
    for key, value in expected.items():
        assert abs(float(shown[key][0]) - value) <= 2 * shown[key][1] + 1e-15 * abs(value), key
    assert shown["regime"][0] == sb.regime_of(solution.fluid_load_share, chosen.asperities / chosen.total)


def point(page):
    """Return the present point of the chart of friction."""
    return next(s["data"][0] for s in page.evaluate(CHART, "friction")["series"] if s["id"] == "point")


def slider(page, name):
    return page.locator(f"[data-row={name}] input.slider")


def field(page, name):
    return page.locator(f"[data-row={name}] input.field")


def test_moving_a_slider_changes_the_numbers_to_what_solve_gives(open_page):
    page = open_page()
    for name in ("speed", "beta", "load_group"):  # with units, without, and several inputs at once
        before = contact_of(page)

        def move(name=name):
            slider(page, name).focus()
            for _ in range(5):
                page.keyboard.press("ArrowLeft")

        now = at_rest(page, move)
        moved = inputs.value_of(now, name) / inputs.value_of(before, name)
        assert moved == pytest.approx(10**-0.05, rel=0.02), name
        assert field(page, name).input_value() == inputs.number_text(now, name)
        check_numbers(page, now)
        friction = sb.solve(now.contact).friction().total
        assert point(page) == pytest.approx([now.contact.speed, friction], rel=1e-5), name


def pick(page, name, value):
    page.locator(f"[data-choice={name}] select").select_option(value)


def test_a_ball_is_chosen_and_shows_its_film_on_the_plane(open_page):
    page = open_page()
    assert not page.locator(".chart-plane").is_visible() and not page.locator("[data-row=wetted_radius]").is_visible()
    now = at_rest(page, lambda: pick(page, "geometry", "point"))
    page.wait_for_selector(".explorer:not(.working)")
    page.wait_for_function("document.querySelector('.chart-plane canvas')?.getBoundingClientRect().width > 100")
    assert isinstance(now.contact, sb.PointContact)
    solution = sb.solve(now.contact, rtol=now.case.rtol)
    shown = page.evaluate(NUMBERS)
    friction = solution.friction(definition=now.case.definition).total
    assert abs(float(shown[f"friction_{now.case.definition}"][0]) / friction - 1) < 3 * now.case.rtol
    film = np.array(page.evaluate(CHART, "plane")["series"][0]["data"])
    assert film.shape == (25 * 49,) and film.max() - film.min() > 1
    page.locator(".chart-plane").scroll_into_view_if_needed()
    box = page.locator(".chart-plane").bounding_box()
    for step in (0, 1):
        page.mouse.move(box["x"] + 50 + 147 + step, box["y"] + 8 + 147)
    page.wait_for_function("document.querySelector('.chart-plane .tip').innerText.includes('film')")
    under = page.locator(".chart-plane .tip").inner_text().split()
    micrometres = float(under[1]) * {"nm": 1e-3, "µm": 1.0}[under[2]]
    assert micrometres == pytest.approx(1e6 * solution.central_gap * now.contact.hertz.indentation, rel=0.02)
    assert page.locator("[data-row=load] select").input_value() == "mN"
    back = at_rest(page, lambda: pick(page, "geometry", "line"))
    assert back.contact.load == pytest.approx(server.example().contact.load) and not page.locator(".chart-plane").is_visible()


def test_parts_of_the_model_are_chosen_and_refused_at_their_place(open_page):
    page = open_page()
    now = at_rest(page, lambda: pick(page, "solid", "layer"))
    assert now.contact.solid.layer_thickness == 0.002
    thickness = page.locator("#detail-solid-layer_thickness")
    thickness.fill("3 s")
    thickness.press("Enter")
    page.wait_for_function("document.querySelector('[data-choice=solid] .sentence').textContent.includes('is a time')")
    assert contact_of(page) == now and thickness.get_attribute("aria-invalid") == "true"
    now = at_rest(page, lambda: (thickness.fill("4 mm"), thickness.press("Enter")))
    assert now.contact.solid.layer_thickness == 0.004
    pick(page, "asperity_friction", "shear-stress")
    refused = "document.querySelector('[data-choice=asperity_friction] .sentence').textContent"
    page.wait_for_function(f"{refused}.includes('real area of contact, which law = \\'exponential\\' does not know')")
    now = at_rest(page, lambda: pick(page, "preset", "glycerol-water"))
    assert page.evaluate(refused) == ""
    assert now.contact.viscosity == sb.fluids.PRESETS["glycerol-water"]().viscosity
    check_numbers(page, now)
    other = open_page(urlparse(address_of(page)).query)
    assert contact_of(other) == now


def test_a_bad_value_is_marked_with_its_sentence_and_the_picture_stays(open_page):
    page = open_page()
    page.wait_for_function(f"({CHART})('friction').series.length > 0")
    before, picture = page.evaluate(NUMBERS), page.evaluate(CHART, "friction")["series"]
    field(page, "load").fill("-3")
    field(page, "load").press("Enter")
    row = page.locator("[data-row=load]")
    page.wait_for_selector("[data-row=load].wrong")
    assert row.get_by_role("alert").inner_text() == "load = '-3 N/m' must be positive."
    assert field(page, "load").get_attribute("aria-invalid") == "true"
    assert field(page, "load").input_value() == "-3"
    assert page.evaluate(NUMBERS) == before
    assert page.evaluate(CHART, "friction")["series"] == picture
    now = at_rest(page, lambda: (field(page, "load").fill("0.1 kN/m"), field(page, "load").press("Enter")))
    assert now.contact.load == 100
    assert page.locator(".wrong").count() == 0
    assert page.locator("[data-row=load] select").input_value() == "kN/m"
    check_numbers(page, now)


def test_numbers_of_the_answer_before_are_pale_while_the_next_is_computed(open_page):
    page = open_page()
    page.evaluate("document.querySelector('.explorer').classList.add('working')")
    pale = "each => [...document.querySelectorAll(each)].every(one => getComputedStyle(one).opacity < 0.5)"
    for each in (".regime", ".answer dl", ".verdict", ".ways", ".numbers table", ".chart"):
        assert page.evaluate(pale, each), each
    assert page.evaluate("getComputedStyle(document.querySelector('.status')).opacity") == "1"


def test_a_case_is_loaded_and_a_wrong_one_is_refused_in_sentences(open_page, tmp_path):
    page = open_page()
    seal = EXAMPLES / "nitrile_seal.toml"
    now = at_rest(page, lambda: page.set_input_files("input[type=file]", seal))
    case = sb.load_case(seal)
    assert now.contact.replace(law=None) == case.contact.replace(law=None)
    assert now.contact.law.parameters == case.contact.law.parameters
    assert page.locator("h1").inner_text().endswith(case.title)
    check_numbers(page, now)
    wrong = tmp_path / "wrong.toml"
    wrong.write_text(seal.read_text().replace("viscosity", "viscose"))
    page.set_input_files("input[type=file]", wrong)
    page.wait_for_selector(".q-dialog")
    said = page.locator(".q-dialog").inner_text()
    assert "wrong.toml: [contact] viscosity is missing" in said and "viscose" in said
    assert contact_of(page) == now


def test_a_measured_curve_is_mapped_shown_fitted_and_removed(open_page, tmp_path):
    page = open_page()
    speeds = np.geomspace(1e-4, 1e-1, 9)
    friction = [sb.atlas.friction(server.example().contact.replace(speed=float(s)).groups, 0.5, 0.06) for s in speeds]
    path = tmp_path / "odd.csv"
    rows = [f"{1e3 * s:.6g};{f * (1 + 0.02 * (-1) ** i):.6g}" for i, (s, f) in enumerate(zip(speeds, friction, strict=True))]
    path.write_text("\n".join(["A;B", *rows]))
    page.set_input_files("input[type=file]", path)
    page.wait_for_selector(".mapping")
    assert "none of which is known as speed or friction" in page.locator(".mapping").inner_text()
    page.get_by_label("speed", exact=True).select_option("A")
    page.get_by_label("its unit, where the header has none").fill("mm/s")
    page.get_by_label("friction", exact=True).select_option("B")
    page.get_by_role("button", name="Read").click()
    page.wait_for_function(f"({CHART})('friction').series.some(s => s.name === 'odd.csv')")
    page.get_by_text("Read: 'A' as speed; 'B' as friction.").wait_for()
    assert page.locator(".mapping").count() == 0
    page.get_by_role("button", name="Fit", exact=True).click()
    page.get_by_label("roughness", exact=True).uncheck()
    now = at_rest(page, lambda: page.get_by_role("button", name="Fit these").click())
    assert now.contact.boundary_friction == pytest.approx(0.5, rel=0.05) and now.contact.roughness == 1e-6
    cells = page.locator(".fitting tr td").all_inner_texts()
    assert re.fullmatch(r"0\.\d+ to 0\.\d+", cells[-1])
    [points] = [each["data"] for each in page.evaluate(CHART, "residuals")["series"] if each["type"] == "points"]
    assert len(points) == 9
    page.wait_for_function("document.querySelector('.chart-residuals canvas').getBoundingClientRect().height > 60")
    page.locator(".chips .q-chip__icon--remove").click()
    page.wait_for_function(f"!({CHART})('friction').series.some(s => s.name === 'odd.csv')")


def test_a_measured_curve_is_read_as_the_table_fit_of_the_case_says(open_page, tmp_path):
    page = open_page()
    case, torque = tmp_path / "case.toml", tmp_path / "torque.csv"
    case.write_text((EXAMPLES / "pdms_cylinder.toml").read_text() + '\n[fit]\narm = "20 mm"\n')
    torque.write_text("Speed [mm/s],Torque [mN m],Normal Force [N]\n1,10,1\n10,4,1\n30,2,1\n")
    at_rest(page, lambda: page.set_input_files("input[type=file]", case))
    assert ".xlsx" in page.locator("input[type=file]").get_attribute("accept").split(",")
    page.set_input_files("input[type=file]", torque)
    page.wait_for_function(f"({CHART})('friction').series.some(s => s.id === 'measured0')")
    series = page.evaluate(CHART, "friction")["series"]
    assert next(s["data"][0] for s in series if s["id"] == "measured0") == pytest.approx([1e-3, 0.5])


def test_what_was_closed_opens_again_and_no_fit_stands_there_for_another_file(open_page, tmp_path):
    page = open_page()
    names = "abcde"
    odd, many, other = (tmp_path / f"{each}.csv" for each in ("odd", "many", "other"))
    odd.write_text("log speed;friction\n1;0.5\n2;0.4\n")
    rows = [f"{name},{speed},{0.5 - 0.01 * k - speed / 100}" for k, name in enumerate(names) for speed in (1, 10, 30)]
    many.write_text("\n".join(["curve,speed [mm/s],friction", *rows]))
    other.write_text("speed [mm/s],friction\n1,0.5\n10,0.4\n30,0.3\n")
    for _ in range(2):
        page.get_by_role("button", name="Copy").click()
        page.get_by_text("As Python ...").click()
        page.locator(".q-dialog").get_by_role("button", name="Close").click()
        page.wait_for_selector(".q-dialog", state="detached")
        page.set_input_files("input[type=file]", odd)
        page.locator(".mapping").get_by_text("Say below which is which.").wait_for()
        assert ".." not in page.locator(".mapping p").inner_text()
        page.locator(".mapping").get_by_role("button", name="Cancel").click()
    page.set_input_files("input[type=file]", many)
    page.wait_for_function(f"({CHART})('friction').series.filter(s => s.id.startsWith('measured')).length === {len(names)}")
    for _ in range(2):
        page.get_by_role("button", name="Fit", exact=True).click()
        page.locator(".fitting").get_by_role("button", name="Close").click()
    page.get_by_role("button", name="Fit", exact=True).click()
    page.get_by_text("Fit to many.csv").wait_for()
    page.set_input_files("input[type=file]", other)  # which "Fit these" would fit now
    page.wait_for_selector(".fitting", state="hidden")
    page.wait_for_function(f"document.querySelectorAll('.chips .q-chip').length === {len(names) + 1}")


def test_what_is_shown_is_downloaded(open_page, tmp_path):
    page = open_page()
    now = at_rest(page, lambda: (slider(page, "load_group").focus(), page.keyboard.press("ArrowRight")))
    path = tmp_path / "file.toml"
    for label, kind in KINDS.items():
        if kind not in ("curve.png", "csv", "toml"):  # the others come the same way
            continue
        page.get_by_role("button", name="Save").click()
        with page.expect_download() as download:
            page.get_by_text(label, exact=True).click()
        assert download.value.suggested_filename == name_of(kind, server.example().case.title)
        download.value.save_as(path)
    assert sb.load_case(path).contact == now.contact  # the last one


def test_a_shared_address_opens_as_it_was_left(open_page):
    page = open_page()
    slider(page, "roughness_group").focus()
    at_rest(page, lambda: page.keyboard.press("ArrowLeft"))
    page.locator(".choice").get_by_role("button", name="balanced").click()
    at_rest(page, lambda: page.keyboard.press("p"))
    now = at_rest(page, lambda: (slider(page, "load").focus(), page.keyboard.press("ArrowRight")))
    assert now.case.definition == "balanced"
    other = open_page(urlparse(address_of(page)).query)
    assert other.evaluate(NUMBERS).keys() == page.evaluate(NUMBERS).keys()
    assert contact_of(other) == now
    check_numbers(other, now)
    assert other.locator(".chips .q-chip").inner_text() == page.locator(".chips .q-chip").inner_text()

    def drawn(each):
        """Return the points of the pinned and the present curve, which come with the first frame."""
        for _ in range(100):
            series = each.evaluate(CHART, "friction")["series"]
            points = [s["data"] for s in series if s["id"] in ("pin0", "friction")]
            if points and all(points):
                break
            each.wait_for_timeout(100)
        return points

    data = [drawn(each) for each in (page, other)]
    assert data[0] == data[1] and len(data[0]) == 2


def test_two_tabs_do_not_disturb_each_other(open_page):
    one, two = open_page(), open_page()
    start = two.evaluate(NUMBERS)

    def both():
        for _ in range(10):
            slider(one, "speed").press("ArrowRight")
            slider(two, "radius").press("ArrowLeft")

    before = two.evaluate("location.search")
    first = at_rest(one, both)
    two.wait_for_function("before => location.search !== before", arg=before)
    second = settled(two)
    assert first.contact == server.example().contact.replace(speed=first.contact.speed)
    assert second.contact == server.example().contact.replace(radius=second.contact.radius)
    assert two.evaluate(NUMBERS) != start
    check_numbers(one, first)
    check_numbers(two, second)


def test_a_hundred_moves_in_five_seconds_leave_it_alive_and_right(open_page):
    page = open_page()
    random = np.random.default_rng(90210)
    place = "([name, place]) => { const s = document.querySelector(`[data-row=${name}] input.slider`);" + (
        " s.value = place; s.dispatchEvent(new Event('input', {bubbles: true})); }"
    )

    def move():
        began = time.monotonic()
        for i in range(100):
            name = ["speed", "load", "roughness", "viscosity", "load_group"][i // 20]
            page.evaluate(place, [name, inputs.position(server.example(), name) + 0.3 * random.uniform(-1, 1)])
            page.wait_for_timeout(max(0.0, 50 * (i + 1) - 1000 * (time.monotonic() - began)))

    now = at_rest(page, move)
    assert np.log10(now.contact.groups.load) == pytest.approx(float(slider(page, "load_group").input_value()), abs=0.008)
    check_numbers(page, now)
    assert point(page)[0] == pytest.approx(now.contact.speed, rel=1e-5)
    now = at_rest(page, lambda: slider(page, "speed").press("ArrowRight"))
    check_numbers(page, now)


def test_it_works_by_keyboard_alone(open_page):
    page = open_page()
    reached = []
    for _ in range(16):
        page.keyboard.press("Tab")
        reached.append(page.evaluate("document.activeElement.name || document.activeElement.getAttribute('aria-label')"))
    assert {"speed", "Unit of Speed", "Speed", "load"} <= set(reached)
    page.evaluate("document.activeElement.blur()")
    page.keyboard.press("t")
    page.wait_for_selector("body.body--dark")
    page.keyboard.press("p")
    page.wait_for_selector(".chips .q-chip")
    names = page.evaluate("""() => [...document.querySelectorAll('input.slider, input.field, select, button, [role=img]')]
        .filter(e => !(e.getAttribute('aria-label') || e.innerText || e.labels?.length)).length""")
    assert names == 0


def test_it_fits_a_phone(open_page):
    page = open_page(viewport={"width": 390, "height": 844}, is_mobile=True, has_touch=True, device_scale_factor=2)
    assert page.evaluate("document.documentElement.scrollWidth") <= 390
    slider(page, "viscosity").scroll_into_view_if_needed()
    box = slider(page, "viscosity").bounding_box()
    chart = page.locator(".chart-friction").bounding_box()
    assert 0 <= chart["y"] and chart["y"] + chart["height"] < box["y"]  # the curve stays in sight
    now = at_rest(page, lambda: page.touchscreen.tap(box["x"] + 0.7 * box["width"], box["y"] + box["height"] / 2))
    check_numbers(page, now)
    assert now.contact.viscosity > server.example().contact.viscosity
    for name, text in {"roughness": "134.6 nm", "alpha": "2.236", "beta": "0.04187"}.items():  # for a long name of a pin
        at_rest(page, lambda name=name, text=text: (field(page, name).fill(text), field(page, name).press("Enter")))
    at_rest(page, lambda: page.get_by_role("button", name="Pin").click())
    assert page.evaluate("document.documentElement.scrollWidth") <= 390
    assert page.locator(".card.friction").bounding_box()["height"] < 0.61 * 844  # the sliders stay in reach


def test_changes_are_undone_and_redone(open_page):
    page = open_page()
    first = contact_of(page)
    assert page.get_by_role("button", name="Undo").is_disabled()
    second = at_rest(page, lambda: (slider(page, "speed").focus(), page.keyboard.press("ArrowRight")))
    third = at_rest(page, lambda: (field(page, "load").fill("40"), field(page, "load").press("Enter")))
    assert at_rest(page, lambda: page.keyboard.press("Control+z")) == second  # the focus is still in the field
    assert at_rest(page, lambda: page.get_by_role("button", name="Undo").click()) == first
    assert page.get_by_role("button", name="Undo").is_disabled()
    assert at_rest(page, lambda: page.keyboard.press("Control+Shift+z")) == second
    assert at_rest(page, lambda: page.keyboard.press("Control+y")) == third
    check_numbers(page, third)
    field(page, "radius").fill("12")
    field(page, "radius").press("Control+z")  # letters that are being typed are undone in the field
    assert contact_of(page) == third and field(page, "load").input_value() == "40"


def test_charts_are_tables_and_sentences_too(open_page):
    page = open_page()
    settled(page)
    contact = contact_of(page).contact
    friction = sb.solve(contact).friction().total
    label = page.locator(".chart-friction canvas")
    page.wait_for_function("document.querySelector('.chart-friction canvas').ariaLabel.includes('present point')")
    said = re.search(r"present point (\S+) at (\S+) m/s", label.get_attribute("aria-label"))
    assert [float(each) for each in said.groups()] == pytest.approx([friction, contact.speed], rel=5e-3)
    page.get_by_role("button", name="As a table: Friction over speed").press("Enter")
    head, *rows = page.eval_on_selector_all(
        ".chart-friction tr", "rows => rows.map(row => [...row.children].map(cell => cell.innerText))"
    )
    assert head[:2] == ["sliding speed U (m/s)", "balanced"] and len(rows) >= 5 and not label.is_visible()
    for speed, shown, *_ in rows:
        found = sb.solve(contact.replace(speed=float(speed))).friction().total
        assert float(shown) == pytest.approx(found, rel=6e-3), speed
    pick(page, "geometry", "point")
    page.wait_for_function("document.querySelector('.chart-plane canvas').ariaLabel.includes('film from')")
    page.get_by_role("button", name=re.compile("^As a table: Film")).click()
    cells = page.locator(".chart-plane td").all_inner_texts()
    assert len(cells) >= 9 and all(re.fullmatch(r"[0-9.]+ (nm|µm|mm)", each) for each in cells)


def test_the_table_of_the_curve_has_the_band_of_its_picture(open_page):
    page = open_page("speed=1e-3&boundary_friction=0.5%20%2B-%2020%20%25")
    page.wait_for_function(f"({CHART})('friction').series.some(each => each.id === 'spread')")
    page.get_by_role("button", name="As a table: Friction over speed").press("Enter")
    head, *rows = page.eval_on_selector_all(
        ".chart-friction tr", "rows => rows.map(row => [...row.children].map(cell => cell.innerText))"
    )
    contact = contact_of(page).contact
    for speed, *_, ends in rows[:4]:
        interval = sb.propagate(contact.replace(speed=float(speed)), {"boundary_friction": 0.2})["friction"].interval_95
        assert [float(each) for each in ends.split(" to ")] == pytest.approx(interval, rel=0.05), speed
    assert head[-1] == "95 % by errors of the inputs" and len(rows) >= 5


@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_axe_core_finds_no_fault(open_page, scheme):
    from axe_playwright_python.sync_playwright import Axe

    page = open_page(color_scheme=scheme)
    page.wait_for_selector(".ways tr[data-key=roughness] td[data-value]")
    page.wait_for_function(f"({CHART})('friction').series.some(s => s.id === 'friction')")
    ink = page.evaluate("getComputedStyle(document.querySelector('.chart-friction canvas')).getPropertyValue('--ink')")
    assert (ink.strip() == "#1f2328") == (scheme == "light")  # it is dark where the system is
    page.locator(".chart-pressure .as-table").click()
    found = Axe().run(page, options={"resultTypes": ["violations"]}).response["violations"]
    assert [(each["id"], [node["html"][:200] for node in each["nodes"]]) for each in found] == []


def test_the_point_is_dragged_along_the_curve_and_a_drag_elsewhere_zooms(open_page):
    page = open_page()
    settled(page)
    canvas = page.locator(".chart-friction canvas")
    box = canvas.bounding_box()
    at = "() => { const {chart} = document.querySelector('.chart-friction'); return chart.handle(); }"
    x, y = page.evaluate(at)

    def drag(start, stop):
        page.mouse.move(box["x"] + start[0], box["y"] + start[1])
        page.mouse.down()
        page.mouse.move(box["x"] + stop[0], box["y"] + stop[1], steps=8)

    painted = "const { chart } = document.querySelector('.chart-friction'), paint = chart.paint.bind(chart);"
    painted += " window.painted = 0; chart.paint = () => { window.painted++; paint(); };"
    drag((x, y), (x + 80, y))
    now = at_rest(page, page.mouse.up)
    assert page.evaluate(at)[0] == pytest.approx(x + 80, abs=1.5)
    assert now.contact.speed > 2 * server.example().contact.speed
    check_numbers(page, now)
    lines = page.locator(".chart-friction .tip").inner_text().split("\n")
    assert re.fullmatch(r"sliding speed U \S+ m/s", lines[0])
    drag((150, 200), (300, 200))
    assert page.locator(".chart-friction .band").bounding_box()["width"] == pytest.approx(150, abs=2)
    page.mouse.up()
    ends = "() => { const {x} = document.querySelector('.chart-friction').chart.view; return [x.low, x.high]; }"
    low, high = page.evaluate(ends)
    whole = page.evaluate(CHART, "friction")["x"]
    assert whole["low"] < low < high < whole["high"] and page.get_by_role("button", name="whole").is_visible()
    assert "sliding speed" in canvas.get_attribute("aria-label")
    page.get_by_role("button", name="whole").click()
    assert page.evaluate(ends) == [whole["low"], whole["high"]]
    page.evaluate(f"() => {{ {painted} }}")
    page.mouse.move(box["x"] + 250, box["y"] + 150, steps=50)
    # What else is painted meanwhile are answers of slow work.
    assert page.locator(".chart-friction .cursor").is_visible() and page.evaluate("window.painted") < 10
    page.locator(".chart-pressure").scroll_into_view_if_needed()
    gap = page.locator(".chart-pressure canvas").bounding_box()
    page.mouse.move(gap["x"] + gap["width"] / 2, gap["y"] + gap["height"] / 2)
    assert re.search(r"total \S+ kPa", page.locator(".chart-pressure .tip").inner_text())


class Firefox:
    """Debian's Firefox by WebDriver BiDi, which Playwright speaks with newer ones only."""

    def __init__(self, path, profile):
        from websockets.sync.client import connect

        command = [path, "--headless", "--no-remote", "--profile", str(profile), "--remote-debugging-port=0"]
        self.process = subprocess.Popen(command, stderr=subprocess.PIPE, text=True)
        found = next(found for line in self.process.stderr if (found := re.search(r"BiDi listening on (ws://\S+)", line)))
        self.drain = threading.Thread(target=self.process.stderr.read, daemon=True)  # or it would stop at a full pipe
        self.drain.start()
        self.closing = contextlib.ExitStack()
        self.socket = self.closing.enter_context(connect(f"{found[1]}/session", max_size=None, open_timeout=30))
        self.number, self.faults = 0, []
        self.send("session.new", capabilities={})
        self.send("session.subscribe", events=["log.entryAdded"])

    def send(self, method, **params):
        self.number += 1
        self.socket.send(json.dumps({"id": self.number, "method": method, "params": params}))
        while True:
            answer = json.loads(self.socket.recv(90))
            if answer.get("method") == "log.entryAdded" and answer["params"]["level"] == "error":
                self.faults.append(answer["params"]["text"])
            if answer.get("id") == self.number:
                assert answer["type"] == "success", answer
                return answer["result"]

    def open(self, address, width, height):
        self.page = self.send("browsingContext.create", type="tab")["context"]
        self.send("browsingContext.setViewport", context=self.page, viewport={"width": width, "height": height})
        self.send("browsingContext.navigate", context=self.page, url=address, wait="complete")
        self.wait("location.search.includes('abscissa=')")

    def evaluate(self, expression):
        """Return what an expression gives, as JSON."""
        expression = f"Promise.resolve({expression}).then(JSON.stringify)"
        found = self.send("script.evaluate", expression=expression, target={"context": self.page}, awaitPromise=True)
        assert found["type"] == "success", found
        return json.loads(found["result"].get("value", "null"))

    def wait(self, condition):
        deadline = time.monotonic() + LONG / 1000
        while not self.evaluate(f"Boolean({condition})"):
            assert time.monotonic() < deadline, condition
            time.sleep(0.1)

    def press(self, *keys):
        actions = [{"type": kind, "value": key} for key in keys for kind in ("keyDown", "keyUp")]
        self.send("input.performActions", context=self.page, actions=[{"type": "key", "id": "keys", "actions": actions}])

    def inputs(self):
        opened = url.decode(parse_qsl(self.evaluate("location.search")[1:], keep_blank_values=True), server.example())
        assert opened.problems == {}
        return opened.inputs


@pytest.fixture(scope="module")
def firefox(tmp_path_factory):
    path = os.environ.get("FIREFOX") or shutil.which("firefox-esr") or shutil.which("firefox")
    assert path, "there is no firefox: apt-get install firefox-esr, or say where it is with FIREFOX="
    driven = Firefox(path, tmp_path_factory.mktemp("firefox"))
    yield driven
    driven.closing.close()
    driven.process.terminate()
    driven.process.wait(20)
    driven.drain.join(20)
    driven.process.stderr.close()
    assert driven.faults == []


ARROW_RIGHT = "\ue014"


def test_firefox_shows_the_same_numbers_and_follows_the_keyboard(firefox, address):
    firefox.open(address, 1440, 900)
    assert firefox.inputs().contact == server.example().contact
    firefox.evaluate("document.querySelector('[data-row=speed] input.slider').focus()")
    before = firefox.evaluate("location.search")
    firefox.press(*[ARROW_RIGHT] * 5)
    firefox.wait(f"location.search !== {json.dumps(before)}")
    time.sleep(1.5)
    now = firefox.inputs()
    assert now.contact.speed / server.example().contact.speed == pytest.approx(10**0.05, rel=0.02)
    shown = firefox.evaluate(f"({NUMBERS})()")
    solution = sb.solve(now.contact)
    assert abs(float(shown["friction_balanced"][0]) - solution.friction().total) <= 2 * shown["friction_balanced"][1]
    series = firefox.evaluate(f"({CHART})('friction').series.map(s => [s.id, s.data.length])")
    assert dict(series)["friction"] > 100


def test_firefox_chooses_a_ball_and_has_no_fault_of_axe_core(firefox, address):
    from axe_playwright_python import sync_playwright as axe

    firefox.open(address, 390, 844)
    assert firefox.evaluate("document.documentElement.scrollWidth") <= 390
    firefox.evaluate(
        "(() => { const s = document.querySelector('[data-choice=geometry] select'); s.value = 'point';"
        " s.dispatchEvent(new Event('change')); })()"
    )
    firefox.wait("document.querySelector('.chart-plane canvas')?.getBoundingClientRect().width > 100")
    firefox.wait("location.search.includes('point')")
    assert isinstance(firefox.inputs().contact, sb.PointContact)
    assert firefox.evaluate("document.documentElement.scrollWidth") <= 390
    source = next(Path(axe.__file__).parent.glob("axe*.js"), None) or next(Path(axe.__file__).parent.rglob("axe*.js"))
    firefox.evaluate(f"(() => {{ {source.read_text()}; }})()")
    found = firefox.evaluate(
        "axe.run(document, {resultTypes: ['violations']}).then("
        "r => r.violations.map(v => [v.id, v.nodes.map(n => n.html.slice(0, 200))]))"
    )
    assert found == []
