"""The virtual rig: simulated tests of a known tyre on a rig with known errors.

Its data serve to test ``mffit build``, and to try a test plan before it is run on the real rig.
"""

from mffit.virtual_rig.campaign import Campaign, run
from mffit.virtual_rig.loading import load_plan
from mffit.virtual_rig.plan import RigPlan
from mffit.virtual_rig.simulate import simulate
from mffit.virtual_rig.truth import Truth
