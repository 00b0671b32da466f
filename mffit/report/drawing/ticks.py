"""Ends of an axis, and the round numbers written at it."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.ticker import LogLocator, MaxNLocator, ScalarFormatter

from mffit.report.drawing.records import Axis

SUPERSCRIPTS = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")


def limits(axis: Axis, values: Sequence[np.ndarray]) -> tuple[float, float]:
    """Both ends of an axis: the given ones, else the ends of the data and some room."""
    known = np.concatenate(values)
    known = known[np.isfinite(known)]
    low, high = (float(known.min()), float(known.max())) if len(known) else (0.0, 1.0)
    room = axis.room * (high - low) or 0.05 * abs(low) or 0.5
    return (
        low - room if axis.low is None else axis.low,
        high + room if axis.high is None else axis.high,
    )


def numbers_at(axis: Axis, low: float, high: float, intervals: int) -> dict[float, str]:
    """Numbers of an axis with their texts, or its words; a single number would show no scale, so there are two at least."""
    if axis.words is not None:
        return dict(axis.words)
    low, high = min(low, high), max(low, high)
    if axis.logarithmic:
        found = LogLocator(numticks=intervals + 1).tick_values(low, high)
    else:
        found = MaxNLocator(intervals, steps=[1, 2, 2.5, 5, 10], min_n_ticks=2).tick_values(low, high)
    places = np.asarray(found)
    slack = 1e-9 * (high - low)
    places = places[(places >= low - slack) & (places <= high + slack)]
    if axis.logarithmic:
        powers = np.round(np.log10(places)).astype(int)
        texts = [{0: "1", 1: "10"}.get(k, f"10{str(k).translate(SUPERSCRIPTS)}") for k in powers.tolist()]
    else:
        written = ScalarFormatter(useOffset=False)
        written.set_scientific(False)
        written.create_dummy_axis()
        texts = written.format_ticks(places.tolist())
    return dict(zip(places.tolist(), texts, strict=True))
