"""Numbers of judgement of the rig errors; usual sizes and limits are in the records themselves."""

from __future__ import annotations

from tir.constant import Real

REFERENCE_TEMPERATURE = Real(25.0, "degC", "Temperature of a property file unless given or fitted.")
CAMBER_SKEW = Real(
    0.1, "deg", "Standard uncertainty of the right angle of camber and steering axis if [rig] gives none."
)
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
LOADCELL_ZERO = Real(
    10.0, "N", "Standard uncertainty of the zero of Fy if [rig] gives none.", "Mottola and Massaro 2022, (24)"
)
CAMBER_ZERO = Real(
    0.5,
    "deg",
    "Standard uncertainty of the camber zero if [rig] gives none.",
    "Mottola and Massaro 2022, (24)",
)
SIDESLIP_FORCE = Real(
    25.0,
    "N",
    "Standard uncertainty of the force that the alignment leaves if [rig] gives none.",
    "Mottola and Massaro 2022, (24)",
)
LONGITUDINAL_ZERO = Real(
    20.0,
    "N",
    "Standard uncertainty of the zero of Fx if [rig] gives none: drag of bearings and brake, and the load cell.",
)
OVERTURNING_ZERO = Real(
    50.0,
    "Nm",
    "Standard uncertainty of the zero of Mx if [rig] gives none: 30 mm of lateral offset of a load of 1650 N, as rigs show.",
)
ROLLING_ZERO = Real(
    5.0,
    "Nm",
    "Standard uncertainty of the zero of My if [rig] gives none, on disc and belt: 10 N of a load cell at a radius of 0.3 m, "
    "and the drag of the spindle, which standards of rolling resistance (SAE J1270, ISO 28580) name as the parasitic loss.",
)
