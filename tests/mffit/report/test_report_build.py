"""The build report: self-contained, complete, and right where data are missing."""

from __future__ import annotations

import re
import subprocess
import sys
import unicodedata
from dataclasses import replace

import numpy as np
import pytest
from plain_pages import without_pictures
from report_toys import made_coefficients, made_result, read_page

from mffit import rounding
from mffit.prediction import OnRoad
from mffit.prediction.road import RoadCurve, RoadSide
from mffit.report import typeset, write_build
from mffit.report.style import ramp
from mffit.report.text import build_summary
from mffit.report.verdict import headlines
from mffit.rounding import AtLeast, ascii_only
from mffit.suspicion import Trust
from mffit.tested import words_on_tested
from tests.browser import (
    PAPER,
    PHONE,
    SCREEN,
    brightness,
    colours,
    complaints,
    console_errors,
    look,
    opened,
    printed,
    sheets,
    words_of,
    words_of_sheets,
)
from tir import Quantity

PNG = b"\x89PNG\r\n"


@pytest.fixture(autouse=True)
def _date(monkeypatch):
    monkeypatch.setenv("SOURCE_DATE_EPOCH", "1700000000")


@pytest.fixture(scope="module")
def written(result, tmp_path_factory):
    folder = tmp_path_factory.mktemp("report")
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("SOURCE_DATE_EPOCH", "1700000000")
        write_build(result, folder)
    return folder


@pytest.fixture(scope="module")
def page(written):
    return read_page(written / "report.html")


def test_pictures_are_on_disk_and_in_the_page(written, page):
    drawn = {
        "overview", "camber_reduction", "alignment", "parts", "fit_Fy", "fit_Mz",
        "residuals",
    }  # fmt: skip
    assert {path.stem for path in (written / "plots").glob("*.png")} == set(page.tables) == drawn
    assert len(page.drawings) == len(drawn)
    assert all(path.read_bytes().startswith(PNG) for path in (written / "plots").glob("*.png"))


def test_page_needs_no_network(written, page):
    assert all(r.startswith(("data:image/png;base64,", "data:application/zip", "#")) for r in page.references)
    html = (written / "report.html").read_text(encoding="utf-8")
    assert "<script" not in html
    assert "<link" not in html
    assert "@import" not in html
    assert "url(" not in html
    assert len(page.ids) == len(set(page.ids))


def test_the_page_says_when_and_with_what_it_was_made(page):
    assert "Written 2023-11-14 22:13 UTC by mffit" in page.text
    assert f"numpy {np.__version__}" in page.text
    assert "SHA-256" in page.text


def test_links_within_the_page_resolve(written, page):
    html = (written / "report.html").read_text(encoding="utf-8")
    assert all(f'id="{r[1:]}"' in html for r in page.references if r.startswith("#"))


def test_every_picture_is_described_in_words(page):
    assert all(len(said) > 20 for said in page.drawings)


def test_the_page_begins_with_the_contents_the_verdict_and_the_numbers_then_the_files(written, page):
    html = (written / "report.html").read_text(encoding="utf-8")
    order = [
        '<nav class="toc"',
        'class="headline sound"',
        "1 warning</a>",
        'class="card main"',
        "Which file goes where",
        "<details",
        "<figure",
    ]
    assert [html.index(mark) for mark in order] == sorted(html.index(mark) for mark in order)
    assert html.count('<div class="name">') == 4
    assert "is sound: 115 points are fitted to" in page.text
    assert "short & noisy" in page.text


def test_input_text_is_escaped(written):
    html = (written / "report.html").read_text(encoding="utf-8")
    assert "120/70 &lt;ZR17&gt;" in html
    assert "<ZR17>" not in html


def test_every_coefficient_is_listed_with_its_status(page):
    for name, coefficient in made_coefficients().items():
        assert re.search(rf"\b{name}\b", page.text)
        assert coefficient.status in page.text
    assert page.text.count("at bound") == 1
    assert "correlated with PKY2 −0.97" in page.text


def test_headline_numbers_are_those_of_the_direct_method(result, page):
    measured = result.measured
    assert f"{measured.epsilon_gamma.value:.2f}"[1:] in page.text
    assert f"{measured.nominal.C_phit.value:.0f} ± {measured.nominal.C_phit.u:.0f}" in page.text


