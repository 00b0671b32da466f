"""One HTML file that needs nothing else: templates filled, pictures embedded."""

from __future__ import annotations

import base64
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any
from urllib.parse import quote

from mffit.measured import wording
from mffit.report import drawing, making, numbers, rounding, style, typeset
from mffit.templates import environment

if TYPE_CHECKING:
    from jinja2 import Environment
    from matplotlib.figure import Figure


@dataclass(frozen=True, slots=True)
class Picture:
    """A picture on disk and in the page."""

    name: str  #: file stem
    drawing: str  #: its panels as HTML
    table: str  #: the numbers behind it, CSV

    @property
    def link(self) -> str:
        """The table as an address that holds it, written in the shorter of both ways."""
        plain = "," + quote(self.table, safe=",;:.+-=()[]/_")
        packed = ";base64," + base64.b64encode(self.table.encode()).decode("ascii")
        return "data:text/csv;charset=utf-8" + min(plain, packed, key=len)


def draw(folder: Path, figures: Mapping[str, Callable[[], Figure]]) -> dict[str, Picture]:
    """Draw every figure into ``folder/plots/<name>.png``, and as it stands in the page.

    A figure may be any of matplotlib's: its axes become panels that the page arranges to its width, so keep each readable for
    itself and at most about 4 inches wide; its legends (:func:`style.legend_above`) and colour scales go on top. What is drawn
    gets into the table of numbers under the artist's ``label``, or that of the legend's entry that looks the same.

    Returns
    -------
    dict
        The pictures by name, for :func:`render`.
    """
    plots = folder / "plots"
    plots.mkdir(parents=True, exist_ok=True)
    pictures = {}
    with style.applied():
        for name, make in figures.items():
            figure = make()
            style.save(figure, plots / f"{name}.png")
            table = numbers.table(figure)
            pictures[name] = Picture(name, drawing.markup(figure, name), table)
    return pictures


def render(template: str, path: Path, **content: Any) -> None:
    """Fill a template of ``templates/``, set its symbols and write it as UTF-8."""
    html = _environment().get_template(template).render(made=making.made(), **content)
    path.write_text(typeset.page(html), encoding="utf-8")


@cache
def _environment() -> Environment:
    found = environment("mffit.report")
    found.filters["note"] = wording.note
    for rounded in (rounding.number, rounding.with_u, rounding.stated, rounding.times, rounding.per_cent):
        found.filters[rounded.__name__] = rounded
    return found
