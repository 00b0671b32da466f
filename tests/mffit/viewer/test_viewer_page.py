"""The page of `mffit show` in a real browser: its numbers are those of tir, its sliders move its curves, nothing overflows."""

from __future__ import annotations

import csv
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import mffit
import tir
from mffit.viewer.controls import CONTROLS, FAN, OUTPUTS, PANELS
from tests.browser import PAPER, PHONE, complaints, console_errors, look, opened, sheets
from tir.codegen.program import INPUTS, Switches, trace

ROOT = Path(__file__).parents[3]
FILES = (
    ROOT / "samples" / "front-120-70" / "true.tir",
    ROOT / "samples" / "rear-190-55" / "true.tir",
    ROOT / "tests" / "tir" / "vectors" / "MagicFormula62.tir",
)
HOSTILE = "</script><script>window.hacked=1</script><img src=x onerror='window.hacked=1'>"
"""A name as no file should have it; the file itself gets one too."""
LONG = "a_very_long_name_of_a_tyre_without_any_space_in_it_that_does_not_fit_into_a_narrow_page"
TEXTS = """
const drawn = [...document.querySelectorAll("figure")].flatMap(figure => {
  const at = figure.querySelector("canvas").getBoundingClientRect();
  return mffit.texts(figure.id).map(([a, b, c, d, text]) => [a + at.left, b + at.top, c + at.left, d + at.top, text]);
});
return drawn.concat([...document.querySelectorAll("figcaption, .x, label, th, td, summary, legend")]
  .filter(e => e.getClientRects().length && !e.closest("aside"))
  .map(e => { const r = e.getBoundingClientRect(); return [r.left, r.top + 2, r.right, r.bottom - 2, e.textContent]; }));
"""


MARGINS = """
return [...document.querySelectorAll("figure")].flatMap(figure => {
  const {clientWidth, clientHeight} = figure.querySelector("canvas");
  return mffit.texts(figure.id).map(([a, b, c, d]) => [a, clientWidth - c, clientHeight - d, b]);
});
"""


@pytest.fixture(scope="module")
def browser(tmp_path_factory):
    """One browser with the page of three tyres, two of them with names that have to be escaped or wrapped."""
    page = tmp_path_factory.mktemp("page") / "page.html"
    names = (f"front {HOSTILE}", LONG, "car")
    mffit.show(dict(zip(names, FILES, strict=True)), page)
    with opened(page) as driver:
        yield driver


def move(browser, **shown: float) -> None:
    """Drag sliders, then let the page draw."""
    for name, value in shown.items():
        browser.execute_script(
            "const e = document.getElementById(arguments[0]); e.value = arguments[1];"
            "e.dispatchEvent(new Event('input')); e.dispatchEvent(new Event('change'));",
            name,
            value,
        )
    drawn(browser)


def drawn(browser) -> None:
    browser.execute_async_script(
        "const done = arguments[0]; requestAnimationFrame(() => requestAnimationFrame(done));"
    )


def lines(browser, panel: str) -> list[object]:
    return browser.execute_script("return mffit.lines(arguments[0])", panel)


def test_the_browser_reports_no_errors(browser):
    assert console_errors(browser) == []
    assert browser.execute_script("return performance.getEntriesByType('resource').length") == 0


@pytest.mark.parametrize("turn_slip", [False, True])
def test_the_page_computes_what_tir_computes(browser, turn_slip):
    rng, n = np.random.default_rng(7), 200
    inputs = np.array(
        [
            rng.uniform(-50.0, 5000.0, n), rng.uniform(-0.4, 0.4, n), rng.uniform(-0.9, 0.9, n), rng.uniform(-0.5, 0.5, n),
            rng.uniform(-0.9, 0.9, n), rng.uniform(-20.0, 60.0, n), rng.uniform(1.5e5, 3.5e5, n),
        ]
    )  # fmt: skip
    for k, file in enumerate(FILES):
        tyre = tir.read(file)
        found = browser.execute_script(
            "return arguments[2].map(row => window.mffit.evaluate(arguments[0], arguments[1], row));",
            k,
            turn_slip,
            inputs.T.tolist(),
        )
        given = dict(zip(INPUTS, inputs, strict=True))
        given["p"] = given.pop("pressure")
        with np.errstate(all="ignore"):
            wanted = {
                **tyre.state(**given, turn_slip=turn_slip)._asdict(),
                **tyre(**given, turn_slip=turn_slip)._asdict(),
            }
        for name in OUTPUTS:
            theirs = np.array([row[name] for row in found], dtype=float)
            ours = np.broadcast_to(wanted[name], (n,))
            assert np.allclose(theirs, ours, rtol=1e-9, atol=1e-9 * np.max(np.abs(ours))), (file.name, name)