def test_the_numbers_of_a_flat_track_are_those_of_the_model(tmp_path):
    """Stiffness and peak by the file's own forces; camber stiffness and moment because the data decide them too."""
    result = made_result(rig={"type": "flat-track"}, phi_t=0.0)
    found = {one.name: one.value for one in headlines(result)}
    tyre, slip = result.tyre, 1e-4
    load = float(tyre["FNOMIN"])
    forces = tyre(load, np.array([-slip, slip]), turn_slip=False).Fy
    peak = (
        np.max(np.abs(tyre(load, np.linspace(0.0, float(tyre["ALPMAX"]), 2001), turn_slip=False).Fy)) / load
    )
    assert list(found) == [
        "Cornering stiffness C_alpha0",
        "Peak side force per load mu_y",
        "Camber stiffness C_gamma0",
        "Peak of self-aligning moment M_zmax",
    ]
    stiffness, u = (
        float(text.split()[0]) for text in ascii_only(found["Cornering stiffness C_alpha0"]).split(" +- ")
    )
    assert stiffness == pytest.approx((forces[1] - forces[0]) / (2 * slip), abs=u)
    assert u == pytest.approx(abs(stiffness * 0.05 / tyre["PKY1"]), rel=0.05)
    assert float(found["Peak side force per load mu_y"].split()[0]) == pytest.approx(peak, abs=0.01)


def test_the_cornering_stiffness_of_a_disc_is_the_one_in_the_result(result):
    """Its uncertainty counts the path's curvature and the measured slope, of which the model alone knows nothing."""
    stated_u, nominal = 742.0, result.measured.nominal
    straight = Quantity(-19302.0, stated_u, "N/rad", "fitted")
    measured = replace(result.measured, nominal=replace(nominal, C_alpha_straight=straight))
    made = replace(result, measured=measured)
    (one,) = [one for one in headlines(made) if one.name.endswith("C_alpha0")]
    assert ascii_only(one.value) == "-19300 +- 740 N/rad"
    assert f"at {rounding.number(nominal.load, 0)} N" in one.note
    assert ascii_only(one.value) in build_summary(made)


def test_numbers_at_another_load_than_the_nominal_one_say_at_which(result):
    """The tested load nearest to the nominal one is the load of the direct method, not that of the model's numbers."""
    nominal = replace(result.measured.nominal, C_alpha_straight=Quantity(-19302.0, 742.0, "N/rad", "fitted"))
    load = float(result.tyre["FNOMIN"])
    for there, said in ((load, ""), (0.95 * load, f" at {0.95 * load:.0f} N")):
        measured = replace(result.measured, nominal=replace(nominal, load=there))
        made = replace(result, measured=measured)
        summary = build_summary(made).replace("\n", " \n")
        for one in headlines(made):
            at = there if re.search("C_phi|epsilon|eps|C_alpha0", one.name) else load
            assert f" at {at:.0f} N" in one.note
            assert f"{ascii_only(one.value)}{said if at == there else ''} \n" in f"{summary} \n"


def test_a_number_that_was_not_reached_or_not_varied_is_not_stated_as_measured(tmp_path):
    """Sideslip to 5 deg, where the side force still rises, and no camber."""
    result = made_result(rig={"type": "flat-track"}, phi_t=0.0)
    ends = {"ALPMAX": words_on_tested(np.radians(5.0), "rad"), "CAMMAX": words_on_tested(0.001, "rad")}
    tyre = result.tyre.annotate(status=ends)
    (use,) = result.tyres
    result = replace(result, tyres={use: tyre})
    found = {one.name.rpartition(" ")[2]: one for one in headlines(result)}
    assert "C_gamma" not in found
    load = float(tyre["FNOMIN"])
    reached = abs(float(tyre(load, alpha=np.radians(5.0), turn_slip=False).Fy)) / load
    word, value = found["mu_y"].value.split(" ±")[0].rsplit(" ", 1)
    assert word == "at least"
    assert float(value) == pytest.approx(reached, abs=0.01)
    assert found["mu_y"].where == "at 5.0 deg, the end of the tested range"
    assert found["mu_y"].where in found["mu_y"].note
    with without_pictures():
        write_build(result, tmp_path)
    assert "at least" in read_page(tmp_path / "report.html").text
    assert f"{ascii_only(found['mu_y'].value)} at 5.0 deg, the end of the tested range" in build_summary(
        result
    )


