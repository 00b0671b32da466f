"""All rig errors in one list, in the order of the chain from set-point readings to force readings."""

from __future__ import annotations

from mffit.rig_errors.angle import ANGLE_ERRORS
from mffit.rig_errors.conditions import CONDITION_ERRORS
from mffit.rig_errors.environment import (
    COEFFICIENT_ERRORS,
    ENVIRONMENT_ERRORS,
    PRESSURE_ARM,
    REFERENCE_PRESSURE,
)
from mffit.rig_errors.force import FORCE_ERRORS
from mffit.rig_errors.record import BEFORE_THE_TYRE, RigError

RIG_ERRORS: tuple[RigError, ...] = (
    *CONDITION_ERRORS,
    *COEFFICIENT_ERRORS,
    *ANGLE_ERRORS,
    *ENVIRONMENT_ERRORS,
    *FORCE_ERRORS,
)
BY_NAME: dict[str, RigError] = {error.name: error for error in RIG_ERRORS}
BEFORE = tuple(error for error in RIG_ERRORS if error.place in BEFORE_THE_TYRE)
"""Errors that act between the readings of the set-points and the conditions of the tyre."""
AFTER = tuple(error for error in RIG_ERRORS if error.place not in (*BEFORE_THE_TYRE, None))
"""Errors that act between the forces of the tyre and their readings."""
DECLARED = tuple((error, error.declared) for error in RIG_ERRORS if error.declared is not None)
"""Errors whose uncertainty ``[rig]`` states, each with its declaration."""
ZEROS = tuple(error for error in RIG_ERRORS if error.of_setup)
"""Errors that differ from set-up to set-up."""
BESIDE = (REFERENCE_PRESSURE, PRESSURE_ARM)
"""Effects of the tyre over known conditions, for which the formula has no coefficient."""
CALIBRATED = {error.acts_on[0]: declared.key for error, declared in DECLARED if error.is_gain}
"""By channel with a calibration, the key of ``[rig]`` that states its uncertainty."""
UNITS = {error.name: error.unit for error in RIG_ERRORS}
MEANINGS = {error.name: error.meaning for error in RIG_ERRORS}
WORDS = {error.name: error.words for error in RIG_ERRORS if error.words}
"""By name of a rig number, its words in sentences."""
