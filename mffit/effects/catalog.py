"""All effects, in one list: tyre, rig and environment compete."""

from __future__ import annotations

from mffit.effects.effect import Effect
from mffit.effects.environment import ENVIRONMENT_EFFECTS
from mffit.effects.rig import RIG_EFFECTS
from mffit.effects.tyre import TYRE_EFFECTS

CATALOG: tuple[Effect, ...] = (*TYRE_EFFECTS, *RIG_EFFECTS, *ENVIRONMENT_EFFECTS)
NAMES = {effect.id: effect.name for effect in CATALOG}
FAULT_WORDS = {
    effect.free[0].name: effect.name
    for effect in (*RIG_EFFECTS, *ENVIRONMENT_EFFECTS)
    if not effect.differs_by_run
}
"""What a number of the rig is called where a reader wants words, by its name in RigFaults."""
