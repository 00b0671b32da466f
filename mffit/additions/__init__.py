"""The runs that a rig could add to a programme: a plan chooses those that inform most, a diagnosis one that separates effects."""

from mffit.additions.kinds import ADDITIONS, BY_ID, SEPARATING, Addition, addition_named
from mffit.additions.runs import PlannedRun, candidates, largest_slip, new_setups, swept
