"""From rig files to sweeps in ISO-W and SI."""

from mffit.sweeps.loading import load, load_file
from mffit.sweeps.sweep import Sweep, Sweeps

__all__ = ["Sweep", "Sweeps", "load", "load_file"]
