"""Numbers of judgement of the decomposition by mirror symmetry."""

from tir.constant import Count, Real

SAME_CAMBER = Real(0.25, "deg", "Camber angles within this are one set-point in the search for mirrors.")
FEWEST_ANGLES_TO_INTERPOLATE = Count(3, "-", "Fewest angles between which a missing mirror is interpolated.")
BEYOND_THE_END = Real(
    0.05,
    "-",
    "Part of a sweep's last step by which a mirrored angle may lie beyond its end: a rig holds set-points no better.",
)
