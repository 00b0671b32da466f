"""From rig files to sweeps in ISO-W and SI."""

from mffit.sweeps.loading import load
from mffit.sweeps.sweep import Sweep
