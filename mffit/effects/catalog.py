"""All effects, in one list: tyre, rig and environment compete."""

from __future__ import annotations

from mffit.effects.effect import Effect
from mffit.effects.environment import ENVIRONMENT_EFFECTS
from mffit.effects.rig import RIG_EFFECTS
from mffit.effects.tyre import TYRE_EFFECTS

CATALOG: tuple[Effect, ...] = (*TYRE_EFFECTS, *RIG_EFFECTS, *ENVIRONMENT_EFFECTS)
