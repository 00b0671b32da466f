"""One self-contained HTML file: a filled template with its pictures."""

from __future__ import annotations

import base64
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any
from urllib.parse import quote

from mffit import rounding
from mffit.errors import shortened
from mffit.report import constants, making, numbers, typeset
from mffit.report.drawing.records import Sheet, long, with_shorter_series
from mffit.templates import environment

if TYPE_CHECKING:
    from jinja2 import Environment


@dataclass(frozen=True, slots=True)
class PagePicture:
    """A picture on disk and in the page."""

    name: str  #: file stem
    drawing: str  #: its panels as HTML
    table: str  #: the numbers behind it, CSV
    left_out: int  #: panels that are not drawn
    most: int = 0  #: points that are drawn of a longer series; 0: there is none

    @property
    def link(self) -> str:
        """The table as a data address, in the shorter of both encodings."""
        quoted = {ord(mark): quote(mark, safe=",;:.+-=()[]/_") for mark in set(self.table)}
        plain = "," + self.table.translate(quoted)
        packed = ";base64," + base64.b64encode(self.table.encode()).decode("ascii")
        return "data:text/csv;charset=utf-8" + min(plain, packed, key=len)


def write(template: str, path: Path, figures: Mapping[str, Callable[[], Sheet]], **content: Any) -> None:
    """Draw the figures, fill a template of ``templates/`` with them and the content, and write the page as UTF-8."""
    pictures = draw(path.parent, figures)
    filled = _environment().get_template(template)
    html = filled.render(made=making.made(), pictures=pictures, **content)
    path.write_text(typeset.page(html), encoding="utf-8")


def draw(folder: Path, figures: Mapping[str, Callable[[], Sheet]]) -> dict[str, PagePicture]:
    """Draw every figure into ``folder/plots/<name>.png``; returns the pictures for the page by name."""
    from mffit.report.drawing import pictures

    plots = folder / "plots"
    plots.mkdir(parents=True, exist_ok=True)
    found = {}
    for name, make in figures.items():
        sheet = make()
        most = int(constants.POINTS_PER_SERIES_DRAWN)
        picture = pictures.draw(with_shorter_series(sheet, most))
        picture.save(plots / f"{name}.png")
        found[name] = PagePicture(
            name=name,
            drawing=picture.markup(),
            table=numbers.table(sheet),
            left_out=sheet.left_out,
            most=most if long(sheet, most) else 0,
        )
    return found


@cache
def _environment() -> Environment:
    found = environment("mffit.report")
    found.filters["shortened"] = shortened
    for rounded in (
        rounding.number,
        rounding.with_u,
        rounding.stated,
        rounding.as_good_as,
        rounding.times,
        rounding.per_cent,
    ):
        found.filters[rounded.__name__] = rounded
    return found
