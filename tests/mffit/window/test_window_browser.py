"""The window and the page of a project in a real browser: the numbers of the build, sliders, clicks, refit, several windows."""

from __future__ import annotations

import json
import re
import shutil
import signal
import subprocess
import sys
import time
import tomllib
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import replace
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from threading import Event, Thread
from typing import Any
from urllib.parse import urlsplit

import numpy as np
import pytest
from inside import of_disc_beside_a_foreign_table

import mffit
from mffit.quantities import SIDEWAYS
from mffit.report.verdict import judgement, verdict
from mffit.viewer import project_data, project_html, project_page
from mffit.viewer.project_points import differing
from mffit.window.app import Opened
from mffit.window.runs import carry_out
from mffit.window.session import Session
from tests.browser import PAPER, PHONE, SCREEN, brightness, complaints, console_errors, look, opened, sheets

SHOWN = "!!(window.mffit && mffit.data() && mffit.data().points.line)"
SIX_DIGITS = 1e-4
"""Agreement [-] of misfits: points have six digits in a page, and a misfit is a hundredth of a force."""
HOSTILE = "</script><script>window.hacked=1</script><img src=x onerror='window.hacked=1'>"


@pytest.fixture(scope="module")
def browser(result, tmp_path_factory) -> Iterator[Any]:
    """One browser with the page without a server."""
    page = project_page(result).write(tmp_path_factory.mktemp("page") / "page.html")
    with opened(page) as driver:
        driver.home = page.as_uri()
        yield driver


@pytest.fixture
def page(browser) -> Any:
    browser.get("about:blank")
    browser.get(browser.home)
    return shown(browser)


def shown(browser: Any) -> Any:
    """The browser once it has unpacked and drawn the points of a fit."""
    until(lambda: ask(browser, SHOWN) and ask(browser, "mffit.data()?.coefficients.length > 0"))
    return browser


def ask(browser: Any, script: str, *given: Any) -> Any:
    return browser.execute_script(f"return {script};", *given)


def press(browser: Any, css: str) -> None:
    browser.execute_script("document.querySelector(arguments[0]).click()", css)


def until(true: Callable[[], Any], seconds: float = 600.0) -> Any:
    end = time.monotonic() + seconds
    while not (found := true()):
        assert time.monotonic() < end, "not in time"
        time.sleep(0.05)
    return found


def test_a_moved_coefficient_moves_the_misfit_and_undo_brings_it_back(page, result):
    """The numbers are tested without a browser, in tests/mffit/viewer."""
    fitted = ask(page, "mffit.misfit('Fy').rmse")
    assert fitted == pytest.approx(result.fit.channels["Fy"].rmse, rel=SIX_DIGITS)
    ask(page, "mffit.move('PCY1', 1.5)")
    assert ask(page, "mffit.misfit('Fy').rmse") > 2.0 * fitted
    press(page, "#undo")
    assert ask(page, "mffit.misfit('Fy').rmse") == fitted
    assert console_errors(page) == []
    assert ask(page, "performance.getEntriesByType('resource').length") == 0


def test_another_fit_of_the_readings_can_be_chosen_and_the_address_keeps_it(page, result, tmp_path):
    data = project_data(result)
    other = replace(result.fit, simulation=result.fit.simulation.with_numbers({"gain": 1.1}))
    points = differing(result.points, result.excluded, result.fit, other)
    data["others"] = [{"title": "warm.tir", "channels": data["channels"][:1], "points": points}]
    path = tmp_path / "two.html"
    path.write_text(project_html("two", data, turn_slip=data["turn_slip"], star=data["star"]))
    page.get(path.as_uri())
    fitted = ask(shown(page), "mffit.misfit('Fy').rmse")
    assert ask(page, "[...document.querySelector('#fit').options].map(one => one.text)")[1:] == ["warm.tir"]
    choose = "Object.assign(document.querySelector('#fit'), {selectedIndex: arguments[0]}).dispatchEvent(new Event('change'))"
    ask(page, choose, 1)
    until(lambda: ask(page, "mffit.data().channels.length") == 1)
    warm = ask(page, "mffit.misfit('Fy').rmse")
    assert warm > 1.5 * fitted
    page.refresh()
    assert ask(shown(page), "mffit.misfit('Fy').rmse") == warm
    assert page.find_element("id", "about").text.startswith("warm.tir: ")  # also on paper
    ask(page, choose, 0)
    until(lambda: ask(page, "mffit.misfit('Fy').rmse") == fitted)
    assert console_errors(page) == []


def test_tab_reaches_the_pictures_at_once(page):
    page.find_element("css selector", "body").send_keys("\ue004\ue007")  # tab, enter
    assert ask(page, "document.activeElement === document.querySelector('.panel canvas')")


def test_the_reading_that_was_left_out_is_marked(page):
    left = ask(page, "mffit.left()")
    assert sum(left) == 1
    row = left.index(1)
    ask(page, "mffit.choose(arguments[0], false)", row)
    section = page.find_element("id", "chosen").text
    assert "sideslip_1400.csv:4" in section
    assert "belt tracking" in section


