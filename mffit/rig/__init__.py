"""What a rig makes of a tyre: the readings it reports, with its own faults and the environment's influence."""

from mffit.rig.faults import FAULT_NAMES, MEANINGS, NO_FAULTS, OF_RUN, UNITS, RigFaults
from mffit.rig.simulation import Readings, Simulation, declared_radius, reference_speed

__all__ = [
    "FAULT_NAMES",
    "MEANINGS",
    "NO_FAULTS",
    "OF_RUN",
    "UNITS",
    "Readings",
    "RigFaults",
    "Simulation",
    "declared_radius",
    "reference_speed",
]
