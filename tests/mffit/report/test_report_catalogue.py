"""Every picture has its place and words in the template of its page, and is described in the documentation."""

from __future__ import annotations

import re
import runpy
from importlib.resources import files
from pathlib import Path

import numpy as np
import pytest

from mffit.quantities import CHANNELS
from mffit.report.build import BUILD
from mffit.report.build_view import view_of
from mffit.report.compare import COMPARISON
from mffit.report.diagnosis import DIAGNOSIS
from mffit.report.fleet import FLEET
from mffit.report.plan import PLAN

CHANNEL = re.compile(f"_({'|'.join(CHANNELS)})$")
DOCS = Path(__file__).parents[3] / "docs"
TABLES = {"build": BUILD, "diagnosis": DIAGNOSIS, "compare": COMPARISON, "fleet": FLEET, "plan": PLAN}


@pytest.mark.parametrize("page", TABLES)
def test_every_picture_has_a_place_and_a_caption_in_its_page(page):
    """A title for readers who do not see it, and a caption of whole sentences."""
    folder = files("mffit.report") / "templates"
    texts = [one.read_text(encoding="utf-8") for one in folder.iterdir() if one.name.startswith(page)]
    text = "\n".join([*texts, (folder / "macros.html.j2").read_text(encoding="utf-8")])
    calls = r'call figure\(pictures\.(\w+), "([^"]{21,})"\) %}([^\n]*\.){% endcall %}'
    placed = {name for name, *_ in re.findall(calls, text)}
    placed |= set(re.findall(r'^  "(\w+)": \("[^"]{21,}",\n    "[^\n]*\."\),$', text, re.MULTILINE))
    of_channels = set(re.findall(r'call figure\(pictures\["(\w+_)" ~ name\], [^\n]*\.{% endcall %}', text))
    assert {name for name in TABLES[page] if CHANNEL.sub("_", name) not in placed | of_channels} == set()


@pytest.mark.parametrize("page", TABLES)
def test_the_documentation_names_every_picture(page):
    written = "".join(path.read_text(encoding="utf-8") for path in DOCS.glob("*.md"))
    missing = [file for name in TABLES[page] if f"`{(file := CHANNEL.sub('_Fy', name))}.png`" not in written]
    assert not missing, f"docs/report.md has no heading for {', '.join(missing)}"


def test_the_pictures_of_readme_and_tutorial_can_be_drawn(result):
    """By the script beside them; each has its panels and data."""
    made = runpy.run_path(str(DOCS / "images" / "make.py"))["sheets"](view_of(result))
    for name, sheet in made.items():
        assert sheet.panels, name
        assert all(
            any(np.isfinite(one.columns()["x"]).any() for one in panel.series) for panel in sheet.panels
        ), name