def test_filters_hide_points_and_the_address_keeps_the_view(page):
    count = int(re.search(r"(\d+) of", page.find_element("id", "shown").text)[1])
    press(page, ".chip[data-facet=Fz]")
    fewer = int(re.search(r"(\d+) of", page.find_element("id", "shown").text)[1])
    assert 0 < fewer < count
    ask(page, "mffit.move('PCY1', 1.5)")
    page.refresh()
    shown(page)
    assert page.find_element("id", "shown").text.startswith(f"{fewer} of")
    assert ask(page, "mffit.trial()") == {"PCY1": 1.5}


DRAWN = "[...mffit.visible().keys()].filter(i => Number.isFinite(mffit.place(0, i)[0])).length"
"""Points of the first picture, which has none of sweeps over something else."""


def test_keys_choose_a_point(page):
    canvas = page.find_element("css selector", ".panel canvas")
    canvas.send_keys("\ue014")  # right
    first = ask(page, "mffit.chosen()")
    canvas.send_keys("\ue014")
    assert len(first) == 1
    second = ask(page, "mffit.chosen()")
    assert len(second) == 1
    assert second != first
    canvas.send_keys("\ue008", "\ue012")  # shift, left
    assert ask(page, "mffit.chosen()") == second + first
    canvas.send_keys("\ue009", "a")  # control
    assert len(ask(page, "mffit.chosen()")) == ask(page, DRAWN)
    canvas.send_keys("\ue00c")  # escape
    assert ask(page, "mffit.chosen()") == []


def drag(page: Any, steps: list[tuple[float, float]], type_: str = "mouse") -> None:
    """Move a pointer over the first picture, from place to place in its pixels."""
    box = ask(page, "(({x, y}) => [x, y])(document.querySelector('.panel canvas').getBoundingClientRect())")
    at = [{"x": box[0] + x, "y": box[1] + y} for x, y in steps]
    if type_ == "mouse":
        names = ["mousePressed", *["mouseMoved"] * (len(at) - 2), "mouseReleased"]
        for name, place in zip(names, at, strict=True):
            given = {"type": name, **place, "button": "left", "buttons": 1, "clickCount": 1}
            page.execute_cdp_cmd("Input.dispatchMouseEvent", given)
        return
    for name, place in zip(["touchStart", *["touchMove"] * (len(at) - 2)], at[:-1], strict=True):
        page.execute_cdp_cmd("Input.dispatchTouchEvent", {"type": name, "touchPoints": [place]})
    page.execute_cdp_cmd("Input.dispatchTouchEvent", {"type": "touchEnd", "touchPoints": []})


@pytest.mark.parametrize("type_", ["mouse", "touch"])
def test_a_rectangle_chooses_the_points_in_it(page, type_):
    """With a finger after "Select points"; then each rectangle adds. The list names every point."""
    page.execute_script("document.querySelector('.panel').scrollIntoView({block: 'center'})")
    places = np.array([ask(page, "mffit.place(0, arguments[0])", i) for i in range(40)], dtype=float)
    if type_ == "touch":
        press(page, "#select")
    box = np.array([[20.0, 20.0], [120.0, 60.0], [170.0, 120.0]])
    drag(page, [tuple(box[0]), tuple(box[1]), tuple(box[2]), tuple(box[2])], type_)
    low, high = box[0], box[2]
    wanted = [i for i, place in enumerate(places) if np.all((place >= low) & (place <= high))]
    found = ask(page, "mffit.chosen()")
    assert 1 < len(wanted) < 40
    assert [i for i in found if i < 40] == wanted
    assert len(page.find_elements("css selector", "#chosen-table tbody tr")) == len(found)
    drag(page, [(0.0, 10.0), (20.0, 15.0), (30.0, 18.0), (30.0, 18.0)], type_)
    assert (ask(page, "mffit.chosen()") == found) == (
        type_ == "touch"
    )  # nothing was added, or nothing chosen
    if type_ == "touch":
        press(page, "#select")


@pytest.mark.parametrize("width", [PHONE, SCREEN])
def test_nothing_overflows(page, width):
    look(page, width)
    ask(page, "mffit.choose(3, false)")
    assert ask(page, "document.documentElement.scrollWidth") <= width
    boxes = ask(
        page,
        "[...document.querySelectorAll('.coefficient .line, .facet')].map(e => [e.scrollWidth, e.clientWidth])",
    )
    assert all(inner <= outer + 1 for inner, outer in boxes)
    look(page, SCREEN)


def test_a_printed_page_has_its_pictures_and_no_controls(page):
    """A moved coefficient and the key of the colours stay, sliders and filters do not; light also where the screen is dark."""
    ask(page, "(mffit.move('PCY1', 1.5), mffit.chooseAll([0, 1], false))")
    try:
        look(page, SCREEN, dark=True)
        paper = page.find_element("css selector", ".panel canvas")
        until(lambda: brightness(paper).mean() < 0.3)
        look(page, PAPER, media="print", dark=True)
        assert complaints(page) == []
        shown = page.find_element("css selector", "body").text
        assert all(text in shown for text in ("load", "side force [N] over sideslip", "PCY1"))
        assert not any(text in shown for text in ("PDY1", "Undo", "sideslip_900"))
        assert brightness(paper).mean() > 0.8
        assert sheets(page) <= 2
    finally:
        ask(page, "mffit.chooseAll([], false)")
        look(page, SCREEN)


