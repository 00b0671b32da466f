"""Numbers of judgement of the configuration; the plausible ranges of single keys are in ``quantities.py``."""

from tir.constant import Real

LARGEST_U_OF_A_RADIUS = Real(
    0.1, "-", "Standard uncertainty over radius above which it was written in another unit."
)
U_GIVEN_PATH_RADIUS = Real(
    0.0018, "m", "Standard uncertainty of a path radius given without one.", "Mottola and Massaro 2022, (19)"
)
PLAUSIBLE_CONICITY = Real(
    0.002, "-", "Standard uncertainty of the conicity force over the load if [rig] gives none."
)
