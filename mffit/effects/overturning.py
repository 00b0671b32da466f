"""Effects of the tyre on its overturning moment."""

from __future__ import annotations

from functools import partial

from mffit.effects.effect import Effect, Free

_effect = partial(Effect, kind="tyre")

OVERTURNING_EFFECTS = (
    _effect(
        id="overturning-offset",
        name="overturning moment of the upright tyre",
        physics="The load acts a little off the middle of the wheel, from conicity and plies.",
        free=(Free(name="QSX1", spread=0.01),),
        needs=("overturning",),
        confusable_with=("loadcell-offset-mx",),
        prior=-0.3,
    ),
    _effect(
        id="overturning-camber",
        name="overturning moment with camber",
        physics="A leaned tyre stands on another part of its crown, so that the load acts off the middle of the wheel.",
        free=(Free(name="QSX2", spread=0.2),),
        needs=("overturning", "camber"),
    ),
    _effect(
        id="overturning-side-force",
        name="overturning moment with side force",
        physics="Side force bends the carcass, and the load acts off the middle of the wheel.",
        free=(Free(name="QSX3", spread=0.02),),
        needs=("overturning", "slip"),
        confusable_with=("crosstalk-fy-mx", "overturning-arm"),
    ),
    _effect(
        id="overturning-arm",
        name="arm of the side force in the overturning moment",
        physics="The side force acts a little above or below the plane of the road, at the same height under every load.",
        free=(Free(name="QSX13", spread=0.01),),
        needs=("overturning", "slip"),
        confusable_with=("crosstalk-fy-mx", "overturning-side-force"),
        prior=-2.0,
    ),
)
