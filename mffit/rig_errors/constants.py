"""Numbers of judgement of the rig errors; usual sizes and limits are in the records themselves."""

from tir.constant import Real

FORCE_GAIN = Real(
    0.005,
    "-",
    "Standard uncertainty of the calibration of a force, a moment and the load if neither [rig] nor a certificate gives one: a "
    "chain of class 1, anywhere within 1 % of its reading, has 0.6 %.",
)
ANGLE_GAIN = Real(
    0.002,
    "-",
    "Standard uncertainty of the calibration of sideslip and camber if neither [rig] nor a certificate gives one: 0.02 deg "
    "of 10.",
)
