"""The forward model: the readings that a rig reports of a tyre, its own errors and the environment's influence included."""

from mffit.rig.histories import blocks, distance_km, reference_speed, sense, successive
from mffit.rig.readings import Readings
from mffit.rig.simulation import SIMULATED, Simulation

__all__ = [
    "SIMULATED",
    "Readings",
    "Simulation",
    "blocks",
    "distance_km",
    "reference_speed",
    "sense",
    "successive",
]