def test_the_road_comes_first_and_its_lesser_side_is_a_headline(result, tmp_path):
    """Numbers of both sides, what the file for turn slip off misses, and what would make the road better known."""
    sideslip = np.radians(np.linspace(-8.0, 8.0, 5))
    best, u = {"Fy": -2e4 * sideslip}, {"Fy": np.full(5, 20.0)}
    leaned = RoadCurve(np.radians(25.0), sideslip, best, u, {"Fy": np.full(5, 40.0)})
    sides = {
        side: RoadSide(Quantity(sign * 1210.0, 12.0, "N"), None, AtLeast(grip, 0.011, ""), None)
        for side, sign, grip in (("negative", 1.0, 1.178), ("positive", -1.0, 1.143))
    }
    upright = replace(leaned, camber=0.0, off={"Fy": np.zeros(5)})
    road = OnRoad(1500.0, 250e3, np.radians(4.0), sides, upright, leaned, ("a sweep the other way",))
    made = replace(result, road=road)
    (grip,) = [one for one in headlines(made) if one.name.endswith("mu_y")]
    assert ascii_only(grip.value) == "at least 1.143 +- 0.011"
    write_build(made, tmp_path)
    html, text = (
        (tmp_path / "report.html").read_text(encoding="utf-8"),
        read_page(tmp_path / "report.html").text,
    )
    marks = ['class="cards"', 'id="road"', "<figure", "Which file goes where", "<h3"]
    assert [html.index(mark) for mark in marks] == sorted(html.index(mark) for mark in marks)
    for number in (
        "1210 ± 12 N",
        "−1210 ± 12 N",
        "at least 1.178 ± 0.011",
        "better known with a sweep the other way",
    ):
        assert number in text
    assert (tmp_path / "plots/road.png").is_file()


def test_a_channel_that_was_not_fitted_is_no_row_of_the_misfits(result, tmp_path):
    """Longitudinal force that was read, but of the freely rolling wheel only."""
    fit = result.fit
    none = {"Fx": replace(fit.channels["Fy"], n=0)}
    points = result.points.replace(Fx=np.full(len(result.points), 3.0))
    made = replace(
        result,
        points=points,
        fit=replace(fit, channels={**fit.channels, **none}, model={**fit.model, "Fx": np.zeros(len(points))}),
    )
    with without_pictures():
        write_build(made, tmp_path)
    html = (tmp_path / "report.html").read_text(encoding="utf-8")
    table = html[html.index('id="fit"') :]
    rows = re.findall(r"<tr><td[^>]*>(.*?), ", table[: table.index("</table>")])
    assert [re.sub("<[^>]*>", "", row) for row in rows] == ["Fy", "Mz"]


def test_same_result_gives_the_same_bytes(result, written, tmp_path):
    write_build(result, tmp_path)
    assert (tmp_path / "report.html").read_bytes() == (written / "report.html").read_bytes()


def test_a_flat_track_has_no_spin_and_no_parts(tmp_path):
    write_build(made_result(rig={"type": "flat-track"}, phi_t=0.0), tmp_path)
    page = read_page(tmp_path / "report.html")
    assert "on a flat track" in page.text
    assert "Camber reduction factor" not in page.text
    assert {p.stem for p in (tmp_path / "plots").iterdir()} == {"overview", "fit_Fy", "fit_Mz", "residuals"}


def test_without_moment_and_stated_noise_the_side_force_is_shown_in_units_of_the_misfit(tmp_path):
    write_build(made_result(moment=False, u_Fy=np.nan, u_Mz=np.nan), tmp_path)
    text = read_page(tmp_path / "report.html").text
    assert not [p for p in (tmp_path / "plots").iterdir() if "Mz" in p.stem]
    assert "Misfit of Mz" not in text
    assert "units of the channel's rms misfit" in text
    assert "not stated" in text


