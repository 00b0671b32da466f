"""Numbers of judgement of the configuration."""

from __future__ import annotations

from tir.constant import Real

U_GIVEN_PATH_RADIUS = Real(
    0.0018, "m", "Standard uncertainty of a path radius given without one.", "Mottola and Massaro 2022, (19)"
)
