"""From rig sweeps to finished points: steady states with standard errors, tested against physics."""

from mffit.points.levels import main_pressure
from mffit.points.points import Points, concatenate, make_points

__all__ = ["Points", "concatenate", "main_pressure", "make_points"]
