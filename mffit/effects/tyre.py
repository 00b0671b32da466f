"""Effects of the tyre: each becomes coefficients of a new property file."""

from __future__ import annotations

from functools import partial

from mffit.effects.effect import Effect, Free

_effect = partial(Effect, kind="tyre")

TYRE_EFFECTS = (
    _effect(
        id="turn-slip",
        name="turn slip not simulated",
        physics="On a curved path the contact patch turns as it rolls, which pushes the tyre outwards and twists it.",
        free=(Free(name="turn_slip", spread=1.0),),
        needs=("curved",),
    ),
    _effect(
        id="camber-reduction",
        name="camber reduction factor",
        physics="The flattened crown passes on only a share of the camber's spin, so camber and path curvature count "
        "differently.",
        free=(Free(name="PECP1", spread=0.3, scan=(0.0, 0.2, -0.2), upper=0.95),),
        needs=("curved",),
        confusable_with=("path-radius", "camber-misalignment"),
    ),
    _effect(
        id="camber-reduction-load",
        name="camber reduction factor over load",
        physics="The share of the camber's spin that the crown passes on changes as load flattens it.",
        free=(Free(name="PECP2", spread=1.0, scan=(0.5, -0.5)),),
        needs=("curved", "loads"),
    ),
    _effect(
        id="ply-steer",
        name="ply-steer",
        physics="The belt's outer plies steer the tyre, which shifts the side-force curve and turns with the direction of "
        "rolling.",
        free=(Free(name="PHY1", spread=0.001),),
        confusable_with=("sideslip-misalignment",),
        prior=-0.5,
    ),
    _effect(
        id="conicity",
        name="conicity",
        physics="A tread a little conical pulls to one side whichever way it rolls, until the tyre is turned on its rim.",
        free=(Free(name="PVY1", spread=0.005),),
        confusable_with=("crosstalk-fz-fy", "loadcell-offset-fy"),
        prior=-0.3,
    ),
    _effect(
        id="camber-stiffness",
        name="camber stiffness",
        physics="The side force per degree of lean at small camber differs from the model's.",
        free=(Free(name="PKY6", spread=0.15, relative=True),),
        needs=("camber",),
    ),
    _effect(
        id="camber-thrust-curvature",
        name="camber force beyond the shift of the curve",
        physics="Part of the camber force does not saturate with slip but adds to it.",
        free=(Free(name="PVY3", spread=0.2),),
        needs=("camber",),
    ),
    _effect(
        id="camber-grip",
        name="loss of grip with camber",
        physics="A leaned tyre presses unevenly and loses peak side force.",
        free=(Free(name="PDY3", spread=0.2),),
        needs=("camber",),
    ),
    _effect(
        id="camber-cornering-stiffness",
        name="cornering stiffness with camber",
        physics="A leaned tyre has another cornering stiffness than an upright one.",
        free=(Free(name="PKY3", spread=0.1),),
        needs=("coupled",),
    ),
    _effect(
        id="load-grip",
        name="grip over load",
        physics="Friction falls, or rises, with contact pressure.",
        free=(Free(name="PDY2", spread=0.1),),
        needs=("loads",),
    ),
    _effect(
        id="load-cornering-stiffness",
        name="cornering stiffness over load",
        physics="Cornering stiffness grows with load at first and then less and less; the load of its maximum differs.",
        free=(Free(name="PKY2", spread=0.2, relative=True),),
        needs=("loads",),
    ),
    _effect(
        id="pressure",
        name="inflation pressure",
        physics="Pressure changes carcass and contact patch: stiffness, grip, camber stiffness and trail.",
        free=(
            Free(name="PPY1", spread=0.3),
            Free(name="PPY2", spread=0.3),
            Free(name="PPY3", spread=0.2),
            Free(name="PPY5", spread=0.3),
            Free(name="PPZ1", spread=0.3),
        ),
        needs=("pressures",),
    ),
    _effect(
        id="curvature-asymmetry",
        name="asymmetry of the side-force curve",
        physics="The curve bends differently on its two sides.",
        free=(Free(name="PEY3", spread=0.1),),
        needs=("slip",),
    ),
    _effect(
        id="trail-load",
        name="pneumatic trail over load",
        physics="The contact patch grows with load and the trail with it, not in proportion.",
        free=(Free(name="QDZ2", spread=0.02),),
        needs=("loads", "moment"),
    ),
    _effect(
        id="trail-camber",
        name="pneumatic trail with camber",
        physics="A leaned tyre stands on another part of its crown, with another contact length.",
        free=(Free(name="QDZ3", spread=0.07), Free(name="QDZ4", spread=0.2)),
        needs=("coupled", "moment"),
    ),
    _effect(
        id="residual-torque",
        name="residual torque",
        physics="A moment remains at zero slip, from plies and tread pattern.",
        free=(Free(name="QDZ6", spread=0.003),),
        needs=("moment",),
        confusable_with=("loadcell-offset-mz",),
        prior=-0.3,
    ),
    _effect(
        id="residual-torque-camber",
        name="residual torque with camber",
        physics="Camber twists the contact patch, which leaves a moment at zero slip.",
        free=(Free(name="QDZ8", spread=0.02),),
        needs=("camber", "moment"),
    ),
    _effect(
        id="spin-grip-loss",
        name="loss of grip by spin",
        physics="A turning contact patch uses part of the grip for the turning.",
        free=(Free(name="PDYP1", spread=0.3, scan=(0.1, 0.3, 0.6, -0.1, -0.3)),),
        needs=("spin",),
    ),
    _effect(
        id="spin-stiffness-loss",
        name="loss of cornering stiffness by spin",
        physics="A turning contact patch yields more easily to sideslip.",
        free=(Free(name="PKYP1", spread=1.0, scan=(0.3, 0.8, 2.0, -0.3, -0.8)),),
        needs=("spin",),
    ),
    _effect(
        id="spin-trail-loss",
        name="loss of trail by spin",
        physics="Spin builds its own stresses along the contact patch, which bring the side force nearer to its middle.",
        free=(Free(name="QDTP1", spread=3.0, scan=(0.5, 1.5, 3.0, -0.5, -1.5)),),
        needs=("spin", "moment"),
    ),
    _effect(
        id="spin-torque",
        name="turn-slip moment",
        physics="A contact patch that is turned resists with a moment of its own.",
        free=(Free(name="QCRP1", spread=0.1, scan=(0.005, 0.03, 0.1, 0.2, -0.03, -0.06)),),
        needs=("spin", "moment"),
    ),
)