def test_importing_loads_no_plot_library_and_drawing_opens_no_window(tmp_path):
    code = (
        "import sys, pathlib, numpy as np, mffit.report, mffit.report.text\n"
        "assert not {'matplotlib', 'PIL', 'jinja2'} & set(sys.modules)\n"
        "from mffit.report.drawing import pictures\n"
        "from mffit.report.drawing.records import Axis, Look, Panel, Sheet, Trace\n"
        "one = Trace(name='one', x=np.arange(2.0), y=np.arange(2.0), look=Look(line='-'))\n"
        "panel = Panel(x=Axis(), y=Axis(), series=[one])\n"
        "pictures.save(Sheet(rows=[[panel]], height=1.0), pathlib.Path(sys.argv[1]))\n"
        "assert not {'matplotlib.pyplot', 'tkinter'} & set(sys.modules)\n"
    )
    subprocess.run([sys.executable, "-W", "error", "-c", code, str(tmp_path / "a.png")], check=True)


@pytest.fixture(scope="module")
def browser(written):
    with opened(written / "report.html") as found:
        yield found


@pytest.mark.parametrize(
    ("width", "media"), [(SCREEN, ""), (PHONE, ""), (PAPER, "print")], ids=["screen", "phone", "paper"]
)
def test_a_reader_sees_every_picture(browser, width, media):
    look(browser, width, media=media)
    assert complaints(browser) == []
    assert console_errors(browser) == []


def test_the_headings_of_tables_are_repeated_on_the_next_sheet(written):
    """Browsers repeat a <thead>, and no other row."""
    page = (written / "report.html").read_text(encoding="utf-8")
    assert len(re.findall(r"<thead><tr><th", page)) > 8
    assert not re.search(r"<table[^>]*>\s*<tr[^>]*>\s*<th", page)


def test_folds_show_when_opened_and_on_paper_what_is_decided_by(browser):
    """The warnings and limits; of the rest, which is named there, a few sheets are left."""
    look(browser)
    label = browser.find_element("css selector", "#fold-purposes summary")

    def shown(css: str = "#fold-purposes .folded") -> bool:
        script = "return [...document.querySelectorAll(arguments[0])].some(one => one.checkVisibility())"
        return browser.execute_script(script, css)

    for css in (".screen-only img", ".screen-only summary"):
        assert shown(css)
    assert not shown(".paper-only")

    assert not shown()
    label.click()
    assert shown()
    label.click()
    assert not shown()
    look(browser, PAPER, media="print")
    assert shown("#fold-warnings .folded")
    assert not shown()
    assert not shown(".screen-only")
    assert shown(".paper-only")
    assert sheets(browser) <= 5
    look(browser)


@pytest.mark.parametrize(
    ("trust", "judged"),
    [(Trust(("wheel loose",)), "NOT TO BE TRUSTED"), (Trust((), ("wheel loose",)), "in doubt")],
)
def test_a_page_gives_each_reason_once(result, trust, judged, tmp_path):
    """Below the verdict, and not among the warnings again."""
    warnings = (
        "the result is not to be trusted: wheel loose" if trust.reasons else "wheel loose",
        "belt worn",
    )
    with without_pictures():
        write_build(replace(result, trust=trust, warnings=warnings), tmp_path)
    page = (tmp_path / "report.html").read_text(encoding="utf-8")
    assert f"is {judged}" in page
    assert page.count("wheel loose") == 1
    assert page.count("belt worn") == 1
    assert "1 other warning" in page


@pytest.mark.parametrize("dark", [False, True])
def test_the_sign_of_a_large_residual_is_seen(browser, dark):
    """Blue at one end of the scale, red at the other, also on a dark screen."""
    look(browser, dark=dark)
    seen = colours(browser.find_element("css selector", "[aria-label^=Residuals] .key img"))
    row = seen[np.argmax(np.ptp(seen, axis=2).sum(axis=1))]
    coloured = np.flatnonzero(np.ptp(row, axis=1) > 0.2)
    first, last = row[coloured[0] + 2], row[coloured[-1] - 2]
    assert first[2] - first[0] > 0.2
    assert last[0] - last[2] > 0.2
    look(browser)


LEADS = """return [...document.querySelectorAll('main :is(h2, h3, h4, summary, p:has(+ .scroll))')].filter(one =>
  one.checkVisibility()).map(one => one.textContent)"""
