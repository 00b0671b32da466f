"""A headless browser to check pages; tests that need one are skipped if it is not installed."""

from __future__ import annotations

import base64
import io
import re
import shutil
import zlib
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
import pytest

PHONE, SCREEN, PAPER = 420, 1200, 703
"""Widths in pixels; A4 between the margins of our pages."""

COMPLAINTS = """
const width = document.documentElement.clientWidth, found = [], phone = matchMedia('screen and (max-width: 820px)').matches;
if (document.documentElement.scrollWidth > width) found.push(`the page is ${document.documentElement.scrollWidth} px wide`);
const folds = document.querySelectorAll('details.fold:not([open])');
for (const fold of folds) fold.open = true;
for (const scroll of document.querySelectorAll('.scroll')) {
  if (scroll.scrollWidth > scroll.clientWidth + 1) found.push(`a table is cut: ${scroll.textContent.trim().slice(0, 40)}`);
}
if (matchMedia('print').matches) for (const control of document.querySelectorAll('button, select, input, a.data')) {
  const framed = getComputedStyle(control).borderTopStyle !== 'none';
  if (control.checkVisibility() && framed) found.push(`on paper: ${control.outerHTML.slice(0, 60)}`);
}
for (const cell of document.querySelectorAll('td, th')) {
  const over = cell.checkVisibility() && cell.scrollWidth > cell.clientWidth + 1;
  if (over) found.push(`over its cell: ${cell.textContent.slice(0, 40)}`);
}
const pen = document.createElement('canvas').getContext('2d');
for (const field of document.querySelectorAll('select, input[type=number]')) {
  if (!field.checkVisibility()) continue;
  const text = field.tagName === 'SELECT' ? field.selectedOptions[0]?.text ?? '' : field.value;
  pen.font = getComputedStyle(field).font;
  if (pen.measureText(text).width > field.clientWidth) found.push(`cut: ${text}`);
}
for (const drawing of document.querySelectorAll('figure img')) {
  if (matchMedia('print').matches && drawing.closest('.screen-only')) continue;
  const box = drawing.getBoundingClientRect(), said = drawing.closest('[role=img]').getAttribute('aria-label').slice(0, 40);
  if (box.width < 5 || box.height < 5) found.push(`invisible: ${said}`);
  if (box.left < 0 || box.right > width + 1) found.push(`outside the page: ${said}`);
  const letter = 7.8 * 2; // of the smallest text, in pixels of the image
  if (letter * box.width / drawing.naturalWidth < 7) found.push(`too small to read: ${said}`);
}
for (const drawing of document.querySelectorAll('.plot canvas, .plot svg')) {
  if (drawing.closest('[hidden]')) continue;
  const box = drawing.getBoundingClientRect(), home = drawing.closest('.grid').getBoundingClientRect();
  const cut = box.width < 5 || box.height < 5 || box.left < home.left - 1 || (box.right > width + 1 && !phone);
  if (cut) found.push(`picture cut: ${box.left} to ${box.right}`);
  const sharp = !(drawing.width < 2 * box.width);  // a canvas; an SVG has no width of pixels
  if (matchMedia('print').matches && !sharp) found.push(`a picture for the screen: ${drawing.width} px`);
}
for (const fold of folds) fold.open = false;
return found;
"""


@contextmanager
def opened(page: Path, width: int = SCREEN, height: int = 900, dark: bool = False) -> Iterator[Any]:
    """The page in headless Chromium (a selenium driver), with its console kept: see ``console_errors``."""
    webdriver = pytest.importorskip("selenium.webdriver")
    chromium, driver = shutil.which("chromium"), shutil.which("chromedriver")
    if chromium is None or driver is None:
        pytest.skip("no chromium with chromedriver on this machine")
    options = webdriver.ChromeOptions()
    options.binary_location = chromium
    for argument in ("--headless=new", "--no-sandbox", "--disable-dev-shm-usage", "--disable-gpu"):
        options.add_argument(argument)
    options.set_capability("goog:loggingPrefs", {"browser": "ALL"})
    browser = webdriver.Chrome(options=options, service=webdriver.ChromeService(driver))
    try:
        look(browser, width, height, dark=dark)
        browser.get(page.resolve().as_uri())
        yield browser
    finally:
        browser.quit()


def look(
    browser: Any, width: int = SCREEN, height: int = 900, *, dark: bool = False, media: str = ""
) -> None:
    """Change window size and colour scheme; ``media`` "print" shows the printed page."""
    scheme = [{"name": "prefers-color-scheme", "value": "dark" if dark else "light"}]
    browser.execute_script(f"dispatchEvent(new Event('{'before' if media == 'print' else 'after'}print'))")
    browser.execute_cdp_cmd("Emulation.setEmulatedMedia", {"features": scheme, "media": media})
    size = {"width": width, "height": height, "deviceScaleFactor": 1, "mobile": False}
    browser.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", size)


