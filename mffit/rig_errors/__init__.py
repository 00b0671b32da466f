"""What a rig, its environment and its motion do to a reading: one record per error."""

from mffit.rig_errors.catalog import AFTER, BEFORE, BY_NAME, DECLARED, MEANINGS, RIG_ERRORS, UNITS, WORDS
from mffit.rig_errors.faults import NO_FAULTS, OF_RUN, Faults
from mffit.rig_errors.record import Appearance, AtZero, Declared, Place, RigError

__all__ = [
    "AFTER",
    "BEFORE",
    "BY_NAME",
    "DECLARED",
    "MEANINGS",
    "NO_FAULTS",
    "OF_RUN",
    "RIG_ERRORS",
    "UNITS",
    "WORDS",
    "Appearance",
    "AtZero",
    "Declared",
    "Faults",
    "Place",
    "RigError",
]
