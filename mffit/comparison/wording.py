"""The sentences about a comparison: written here and nowhere else."""

from __future__ import annotations

import math

from mffit.comparison.record import Comparison, Difference
from mffit.measured import KEYS
from mffit.quantities import CHANNELS, CHARACTERISTICS, CONDITIONS, DIRECT, QuantityName
from tir.parameters import BY_NAME

STANDS_OUT = 2.0
"""Differences of this many standard uncertainties stand out."""
OF_DIRECT = {key: DIRECT[name] for name, key in KEYS.items()}


def quantity(row: Difference) -> QuantityName:
    """Word, symbol and unit of a number."""
    if row.load is None:
        known = BY_NAME[row.key]
        return QuantityName(known.description, row.key, known.unit)
    return CHARACTERISTICS.get(row.key) or OF_DIRECT[row.key]


def headline(found: Comparison) -> str:
    """What differs most, in a sentence."""
    if found.sweeps:
        parts = []
        for channel, known in CHANNELS.items():
            rows = [gap for gap in found.sweeps if gap.channel == channel]
            if rows:
                n = sum(gap.n for gap in rows)
                total = math.sqrt(sum(gap.n * gap.rms**2 for gap in rows) / n)
                parts.append(f"{channel} by {total:.3g} {known.unit} rms")
        return f"{found.first} misses {found.second}: {' and '.join(parts)}; {_standing_out(found)}."
    gap = {c: max((g.rms for g in found.curves if g.channel == c), default=0.0) for c in CHANNELS}
    if not any(gap.values()):
        return f"The curves of {found.first} and {found.second} do not differ; {_standing_out(found)}."
    said = " and ".join(f"{c} by up to {gap[c]:.3g} {q.unit} rms" for c, q in CHANNELS.items())
    return f"The curves of {found.first} and {found.second} differ in {said}; {_standing_out(found)}."


def _standing_out(found: Comparison) -> str:
    rows = [row for row in found.numbers if row.z is not None and abs(row.z) > STANDS_OUT]
    if rows:
        names = list(dict.fromkeys(quantity(row).word for row in rows))
        return f"beyond {STANDS_OUT:g} u: {', '.join(names)}"
    if any(row.z is not None for row in found.numbers):
        return f"no number differs by more than {STANDS_OUT:g} u"
    largest = max(found.numbers, key=lambda row: row.relative, default=None)
    if largest is None or not largest.relative:
        return "all numbers are equal"
    return f"the largest relative difference is that of the {quantity(largest).word}, {100.0 * largest.relative:.3g} %"


def place(row: Difference) -> str:
    """Where a number holds."""
    return "" if row.load is None else CONDITIONS["Fz_N"].of(row.load)
