"""Coefficients that the data determine, and the data that the other coefficients need."""

from collections.abc import Collection, Mapping
from dataclasses import dataclass

import numpy as np

from mffit.as_json import keys
from mffit.constants import STRAIGHT, UPRIGHT
from mffit.fit.by_hand import HELD_BY_HAND
from mffit.fit.stages import STAGES, Stage
from mffit.points import Points, levels
from tir.parameters import BY_NAME, Parameter


@dataclass(frozen=True, slots=True)
class StageCoverage:
    """One row of the coverage matrix."""

    stage: str
    title: str
    supported: bool
    free: tuple[str, ...]
    held: tuple[str, ...]
    missing: tuple[str, ...]  #: why coefficients are held, as sentences
    by_hand: tuple[str, ...] = ()  #: coefficients that the engineer holds


keys(StageCoverage, "stage supported held missing")


LACKING = {
    "camber": "no camber was run",
    "coupled": "no sweep combines sideslip and camber",
    "kappa": "no sweep varies longitudinal slip",
    "combined": "longitudinal slip was run at one sideslip only, which does not show how it falls with sideslip",
    "side_force": "no sweep combines longitudinal slip and side force, from sideslip or camber",
    "both_sides": "sideslip was run to one side only, which does not show how the other one differs: run sideslip of the other "
    "sign",
    "speeds": "{needed} speeds are needed, {run} run",
    "sideslips": "{needed} sideslips are needed, {run} run",
    "curvature": "the path is straight, so spin is not excited",
    "loads": "{needed} loads are needed, {run} run",
    "pressures": "{needed} pressures are needed, {run} run",
    "pressure_loads": "pressures were run at {where} only, which does not separate the pressure effect on cornering stiffness "
    "from that on the load of its peak",
}
"""By a need's word in the parameter table, the sentence that says that the data do not meet it."""


@dataclass(frozen=True, slots=True)
class Design:
    """The properties of the test plan that decide which coefficients are identifiable."""

    run: Mapping[str, int]
    """By need of the parameter table, the number of levels that were run; 0 or 1 for needs without levels."""
    driven: Mapping[
        str, int
    ]  #: the same at points with longitudinal slip, for needs that can be met without it
    both_flanks: bool  #: sideslip towards both flanks of the tyre: to both sides, or with the tyre turned on its rim or backwards
    measured: tuple[str, ...]  #: channels with readings
    shifts: bool  #: odd shift terms are separable: flat track, or disc with backward runs, flipped mounts or both sides
    symmetric: bool


def design(points: Points, side: str) -> Design:
    """The test plan of a tyre of this side."""
    curved = bool(np.any(points.phi_t != 0.0))
    held = levels.labels_of_setting(points, "Fz")
    # Points of an upright wheel rolling straight show radii, not stiffnesses, so their pressures do not count here.
    load = np.where(_straight_on(points), levels.NO_LEVEL, held)
    pressures_at = [levels.count(points.p[load == k], levels.PRESSURE) for k in np.unique(load[load >= 0])]
    both_ways = bool(
        np.any(points.direction < 0) or np.any(points.mount < 0) or _differ(np.sign(points.phi_t))
    )
    cambered = np.abs(points.gamma) > UPRIGHT.rad
    slipping = np.abs(points.alpha) > STRAIGHT.rad
    driven, towards = ~points.free_rolling, np.sign(points.alpha)

    def anywhere(rows: np.ndarray) -> dict[str, int]:
        """The needs that points (n,) of a mask meet, whatever else differs between them."""
        return {
            "loads": len(np.unique(held[rows & (held >= 0)])),
            "pressures": levels.count(points.p[rows], levels.PRESSURE),
            "camber": levels.count(np.abs(points.gamma[rows]), levels.CAMBER) - 1,
            "both_sides": int(_differ(towards[rows & slipping])),
        }

    run: dict[str, float | np.bool_] = {
        **anywhere(np.ones(len(points), dtype=bool)),
        "pressure_loads": sum(n > 1 for n in pressures_at),
        "coupled": np.any(cambered & slipping),
        "speeds": levels.count(points.V, levels.SPEED),
        "sideslips": levels.count(points.alpha, levels.SIDESLIP),
        "kappa": np.any(driven),
        "combined": levels.count(np.abs(points.alpha[driven]), levels.SIDESLIP) - 1 if np.any(driven) else 0,
        "side_force": np.any(driven & (slipping | cambered)),
        "curvature": curved,
    }
    return Design(
        run={word: int(count) for word, count in run.items()},
        driven=anywhere(driven) if np.any(driven) else {},
        both_flanks=_differ((towards * points.direction * points.mount)[slipping]),
        measured=points.measured,
        shifts=both_ways or not curved,
        symmetric=side == "symmetric",
    )


