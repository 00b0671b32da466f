"""The virtual rig: a known tyre on a rig with known errors, tested like a real one.

``mffit build`` is tested with its data, and a test plan can be tried on it before it is run on the rig.
"""

from mffit.virtual_rig.campaign import Campaign, run
from mffit.virtual_rig.loading import load_plan
from mffit.virtual_rig.plan import RigPlan
from mffit.virtual_rig.simulate import simulate
from mffit.virtual_rig.truth import Truth

__all__ = ["Campaign", "RigPlan", "Truth", "load_plan", "run", "simulate"]
