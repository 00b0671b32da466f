"""The numbers behind a figure as a table, from which a reader can draw it again."""

from __future__ import annotations

import pandas as pd

from mffit.report import constants
from mffit.report.drawing.records import Axis, DataSeries, Panel, Sheet
from mffit.report.labels import plain

COLUMNS = ("panel", "series", "x axis", "y axis", "x", "y", "lower", "upper", "value")


def table(sheet: Sheet) -> str:
    """Everything that the sheet draws in its axes' units, as CSV: a row per point, bar or end of a band.

    Guides across a whole panel are left out, and columns that are empty. Of a long series every so many points are listed.
    """
    has_words = any(panel.y.words for panel in sheet.panels)
    parts = [_rows(panel, one, has_words) for panel in sheet.panels for one in panel.series]
    found = pd.concat(parts, ignore_index=True)
    kept = [name for name in COLUMNS if name in found and not (found[name] == "").all()]
    return found[kept].to_csv(index=False, float_format="%.6g", lineterminator="\n")


def _rows(panel: Panel, series: DataSeries, has_words: bool) -> pd.DataFrame:
    columns = series.columns()
    every = max(1, -(-len(columns["x"]) // int(constants.POINTS_PER_SERIES)))
    found = pd.DataFrame({name: values[::every] for name, values in columns.items()})
    if has_words:
        found["y"] = [plain(_word(panel.y, y)) or f"{y:.6g}" for y in found["y"]]
    texts = {"panel": panel.title, "series": series.name, "x axis": panel.x.label, "y axis": panel.y.label}
    return found.assign(**{name: plain(text) for name, text in texts.items()})


def _word(axis: Axis, y: float) -> str:
    """The word nearest to a place on the axis; empty on an axis with numbers."""
    words = axis.words or {}
    return words[min(words, key=lambda place: abs(place - y))] if words else ""
