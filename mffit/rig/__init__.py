"""The forward model: readings of a tyre on a rig, including rig errors and influences of the environment."""

from mffit.rig.histories import blocks, distance_km, reference_speed, successive
from mffit.rig.readings import Readings
from mffit.rig.simulation import SIMULATED, Simulation
