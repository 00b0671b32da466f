"""Which coefficients the data determine, and what is missing for the others."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass

import numpy as np

from mffit.constants import STRAIGHT, UPRIGHT
from mffit.fit.by_hand import HELD_BY_HAND
from mffit.fit.stages import STAGES, Stage
from mffit.points import Points, levels
from tir.parameters import BY_NAME, Need, Parameter

NEEDLESS = "left-out sweeps are not predicted clearly better with these terms"


@dataclass(frozen=True, slots=True)
class StageCoverage:
    """One row of the coverage matrix."""

    stage: str
    title: str
    supported: bool
    free: tuple[str, ...]
    held: tuple[str, ...]
    missing: tuple[str, ...]  #: what the data lack for the held ones, as sentences
    by_hand: tuple[str, ...] = ()  #: those of the held ones that the engineer holds


@dataclass(frozen=True, slots=True)
class Design:
    """Numbers of levels of the set-points of a data set."""

    loads: int
    pressures: int
    pressure_loads: (
        int  #: loads at which more than one pressure was run, a wheel that only rolls straight on apart
    )
    cambers: int
    coupled: bool  #: sideslip and camber together
    speeds: int
    sideslips: int
    slip: bool  #: longitudinal slip was run
    combined: bool  #: longitudinal slip and sideslip together
    side_force: bool  #: longitudinal slip where there is side force, of sideslip or of camber
    both_sides: bool  #: sideslip to both sides
    both_flanks: bool  #: sideslip towards both flanks of the tyre: to both sides, or with the tyre turned on its rim or backwards
    measured: tuple[str, ...]  #: channels with readings
    curved: bool  #: path curvature present
    shifts: bool  #: odd shift terms are separable: flat track, or disc with backward runs, flipped mounts or both sides
    symmetric: bool


def design(points: Points, side: str) -> Design:
    """The numbers of levels that were run."""
    curved = bool(np.any(points.phi_t != 0.0))
    held = levels.labels_of_sweeps(points.Fz, points.sweep, levels.LOAD)
    load = np.where(_straight_on(points), levels.NO_LEVEL, held)
    pressures_at = [levels.count(points.p[load == k], levels.PRESSURE) for k in np.unique(load[load >= 0])]
    both_sides = len(np.unique(np.sign(points.phi_t))) > 1
    both_ways = bool(np.any(points.direction < 0) or np.any(points.mount < 0) or both_sides)
    cambered = np.abs(points.gamma) > UPRIGHT.rad
    slipping = np.abs(points.alpha) > STRAIGHT.rad
    driven = ~points.free_rolling
    towards = np.sign(points.alpha)
    return Design(
        loads=len(np.unique(held[held >= 0])),
        pressures=levels.count(points.p, levels.PRESSURE),
        pressure_loads=sum(n > 1 for n in pressures_at),
        cambers=levels.count(np.abs(points.gamma), levels.CAMBER),
        coupled=bool(np.any(cambered & slipping)),
        speeds=levels.count(points.V, levels.SPEED),
        sideslips=levels.count(points.alpha, levels.SIDESLIP),
        slip=bool(np.any(driven)),
        combined=bool(np.any(driven & slipping)),
        side_force=bool(np.any(driven & (slipping | cambered))),
        both_sides=_both_signs(towards[slipping]),
        both_flanks=_both_signs((towards * points.direction * points.mount)[slipping]),
        measured=points.measured,
        curved=curved,
        shifts=both_ways or not curved,
        symmetric=side == "symmetric",
    )


def _both_signs(signs: np.ndarray) -> bool:
    """Whether signs (n,) are positive and negative."""
    return len(np.unique(signs)) > 1


def side_run(points: Points) -> bool:
    """Whether sideslip was run, and to one side only."""
    seen = points.alpha[np.abs(points.alpha) > STRAIGHT.rad]
    return len(np.unique(np.sign(seen))) == 1


def _straight_on(points: Points) -> np.ndarray:
    """Mask (n,) of an upright wheel that rolls freely straight on: radii depend on its load and pressure, stiffnesses do not."""
    upright = np.abs(points.gamma) < UPRIGHT.rad
    straight = (np.abs(points.alpha) < STRAIGHT.rad) & (points.phi_t == 0.0)
    return np.asarray(upright & straight & points.free_rolling)


def coverage(
    points: Points, side: str, by_hand: Collection[str] = (), predicting: Collection[str] = ()
) -> tuple[StageCoverage, ...]:
    """The coverage matrix: per stage the coefficients that are freed and what is missing for the rest.

    Those named in ``by_hand`` are held, whatever the data determine. ``predicting`` are the stages with terms that are free only
    if they predict left-out sweeps better, and do. Stages of longitudinal slip and of channels beside Fy and
    Mz are listed where there are such data.
    """
    seen = design(points, side)
    rows = []
    for stage in STAGES:
        if not _listed(stage, seen):
            continue
        needless = NEEDLESS if stage.if_predicted and stage.name not in predicting else ""
        reasons = {
            name: HELD_BY_HAND if name in by_hand else _missing(BY_NAME[name], seen) or needless
            for name in stage.parameters
        }
        free = tuple(name for name, reason in reasons.items() if not reason)
        held = tuple(name for name, reason in reasons.items() if reason)
        missing = tuple(dict.fromkeys(reason for reason in reasons.values() if reason))
        rows.append(
            StageCoverage(
                stage=stage.name,
                title=stage.title,
                supported=bool(free),
                free=free,
                held=held,
                missing=missing,
                by_hand=tuple(name for name in stage.parameters if name in by_hand),
            )
        )
    return tuple(rows)


def _listed(stage: Stage, seen: Design) -> bool:
    there = set(seen.measured).issuperset(stage.channels) or not stage.where_measured
    return there and (seen.slip or not stage.where_run)


def why_held(name: str, points: Points, side: str) -> str:
    """What the data lack for a coefficient; empty if they determine it, and without a name."""
    return _missing(BY_NAME[name], design(points, side)) if name else ""


def _missing(row: Parameter, seen: Design) -> str:
    """Why these data do not determine the coefficient; empty if they do."""
    if row.channel not in ("", "Fy", *seen.measured):
        return f"{row.channel} was not measured"
    if row.shift and not seen.shifts:
        return (
            "backward runs, flipped mounts or runs on the other side of the disc are missing, "
            "which separate shifts from turn slip"
        )
    if row.odd and seen.symmetric:
        return "the tyre is declared symmetric"
    return next((reason for need in row.needs if (reason := _unmet(need, seen, row))), "")


def _sides(row: Parameter, seen: Design) -> bool:
    """Whether an asymmetry is seen: from both sides, conicity from both flanks; on a disc a small prior decides it."""
    small = seen.curved and row.disc_spread is not None
    return small or seen.both_sides or (row.conicity and seen.both_flanks)


def _unmet(need: Need, seen: Design, row: Parameter) -> str:
    """The sentence about an unmet need of a coefficient; empty if the data meet it."""
    run, sentence = {
        "camber": (seen.cambers - 1, "no camber was run"),
        "coupled": (seen.coupled, "no sweep combines sideslip and camber"),
        "kappa": (seen.slip, "no sweep varies longitudinal slip"),
        "combined": (seen.combined, "no sweep combines longitudinal slip and sideslip"),
        "side_force": (
            seen.side_force,
            "no sweep combines longitudinal slip and side force, from sideslip or camber",
        ),
        "both_sides": (
            _sides(row, seen),
            "sideslip was run to one side only, which does not show how the other one differs: run sideslip of the other sign",
        ),
        "speeds": (seen.speeds, f"{need.levels} speeds are needed, {seen.speeds} run"),
        "sideslips": (seen.sideslips, f"{need.levels} sideslips are needed, {seen.sideslips} run"),
        "curvature": (seen.curved, "the path is straight, so spin is not excited"),
        "loads": (seen.loads, f"{need.levels} loads are needed, {seen.loads} run"),
        "pressures": (seen.pressures, f"{need.levels} pressures are needed, {seen.pressures} run"),
        "pressure_loads": (
            seen.pressure_loads,
            f"pressures were run at {'one load' if seen.pressure_loads else 'different loads'} only, which does not "
            "separate the pressure effect on cornering stiffness from that on the load of its peak",
        ),
    }[need.word]
    return sentence if run < need.levels else ""
