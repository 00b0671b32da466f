"""The numbers behind a figure as a table, from which a reader can draw it again."""

from __future__ import annotations

import csv
import io
import math
from collections.abc import Iterator
from typing import Any

from mffit.report import constants
from mffit.report.drawing.records import Axis, DataSeries, Panel, Sheet, shorter
from mffit.report.drawing.texts import plain

COLUMNS = ("panel", "series", "x axis", "x", "y axis", "y", "lower", "upper", "value")
"""``lower`` and ``upper`` are ends of an error bar or band, ``value`` is what a colour shows."""


def table(sheet: Sheet) -> str:
    """Everything that the sheet draws in its axes' units, as CSV: a header, then a row per point, bar or end of a band.

    Guides across a whole panel and empty columns are left out. The header names the axes; where panels have different axes,
    columns of their own name them.
    """
    rows = [row for panel in sheet.panels for series in panel.series for row in _rows(panel, series)]
    header = list(COLUMNS)
    used = []
    for k, name in enumerate(COLUMNS):
        found = {row[k] for row in rows}
        if name.endswith(" axis"):
            if len(found) == 1:
                header[k + 1] = ": ".join(filter(None, (header[k + 1], *found)))
            if len(found) < 2:
                continue
        if name in ("x", "y") or found - {""}:
            used.append(k)
    buffer = io.StringIO()
    writer = csv.writer(buffer, lineterminator="\n")
    writer.writerow([header[k] for k in used])
    writer.writerows([[row[k] for k in used] for row in rows])
    return buffer.getvalue()


def _rows(panel: Panel, series: DataSeries) -> Iterator[tuple[str, ...]]:
    """Rows of a series; of a long one every so many, which its name then says. points.csv holds every reading."""
    series, every = shorter(series, constants.POINTS_PER_SERIES_IN_PAGE)
    name = f"{series.name}, every {every}th" if every > 1 else series.name
    title, name, x_label, y_label = map(plain, (panel.title, name, panel.x.label, panel.y.label))
    for row in series.rows():
        y = plain(_word(panel.y, row.y)) or _cell(row.y)
        yield title, name, x_label, _cell(row.x), y_label, y, *map(_cell, (row.lower, row.upper, row.value))


def _word(axis: Axis, y: float) -> str:
    """The word nearest to a place on the axis; empty on an axis with numbers."""
    words = axis.words or {}
    return words[min(words, key=lambda place: abs(place - y))] if words else ""


def _cell(value: Any) -> str:
    return f"{float(value):.{constants.DIGITS_IN_TABLE}g}" if math.isfinite(value) else ""