TABLES = """return [...document.querySelectorAll('table:has(thead)')].filter(one => one.checkVisibility()).map(one =>
  [one.tHead.textContent, [...one.tBodies[0].rows].map(row => row.textContent)])"""


def test_sheets_break_between_rows_below_a_repeated_head(browser):
    """No heading ends a sheet, and rows have the head of their table on their sheet, wherever on a sheet they begin."""
    browser.find_element("id", "everything").click()
    look(browser, PAPER, media="print")
    leads = {_letters(text) for text in browser.execute_script(LEADS)}
    tables = [(_letters(head), [*map(_letters, rows)]) for head, rows in browser.execute_script(TABLES)]
    assert len(leads) > 20
    assert max(len(rows) for _, rows in tables) > 15
    for lower_by in (0, 60, 120):
        browser.execute_script(f"document.querySelector('main').style.paddingTop = '{lower_by}mm'")
        sheets_said = [_letters(text) for text in words_of_sheets(printed(browser))]
        assert len(sheets_said) <= 12
        for said in sheets_said:
            assert not [lead for lead in leads if said.endswith(lead)]
            for head, rows in tables:
                assert head in said or not [row for row in rows if len(row) > LONG and row in said]
    browser.execute_script("document.querySelector('main').style.paddingTop = ''")
    browser.find_element("id", "everything").click()
    look(browser)


LONG = 20
"""Letters of a row that no other text of the page has by chance."""


def _letters(text: str) -> str:
    """Without spaces, and letters that a font joins apart."""
    return unicodedata.normalize("NFKD", re.sub(r"\s", "", text))


def test_everything_is_printed_if_asked_for(browser, result):
    """Coefficients with origin and uncertainty, budgets, sweeps, digests of the inputs, and a place to sign."""
    few = words_of(printed(browser))
    browser.find_element("id", "everything").click()
    try:
        every = words_of(printed(browser))
    finally:
        look(browser)
        browser.find_element("id", "everything").click()
    assert "Signature" in few
    assert "onscreenonly" in few
    assert "onscreenonly" not in every
    assert all(name in every for name in result.fit.coefficients)
    fitted = [name for name, found in result.fit.coefficients.items() if found.stderr and not found.by_hand]
    value = rounding.with_u(
        result.fit.coefficients[fitted[0]].value, result.fit.coefficients[fitted[0]].stderr
    )
    assert fitted[0] + value.replace(" ", "") in every
    sources = [re.sub("<[^>]*>| ", "", typeset.sentence(line.source)) for line in result.measured.budget]
    assert sources
    assert [source for source in sources if _letters(source) not in _letters(every)] == []
    assert all(name in every for name in result.points.sweep_names)


def test_page_and_pictures_are_dark_in_dark_mode(browser):
    drawing = browser.find_element("css selector", ".panels")
    look(browser)
    browser.execute_script("scrollTo(0, 0)")
    light = brightness(drawing)
    look(browser, dark=True)
    dark = brightness(drawing)
    assert np.median(light) > 0.95
    assert np.median(dark) < 0.2
    # What is dark on white is light on black, and what is faint stays faint.
    assert np.corrcoef(light.ravel(), dark.ravel())[0, 1] < -0.9


def test_the_colours_of_angles_differ_in_dark_mode(browser):
    colours = list(ramp(range(7)).values())
    squares = "".join(
        f'<rect x="{20 * k}" width="20" height="20" fill="{c}"/>' for k, c in enumerate(colours)
    )
    drawn = f'<svg xmlns="http://www.w3.org/2000/svg" width="140" height="20">{squares}</svg>'
    look(browser, dark=True)
    added = (
        "const box = document.createElement('div'); box.className = 'panels'; box.innerHTML = arguments[0];"
    )
    browser.execute_script(f"{added} document.querySelector('main').prepend(box); scrollTo(0, 0)", drawn)
    grey = brightness(browser.find_element("css selector", "main > .panels svg"))[10, 10::20]
    browser.execute_script("document.querySelector('main > .panels').remove()")
    assert np.all(np.diff(grey) < -0.03)
    assert grey[-1] > 0.3
