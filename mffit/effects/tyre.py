"""Effects of the tyre: each becomes coefficients of a new property file."""

from __future__ import annotations

from mffit.effects.effect import Effect, Free

TURN_SLIP = Effect(
    id="turn-slip",
    name="turn slip not simulated",
    kind="tyre",
    physics="On a curved path the contact patch turns as it rolls, which pushes the tyre outwards and twists it.",
    free=(Free(name="turn_slip", spread=1.0),),
    needs=("curved",),
    parity="odd in phi_t",
)
CAMBER_REDUCTION = Effect(
    id="camber-reduction",
    name="camber reduction factor",
    kind="tyre",
    physics="The flattened crown passes on only a share of the camber's spin, so camber and path curvature count differently.",
    free=(Free(name="PECP1", spread=0.3, scan=(0.0, 0.2, -0.2), lower=-1.5, upper=0.95),),
    needs=("curved",),
    parity="odd in phi_t",
    confusable_with=(
        "path-radius",
        "camber-misalignment",
    ),
)
CAMBER_REDUCTION_LOAD = Effect(
    id="camber-reduction-load",
    name="camber reduction factor over load",
    kind="tyre",
    physics="The share of the camber's spin that the crown passes on changes as load flattens it.",
    free=(Free(name="PECP2", spread=1.0, scan=(0.5, -0.5), lower=-8.0, upper=8.0),),
    needs=(
        "curved",
        "loads",
    ),
    parity="odd in phi_t",
)
PLY_STEER = Effect(
    id="ply-steer",
    name="ply-steer",
    kind="tyre",
    physics="The belt's outer plies steer the tyre, which shifts the side-force curve and turns with the direction of "
    "rolling.",
    free=(Free(name="PHY1", spread=0.001, lower=-0.03, upper=0.03),),
    parity="even in alpha",
    confusable_with=("sideslip-misalignment",),
    prior=-0.5,
)
CONICITY = Effect(
    id="conicity",
    name="conicity",
    kind="tyre",
    physics="A tread a little conical pulls to one side whichever way it rolls, until the tyre is turned on its rim.",
    free=(Free(name="PVY1", spread=0.005, lower=-0.15, upper=0.15),),
    parity="even in alpha and gamma",
    confusable_with=(
        "crosstalk-fz-fy",
        "loadcell-offset-fy",
    ),
    prior=-0.3,
)
CAMBER_STIFFNESS = Effect(
    id="camber-stiffness",
    name="camber stiffness",
    kind="tyre",
    physics="The side force per degree of lean at small camber differs from the model's.",
    free=(Free(name="PKY6", spread=0.15, lower=-8.0, upper=2.0, relative=True),),
    needs=("camber",),
    parity="odd in gamma and phi_t",
)
CAMBER_THRUST_CURVATURE = Effect(
    id="camber-thrust-curvature",
    name="camber force beyond the shift of the curve",
    kind="tyre",
    physics="Part of the camber force does not saturate with slip but adds to it.",
    free=(Free(name="PVY3", spread=0.2, lower=-3.0, upper=3.0),),
    needs=("camber",),
    parity="odd in gamma",
)
CAMBER_GRIP = Effect(
    id="camber-grip",
    name="loss of grip with camber",
    kind="tyre",
    physics="A leaned tyre presses unevenly and loses peak side force.",
    free=(Free(name="PDY3", spread=0.2, lower=-3.0, upper=20.0),),
    needs=("camber",),
    parity="odd",
)
CAMBER_CORNERING_STIFFNESS = Effect(
    id="camber-cornering-stiffness",
    name="cornering stiffness with camber",
    kind="tyre",
    physics="A leaned tyre has another cornering stiffness than an upright one.",
    free=(Free(name="PKY3", spread=0.1, lower=-1.0, upper=3.0),),
    needs=("coupled",),
    parity="odd",
)
LOAD_GRIP = Effect(
    id="load-grip",
    name="grip over load",
    kind="tyre",
    physics="Friction falls, or rises, with contact pressure.",
    free=(Free(name="PDY2", spread=0.1, lower=-1.5, upper=1.5),),
    needs=("loads",),
    parity="odd",
)
LOAD_CORNERING_STIFFNESS = Effect(
    id="load-cornering-stiffness",
    name="cornering stiffness over load",
    kind="tyre",
    physics="Cornering stiffness grows with load at first and then less and less; the load of its maximum differs.",
    free=(Free(name="PKY2", spread=0.2, lower=0.2, upper=12.0, relative=True),),
    needs=("loads",),
    parity="odd",
)
PRESSURE = Effect(
    id="pressure",
    name="inflation pressure",
    kind="tyre",
    physics="Pressure changes carcass and contact patch: stiffness, grip, camber stiffness and trail.",
    free=(
        Free(name="PPY1", spread=0.3),
        Free(name="PPY2", spread=0.3),
        Free(name="PPY3", spread=0.2),
        Free(name="PPY5", spread=0.3),
        Free(name="PPZ1", spread=0.3),
    ),
    needs=("pressures",),
    parity="odd",
)
CURVATURE_ASYMMETRY = Effect(
    id="curvature-asymmetry",
    name="asymmetry of the side-force curve",
    kind="tyre",
    physics="The curve bends differently on its two sides.",
    free=(Free(name="PEY3", spread=0.1, lower=-1.0, upper=1.0),),
    needs=("slip",),
    parity="even in alpha",
)
TRAIL_LOAD = Effect(
    id="trail-load",
    name="pneumatic trail over load",
    kind="tyre",
    physics="The contact patch grows with load and the trail with it, not in proportion.",
    free=(Free(name="QDZ2", spread=0.02, lower=-0.2, upper=0.2),),
    needs=(
        "loads",
        "moment",
    ),
    parity="odd",
)
TRAIL_CAMBER = Effect(
    id="trail-camber",
    name="pneumatic trail with camber",
    kind="tyre",
    physics="A leaned tyre stands on another part of its crown, with another contact length.",
    free=(
        Free(name="QDZ3", spread=0.07),
        Free(name="QDZ4", spread=0.2),
    ),
    needs=(
        "coupled",
        "moment",
    ),
    parity="odd",
)
RESIDUAL_TORQUE = Effect(
    id="residual-torque",
    name="residual torque",
    kind="tyre",
    physics="A moment remains at zero slip, from plies and tread pattern.",
    free=(Free(name="QDZ6", spread=0.003, lower=-0.1, upper=0.1),),
    needs=("moment",),
    parity="even",
    confusable_with=("loadcell-offset-mz",),
    prior=-0.3,
)
RESIDUAL_TORQUE_CAMBER = Effect(
    id="residual-torque-camber",
    name="residual torque with camber",
    kind="tyre",
    physics="Camber twists the contact patch, which leaves a moment at zero slip.",
    free=(Free(name="QDZ8", spread=0.02, lower=-1.0, upper=1.0),),
    needs=(
        "camber",
        "moment",
    ),
    parity="odd",
)
SPIN_GRIP_LOSS = Effect(
    id="spin-grip-loss",
    name="loss of grip by spin",
    kind="tyre",
    physics="A turning contact patch uses part of the grip for the turning.",
    free=(Free(name="PDYP1", spread=0.3, scan=(0.1, 0.3, 0.6, -0.1, -0.3), lower=0.0, upper=4.0),),
    needs=("spin",),
    parity="even in phi",
)
SPIN_STIFFNESS_LOSS = Effect(
    id="spin-stiffness-loss",
    name="loss of cornering stiffness by spin",
    kind="tyre",
    physics="A turning contact patch yields more easily to sideslip.",
    free=(Free(name="PKYP1", spread=1.0, scan=(0.3, 0.8, 2.0, -0.3, -0.8), lower=0.0, upper=12.0),),
    needs=("spin",),
    parity="even in phi",
)
SPIN_TRAIL_LOSS = Effect(
    id="spin-trail-loss",
    name="loss of trail by spin",
    kind="tyre",
    physics="Spin builds its own stresses along the contact patch, which bring the side force nearer to its middle.",
    free=(Free(name="QDTP1", spread=3.0, scan=(0.5, 1.5, 3.0, -0.5, -1.5), lower=0.0, upper=25.0),),
    needs=(
        "spin",
        "moment",
    ),
    parity="even in phi",
)
SPIN_TORQUE = Effect(
    id="spin-torque",
    name="turn-slip moment",
    kind="tyre",
    physics="A contact patch that is turned resists with a moment of its own.",
    free=(Free(name="QCRP1", spread=0.1, scan=(0.005, 0.03, 0.1, 0.2, -0.03, -0.06), lower=0.0, upper=1.5),),
    needs=(
        "spin",
        "moment",
    ),
    parity="odd in phi",
)

TYRE_EFFECTS = (
    TURN_SLIP,
    CAMBER_REDUCTION,
    CAMBER_REDUCTION_LOAD,
    PLY_STEER,
    CONICITY,
    CAMBER_STIFFNESS,
    CAMBER_THRUST_CURVATURE,
    CAMBER_GRIP,
    CAMBER_CORNERING_STIFFNESS,
    LOAD_GRIP,
    LOAD_CORNERING_STIFFNESS,
    PRESSURE,
    CURVATURE_ASYMMETRY,
    TRAIL_LOAD,
    TRAIL_CAMBER,
    RESIDUAL_TORQUE,
    RESIDUAL_TORQUE_CAMBER,
    SPIN_GRIP_LOSS,
    SPIN_STIFFNESS_LOSS,
    SPIN_TRAIL_LOSS,
    SPIN_TORQUE,
)
