"""Effects of the tyre under drive and brake, alone and with sideslip."""

from __future__ import annotations

from functools import partial

from mffit.effects.effect import Effect, Free

_effect = partial(Effect, kind="tyre")

LONGITUDINAL_EFFECTS = (
    _effect(
        id="longitudinal-grip",
        name="longitudinal grip",
        physics="The peak of the longitudinal force is higher, or lower, than the model's.",
        free=(Free(name="PDX1", spread=0.1, relative=True),),
        needs=("drive",),
        confusable_with=("loadcell-gain-fx",),
    ),
    _effect(
        id="longitudinal-grip-load",
        name="longitudinal grip over load",
        physics="Longitudinal friction falls, or rises, with contact pressure.",
        free=(Free(name="PDX2", spread=0.1),),
        needs=("drive", "loads"),
    ),
    _effect(
        id="slip-stiffness",
        name="slip stiffness",
        physics="The longitudinal force per unit of slip near free rolling differs from the model's.",
        free=(Free(name="PKX1", spread=0.15, relative=True),),
        needs=("drive",),
        confusable_with=("loadcell-gain-fx",),
    ),
    _effect(
        id="slip-shift",
        name="shift of the Fx curve over slip",
        physics="The longitudinal force is zero at another slip than that of free rolling, at which slip is counted from zero.",
        free=(Free(name="PHX1", spread=0.002),),
        needs=("drive",),
        confusable_with=("slip-zero",),
        prior=-2.0,
    ),
    _effect(
        id="rolling-force",
        name="longitudinal force in proportion to load",
        physics="A share of the load that the slip does not change acts along the tyre, as rolling resistance does.",
        free=(Free(name="PVX1", spread=0.005),),
        needs=("drive",),
        confusable_with=("loadcell-offset-fx", "longitudinal-drag"),
        prior=-0.3,
    ),
    _effect(
        id="combined-longitudinal",
        name="loss of longitudinal force by sideslip",
        physics="Sideslip uses part of the grip, so that less is left for drive and brake.",
        free=(Free(name="RBX1", spread=0.2, relative=True),),
        needs=("drive", "combined"),
    ),
    _effect(
        id="combined-lateral",
        name="loss of side force by longitudinal slip",
        physics="Drive and brake use part of the grip, so that less is left for the side force.",
        free=(Free(name="RBY1", spread=0.2, relative=True),),
        needs=("drive", "combined"),
    ),
    _effect(
        id="combined-camber",
        name="combined slip with camber",
        physics="A leaned tyre shares its grip between drive and sideslip otherwise than an upright one.",
        free=(
            Free(name="RBX3", spread=10.0),
            Free(name="RBY4", spread=10.0),
        ),
        needs=("drive", "combined_camber"),
    ),
    _effect(
        id="longitudinal-arm",
        name="moment arm of the longitudinal force",
        physics="The longitudinal force acts off the middle of the wheel and turns it, to the other side once the tyre is "
        "turned on its rim.",
        free=(Free(name="SSZ1", spread=0.006),),
        needs=("drive", "moment"),
        confusable_with=("crosstalk-fx-mz",),
        prior=-2.0,
    ),
)
