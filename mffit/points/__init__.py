"""From rig sweeps to finished points: steady states with standard errors, tested against physics."""

from mffit.points.levels import main_pressure
from mffit.points.loading import load, load_table
from mffit.points.plausibility import check_physics
from mffit.points.points import Points, concatenate, make_points
from mffit.points.steady import mean_and_error, plateaus

__all__ = [
    "Points",
    "check_physics",
    "concatenate",
    "load",
    "load_table",
    "main_pressure",
    "make_points",
    "mean_and_error",
    "plateaus",
]
