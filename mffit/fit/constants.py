"""Numbers of judgement of the fit."""

from __future__ import annotations

from tir.constant import Real

RIG_ERROR_REACH = Real(
    8.0,
    "-",
    "Standard uncertainties that a rig error may move; beyond that the declaration is wrong, not the reading.",
)