def box(page: Any) -> np.ndarray:
    """What the first picture shows: ends of x, ends of y."""
    found = ask(page, "(mffit.redraw(), mffit.box(0))")
    return np.array([found["x"], found["y"]])


def test_a_picture_zooms_and_moves(page):
    """A rectangle becomes the view; a drag moves it by as much as the pointer; keys and a double click show all again."""
    page.execute_script("document.querySelector('.panel').scrollIntoView({block: 'center'})")
    whole = box(page)
    press(page, "#zoom")
    drag(page, [(100.0, 60.0), (150.0, 90.0), (200.0, 160.0), (200.0, 160.0)])
    near = box(page)
    assert np.all(np.ptp(near, axis=1) < 0.6 * np.ptp(whole, axis=1))
    assert np.all((near[:, 0] > whole[:, 0]) & (near[:, 1] < whole[:, 1]))
    assert ask(page, "mffit.chosen()") == []
    press(page, "#move")
    drag(page, [(100.0, 60.0), (120.0, 60.0), (140.0, 60.0), (140.0, 60.0)])
    moved = box(page)
    assert moved[1] == pytest.approx(near[1])
    assert np.ptp(moved[0]) == pytest.approx(np.ptp(near[0]))
    assert moved[0, 0] < near[0, 0]
    canvas = page.find_element("css selector", ".panel canvas")
    canvas.send_keys("+")
    assert np.ptp(box(page), axis=1) == pytest.approx(np.ptp(moved, axis=1) / 1.25)
    canvas.send_keys("0")
    assert box(page) == pytest.approx(whole)
    press(page, "#move")


def test_two_fingers_zoom(page):
    page.execute_script("document.querySelector('.panel').scrollIntoView({block: 'center'})")
    whole = box(page)
    left, top = ask(
        page, "(({x, y}) => [x, y])(document.querySelector('.panel canvas').getBoundingClientRect())"
    )
    for kind, apart in (("touchStart", 20.0), ("touchMove", 30.0), ("touchMove", 40.0), ("touchEnd", None)):
        at = [] if apart is None else [(150.0 - apart, 0), (150.0 + apart, 1)]
        fingers = [{"x": left + x, "y": top + 100.0, "id": k} for x, k in at]
        page.execute_cdp_cmd("Input.dispatchTouchEvent", {"type": kind, "touchPoints": fingers})
    assert np.ptp(box(page), axis=1) == pytest.approx(np.ptp(whole, axis=1) / 2.0, rel=0.1)


def test_every_channel_measured_has_a_picture_and_two_are_in_sight(page, result):
    look(page, 1280, 900)
    shown_first = ask(
        page, "[...document.querySelectorAll('.panel')].map(one => one.querySelector('select').value)"
    )
    assert set(result.points.measured) <= set(shown_first)
    ends = ask(
        page, "[...document.querySelectorAll('.panel')].map(one => one.getBoundingClientRect().bottom)"
    )
    assert sum(end <= 900 for end in ends) >= 2
    look(page, SCREEN)


def test_a_picture_and_its_numbers_are_saved(page, tmp_path):
    page.execute_cdp_cmd("Browser.setDownloadBehavior", {"behavior": "allow", "downloadPath": str(tmp_path)})
    for k in (0, 1):
        page.execute_script(f"document.querySelectorAll('.panel .more button')[{k}].click()")
    until(lambda: len(list(tmp_path.glob("small_*.*[gv]"))) == 2)
    files = {path.suffix: path for path in tmp_path.iterdir()}
    assert files[".png"].read_bytes().startswith(b"\x89PNG")
    lines = files[".csv"].read_text(encoding="utf-8").splitlines()
    assert lines[0].endswith("sideslip [deg],side force [N]")
    assert sum(line.startswith("point,") for line in lines) == ask(page, DRAWN) - 1  # left out


LIGHT = """
const light = colour => {
  const [r, g, b, opaque] = (colour.match(/[\\d.]+/g) || [0, 0, 0]).map(Number);
  return (opaque === undefined || opaque > 0.5) && Math.min(r, g, b) > 150;
};
return [...document.querySelectorAll('body, body *')]
  .filter(e => e.offsetParent && light(getComputedStyle(e).backgroundColor)).map(e => e.tagName + '.' + e.className);
"""


def test_nothing_light_is_left_in_the_dark(page):
    """After the scheme is switched: neither a background nor the colours of canvases and filters."""
    mark = "getComputedStyle(document.querySelector('.chip i')).backgroundColor"
    before, paper = ask(page, mark), page.find_element("css selector", ".panel canvas")
    assert brightness(paper).mean() > 0.8
    look(page, dark=True)
    until(lambda: brightness(paper).mean() < 0.3)
    assert ask(page, mark) != before
    assert page.execute_script(LIGHT) == []
    look(page, dark=False)


