"""Numbers of judgement of a comparison."""

from __future__ import annotations

from tir.constant import Count, Real, Series

COMPARED_SLOPE_ANGLE = Real(1e-3, "rad", "Angle over which stiffnesses are taken as slopes at zero.")
COMPARED_SLOPE_CURVATURE = Real(1e-3, "1/m", "Path curvature over which the turn-slip stiffness is taken.")
COMPARED_PEAK_POINTS = Count(101, "-", "Points of the curve on which peaks are sought.")
COMPARED_COEFFICIENT_STEP = Real(
    0.05, "-", "Step of a coefficient for a derivative, over its standard uncertainty."
)
COMPARED_LARGEST_STEP = Real(
    0.1, "-", "Largest standard uncertainty for this step, over the plausible range."
)
COMPARED_LOADS = Series(
    (0.6, 1.0, 1.4), "-", "Loads of numbers and curves over the nominal load, within both files' ranges."
)
COMPARED_POINTS = Count(61, "-", "Points of a compared curve.")
COMPARED_SAME_LOAD = Real(0.02, "-", "Relative difference of loads that count as one.")
SIGNIFICANT_DIFFERENCE = Real(2.0, "-", "Standard uncertainties beyond which a difference is significant.")
