"""All effects, in one list: tyre, rig and environment compete."""

from __future__ import annotations

from mffit.effects.effect import Effect
from mffit.effects.of_rig import RIG_EFFECTS
from mffit.effects.tyre import TYRE_EFFECTS

CATALOG: tuple[Effect, ...] = (*TYRE_EFFECTS, *RIG_EFFECTS)
NAMES = {effect.id: effect.name for effect in CATALOG}
