"""What a rig, its environment and its motion do to a reading: one record per error."""

from mffit.rig_errors.catalog import (
    AFTER,
    BEFORE,
    BY_NAME,
    DECLARED,
    MEANINGS,
    RIG_ERRORS,
    UNITS,
    WORDS,
    ZEROS,
)
from mffit.rig_errors.faults import (
    NO_FAULTS,
    OF_RUN,
    Faults,
    error_of,
    meaning_of,
    number_of,
    shown,
    unit_of,
    words_of,
)
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
    "ZEROS",
    "Appearance",
    "AtZero",
    "Declared",
    "Faults",
    "Place",
    "RigError",
    "error_of",
    "meaning_of",
    "number_of",
    "shown",
    "unit_of",
    "words_of",
]
