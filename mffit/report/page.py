"""One self-contained HTML file: a filled template with its pictures."""

from __future__ import annotations

import base64
import io
import zipfile
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cache, partial
from pathlib import Path
from typing import TYPE_CHECKING, Any
from urllib.parse import quote

from mffit import rounding
from mffit.errors import shortened
from mffit.points.left_out import together
from mffit.report import constants, left_undrawn, making, numbers, typeset
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
    left_out: str  #: what is not drawn, in sentences for the caption

    @property
    def is_packed(self) -> bool:
        """Whether the table is a ZIP archive of its file, because it is long."""
        return len(self.table) > constants.LARGEST_PLAIN_TABLE

    @property
    def link(self) -> str:
        """The table, or the archive with it, as a data address; of a table in the shorter of both encodings."""
        if self.is_packed:
            return f"data:application/zip;base64,{base64.b64encode(self._archive()).decode('ascii')}"
        quoted = {ord(mark): quote(mark, safe=",;:.+-=()[]/_") for mark in set(self.table)}
        plain = "," + self.table.translate(quoted)
        packed = ";base64," + base64.b64encode(self.table.encode()).decode("ascii")
        return "data:text/csv;charset=utf-8" + min(plain, packed, key=len)

    def _archive(self) -> bytes:
        buffer = io.BytesIO()
        with zipfile.ZipFile(buffer, "w", zipfile.ZIP_DEFLATED) as archive:
            # With the default date the same table gives the same bytes.
            archive.writestr(zipfile.ZipInfo(f"{self.name}.csv"), self.table, zipfile.ZIP_DEFLATED)
        return buffer.getvalue()


def write(
    template: str,
    path: Path,
    figures: Mapping[str, Callable[[], Sheet]],
    *,
    readings: str = "",
    **content: Any,
) -> None:
    """Draw the figures, fill a template of ``templates/`` with them and the content, and write the page as UTF-8.

    ``readings`` is the file beside the page that has every reading, if there is one.
    """
    pictures = draw(path.parent, figures, readings)
    filled = _environment().get_template(template)
    html = filled.render(made=making.made(), pictures=pictures, **content)
    path.write_text(typeset.page(html), encoding="utf-8")


def draw(
    folder: Path, figures: Mapping[str, Callable[[], Sheet]], readings: str = ""
) -> dict[str, PagePicture]:
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
        shorter = left_undrawn.long_series(most) if long(sheet, most) else ""
        left_out = " ".join(filter(None, [sheet.left_out, shorter]))
        if left_out and readings:
            left_out = f"{left_out} {readings} has every reading."
        found[name] = PagePicture(
            name=name,
            drawing=picture.markup(),
            table=numbers.table(sheet),
            left_out=left_out,
        )
    return found


@cache
def _environment() -> Environment:
    found = environment("mffit.report")
    found.filters["shortened"] = shortened
    found.filters["together"] = partial(together, most=int(constants.MOST_LEFT_OUT_ONE_BY_ONE))
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