def test_fingers_have_room(page):
    page.execute_cdp_cmd("Emulation.setTouchEmulationEnabled", {"enabled": True})
    page.execute_cdp_cmd("Emulation.setEmulatedMedia", {"features": [{"name": "pointer", "value": "coarse"}]})
    look(page, PHONE)
    page.execute_cdp_cmd(
        "Emulation.setDeviceMetricsOverride",
        {"width": PHONE, "height": 900, "deviceScaleFactor": 1, "mobile": True},
    )
    page.refresh()
    assert ask(shown(page), "matchMedia('(pointer: coarse)').matches")
    small = ask(
        page,
        "[...document.querySelectorAll('button, select, summary, input')].map(e => [e.outerHTML.slice(0, 80),"
        " e.getBoundingClientRect()]).filter(([, b]) => b.width && (b.height < 24 || b.width < 24)).map(([e]) => e)",
    )
    page.execute_cdp_cmd("Emulation.setTouchEmulationEnabled", {"enabled": False})
    look(page, SCREEN)
    assert small == []


FRAMES = """
const slider = document.querySelector('.coefficient[data-name=PCY1] .slider'), {min, max} = slider;
for (let k = 1; k <= arguments[0]; k++) {
  slider.value = +min + (max - min) * k / (arguments[0] + 1);
  slider.dispatchEvent(new Event('input'));
  mffit.redraw();
}
"""
"""A slider moves, and each time all is computed and drawn."""


def processor_time(page: Any) -> float:
    """Time [s] that the page's main thread has computed."""
    found = page.execute_cdp_cmd("Performance.getMetrics", {})["metrics"]
    return next(one["value"] for one in found if one["name"] == "TaskDuration")


def test_a_slider_moves_five_thousand_points_smoothly(page, result, tmp_path):
    """The sample's points repeated; 30 frames a second, in processor time, because other work may share the processor."""
    rows = np.arange(5000) % len(result.points)
    many = replace(result, points=result.points.select(rows, with_table=False))
    page.get(project_page(many).write(tmp_path / "many.html").as_uri())
    assert ask(shown(page), "mffit.data().points.count") >= 5000
    page.execute_script(FRAMES, 4)  # after that the browser has compiled them
    page.execute_cdp_cmd("Performance.enable", {"timeDomain": "threadTicks"})
    before = processor_time(page)
    page.execute_script(FRAMES, 8)
    assert (processor_time(page) - before) / 8 < 1.0 / 30.0


def test_hostile_names_do_no_harm(page, result, tmp_path):
    bad = mffit.viewer.project_data(result)
    bad["name"] = HOSTILE
    bad["points"]["files"] = [HOSTILE] * len(bad["points"]["files"])
    bad["warnings"] = [HOSTILE]
    html = mffit.viewer.project_html(HOSTILE, bad, turn_slip=False, star=False)
    path = tmp_path / "hostile.html"
    path.write_text(html, encoding="utf-8")
    page.get(path.as_uri())
    ask(shown(page), "mffit.choose(2, false)")
    assert page.find_element("css selector", "#warnings li").get_attribute("textContent") == HOSTILE
    assert HOSTILE in page.find_element("id", "chosen-title").text
    assert ask(page, "window.hacked") is None


def enter(browser: Any, address: str) -> str:
    """Open a window by an address that lets one browser in; returns the address of its page."""
    console_errors(browser)  # of other tests
    browser.get(address)
    until(lambda: "/enter/" not in browser.current_url and browser.find_elements("id", "status"))
    return browser.current_url.partition("#")[0]


@contextmanager
def served(given: Any, port: int = 0) -> Iterator[str]:
    """Address, for one browser, of a window whose server runs in this process."""
    import uvicorn

    from mffit.window.app import window_app
    from mffit.window.guard import Entrance
    from mffit.window.serving import _listening

    with _listening(port) as listening:
        port = listening.getsockname()[1]
        entrance = Entrance()
        app = window_app(given, entrance=entrance, port=port, closing=lambda: server.should_exit)
        server = uvicorn.Server(
            uvicorn.Config(app, log_level="error", lifespan="off", timeout_graceful_shutdown=1)
        )
        thread = Thread(target=server.run, kwargs={"sockets": [listening]})
        thread.start()
        try:
            yield f"http://127.0.0.1:{port}{entrance.new_address()}"
        finally:
            server.should_exit = True
            thread.join()


def test_a_file_leads_into_the_window_and_the_address_bar_has_no_key(browser, tyre_toml):
    """As `mffit open` starts a browser: cookies of SameSite=Strict stay behind where a file redirects."""
    from mffit.window.serving import _leading_to

    with served(Opened(Session(tyre_toml))) as address, _leading_to(address, 1) as page:
        home = enter(browser, page.as_uri())
        assert urlsplit(home).netloc == urlsplit(address).netloc
        assert ask(browser, "document.cookie") == ""
        (cookie,) = [one for one in browser.get_cookies() if one["name"] == "mffit"]
        assert (cookie["httpOnly"], cookie["sameSite"]) == (True, "Strict")
        assert cookie["value"] not in home
        browser.refresh()
        assert browser.find_elements("id", "status")
        shown = browser.execute_cdp_cmd("Page.getNavigationHistory", {})["entries"]
        assert [entry["url"] for entry in shown if "/enter/" in entry["url"]] == []