def _differ(values: np.ndarray) -> bool:
    """Whether values (n,) differ."""
    return len(np.unique(values)) > 1


def side_run(points: Points) -> bool:
    """Whether sideslip was run to exactly one side."""
    seen = points.alpha[np.abs(points.alpha) > STRAIGHT.rad]
    return len(np.unique(np.sign(seen))) == 1


UNSEEN = (
    "the formula misses these readings, and they do not tell an asymmetry from what it misses of turn slip: run more of the "
    "other side of the disc, or the tyre turned on its rim"
)
"""Why asymmetries of a tyre are held of which a disc shows nothing beside the model error."""


def _straight_on(points: Points) -> np.ndarray:
    """Mask (n,) of the points at which the upright wheel rolls freely on a straight path without sideslip."""
    upright = np.abs(points.gamma) < UPRIGHT.rad
    straight = (np.abs(points.alpha) < STRAIGHT.rad) & (points.phi_t == 0.0)
    return np.asarray(upright & straight & points.free_rolling)


def coverage(points: Points, side: str, by_hand: Collection[str] = ()) -> tuple[StageCoverage, ...]:
    """The coverage matrix: per stage the free coefficients, the held ones, and the reason why each is held.

    Coefficients named in ``by_hand`` are always held. Stages of longitudinal slip and of channels other than Fy and Mz are
    listed only if there are such data.
    """
    seen = design(points, side)
    rows = []
    for stage in STAGES:
        if not _listed(stage, seen):
            continue
        reasons = {
            name: HELD_BY_HAND if name in by_hand else _missing(BY_NAME[name], seen)
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
    return there and (bool(seen.run["kappa"]) or not stage.where_run)


def why_held(name: str, points: Points, side: str) -> str:
    """What the data lack for a coefficient; empty if they determine it or if ``name`` is empty."""
    return _missing(BY_NAME[name], design(points, side)) if name else ""


def _missing(row: Parameter, seen: Design) -> str:
    """Why these data do not determine a coefficient; empty if they do."""
    if row.channel not in ("", "Fy", *seen.measured):
        return f"{row.channel} was not measured"
    if row.shift and not seen.shifts:
        return (
            "backward runs, flipped mounts or runs on the other side of the disc are missing, "
            "which separate shifts from turn slip"
        )
    if row.odd and seen.symmetric:
        return "the tyre is declared symmetric"
    driven = seen.driven if {"kappa", "combined", "side_force"} & {need.word for need in row.needs} else {}
    for need in row.needs:
        run = min(seen.run[need.word], driven.get(need.word, seen.run[need.word]))
        if run < need.levels and not (need.word == "both_sides" and _side_known(row, seen)):
            among = "with longitudinal slip, " if run < seen.run[need.word] else ""
            return among + LACKING[need.word].format(
                needed=need.levels, run=run, where="one load" if run else "different loads"
            )
    return ""


def _side_known(row: Parameter, seen: Design) -> bool:
    """Whether a coefficient of asymmetry is determined although sideslip was run to one side only.

    On a disc its prior is narrow; elsewhere, conicity is determined if sideslip was run towards both flanks of the tyre.
    """
    small = bool(seen.run["curvature"]) and row.disc_spread is not None
    return small or (row.conicity and seen.both_flanks)
