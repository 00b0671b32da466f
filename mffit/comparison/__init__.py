"""Comparison of two property files, of a file with measured points, or of two builds."""

from mffit.comparison.characteristics import characteristics
from mffit.comparison.compare import against_points, between
from mffit.comparison.record import ComparedSubject, Comparison, CurveGap, Difference
from mffit.comparison.wording import note_on_temperature

__all__ = [
    "ComparedSubject",
    "Comparison",
    "CurveGap",
    "Difference",
    "against_points",
    "between",
    "characteristics",
    "note_on_temperature",
]
