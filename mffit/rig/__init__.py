"""What a rig makes of a tyre: the readings it reports, with its own faults and the environment's influence."""

from mffit.rig.faults import NO_FAULTS, RigFaults
from mffit.rig.readings import Readings, readings, true_conditions

__all__ = ["NO_FAULTS", "Readings", "RigFaults", "readings", "true_conditions"]
