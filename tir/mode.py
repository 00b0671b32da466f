"""Whether turn slip acts: one rule for calls and exports, and warnings about a file's coefficients of turn slip."""

import sys
import warnings
from collections.abc import Collection, Mapping
from typing import Any, TypedDict

from tir.equations.normalise import Switches
from tir.errors import TirWarning
from tir.parameters import TABLE, TURN_SLIP

BLOCK = tuple(row for row in TABLE if row.section == TURN_SLIP and row.files == "")
"""The coefficients of turn slip."""

INSIDE = ("tir.", "functools")
"""Modules skipped when a warning is located: this package, and the cache of its properties."""


class SwitchOptions(TypedDict, total=False):
    """Switches of calls and exports by name, each with its default if left out."""

    turn_slip: bool | None  #: whether spin acts; default: if the units digit of the file's USE_MODE is 5
    star: bool  #: tan(alpha) and sin(gamma) as inputs of the formulae
    limits: bool  #: inputs held to the file's ranges


def asks_for_turn_slip(values: Mapping[str, Any]) -> bool:
    """Whether the units digit of USE_MODE is 5; then spin acts unless a call or an export says otherwise."""
    return bool(abs(values["USE_MODE"]) % 10.0 // 1.0 == 5.0)


def with_turn_slip(mode: float) -> float:
    """The USE_MODE with 5 as units digit, so that spin acts."""
    return mode // 10.0 * 10.0 + 5.0


def words(switches: Switches) -> str:
    """The switches as they are written into exported files."""
    also = ("slip and camber as tan(alpha), sin(gamma)", "inputs held to the file's ranges")
    on = (text for text, chosen in zip(also, switches[1:], strict=True) if chosen)
    return ", ".join([f"turn slip {'on' if switches.turn_slip else 'off'}", *on])


def doubt(values: Mapping[str, Any], present: Collection[str]) -> str:
    """A sentence if the coefficients of turn slip are the common defaults or give no force from spin; else empty."""
    n = len(BLOCK)
    if all(values[row.name] == row.default for row in BLOCK):
        absent = not any(row.name in present for row in BLOCK)
        lead = "the file has no coefficients for it, and the" if absent else f"its {n} coefficients are the"
        return (
            f"turn slip is on, but {lead} common defaults, not measurements: camber and path curvature act by a guess. Use "
            "turn_slip=False (--no-turn-slip), or a file with a measured block"
        )
    if values["PHYP1"] == 0.0 or (values["PHYP2"] == 0.0 and values["PHYP3"] == 0.0):
        return (
            "turn slip is on, but PHYP1 or PHYP2 is 0, so camber and path curvature give no side force. Use turn_slip=False "
            "(--no-turn-slip), or a file with a measured block"
        )
    return ""


def warn_of_doubt(values: Mapping[str, Any], present: Collection[str]) -> None:
    """Warn with the sentence of :func:`doubt`, at the line outside this package that asked for the forces."""
    sentence = doubt(values, present)
    if sentence:
        warn(sentence)


def warn(sentence: str) -> None:
    """Warn at the line outside this package that called it."""
    level, frame = 1, sys._getframe()
    while frame.f_back is not None and str(frame.f_globals.get("__name__")).startswith(INSIDE):
        level, frame = level + 1, frame.f_back
    warnings.warn(sentence, TirWarning, stacklevel=level)
