"""Numbers of judgement of the decomposition by mirror symmetry."""

from __future__ import annotations

from tir.constant import Count, Real

SAME_CAMBER = Real(0.25, "deg", "Camber angles within this are one set-point in the search for mirrors.")
SAME_LOAD = Real(0.04, "-", "Loads within this share are one condition in the search for mirrors.")
SAME_PRESSURE = Real(6.0, "kPa", "Pressures within this are one condition in the search for mirrors.")
SAME_SPEED = Real(0.1, "-", "Speeds within this share are one condition in the search for mirrors.")
SAME_SLIP = Real(0.005, "-", "Longitudinal slips within this are one condition in the search for mirrors.")
OTHER_SWEEP_DISTANCE = Real(10.0, "deg", "Added to the distance of a mirror from another sweep.")
FEWEST_ANGLES_TO_INTERPOLATE = Count(3, "-", "Fewest angles between which a missing mirror is interpolated.")
REPEATED_ANGLE = Real(1e-3, "deg", "Angles within this are repetitions when mirrors are interpolated.")
UNPAIRED_IN_SENTENCE = Count(4, "-", "Most points without a mirror that a sentence names.")
