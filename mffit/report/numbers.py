"""The numbers behind a figure as a table, from which a reader can draw it again."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import pandas as pd

from mffit.report import constants
from mffit.report.drawing.records import Axis, Sheet
from mffit.report.labels import plain

WORDS = ("panel", "series", "x axis", "y axis")
NUMBERS = ("x", "y", "lower", "upper", "value")


def table(sheet: Sheet) -> str:
    """Everything that the sheet draws in its axes' units, as CSV: a row per point, bar or end of a band.

    Guides across a whole panel are left out, and columns that are empty. Of a long series every so many points are listed.
    """
    found = [(panel, series, _thinned(series.columns())) for panel in sheet.panels for series in panel.series]
    lengths = [len(columns["x"]) for *_, columns in found]
    words = [(panel.title, one.name, panel.x.label, panel.y.label) for panel, one, _ in found]
    table: dict[str, np.ndarray] = {}
    for name, texts in zip(WORDS, zip(*words, strict=True), strict=True):
        if any(texts):
            table[name] = np.repeat([plain(text) for text in texts], lengths)
    for name in NUMBERS:
        if any(name in columns for *_, columns in found):
            parts = [
                columns.get(name, np.full(n, np.nan)) for (*_, columns), n in zip(found, lengths, strict=True)
            ]
            table[name] = np.concatenate(parts)
    if any(panel.y.words for panel in sheet.panels):
        at = zip(np.repeat(np.arange(len(found)), lengths), table["y"], strict=True)
        table["y"] = np.array([plain(_word(found[k][0].y, y)) or f"{y:.6g}" for k, y in at])
    return pd.DataFrame(table).to_csv(index=False, float_format="%.6g", lineterminator="\n")


def _thinned(columns: Mapping[str, np.ndarray]) -> dict[str, np.ndarray]:
    every = max(1, -(-len(columns["x"]) // int(constants.POINTS_PER_SERIES)))
    return {name: values[::every] for name, values in columns.items()}


def _word(axis: Axis, y: float) -> str:
    """The word nearest to a place on the axis; empty on an axis with numbers."""
    words = axis.words or {}
    return words[min(words, key=lambda place: abs(place - y))] if words else ""
