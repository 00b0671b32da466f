"""What the data can support: which coefficients may be freed, and what is missing for the others."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from mffit.fit.stages import (
    CAMBER_MOMENT,
    COUPLED,
    ODD_TERMS,
    SHIFT_TERMS,
    STAGES,
    THREE_LOADS,
    THREE_PRESSURES,
    TWO_LOADS,
    TWO_PRESSURES,
)
from mffit.points import Points


@dataclass(frozen=True, slots=True)
class StageCoverage:
    """One row of the coverage matrix."""

    stage: str
    title: str
    supported: bool
    free: tuple[str, ...]
    held: tuple[str, ...]
    missing: tuple[str, ...]  #: what the data would need for the held ones, as sentences


@dataclass(frozen=True, slots=True)
class Design:
    """The set-points of a data set, counted."""

    loads: int
    pressures: int
    cambers: int
    coupled: bool  #: sideslip and camber together
    moment: bool  #: Mz measured
    curved: bool  #: path curvature present
    shifts: bool  #: odd shift terms visible: flat track, or backward runs or flipped mounts on a disc
    symmetric: bool


def design(points: Points, side: str) -> Design:
    """Count what was varied. Loads within 8 %, pressures within 10 kPa and cambers within 1 deg are one level."""
    curved = bool(np.any(points.phi_t != 0.0))
    both_ways = bool(np.any(points.direction < 0) or np.any(points.mount < 0))
    gamma, alpha = np.degrees(points.gamma), np.degrees(points.alpha)
    return Design(
        loads=levels(np.log(points.Fz), 0.08),
        pressures=levels(points.p, 10e3),
        cambers=levels(np.abs(gamma), 1.0),
        coupled=bool(np.any((np.abs(gamma) > 1.0) & (np.abs(alpha) > 0.5))),
        moment=bool(np.any(np.isfinite(points.Mz))),
        curved=curved,
        shifts=both_ways or not curved,
        symmetric=side == "symmetric",
    )


def levels(values: np.ndarray, gap: float) -> int:
    """Number of levels among the values: groups that are separated by more than ``gap``."""
    ordered = np.sort(values[np.isfinite(values)])
    return int(np.sum(np.diff(ordered) > gap)) + 1 if len(ordered) else 0


def coverage(points: Points, side: str) -> tuple[StageCoverage, ...]:
    """The coverage matrix: per stage the coefficients that are freed and what is missing for the rest."""
    seen = design(points, side)
    rows = []
    for stage in STAGES:
        reasons = {name: _missing(name, stage.name, seen) for name in stage.parameters}
        free = tuple(name for name, reason in reasons.items() if not reason)
        held = tuple(name for name, reason in reasons.items() if reason)
        missing = tuple(dict.fromkeys(reason for reason in reasons.values() if reason))
        rows.append(StageCoverage(stage.name, stage.title, bool(free), free, held, missing))
    return tuple(rows)


def _missing(name: str, stage: str, seen: Design) -> str:
    """Why the coefficient cannot be seen; empty if it can."""
    if name.startswith(("Q", "PPZ")) and not seen.moment:
        return "Mz was not measured"
    if (stage == "camber" or name in CAMBER_MOMENT) and seen.cambers < 2:
        return "no camber was run"
    if name in COUPLED and not seen.coupled:
        return "no sweep combines sideslip and camber"
    if stage == "spin" and not seen.curved:
        return "the path is straight, so spin is not excited"
    if name in SHIFT_TERMS and not seen.shifts:
        return "backward runs or flipped mounts, which tell shifts from turn slip, are absent"
    if name in ODD_TERMS and seen.symmetric:
        return "the tyre is declared symmetric"
    needed = 3 if name in THREE_LOADS else 2 if name in TWO_LOADS else 1
    if seen.loads < needed:
        return f"{needed} loads are needed, {seen.loads} run"
    needed = 3 if name in THREE_PRESSURES else 2 if name in TWO_PRESSURES else 1
    if seen.pressures < needed:
        return f"{needed} pressures are needed, {seen.pressures} run"
    return ""
