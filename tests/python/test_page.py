"""The HTML page of a result in headless Chromium: phone, dark screen, printer, slider, read-outs; skipped without a browser."""

import base64
import re
import subprocess

import pytest

from browser import Browser, chromium

pytestmark = pytest.mark.skipif(chromium() is None, reason="no Chromium on this machine (Debian: apt install chromium)")

COPPER = "runs/copper-below-critical.toml"
BEAM = "runs/beam.toml"
SPHERES = "runs/spheres.toml"
PHONE = 360


@pytest.fixture(scope="module")
def browser():
    browser = Browser()
    yield browser
    browser.close()


@pytest.fixture(scope="module")
def page(program, run, tmp_path_factory):
    """page("runs/x.toml") -> path of the page of its result."""
    folder = tmp_path_factory.mktemp("pages")

    def write(scene):
        path = folder / f"{run(scene).stem}.html"
        subprocess.run([program, "report", run(scene), "-o", path], check=True, stdout=subprocess.DEVNULL)
        return path

    return write


PROFILE = "document.querySelector('.player g[clip-path] > path').getAttribute('d')"
TIME = "document.querySelector('.player output').textContent"


def place(browser, selector, across, up):
    """Where a part of a plot is on the screen."""
    return browser.evaluate(f"""(() => {{
        const plot = document.querySelector({selector!r});
        plot.scrollIntoView({{ block: "center" }});
        const box = plot.getBoundingClientRect();
        return {{ x: box.left + {across} * box.width, y: box.bottom - {up} * box.height }};
    }})()""")


def read_out(browser):
    return browser.evaluate("(b => b.hidden ? null : b.textContent)(document.querySelector('.readout'))")


def press(browser, key, code):
    for kind in ("keyDown", "keyUp"):
        browser("Input.dispatchKeyEvent", type=kind, key=key, code=key, windowsVirtualKeyCode=code)


@pytest.mark.parametrize("scene", [COPPER, BEAM, SPHERES])
def test_a_phone_needs_no_sideways_scrolling(browser, page, scene):
    browser.open(page(scene), width=PHONE)
    # A page that is too wide is zoomed out, and the window then counts as wider than the phone.
    width, inner = browser.evaluate("[document.scrollingElement.scrollWidth, innerWidth]")
    assert width <= inner == PHONE
    smallest = """Math.min(...[...document.querySelectorAll("svg text")].map(
        (text) => parseFloat(getComputedStyle(text).fontSize) * text.getScreenCTM().a))"""
    # The smallest letters are the names of the gauges.
    turned = "[...document.querySelectorAll('svg text[transform]')].forEach((text) => text.remove())"
    browser.evaluate(turned)
    assert browser.evaluate(smallest) > 8
    assert not browser.errors


def test_wide_tables_scroll_by_themselves(browser, page):
    browser.open(page(COPPER), width=PHONE)
    inside, outside = browser.evaluate(
        "(box => [box.scrollWidth, box.clientWidth])(document.querySelector('[aria-label=Fronts]'))"
    )
    assert inside > outside <= PHONE


def test_dark_mode_changes_paper_lines_and_letters_and_no_map(browser, page):
    colours = """[
        getComputedStyle(document.body).backgroundColor,
        getComputedStyle(document.querySelector("svg text")).fill,
        getComputedStyle(document.querySelector("rect.plot")).stroke,
        getComputedStyle(document.querySelector("svg > rect")).fill,
        getComputedStyle(document.querySelector("figure:nth-child(2) g[clip-path] > path")).stroke,
        getComputedStyle(document.querySelector(".on-map line")).stroke,
    ]"""
    browser.open(page(COPPER))
    light = browser.evaluate(colours)
    browser.open(page(COPPER), scheme="dark")
    dark = browser.evaluate(colours)
    assert all(a != b for a, b in zip(light[:-1], dark[:-1]))
    assert light[-1] == dark[-1]
    brightness = [sum(map(int, re.findall(r"\d+", colour)[:3])) for colour in dark]
    paper, *inks = brightness[0], *brightness[1:3], brightness[4]
    assert paper < 100 and all(ink > paper + 200 for ink in inks)
    assert dark[3] == dark[0]


