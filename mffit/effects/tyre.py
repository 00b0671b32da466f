"""Effects of the tyre: each becomes coefficients of a new property file."""

from __future__ import annotations

from mffit.effects.effect import Effect, Free

TURN_SLIP = Effect(
    "turn-slip", "turn slip not simulated", "tyre",
    "On a curved path the contact patch turns as it rolls, which pushes the tyre outwards and twists it.",
    (Free("turn_slip", 1.0),), ("curved",), "odd in phi_t",
)  # fmt: skip
CAMBER_REDUCTION = Effect(
    "camber-reduction", "camber reduction factor", "tyre",
    "The flattened crown passes on only a share of the camber's spin, so camber and path curvature count differently.",
    (Free("PECP1", 0.3, (0.0, 0.2, -0.2), -1.5, 0.95),), ("curved",), "odd in phi_t", ("path-radius", "camber-misalignment"),
)  # fmt: skip
CAMBER_REDUCTION_LOAD = Effect(
    "camber-reduction-load", "camber reduction factor over load", "tyre",
    "The share of the camber's spin that the crown passes on changes as load flattens it.",
    (Free("PECP2", 1.0, (0.5, -0.5), -8.0, 8.0),), ("curved", "loads"), "odd in phi_t",
)  # fmt: skip
PLY_STEER = Effect(
    "ply-steer", "ply-steer", "tyre",
    "The belt's outer plies steer the tyre, which shifts the side-force curve sideways and turns with the direction of rolling.",
    (Free("PHY1", 0.001, (0.0,), -0.03, 0.03),), (), "even in alpha", ("sideslip-misalignment",), prior=-0.5,
)  # fmt: skip
CONICITY = Effect(
    "conicity", "conicity", "tyre",
    "A tread a little conical pulls to one side whichever way it rolls, until the tyre is turned on its rim.",
    (Free("PVY1", 0.005, (0.0,), -0.15, 0.15),), (), "even in alpha and gamma",
    ("crosstalk-fz-fy", "loadcell-offset-fy"), prior=-0.3,
)  # fmt: skip
CAMBER_STIFFNESS = Effect(
    "camber-stiffness", "camber stiffness", "tyre",
    "The side force per degree of lean at small camber differs from the model's.",
    (Free("PKY6", 0.15, (0.0,), -8.0, 2.0, relative=True),), ("camber",), "odd in gamma and phi_t",
)  # fmt: skip
CAMBER_THRUST_CURVATURE = Effect(
    "camber-thrust-curvature", "camber force beyond the shift of the curve", "tyre",
    "Part of the camber force does not saturate with slip but adds to it.",
    (Free("PVY3", 0.2, (0.0,), -3.0, 3.0),), ("camber",), "odd in gamma",
)  # fmt: skip
CAMBER_GRIP = Effect(
    "camber-grip", "loss of grip with camber", "tyre",
    "A leaned tyre presses unevenly and loses peak side force.",
    (Free("PDY3", 0.2, (0.0,), -3.0, 20.0),), ("camber",), "odd",
)  # fmt: skip
CAMBER_CORNERING_STIFFNESS = Effect(
    "camber-cornering-stiffness", "cornering stiffness with camber", "tyre",
    "A leaned tyre has another cornering stiffness than an upright one.",
    (Free("PKY3", 0.1, (0.0,), -1.0, 3.0),), ("coupled",), "odd",
)  # fmt: skip
LOAD_GRIP = Effect(
    "load-grip", "grip over load", "tyre",
    "Friction falls, or rises, with contact pressure.",
    (Free("PDY2", 0.1, (0.0,), -1.5, 1.5),), ("loads",), "odd",
)  # fmt: skip
LOAD_CORNERING_STIFFNESS = Effect(
    "load-cornering-stiffness", "cornering stiffness over load", "tyre",
    "Cornering stiffness grows with load at first and then less and less; the load of its maximum differs.",
    (Free("PKY2", 0.2, (0.0,), 0.2, 12.0, relative=True),), ("loads",), "odd",
)  # fmt: skip
PRESSURE = Effect(
    "pressure", "inflation pressure", "tyre",
    "Pressure changes carcass and contact patch: stiffness, grip, camber stiffness and trail.",
    (Free("PPY1", 0.3), Free("PPY2", 0.3), Free("PPY3", 0.2), Free("PPY5", 0.3), Free("PPZ1", 0.3)), ("pressures",), "odd",
)  # fmt: skip
CURVATURE_ASYMMETRY = Effect(
    "curvature-asymmetry", "asymmetry of the side-force curve", "tyre",
    "The curve bends differently on its two sides.",
    (Free("PEY3", 0.1, (0.0,), -1.0, 1.0),), ("slip",), "even in alpha",
)  # fmt: skip
TRAIL_LOAD = Effect(
    "trail-load", "pneumatic trail over load", "tyre",
    "The contact patch grows with load and the trail with it, not in proportion.",
    (Free("QDZ2", 0.02, (0.0,), -0.2, 0.2),), ("loads", "moment"), "odd",
)  # fmt: skip
TRAIL_CAMBER = Effect(
    "trail-camber", "pneumatic trail with camber", "tyre",
    "A leaned tyre stands on another part of its crown, with another contact length.",
    (Free("QDZ3", 0.07), Free("QDZ4", 0.2)), ("coupled", "moment"), "odd",
)  # fmt: skip
RESIDUAL_TORQUE = Effect(
    "residual-torque", "residual torque", "tyre",
    "A moment remains at zero slip, from plies and tread pattern.",
    (Free("QDZ6", 0.003, (0.0,), -0.1, 0.1),), ("moment",), "even", ("loadcell-offset-mz",), prior=-0.3,
)  # fmt: skip
RESIDUAL_TORQUE_CAMBER = Effect(
    "residual-torque-camber", "residual torque with camber", "tyre",
    "Camber twists the contact patch, which leaves a moment at zero slip.",
    (Free("QDZ8", 0.02, (0.0,), -1.0, 1.0),), ("camber", "moment"), "odd",
)  # fmt: skip
SPIN_GRIP_LOSS = Effect(
    "spin-grip-loss", "loss of grip by spin", "tyre",
    "A turning contact patch uses part of the grip for the turning.",
    (Free("PDYP1", 0.3, (0.1, 0.3, 0.6, -0.1, -0.3), 0.0, 4.0),), ("spin",), "even in phi",
)  # fmt: skip
SPIN_STIFFNESS_LOSS = Effect(
    "spin-stiffness-loss", "loss of cornering stiffness by spin", "tyre",
    "A turning contact patch yields more easily to sideslip.",
    (Free("PKYP1", 1.0, (0.3, 0.8, 2.0, -0.3, -0.8), 0.0, 12.0),), ("spin",), "even in phi",
)  # fmt: skip
SPIN_TRAIL_LOSS = Effect(
    "spin-trail-loss", "loss of trail by spin", "tyre",
    "Spin builds its own stresses along the contact patch, which bring the side force nearer to its middle.",
    (Free("QDTP1", 3.0, (0.5, 1.5, 3.0, -0.5, -1.5), 0.0, 25.0),), ("spin", "moment"), "even in phi",
)  # fmt: skip
SPIN_TORQUE = Effect(
    "spin-torque", "turn-slip moment", "tyre",
    "A contact patch that is turned resists with a moment of its own.",
    (Free("QCRP1", 0.1, (0.005, 0.03, 0.1, 0.2, -0.03, -0.06), 0.0, 1.5),), ("spin", "moment"), "odd in phi",
)  # fmt: skip
TYRE_EFFECTS = (
    TURN_SLIP, CAMBER_REDUCTION, CAMBER_REDUCTION_LOAD, PLY_STEER, CONICITY, CAMBER_STIFFNESS, CAMBER_THRUST_CURVATURE,
    CAMBER_GRIP, CAMBER_CORNERING_STIFFNESS, LOAD_GRIP, LOAD_CORNERING_STIFFNESS, PRESSURE, CURVATURE_ASYMMETRY,
    TRAIL_LOAD, TRAIL_CAMBER, RESIDUAL_TORQUE, RESIDUAL_TORQUE_CAMBER, SPIN_GRIP_LOSS, SPIN_STIFFNESS_LOSS,
    SPIN_TRAIL_LOSS, SPIN_TORQUE,
)  # fmt: skip
