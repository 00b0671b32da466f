"""Comparison of two property files, of a file with measured points, or of two builds."""

from mffit.comparison.characteristics import characteristics, with_u
from mffit.comparison.compare import against_points, between
from mffit.comparison.record import Comparison, CurveGap, Difference, Subject

__all__ = [
    "Comparison",
    "CurveGap",
    "Difference",
    "Subject",
    "against_points",
    "between",
    "characteristics",
    "with_u",
]
