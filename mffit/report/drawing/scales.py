"""Places of numbers on an axis, and the round numbers written at it."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from mffit.report.drawing.records import Axis
from mffit.rounding import MINUS

NICE_STEPS = (1.0, 2.0, 2.5, 5.0, 10.0)
SUPERSCRIPTS = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")


@dataclass(frozen=True, slots=True, kw_only=True)
class Scale:
    """An axis in a drawing: ``low`` is at ``begin``, ``high`` at ``end`` [pt]."""

    low: float
    high: float
    begin: float
    end: float
    logarithmic: bool

    def of(self, values: np.ndarray | float) -> np.ndarray:
        """Places of the values [pt]."""
        low, high, x = self.low, self.high, np.asarray(values, dtype=float)
        if self.logarithmic:
            low, high, x = math.log10(low), math.log10(high), np.log10(np.maximum(x, low))
        return self.begin + (x - low) / (high - low) * (self.end - self.begin)


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
    if axis.logarithmic:
        return _powers(low, high, intervals)
    found = _round_numbers(min(low, high), max(low, high), intervals)
    return found if len(found) > 1 else numbers_at(axis, low, high, intervals + 1)


def _round_numbers(low: float, high: float, intervals: int) -> dict[float, str]:
    rough = (high - low) / intervals
    power = 10.0 ** math.floor(math.log10(rough))
    step = power * next(nice for nice in NICE_STEPS if nice * power >= rough * (1.0 - 1e-9))
    decimals = max(0, -math.floor(math.log10(step) + 1e-9))
    if round(step * 10.0**decimals, 6) % 1.0:
        decimals += 1  # steps of 2.5
    first, last = math.ceil(low / step - 1e-9), math.floor(high / step + 1e-9)
    return {k * step: f"{k * step:.{decimals}f}".replace("-", MINUS) for k in range(first, last + 1)}


def _powers(low: float, high: float, intervals: int) -> dict[float, str]:
    first, last = math.ceil(math.log10(low) - 1e-9), math.floor(math.log10(high) + 1e-9)
    every = max(1, math.ceil((last - first) / intervals))
    written = {0: "1", 1: "10"}
    return {
        10.0**k: written.get(k, f"10{str(k).translate(SUPERSCRIPTS)}") for k in range(first, last + 1, every)
    }
