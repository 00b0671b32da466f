"""Effects of the environment: each becomes a documented term beside the file."""

from __future__ import annotations

from mffit.effects.effect import Effect, Free

TEMPERATURE = Effect(
    "temperature", "tyre temperature", "environment",
    "Warm rubber grips and stiffens differently: forces scale with temperature.",
    (Free("k_T_per_K", 0.001, (0.0,), -0.05, 0.05),), ("temperatures",), "as the forces", ("drift",),
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

ENVIRONMENT_EFFECTS = (TEMPERATURE, SPEED, DRIFT)
