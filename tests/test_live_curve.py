"""The live curve of the documentation's front page: the same numbers as Python, in a real browser, from a folder."""

import importlib.util
import shutil
from pathlib import Path

import numpy as np
import pytest
from test_browser import LONG, address_of, chromium  # noqa: F401

import stribeck as sb

DOCS = Path(__file__).parents[1] / "docs"
PAGE = """<!doctype html><html lang="en" data-theme="light"><head><meta charset="utf-8"><title>Live curve</title>
<meta name="viewport" content="width=device-width"><link rel="stylesheet" href="site.css">
<link rel="stylesheet" href="chart.css"></head>
<body><main><h1>Live curve</h1><div id="live-curve"><p>The picture</p></div></main>
<script defer src="atlas_table.js"></script><script defer src="chart.js"></script>
<script defer src="live_curve.js"></script></body></html>"""


THEME = """theme => {
    document.documentElement.dataset.theme = theme;
    document.body.style = theme === "dark" ? "background: #14181e; color: #e8ecf1" : "";
}"""


@pytest.fixture(scope="module")
def made():
    spec = importlib.util.spec_from_file_location("live_curve", DOCS / "live_curve.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.fixture(scope="module")
def folder(made, tmp_path_factory):
    found = tmp_path_factory.mktemp("live")
    made.write(found)
    for name in ("site.css", "live_curve.js"):
        shutil.copy(DOCS / "_static" / name, found)
    (found / "index.html").write_text(PAGE)
    return found


def test_the_front_page_has_a_picture_that_the_curve_can_replace():
    assert (DOCS / "index.md").read_text().count("](images/curve.png)") == 1


@pytest.fixture
def open_live(chromium, folder):  # noqa: F811
    contexts, faults, asked = [], [], []

    def go(fragment="", **settings):
        context = chromium.new_context(**settings)
        contexts.append(context)
        page = context.new_page()
        page.set_default_timeout(LONG)
        page.on("pageerror", lambda error: faults.append(str(error)))
        page.on("console", lambda message: faults.append(message.text) if message.type == "error" else None)
        page.on("request", lambda request: asked.append(request.url))
        page.goto(f"{(folder / 'index.html').as_uri()}{fragment}")
        page.wait_for_selector("#live-curve[data-ready]")
        return page

    yield go
    for context in contexts:
        context.close()
    assert faults == []
    assert {url.partition(":")[0] for url in asked} <= {"file", "blob", "data"}


def contact_of(page):
    """Return the contact that the address of a page holds, read as a reader would."""
    from urllib.parse import parse_qs

    query = {key: float(text) for key, [text] in parse_qs(address_of(page).partition("?")[2]).items() if key != "mode"}
    return sb.LineContact(**query)


def shown(page, name="friction"):
    return float(page.locator("#live-curve").get_attribute(f"data-{name}"))


@pytest.mark.browser
def test_the_browser_reads_the_numbers_that_python_reads(open_live):
    page = open_live()
    rng = np.random.default_rng(271_828)
    speed, load, kappa = (10 ** rng.uniform(low, high, 2000) for low, high in ((-12, 6), (-6, 0), (-6, 2)))
    kappa[:50] = 0
    groups = sb.Groups(speed, load, kappa * load)
    found = page.evaluate(
        """async rows => {
            const atlas = await stribeckAtlas.load();
            return rows.map(([speed, load, roughness]) => {
                const at = atlas.curve(load, roughness, 0.5, 0.03)(speed);
                return [at.friction, at.contactShare, at.fluidShare, at.viscous, at.centralGap, at.minimumGap];
            });
        }""",
        np.stack([speed, load, kappa * load], axis=1).tolist(),
    )
    expected = [
        sb.atlas.friction(groups, 0.5, 0.03),
        sb.atlas.contact_load_share(groups),
        sb.atlas.fluid_load_share(groups),
        sb.atlas.viscous_friction(groups, 0.03),
        sb.atlas.central_gap(groups),
        sb.atlas.minimum_gap(groups),
    ]
    np.testing.assert_allclose(np.transpose(found), expected, rtol=1e-6, atol=1e-300)


@pytest.mark.browser
def test_sliders_in_si_move_the_curve_and_the_link_opens_it_again(open_live):
    page = open_live()
    assert "?" not in address_of(page)
    contact = sb.load_case(DOCS.parent / "examples" / "pdms_cylinder.toml").contact
    assert shown(page) == pytest.approx(sb.atlas.friction(contact.groups, contact.boundary_friction, contact.beta), rel=1e-6)
    assert shown(page, "minimum") == pytest.approx(sb.stribeck_curve(contact).minimum.value, rel=1e-3)
    for name, key in (("viscosity", "ArrowRight"), ("beta", "ArrowLeft"), ("speed", "ArrowRight")):
        page.get_by_label(sb.LineContact.INPUTS.quantities[name].label, exact=True).focus()
        for _ in range(7):
            page.keyboard.press(key)
    now = contact_of(page)
    assert now.viscosity == pytest.approx(contact.viscosity * 10**0.07, rel=0.012)
    friction = sb.atlas.friction(now.groups, now.boundary_friction, now.beta)
    assert shown(page) == pytest.approx(friction, rel=1e-6)
    assert f"friction {friction:.4g}" in page.get_by_role("status").inner_text()
    again = open_live("#" + address_of(page).partition("#")[2])
    assert contact_of(again) == now and shown(again) == shown(page)


@pytest.mark.browser
def test_sliders_of_the_groups_and_what_lies_beyond_the_table(open_live):
    page = open_live()
    before = shown(page)
    page.get_by_label("dimensionless groups").check()
    assert shown(page) == pytest.approx(before, rel=1e-9)  # the same contact
    page = open_live("#live-curve?mode=groups&speed_group=1e-5&load_group=0.1&roughness_group=1e-4")
    assert shown(page) == pytest.approx(sb.atlas.friction(sb.Groups(1e-5, 0.1, 1e-4), 0.7, 0.06), rel=1e-6)
    page.evaluate("location.hash = '#live-curve?mode=si&modulus=1e5'")
    page.wait_for_selector("#live-curve.live-beyond")
    said = page.get_by_role("status").inner_text()
    assert "covers load groups of 1e-6 to 1" in said and "this contact has 2.65" in said
    page.get_by_role("button", name="Reset").click()
    assert page.locator("#live-curve.live-beyond").count() == 0


@pytest.mark.browser
@pytest.mark.parametrize("theme", ["light", "dark"])
def test_it_is_accessible_and_fits_a_phone(open_live, theme):
    from axe_playwright_python.sync_playwright import Axe

    page = open_live(viewport={"width": 390, "height": 844})
    page.evaluate(THEME, theme)
    assert page.evaluate("document.documentElement.scrollWidth") <= 390
    page.evaluate("document.getElementById('live-curve-boundary_friction').scrollIntoView()")
    assert 0 <= page.locator("#live-curve canvas").bounding_box()["y"] < 500  # the curve stays in sight
    found = Axe().run(page, options={"preload": False})
    assert [(each["id"], [node["html"] for node in each["nodes"]]) for each in found.response["violations"]] == []