def drop(browser: Any, path: Path) -> None:
    files = {"items": [], "files": [str(path)], "dragOperationsMask": 1}
    for kind in ("dragEnter", "dragOver", "drop"):
        browser.execute_cdp_cmd("Input.dispatchDragEvent", {"type": kind, "x": 200, "y": 120, "data": files})


def test_a_folder_dropped_into_the_page_is_stored_once_agreed(browser, original, tmp_path):
    from mffit.window.recordings_folder import RecordingsFolder

    (tmp_path / "run" / "deep").mkdir(parents=True)
    (tmp_path / "empty").mkdir()
    shutil.copy(original.parent / "sideslip_900.csv", tmp_path / "run")
    shutil.copy(original.parent / "camber_900.csv", tmp_path / "run" / "deep")
    (tmp_path / "run" / "photo.jpg").write_bytes(b"jpg")
    with served(Opened(folder=RecordingsFolder(tmp_path / "empty"))) as address:
        enter(browser, address)
        until(lambda: "No recordings here yet" in browser.find_element("id", "status").text)
        drop(browser, tmp_path / "run")
        until(lambda: ask(browser, "document.getElementById('store').open"))
        assert "these 2 recordings" in browser.find_element("id", "store-about").text
        assert "1 other file" in browser.find_element("id", "store-about").text
        assert list((tmp_path / "empty").iterdir()) == []
        press(browser, "#store button.main")
        until(lambda: browser.find_elements("css selector", "#groups tr"))
        stored = sorted(path.name for path in (tmp_path / "empty").iterdir())
        assert stored == ["camber_900.csv", "sideslip_900.csv"]
        assert ask(browser, "document.querySelector('[name=axes]').value") == "iso"
        for width, media in ((PHONE, ""), (PAPER, "print")):
            look(browser, width, media=media)
            assert complaints(browser) == []
        shown = browser.find_element("css selector", ".folder").text
        assert "sideslip_900.csv" in shown
        assert "rolls backwards" not in shown  # which nobody ticked
        assert "path radius" not in shown  # of a belt
        assert browser.find_element("css selector", "#tyre").is_displayed()
        look(browser)
        assert console_errors(browser) == []


def test_the_page_proposes_what_the_ticked_recordings_say_and_sends_only_what_was_chosen(browser, tmp_path):
    def value(name: str) -> str:
        return str(ask(browser, f"document.querySelector('[name={name}]').value"))

    fill = """for (const [name, x] of Object.entries(arguments[0])) {
      const field = document.querySelector(`[name=${name}]`);
      field.value = x;
      field.dispatchEvent(new Event("change", {bubbles: true}));  // all that scripts of a browser send
    }"""
    of_tyre = {"unloaded_radius": 0.2992, "nominal_load": 1400, "nominal_pressure": 250}
    of_disc = {"type": "rotating-disk", "path_radius": 1.323}
    status = lambda: browser.find_element("id", "status").text  # noqa: E731
    with served(Opened(folder=of_disc_beside_a_foreign_table(tmp_path))) as address:
        enter(browser, address)
        until(lambda: "do not say yet what rig and axes" in status())
        assert (value("type"), value("axes")) == ("", "")
        assert "take its tick away" in browser.find_element("id", "problems").text
        press(browser, "#groups section:has([aria-label='costs is']) .files input")
        until(lambda: "These look like recordings of a disc" in status())
        assert not browser.find_element("id", "problems").is_displayed()
        assert (value("type"), value("axes")) == ("", "iso")
        browser.execute_script(fill, of_tyre | of_disc)
        press(browser, "#check")
        assert not ask(browser, "document.getElementById('choice').checkValidity()")  # left or right?
        browser.execute_script(fill, {"path_centre": "left"})
        press(browser, "#check")
        until(lambda: "Checked" in status())
        assert "camber: " in browser.find_element("id", "conditions").text
        press(browser, "#choice [type=submit]")
        until(lambda: (tmp_path / "tyre.toml").exists())
    text = (tmp_path / "tyre.toml").read_text(encoding="utf-8")
    assert 'type = "rotating-disk"' in text
    assert "as chosen" not in text
    assert "costs.csv" not in text


@contextmanager
def window(tyre_toml: Path) -> Iterator[tuple[str, subprocess.Popen]]:
    """Address and process of `mffit open`."""
    command = [sys.executable, "-m", "mffit", "open", str(tyre_toml), "--no-browser"]
    process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    try:
        assert process.stdout is not None
        yield process.stdout.readline().split()[-1], process
    finally:
        process.kill()
        process.communicate()


def test_the_sentence_of_a_refused_change_goes_with_its_cause(browser, tyre_toml, session):
    """It does not take the name of the coefficient for that of another table, either."""
    right = tyre_toml.read_bytes()
    with served(Opened(session)) as address:
        enter(browser, address)
        shown(browser)
        ask(browser, "mffit.move('PEY1', -0.9)")
        problem = browser.find_element("css selector", ".coefficient[data-name=PEY1] .problem")
        for broken, said in ((right + b"x = ", "is not valid TOML"), (b"", "tyre: is missing")):
            tyre_toml.write_bytes(broken)
            until(lambda said=said: said in browser.find_element("id", "status").text)
            press(browser, ".coefficient[data-name=PEY1] .keys button")  # hold
            until(lambda said=said: said in problem.text)
            assert not problem.text.startswith("PEY1: is missing")
            tyre_toml.write_bytes(right)
            until(lambda: problem.text == "")
        assert tyre_toml.read_bytes() == right