def test_a_slider_moves_the_curves_that_depend_on_it(browser):
    move(browser, alpha=0, gamma=0, Fz=1500)
    before = {panel.key: lines(browser, panel.key) for panel in PANELS}
    move(browser, Fz=2200)
    after = {panel.key: lines(browser, panel.key) for panel in PANELS}
    assert after["Fy-alpha"] != before["Fy-alpha"]
    assert after["Fy-Fx"] != before["Fy-Fx"]
    assert after["K_ya-Fz"] == before["K_ya-Fz"]  # over load: only the mark moves


def test_a_curve_is_that_of_the_condition_shown(browser):
    """In the units of the page: degrees, and the size of what is negative in these axes."""
    move(browser, Fz=1800, gamma=10, alpha=0, phi_t=-0.3)
    browser.find_element("css selector", "input[value=on]").click()
    drawn(browser)
    tyre, p = tir.read(FILES[0]), tir.read(FILES[0])["INFLPRES"]
    curve = browser.execute_script("return window.mffit.curve('Fy-alpha', 0)")
    alpha = np.array([point["x"] for point in curve])
    Fy = tyre(1800.0, np.radians(alpha), np.radians(10.0), phi_t=-0.3, Vx=tyre["LONGVL"], p=p).Fy
    assert alpha.min() < -14 < 14 < alpha.max()
    assert np.allclose([point["y"] for point in curve], Fy, rtol=1e-9)
    curve = browser.execute_script("return window.mffit.curve('K_ya-Fz', 0)")
    loads = np.array([point["x"] for point in curve])
    K = tyre.state(loads, gamma=np.radians(10.0), phi_t=-0.3, Vx=tyre["LONGVL"], p=p).K_ya
    assert np.allclose([point["y"] for point in curve], -K, rtol=1e-9)
    browser.find_element("id", "reset").click()
    drawn(browser)


def test_curves_are_shown_as_differences_from_the_first_tyre(browser):
    """At equal conditions; a picture of one output over another has none, and is not shown."""
    move(browser, Fz=1800, gamma=5, alpha=0)
    browser.find_element("id", "difference").click()
    drawn(browser)
    first, second = (tir.read(file) for file in FILES[:2])
    curve = browser.execute_script("return window.mffit.curve('Fy-alpha', 1)")
    at = {"alpha": np.radians([point["x"] for point in curve]), "gamma": np.radians(5.0), "phi_t": 0.0}
    at |= {"Vx": first["LONGVL"], "p": first["INFLPRES"]}
    Fy = [tyre(1800.0, turn_slip=tyre.turn_slip, **at).Fy for tyre in (first, second)]
    assert np.allclose([point["y"] for point in curve], Fy[1] - Fy[0], rtol=1e-9, atol=1e-9)
    own = browser.execute_script("return window.mffit.curve('Fy-alpha', 0)")
    assert {point["y"] for point in own} == {0}
    hidden = [
        figure.get_attribute("id") for figure in browser.find_elements("css selector", "figure[hidden]")
    ]
    assert hidden == [panel.key for panel in PANELS if panel.x in OUTPUTS]
    before = lines(browser, "Fy-Fx")
    move(browser, Fz=2600)
    assert complaints(browser) == []
    assert console_errors(browser) == []
    browser.find_element("id", "reset").click()
    drawn(browser)
    assert not browser.find_elements("css selector", "figure[hidden]")
    assert lines(browser, "Fy-Fx") != before  # drawn again, as the condition is another


def test_a_picture_is_drawn_where_its_curves_are(browser):
    move(browser, alpha=0, gamma=0)
    on, share = browser.execute_script(
        """
        const canvas = document.querySelector("#Fy-alpha canvas"), pen = canvas.getContext("2d");
        const {data} = pen.getImageData(0, 0, canvas.width, canvas.height), at = mffit.place("Fy-alpha");
        const dark = k => data[4 * k + 3] > 200 && Math.min(data[4 * k], data[4 * k + 1], data[4 * k + 2]) < 128;
        const pixel = p => Math.round(at.Y(p.y) * at.ratio) * canvas.width + Math.round(at.X(p.x) * at.ratio);
        const curve = mffit.curve("Fy-alpha", 0).slice(5, -5), every = [...Array(canvas.width * canvas.height).keys()];
        const share = (list, of) => list.filter(of).length / list.length;
        return [share(curve.map(pixel), dark), share(every, dark)];
        """
    )
    assert on > 0.85  # the rings of marks lie over it
    assert share < 0.1