def test_the_slider_changes_the_profile_by_hand_and_by_itself(browser, page):
    browser.open(page(COPPER))
    last = browser.evaluate(PROFILE)
    assert browser.evaluate(TIME) == "time 250 \u00b5s"
    browser.evaluate("document.querySelector('.player input').focus()")
    press(browser, "ArrowLeft", 37)
    assert browser.evaluate(TIME) == "time 247.5 \u00b5s"
    before = browser.evaluate(PROFILE)
    assert before != last
    press(browser, "End", 35)
    assert browser.evaluate(PROFILE) == last
    # From the end it starts over; a bar at rest is a straight line.
    browser.evaluate("document.querySelector('.player button').focus()")
    press(browser, " ", 32)
    assert browser.evaluate("document.querySelector('.player button').getAttribute('aria-label')") == "Pause"
    seen = browser.evaluate(f"""new Promise((done) => {{
        const seen = new Set();
        const timer = setInterval(() => {{
            seen.add({TIME});
            if (seen.size > 3) {{ clearInterval(timer); done([...seen]); }}
        }}, 10);
    }})""")
    assert len(seen) > 3
    press(browser, " ", 32)
    assert browser.evaluate("document.querySelector('.player button').getAttribute('aria-label')") == "Play"
    assert not browser.errors


def test_only_results_with_profiles_have_a_slider(browser, page):
    sliders = "document.querySelectorAll('.player input').length"
    for scene, expected in [(COPPER, 1), (BEAM, 1), (SPHERES, 0)]:
        browser.open(page(scene))
        assert browser.evaluate(sliders) == expected


def test_plots_are_read_off_by_mouse_and_finger(browser, page):
    browser.open(page(COPPER))
    # Yellow of the map: behind all fronts, where the stress is that of the pulled end.
    browser("Input.dispatchMouseEvent", type="mouseMoved", **place(browser, "rect.plot", 0.02, 0.9))
    x, time, stress = read_out(browser).splitlines()
    assert re.fullmatch(r"position x 0\.0\d+ m", x) and re.fullmatch(r"time 22\d(\.\d)? \u00b5s", time)
    assert 147 < float(re.fullmatch(r"stress (\S+) MPa", stress)[1]) < 149
    # On a line: its name and the values on it.
    browser("Input.dispatchMouseEvent", type="mouseMoved", **place(browser, "figure:nth-child(2) rect.plot", 0.02, 0.95))
    name, x, stress = read_out(browser).splitlines()
    assert name.endswith("\u00b5s") and 147 < float(re.fullmatch(r"stress (\S+) MPa", stress)[1]) < 149
    browser("Input.dispatchMouseEvent", type="mouseMoved", x=1, y=1)
    assert read_out(browser) is None
    browser.open(page(COPPER), width=PHONE)
    at = place(browser, "rect.plot", 0.5, 0.5)
    browser("Input.dispatchTouchEvent", type="touchStart", touchPoints=[at])
    browser("Input.dispatchTouchEvent", type="touchEnd", touchPoints=[])
    assert read_out(browser).startswith("position x 0.5")
    assert not browser.errors


def test_the_page_prints_light_and_without_controls(browser, page):
    browser.open(page(COPPER), scheme="dark")
    browser("Emulation.setEmulatedMedia", media="print")
    paper, controls = browser.evaluate(
        "[document.body, document.querySelector('.controls')].map((e) => getComputedStyle(e)).map((s, i) =>"
        "i ? s.display : s.backgroundColor)"
    )
    assert (paper, controls) == ("rgb(255, 255, 255)", "none")
    pdf = base64.b64decode(browser("Page.printToPDF")["data"])
    assert pdf.startswith(b"%PDF-") and len(re.findall(rb"/Type\s*/Page\b", pdf)) > 2


def test_without_script_the_page_shows_everything(browser, page):
    browser("Emulation.setScriptExecutionDisabled", value=True)
    try:
        browser.open(page(BEAM))
        tree = browser("Accessibility.getFullAXTree")["nodes"]
    finally:
        browser("Emulation.setScriptExecutionDisabled", value=False)
    names = {(node["role"]["value"], node.get("name", {}).get("value")) for node in tree if "role" in node}
    assert ("image", "deflection along the beam at one instant") in names
    assert not any(role in ("slider", "button") for role, _ in names)