class ForeignServer(ThreadingHTTPServer):
    """A server of somebody else that writes down what it is asked, and answers every stream with a state of its own."""

    def __init__(self, port: int) -> None:
        self.asked: list[str] = []
        super().__init__(("127.0.0.1", port), _Foreign)


class _Foreign(BaseHTTPRequestHandler):
    server: ForeignServer

    def do_GET(self) -> None:
        self.server.asked.append(self.path)
        self.send_response(200)
        self.send_header("content-type", "text/event-stream")
        self.end_headers()
        state = {"fits": 99, "pages": [], "hand": {}, "exclude": [], "problem": "FOREIGN", "digest": "0"}
        self.wfile.write(f"data: {json.dumps(state)}\n\n".encode())

    do_POST = do_GET


def test_a_server_of_somebody_else_at_the_port_is_asked_nothing(browser, tyre_toml, session):
    """Neither by a page that is looked at, nor by one behind it, whatever is clicked there."""
    first, had_ended = browser.current_window_handle, "has ended"
    status = lambda: browser.find_element("id", "status").text  # noqa: E731
    with served(Opened(session)) as address:
        home = enter(browser, address)
        shown(browser)
        browser.switch_to.new_window("tab")
        browser.get(f"{home}add")
        until(lambda: "in tyre.toml" in status())
    foreign = ForeignServer(urlsplit(address).port)
    thread = Thread(target=foreign.serve_forever)
    thread.start()
    try:
        until(lambda: had_ended in status(), 10.0)
        browser.execute_script("document.getElementById('check').click()")
        browser.close()
        browser.switch_to.window(first)
        until(lambda: had_ended in status(), 10.0)
        ask(browser, "mffit.move('PCY1', 1.5)")
        press(browser, ".coefficient[data-name=PCY1] .keys button")  # hold
        for button in ("#refit", "#undo", "#settings summary"):
            press(browser, button)
        ask(browser, "mffit.choose(0)")
        browser.find_element("css selector", ".panel canvas").send_keys("\ue017")  # Delete
        browser.execute_script("for (const one of document.querySelectorAll('details')) one.open = true")
        words = {"Refit", "hold", "start", "free", "limits", "Leave out", "Try a file"}
        usable = [e.text for e in browser.find_elements("css selector", "button") if e.is_enabled()]
        assert words & {*usable} == set()
        assert words - {e.text for e in browser.find_elements("css selector", "button")} == {"free"}
        assert "Zoom" in usable  # what the page does by itself
        assert not browser.find_element("id", "ask").is_displayed()
        time.sleep(6.0)  # a browser comes back to a stream after 3 s or so
        assert browser.find_elements("css selector", "#links a, #add-recordings:not([hidden])") == []
        assert had_ended in status()
        assert foreign.asked == []
    finally:
        foreign.shutdown()
        thread.join()
        foreign.server_close()
    assert "PCY1" not in tyre_toml.read_text(encoding="utf-8")


def test_points_are_seen_before_the_first_fit_ends(browser, tyre_toml, result):
    """Without what works on a fit; then the fit comes with its verdict."""
    session = Session(tyre_toml)
    visible = lambda css: [e for e in browser.find_elements("css selector", css) if e.is_displayed()]  # noqa: E731
    with served(Opened(session)) as address:
        enter(browser, address)
        assert not visible("#content, #undo, #links button")
        session.readings = carry_out("points", tyre_toml, lambda sentence: None)
        until(lambda: ask(browser, SHOWN), 30.0)
        assert ask(browser, "mffit.data().coefficients") == []
        assert (
            ask(browser, "mffit.visible().length") == len(result.points) + 1
        )  # with the one that is left out
        assert len(visible("figure.panel")) >= len(result.points.measured)
        assert not visible("aside, #undo, #links button, #bands, #reading, footer .of-fit")
        assert console_errors(browser) == []
        ask(browser, "mffit.choose(0)")
        assert visible("#chosen-actions button")
        given = {"verdict": verdict(result), "judgement": judgement(result)}
        session.data, session.fits = mffit.viewer.project_data(result, **given) | {"before": None}, 1
        shown(browser)
        assert visible("aside")
        assert visible("#undo")
        assert "is sound" in browser.find_element("id", "verdict").text
        browser.get("about:blank")


def test_coefficients_of_the_pictures_come_first(page):
    """The aligning moment's own before those of the side force, on which it depends, if only it is shown."""
    groups = "return [...document.querySelectorAll('#coefficients > details')].map(one => one.dataset.key)"
    before = page.execute_script(groups)
    assert before.index("Lateral") < before.index("Aligning")
    while len(page.find_elements("css selector", ".panel .close")) > 1:
        press(page, ".panel .close")
    script = "const one = document.querySelector('.panel select'); one.value = 'Mz'; "
    page.execute_script(script + "one.dispatchEvent(new Event('change'))")
    after = page.execute_script(groups)
    assert after.index("Aligning") < after.index("Lateral")


