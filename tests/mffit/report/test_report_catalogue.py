"""Every picture stands in one table, with its words, and is described in the documentation."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from mffit.quantities import CHANNELS
from mffit.report.build import BUILD
from mffit.report.compare import COMPARISON
from mffit.report.diagnosis import DIAGNOSIS
from mffit.report.fleet import FLEET
from mffit.report.plan import PLAN

CHANNEL = re.compile(f"_({'|'.join(CHANNELS)})$")
DOCS = Path(__file__).parents[3] / "docs"
TABLES = {
    "build": BUILD,
    "diagnosis": DIAGNOSIS,
    "compare": COMPARISON,
    "fleet": FLEET,
    "plan": (PLAN,),
}


@pytest.mark.parametrize("page", TABLES)
def test_names_are_unique_and_every_picture_is_described(page):
    names = [picture.name for picture in TABLES[page]]
    assert len(names) == len(set(names))
    for picture in TABLES[page]:
        assert len(picture.title) > 20
        assert picture.shows.endswith(".")


@pytest.mark.parametrize("page", TABLES)
def test_the_documentation_names_every_picture(page):
    written = "".join(path.read_text(encoding="utf-8") for path in DOCS.glob("*.md"))
    missing = [
        file
        for picture in TABLES[page]
        if f"`{(file := re.sub(CHANNEL, '_Fy', picture.name))}.png`" not in written
    ]
    assert not missing, f"docs/report.md has no heading for {', '.join(missing)}"