def test_turn_slip_can_be_switched(browser):
    """Files of USE_MODE ending in 5 start with it; the force at a curvature goes with the switch, and comes back."""
    flat = lambda: browser.execute_script(  # noqa: E731
        "return document.getElementById('Fy-phi_t').classList.contains('flat')"
    )
    force = lambda: browser.execute_script("return window.mffit.curve('Fy-phi_t', 0).map(p => p.y)")  # noqa: E731
    assert not flat()
    browser.find_element("css selector", "input[value=off]").click()
    drawn(browser)
    assert flat()
    assert np.ptp(force()) == 0.0
    browser.find_element("css selector", "input[value=on]").click()
    drawn(browser)
    assert not flat()
    assert np.ptp(force()) > 100.0
    browser.find_element("id", "reset").click()
    drawn(browser)


def test_curves_beyond_the_ranges_are_dotted(browser):
    """The car's file allows 6 degrees of camber: its curves are dotted at 20, and the table says why."""
    move(browser, gamma=20)
    car = browser.find_elements("css selector", "#legend .about")[2].text
    assert "outside the file's range: camber" in car
    zones = browser.execute_script("return window.mffit.curve('Fy-alpha', 2).map(p => p.zone)")
    assert set(zones) == {2}
    move(browser, gamma=0)


def test_what_follows_from_an_estimated_longitudinal_force_is_dashed(tmp_path):
    """Over its whole range, where a measured side force beside it is not; the table says so."""
    guessed = tir.read(FILES[0]).annotate(status={"PKX1": "estimate, not measured"})
    mffit.show({"guessed": guessed}, tmp_path / "page.html")
    with opened(tmp_path / "page.html") as browser:
        zones = {
            panel: browser.execute_script(f"return window.mffit.curve('{panel}', 0).map(p => p.zone)")
            for panel in ("Fx-kappa", "Fy-alpha")
        }
        assert (
            "estimated, not measured: longitudinal force"
            in browser.find_element("css selector", "#legend .about").text
        )
    assert min(zones["Fx-kappa"]) == 1
    assert min(zones["Fy-alpha"]) == 0


def until(true: Callable[[], Any]) -> Any:
    end = time.monotonic() + 30.0
    while not (found := true()):
        assert time.monotonic() < end, "not in time"
        time.sleep(0.05)
    return found


def shown(browser, name: str) -> float:
    return float(browser.find_element("id", name).get_attribute("value"))


def test_the_address_keeps_what_is_seen(browser):
    """The address keeps condition, hidden tyres and differences; one that holds something else opens the page as it was made."""
    move(browser, gamma=7, Fz=2000)
    for css in ("input[value=off]", "#difference", "#legend tr:nth-child(3) input"):
        browser.find_element("css selector", css).click()
    drawn(browser)
    before = browser.execute_script("return mffit.curve('Fy-alpha', 1)")
    browser.refresh()
    drawn(browser)
    assert browser.execute_script("return mffit.curve('Fy-alpha', 1)") == before
    assert (shown(browser, "gamma"), shown(browser, "Fz")) == (7.0, 2000.0)
    assert browser.find_elements("css selector", "#legend .hidden .name")[0].text == "car"
    home = browser.current_url.partition("#")[0]
    for other in ("null", "7", "%7B", '{"now":{"Fz":"x"},"use":3,"hidden":5}'):
        browser.get("about:blank")
        browser.get(f"{home}#{other}")
        drawn(browser)
        assert shown(browser, "Fz") == 1400.0
        assert len(lines(browser, "Fy-alpha")) == len(FILES)
    browser.get("about:blank")
    browser.get(home)
    assert console_errors(browser) == []


def test_keys_zoom_a_picture_and_move_its_slider(browser):
    canvas = browser.find_element("css selector", "#Fy-alpha canvas")
    box = lambda: browser.execute_script("return mffit.place('Fy-alpha').box")  # noqa: E731
    whole = box()
    canvas.send_keys("+")
    drawn(browser)
    assert np.ptp(box()["x"]) == pytest.approx(np.ptp(whole["x"]) / 1.25)
    move(browser, Fz=3000)
    assert np.ptp(box()["x"]) == pytest.approx(np.ptp(whole["x"]) / 1.25)  # a view stays
    move(browser, Fz=1400)
    canvas.send_keys("0")
    drawn(browser)
    assert box() == whole
    step = float(browser.find_element("id", "alpha").get_attribute("step"))
    canvas.send_keys("\ue014\ue014")  # right
    assert shown(browser, "alpha") == pytest.approx(2.0 * step)
    canvas.send_keys("\ue012\ue012")  # left
    assert shown(browser, "alpha") == pytest.approx(0.0)


