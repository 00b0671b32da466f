"""Finished points from rig sweeps: steady states with standard errors."""

from mffit.points import levels
from mffit.points.levels import main_path, main_pressure
from mffit.points.loading import load_table, read
from mffit.points.points import Points, concatenate, make_points
