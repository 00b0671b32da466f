"""The numbers behind a figure as a table, from which a reader can draw it again."""

import numpy as np
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
    columns = {}
    for name in COLUMNS:
        if any(name in part for part in parts):
            column = np.concatenate([part.get(name, np.full(len(part["x"]), np.nan)) for part in parts])
            if not np.all(column == ""):
                columns[name] = column
    return pd.DataFrame(columns).to_csv(index=False, float_format="%.6g", lineterminator="\n")


def _rows(panel: Panel, series: DataSeries, has_words: bool) -> dict[str, np.ndarray]:
    columns = series.columns()
    every = max(1, -(-len(columns["x"]) // int(constants.POINTS_PER_SERIES)))
    found = {name: values[::every] for name, values in columns.items()}
    if has_words:
        words = [plain(_word(panel.y, y)) or f"{y:.6g}" for y in found["y"]]
        found["y"] = np.array(words, dtype=object)
    texts = {"panel": panel.title, "series": series.name, "x axis": panel.x.label, "y axis": panel.y.label}
    return found | {name: np.full(len(found["x"]), plain(text), dtype=object) for name, text in texts.items()}


def _word(axis: Axis, y: float) -> str:
    """The word nearest to a place on the axis; empty on an axis with numbers."""
    words = axis.words or {}
    return words[min(words, key=lambda place: abs(place - y))] if words else ""