def test_each_of_eight_tabs_saves(browser, tyre_toml, session):
    """All of them show what each saved; a headless browser says that all are seen, as windows side by side are."""
    first = browser.current_window_handle
    with served(Opened(session)) as address:
        home, tabs = enter(browser, address), [first]
        for _ in range(7):
            browser.switch_to.new_window("tab")
            browser.get(home)
            tabs.append(browser.current_window_handle)
        for k, tab in enumerate(tabs):
            browser.switch_to.window(tab)
            if k:  # it shows what the tab before saved
                until(lambda k=k: ask(browser, "mffit.data().hand.PEY1") == round(-0.49 - 0.01 * k, 2), 5.0)
            ask(browser, f"mffit.move('PEY1', {-0.5 - 0.01 * k})")
            press(browser, ".coefficient[data-name=PEY1] .keys button")
            until(lambda k=k: f"PEY1 = {-0.5 - 0.01 * k:g}" in tyre_toml.read_text(encoding="utf-8"), 10.0)
        for tab in tabs:
            browser.switch_to.window(tab)
            until(lambda: ask(browser, "mffit.data().hand.PEY1") == -0.57, 5.0)
        for tab in tabs[1:]:
            browser.switch_to.window(tab)
            browser.close()
        browser.switch_to.window(first)
        browser.get("about:blank")


def test_a_recording_dropped_on_an_open_project_is_shown_and_added(browser, tyre_toml, session, tmp_path):
    before = tyre_toml.read_text(encoding="utf-8")
    entry = '[[sweep]]\nfile = "camber_900.csv"\n'
    tyre_toml.write_text(before.replace(entry, ""), encoding="utf-8")
    shutil.move(tyre_toml.with_name("camber_900.csv"), tmp_path / "rolls_backward.csv")
    with served(Opened(session)) as address:
        home = enter(browser, address)
        drop(browser, tmp_path / "rolls_backward.csv")
        until(lambda: ask(browser, "document.getElementById('store').open"))
        press(browser, "#store button.main")
        until(lambda: browser.find_elements("css selector", "#groups tr"))
        assert browser.current_url == f"{home}add"
        assert "Fy_N" in [
            select.get_attribute("value")
            for select in browser.find_elements("css selector", "#groups td select")
        ]
        back = browser.find_element("css selector", ".files label:last-child input")
        assert back.is_selected()
        press(browser, ".files label:last-child input")  # its name is wrong
        assert not any(field.is_displayed() for field in browser.find_elements("css selector", "#tyre, #rig"))
        assert ask(browser, "document.documentElement.scrollWidth") <= SCREEN
        press(browser, "#choice button.main")
        until(lambda: "rolls_backward.csv" in tyre_toml.read_text(encoding="utf-8"), 30.0)
        until(lambda: browser.current_url.partition("#")[0] == home)
        until(lambda: not ask(browser, "document.getElementById('undo').disabled"))
        assert "direction" not in tyre_toml.read_text(encoding="utf-8")
        assert console_errors(browser) == []
        browser.get("about:blank")


def test_a_save_of_another_program_is_shown_beside_the_click(browser, tyre_toml, session):
    with served(Opened(session)) as address:
        enter(browser, address)
        edit = session.edit

        def late(name: str, seen: str, arguments: dict[str, Any]) -> None:
            session.edit = edit
            tyre_toml.write_bytes(tyre_toml.read_bytes() + b"# theirs\n")
            edit(name, seen, arguments)

        session.edit = late
        ask(browser, "mffit.move('PEY1', -0.5)")
        press(browser, ".coefficient[data-name=PEY1] .keys button")
        until(lambda: ask(browser, "document.getElementById('both').open"), 10.0)
        assert "+# theirs" in browser.find_element("id", "both-theirs").text
        assert "+PEY1 = -0.5" in browser.find_element("id", "both-mine").text
        assert "PEY1" not in tyre_toml.read_text(encoding="utf-8")
        press(browser, "#both button.main")
        until(lambda: "PEY1 = -0.5" in tyre_toml.read_text(encoding="utf-8"), 10.0)
        assert "# theirs" in tyre_toml.read_text(encoding="utf-8")
        browser.get("about:blank")


def test_settings_are_seen_changed_and_refused_in_their_place(browser, tyre_toml, session):
    with served(Opened(session)) as address:
        enter(browser, address)
        press(browser, "#settings summary")
        row = "document.getElementById('setting [normal] weight')"
        until(lambda: ask(browser, f"{row} !== null"))
        ask(browser, f"({row}.value = '\"road\"', {row}.dispatchEvent(new Event('change')))")
        until(lambda: 'weight = "road"' in tyre_toml.read_text(encoding="utf-8"), 10.0)
        until(lambda: "differs from the fit" in browser.find_element("id", "status").text, 10.0)
        until(lambda: ask(browser, f"{row}.value") == '"road"', 10.0)
        row = "document.getElementById('setting [tyre] nominal_load')"
        ask(browser, f"({row}.value = '1.4', {row}.dispatchEvent(new Event('change')))")
        until(lambda: "looks like kilonewtons" in ask(browser, f"{row}.parentNode.textContent"), 10.0)
        for width in (PHONE, SCREEN):
            look(browser, width)
            assert ask(browser, "document.documentElement.scrollWidth") <= width
        browser.get("about:blank")


