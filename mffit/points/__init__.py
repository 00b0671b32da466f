"""Finished points from rig sweeps: steady states with standard errors."""

from mffit.points import levels
from mffit.points.levels import main_path, main_pressure
from mffit.points.loading import load_table, read
from mffit.points.points import Points, concatenate, make_points

__all__ = [
    "Points",
    "concatenate",
    "levels",
    "load_table",
    "main_path",
    "main_pressure",
    "make_points",
    "read",
]
