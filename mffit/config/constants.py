"""Numbers of judgement of the configuration; the plausible ranges of single keys are in ``quantities.py``."""

from __future__ import annotations

from tir.constant import Real

LARGEST_U_OF_A_RADIUS = Real(
    0.1, "-", "Standard uncertainty over radius above which it was written in another unit."
)
U_GIVEN_PATH_RADIUS = Real(
    0.0018, "m", "Standard uncertainty of a path radius given without one.", "Mottola and Massaro 2022, (19)"
)
SISTER_FRICTION_SCATTER = Real(
    0.05,
    "-",
    "Relative scatter of PDX1 over PDY1 among the seven public files of unrelated tyres that were compared (1.02 to 1.16).",
)
SISTER_STIFFNESS_SCATTER = Real(
    0.25,
    "-",
    "Relative uncertainty of slip over cornering stiffness: among these seven (0.97 to 2.6) it scatters by 38 %, and a sister "
    "is of one kind with its tyre.",
)
PLAUSIBLE_CONICITY = Real(
    0.002, "-", "Standard uncertainty of the conicity force over the load if [rig] gives none."
)