def test_a_call_without_an_answer_says_so(browser, tyre_toml, session):
    go = Event()
    with served(Opened(session)) as address:
        enter(browser, address)
        edit = session.edit
        session.edit = lambda *given: (go.wait(30.0), edit(*given))[1]
        ask(browser, "mffit.move('PEY1', -0.5)")
        press(browser, ".coefficient[data-name=PEY1] .keys button")
        until(lambda: "No answer for 3 s" in browser.find_element("id", "status").text, 10.0)
        go.set()
        until(lambda: "differs from the fit" in browser.find_element("id", "status").text, 10.0)
        assert "PEY1 = -0.5" in tyre_toml.read_text(encoding="utf-8")
        browser.get("about:blank")


def test_hold_refit_reload_two_windows_and_a_server_that_ends(browser, tyre_toml, result, tmp_path):
    """A walk: what is shown at its end is what mffit build gives for the file that was saved on the way."""
    before = tyre_toml.read_text(encoding="utf-8")
    status = lambda: browser.find_element("id", "status").text  # noqa: E731
    with window(tyre_toml) as (once, process):
        address = enter(browser, once)
        shown(browser)
        result.fit.tyre.replace(PCY1=1.7).write(tmp_path / "other.tir")
        browser.find_element("id", "other-file").send_keys(str(tmp_path / "other.tir"))
        until(lambda: ask(browser, "mffit.trial()") == {"PCY1": 1.7})
        assert "other.tir" in status()
        press(browser, "#undo")
        until(lambda: ask(browser, "mffit.trial()") == {})
        ask(browser, "mffit.move('PEY1', -0.9)")
        press(browser, ".coefficient[data-name=PEY1] .keys button")
        until(lambda: "PEY1" in tyre_toml.read_text(encoding="utf-8"))
        assert tyre_toml.read_text(encoding="utf-8").startswith(before)
        assert tomllib.loads(tyre_toml.read_text(encoding="utf-8"))["coefficients"] == {"PEY1": -0.9}
        until(lambda: "Refit" in status())
        row = browser.find_element("css selector", ".coefficient[data-name=PKY2]")
        keys = row.find_elements("css selector", ".keys button")
        browser.execute_script("arguments[0].click()", next(k for k in keys if k.text == "limits"))
        field = {one.get_attribute("name"): one for one in row.find_elements("css selector", ".limits input")}
        field["min"].send_keys("4")
        field["max"].send_keys("3\ue007")  # enter
        until(
            lambda: (
                row.find_element("css selector", ".problem").text
                == "min: 4 is not below max, 3; exchange the two"
            )
        )
        assert field["min"].get_attribute("aria-invalid") == "true"
        field["min"].clear()
        field["min"].send_keys("2.5\ue007")
        until(lambda: "PKY2" in tyre_toml.read_text(encoding="utf-8"))
        limits = {"PKY2": {"min": 2.5, "max": 3}}
        until(lambda: ask(browser, "mffit.data().hand") == {"PEY1": -0.9, **limits})

        first = browser.current_window_handle
        browser.switch_to.new_window("tab")  # a second window shows what the first one saved
        browser.get(address)
        shown(browser)
        row = ask(browser, "mffit.data().points.files.indexOf('camber_900.csv')")
        row = ask(browser, "mffit.data().points.file.indexOf(arguments[0])", row)
        ask(browser, "mffit.chooseAll([0, 1, 2].map(k => k + arguments[0]), false)", row)
        press(browser, "#chosen-actions button")
        browser.find_element("id", "ask-why").send_keys("the belt slipped")
        press(browser, "#ask-yes")
        until(lambda: "the belt slipped" in tyre_toml.read_text(encoding="utf-8"))
        browser.close()
        browser.switch_to.window(first)
        until(lambda: sum(ask(browser, "mffit.left()")) == 4)

        press(browser, "#refit")
        until(lambda: ask(browser, "mffit.data().before"))
        assert ask(browser, "mffit.trial()") == {}
        assert ask(browser, "mffit.data().before.values.PEY1") != -0.9
        misfits = {name: ask(browser, "mffit.misfit(arguments[0]).rmse", name) for name in SIDEWAYS}
        until(lambda: "mffit build" in status())
        browser.refresh()
        shown(browser)
        assert ask(browser, "mffit.misfit('Fy').rmse") == misfits["Fy"]
        refused = [line for line in console_errors(browser) if "422" not in line]
        assert refused == []

        process.send_signal(signal.SIGINT)
        assert process.wait(15) == 0
        until(lambda: "has ended" in status())
        built = mffit.build(tyre_toml)
        assert misfits == pytest.approx(
            {name: built.fit.channels[name].rmse for name in SIDEWAYS}, rel=SIX_DIGITS
        )
        assert built.fit.tyre["PEY1"] == -0.9
    again = Session(tyre_toml).state()  # what a restarted server knows
    assert again["hand"] == {"PEY1": -0.9, **limits}
    assert [entry["why"] for entry in again["exclude"]] == ["belt tracking", "the belt slipped"]
