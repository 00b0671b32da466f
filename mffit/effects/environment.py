"""Effects of the environment: each becomes a documented term beside the file."""

from __future__ import annotations

from mffit.effects.effect import Effect, Free

TEMPERATURE = Effect(
    "temperature", "tyre temperature", "environment",
    "Warm rubber grips and stiffens differently: forces scale with temperature.",
    (Free("k_T_per_K", 0.001, (0.0,), -0.05, 0.05), Free("T_ref_degC", 10.0, (0.0,), -40.0, 200.0)),
    ("temperatures",), "as the forces",
    ("drift", "temperature-grip", "temperature-stiffness"),
)  # fmt: skip
TEMPERATURE_GRIP = Effect(
    "temperature-grip", "friction with tyre temperature", "environment",
    "The friction of rubber depends on its temperature: the peak of the curves moves, their slope at zero stays.",
    (Free("k_T_grip_per_K", 0.002, (0.0,), -0.05, 0.05),), ("temperatures",), "as the forces", ("temperature",),
)  # fmt: skip
TEMPERATURE_STIFFNESS = Effect(
    "temperature-stiffness", "cornering stiffness with tyre temperature", "environment",
    "Warm rubber is softer: the slope of the side force at zero changes, its peak stays.",
    (Free("k_T_stiffness_per_K", 0.002, (0.0,), -0.05, 0.05),), ("temperatures",), "as the forces", ("temperature",),
)  # fmt: skip
SPEED = Effect(
    "speed", "speed", "environment",
    "Friction and carcass depend on speed: forces scale with it.",
    (Free("k_V_per_mps", 0.005, (0.0,), -0.2, 0.2),), ("speeds",), "as the forces",
)  # fmt: skip
DRIFT = Effect(
    "drift", "drift over the test", "environment",
    "Wear and ageing change the forces with time.",
    (Free("k_t_per_s", 1e-6, (0.0,), -1e-3, 1e-3),), ("times",), "as the forces", ("temperature",),
)  # fmt: skip
WEAR = Effect(
    "wear", "wear over the distance rolled", "environment",
    "The tread wears with every kilometre, which changes the forces.",
    (Free("wear_per_km", 3e-4, (0.0,), -0.1, 0.1),), ("distances",), "as the forces", ("drift",),
)  # fmt: skip
WARM_UP = Effect(
    "warm-up", "warm-up at the start", "environment",
    "A tyre that starts cold has other forces until it has rolled about a kilometre.",
    (Free("warm_up", 0.03, (0.0,), -0.5, 0.5),), ("times",), "as the forces", ("temperature",),
)  # fmt: skip

ENVIRONMENT_EFFECTS = (TEMPERATURE, TEMPERATURE_GRIP, TEMPERATURE_STIFFNESS, SPEED, DRIFT, WEAR, WARM_UP)
