"""Comparison of two property files, of a file with measured points, or of two builds."""

from typing import TYPE_CHECKING

from mffit.on_demand import on_demand

if TYPE_CHECKING:
    from mffit.comparison.characteristics import DECIDED_BY, PEAKS, Tested
    from mffit.comparison.compare import against_points, between
    from mffit.comparison.record import ComparedSubject, Comparison, CurveGap, Difference

__getattr__ = on_demand(__name__)