def test_the_numbers_of_a_picture_are_those_of_tir(browser, tmp_path):
    """As the menu saves them: of every tyre, at the condition of the sliders and at the sideslips of the thin lines."""
    browser.execute_cdp_cmd(
        "Browser.setDownloadBehavior", {"behavior": "allow", "downloadPath": str(tmp_path)}
    )
    move(browser, Fz=1800, alpha=0)
    browser.execute_script("document.querySelectorAll('#Fy-Fx .more button')[1].click()")
    (found,) = until(lambda: [path for path in tmp_path.glob("*.csv") if path.stat().st_size])
    rows = list(csv.reader(found.read_text(encoding="utf-8").splitlines()))
    heading = "tyre,load [N],sideslip [deg],camber [deg],longitudinal slip,path curvature [1/m],speed [m/s],pressure [kPa]"
    assert rows[0][:8] == heading.split(",")
    assert rows[0][8:] == ["longitudinal force [N]", "side force [N]"]
    own = np.array([row[1:] for row in rows if row[0] == LONG], dtype=float).T
    assert set(own[1]) == {0.0, *(angle for angle in FAN)}
    tyre = tir.read(FILES[1])
    forces = tyre(1800.0, *np.radians(own[1:3]), own[3], phi_t=0.0, Vx=own[5], p=1e3 * own[6])
    assert own[7] == pytest.approx(forces.Fx, rel=1e-5, abs=1e-2)
    assert own[8] == pytest.approx(forces.Fy, rel=1e-5, abs=1e-2)
    browser.find_element("id", "reset").click()
    drawn(browser)


def test_a_notebook_shows_the_page(browser, tmp_path):
    """In a frame without an address of its own, the controls act all the same."""
    frame = mffit.show(FILES[0])._repr_html_()
    (tmp_path / "notebook.html").write_text(f"<!doctype html>{frame}", encoding="utf-8")
    home = browser.current_url
    browser.get((tmp_path / "notebook.html").as_uri())
    browser.switch_to.frame(0)
    until(lambda: browser.execute_script("return window.mffit?.place('Fy-alpha')"))
    assert len(lines(browser, "Fy-alpha")) == 1
    browser.find_element("id", "loads").click()
    drawn(browser)
    assert len(lines(browser, "Fy-alpha")) == 3
    browser.switch_to.default_content()
    assert console_errors(browser) == []
    browser.get(home)


def test_hostile_names_do_no_harm(browser):
    assert browser.execute_script("return window.hacked") is None
    assert browser.find_element("css selector", ".name").text == f"front {HOSTILE}"
    assert browser.find_elements("css selector", "img") == []


@pytest.mark.parametrize("width", [420, 1200])
def test_nothing_overflows_and_no_labels_overlap(browser, width):
    size = {"width": width, "height": 900, "deviceScaleFactor": 1, "mobile": False}
    browser.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", size)
    browser.execute_script("window.dispatchEvent(new Event('resize'))")
    drawn(browser)
    assert browser.execute_script("return document.documentElement.scrollWidth") <= width
    boxes = browser.execute_script(TEXTS)
    plots = browser.execute_script(
        "return [...document.querySelectorAll('.plot canvas')].map(e => e.getBoundingClientRect()).map(r => [r.left, r.right]);"
    )
    assert len(plots) == len(PANELS)
    assert all(left >= 0 and right <= width for left, right in plots)
    assert np.min(browser.execute_script(MARGINS)) >= 0.0, "a tick's text is cut off"
    for i, a in enumerate(boxes):
        for b in boxes[i + 1 :]:
            apart = a[2] <= b[0] or b[2] <= a[0] or a[3] <= b[1] or b[3] <= a[1]
            assert apart or a[4].strip() in b[4] or b[4].strip() in a[4], (a, b)


def test_a_printed_page_has_its_pictures_and_no_controls(browser):
    try:
        for width, media in ((PHONE, ""), (PAPER, "print")):
            look(browser, width, media=media)
            assert complaints(browser) == []
        assert sheets(browser) <= 3
    finally:
        look(browser)


def test_every_slider_belongs_to_an_input_and_every_panel_to_an_output():
    assert {control.name for control in CONTROLS} == set(INPUTS)
    program = trace(Switches(True), OUTPUTS)
    assert set(program.outputs) == set(OUTPUTS)


def test_the_last_tick_of_an_axis_is_not_cut_off(browser, tmp_path):
    """The load axis of this tyre ends with a number of four digits at its very end."""
    mffit.show({"front": tir.read(FILES[0]).replace(FZMAX=3000.0)}, tmp_path / "front.html")
    browser.get((tmp_path / "front.html").as_uri())
    drawn(browser)
    texts = browser.execute_script("return mffit.texts('K_ya-Fz').map(text => text[4])")
    assert texts[-1] == "3000"
    assert np.min(browser.execute_script(MARGINS)) >= 0.0
    assert console_errors(browser) == []