def printed(browser: Any) -> bytes:
    """The page as a PDF on sheets of A4."""
    cut = {"paperWidth": 8.27, "paperHeight": 11.69, "preferCSSPageSize": True}
    browser.execute_cdp_cmd("Emulation.clearDeviceMetricsOverride", {})
    browser.execute_cdp_cmd("Emulation.setEmulatedMedia", {"features": [], "media": ""})
    return base64.b64decode(browser.execute_cdp_cmd("Page.printToPDF", cut)["data"])


def sheets(browser: Any) -> int:
    """Number of sheets of A4 that the page takes when it is printed."""
    return len(re.findall(rb"/Type\s*/Page\b", printed(browser)))


def words_of(document: bytes) -> str:
    """The text of a PDF that Chromium wrote, without its spaces."""
    return "".join(words_of_sheets(document))


def words_of_sheets(document: bytes) -> list[str]:
    """The text of every sheet of a PDF that Chromium wrote, without its spaces: glyphs by the table of Unicode of each font.

    Chromium ends its lines with a line feed: a carriage return before it is the last byte of what was compressed.
    """
    objects = {
        int(number): (head, zlib.decompress(content) if b"/FlateDecode" in head else content)
        for number, head, content in re.findall(
            rb"(\d+) 0 obj\s*(.*?)(?:\s*stream\n(.*?)\nendstream)?\s*endobj", document, re.DOTALL
        )
    }
    tables = {
        font: _unicode(objects[int(found[1])][1])
        for head, _ in objects.values()
        for font, number in re.findall(rb"/(F\d+) (\d+) 0 R", head)
        if (found := re.search(rb"/ToUnicode (\d+) 0 R", objects[int(number)][0]))
    }
    contents = [
        re.search(rb"/Type /Page\b.*?/Contents (\d+) 0 R", head, re.DOTALL) for head, _ in objects.values()
    ]
    return [_text(objects[int(found[1])][1], tables) for found in contents if found]


def _text(content: bytes, tables: dict[bytes, dict[int, str]]) -> str:
    """The text of a sheet by the tables of its fonts."""
    said, table = [], {}
    for font, glyphs in re.findall(rb"/(F\d+) [\d.]+ Tf|<([0-9A-Fa-f]+)>", content):
        table = tables[font] if font else table
        said += [table.get(int(glyphs[k : k + 4], 16), "") for k in range(0, len(glyphs), 4)]
    return "".join(said).replace(" ", "")


def _unicode(table: bytes) -> dict[int, str]:
    """Text by glyph, of a CMap."""
    found: dict[int, str] = {}
    for block in re.findall(rb"beginbfrange(.*?)endbfrange", table, re.DOTALL):
        for first, last, text in re.findall(rb"<(\w+)>\s*<(\w+)>\s*<(\w+)>", block):
            begin = int(first, 16)
            found |= {k: chr(int(text, 16) + k - begin) for k in range(begin, int(last, 16) + 1)}
    for block in re.findall(rb"beginbfchar(.*?)endbfchar", table, re.DOTALL):
        for glyph, text in re.findall(rb"<(\w+)>\s*<(\w+)>", block):
            found[int(glyph, 16)] = bytes.fromhex(text.decode()).decode("utf-16-be")
    return found


def console_errors(browser: Any) -> list[str]:
    """Errors in the console since the last call."""
    return [entry["message"] for entry in browser.get_log("browser") if entry["level"] == "SEVERE"]


def complaints(browser: Any) -> list[str]:
    """Defects of the layout: a page wider than the window, invisible drawings, text that overlaps or is too small."""
    return browser.execute_script(COMPLAINTS)


def assert_readable(page: Path) -> None:
    """The page has no layout defects on a screen, on a telephone and on paper."""
    with opened(page) as browser:
        for width, media in ((SCREEN, ""), (PHONE, ""), (PAPER, "print")):
            look(browser, width, media=media)
            assert complaints(browser) == [], f"{page.name} at {width} px"
            assert console_errors(browser) == []


def colours(element: Any) -> np.ndarray:
    """A screenshot of an element (height, width, 3), red, green and blue, 0 to 1."""
    from PIL import Image

    with Image.open(io.BytesIO(base64.b64decode(element.screenshot_as_base64))) as image:
        return np.asarray(image.convert("RGB")) / 255.0


def brightness(element: Any) -> np.ndarray:
    """A screenshot of an element as grey levels (height, width), 0 black to 1 white."""
    return colours(element) @ [0.299, 0.587, 0.114]
