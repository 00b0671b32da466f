"""Coefficients that the data determine, and the data that the other coefficients need."""

from collections.abc import Collection, Mapping
from dataclasses import dataclass

import numpy as np

from mffit.as_json import keys
from mffit.constants import STRAIGHT, UPRIGHT
from mffit.fit.by_hand import HELD_BY_HAND
from mffit.fit.stages import STAGES, Stage
from mffit.points import Points, levels
from tir.frozen import ReadOnlyArrays
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
    "camber": "no camber was run{among}",
    "coupled": "no sweep combines sideslip and camber",
    "kappa": "no sweep varies longitudinal slip",
    "combined": "longitudinal slip was run at one sideslip only, which does not show how it falls with sideslip",
    "side_force": "no sweep combines longitudinal slip and side force, from sideslip or camber",
    "both_sides": "sideslip was run to one side only, which does not show how the other one differs: run sideslip of the other "
    "sign",
    "speeds": "{needed} speeds are needed{among}, {run} run",
    "sideslips": "{needed} sideslips are needed, {run} run",
    "curvature": "the path is straight, so spin is not excited",
    "loads": "{needed} loads are needed{among}, {run} run",
    "pressures": "{needed} pressures are needed{among}, {run} run",
    "pressure_loads": "pressures were run at {where} only, which does not separate the pressure effect on cornering stiffness "
    "from that on the load of its peak",
}
"""By a need's word in the parameter table, the sentence that says that the data do not meet it."""
ACTS = {
    "combined": "longitudinal slip under sideslip",
    "side_force": "longitudinal slip under side force",
    "kappa": "longitudinal slip",
    "coupled": "sideslip and camber",
    "camber": "camber",
    "sideslips": "sideslip",
}
"""Needs without which a coefficient does not act, in words; the other settings count only where these are met."""
CHANGES = ("camber", "both_sides")
"""Needs of a second level, which is counted as one."""


@dataclass(frozen=True, eq=False)
class Design(ReadOnlyArrays):
    """The properties of the test plan that decide which coefficients are identifiable."""

    run: Mapping[str, int]
    """By need of the parameter table, the number of levels that were run; 0 or 1 for needs without levels."""
    met: Mapping[str, np.ndarray]  #: mask (n,) of the readings that meet a need of :data:`ACTS`
    level: Mapping[str, np.ndarray]  #: by need, label (n,) of the level of its setting
    both_flanks: bool  #: sideslip towards both flanks of the tyre: to both sides, or with the tyre turned on its rim or backwards
    measured: tuple[str, ...]  #: channels with readings
    shifts: bool  #: odd shift terms are separable: flat track, or disc with backward runs, flipped mounts or both sides
    symmetric: bool

    def levels_among(self, setting: str, words: Collection[str]) -> int:
        """Number of levels of a setting among the readings that meet all needs ``words``."""
        rows = np.logical_and.reduce([self.met[word] for word in words])
        return _count(self.level[setting][rows])


def design(points: Points, side: str) -> Design:
    """The test plan of a tyre of this side."""
    curved = bool(np.any(points.phi_t != 0.0))
    both_ways = bool(
        np.any(points.direction < 0) or np.any(points.mount < 0) or _differ(np.sign(points.phi_t))
    )
    cambered = np.abs(points.gamma) > UPRIGHT.rad
    slipping = np.abs(points.alpha) > STRAIGHT.rad
    driven, towards = ~points.free_rolling, np.sign(points.alpha)
    level = {
        "loads": levels.labels_of_setting(points, "Fz"),
        "pressures": levels.nearest_labels(points.p, levels.PRESSURE),
        "camber": levels.nearest_labels(np.abs(points.gamma), levels.CAMBER),
        "speeds": levels.nearest_labels(points.V, levels.SPEED),
        "both_sides": np.where(slipping, (points.alpha > 0.0).astype(int), levels.NO_LEVEL),
    }
    met = {
        "combined": driven & slipping,
        "side_force": driven & (slipping | cambered),
        "kappa": driven,
        "coupled": cambered & slipping,
        "camber": cambered,
        "sideslips": slipping,
    }
    # Points without sideslip show radii, not stiffnesses, so their pressures do not count here.
    load = np.where(slipping, level["loads"], levels.NO_LEVEL)
    pressures_at = [_count(level["pressures"][load == k]) for k in np.unique(load[load >= 0])]
    run: dict[str, float | np.bool_] = {
        **{word: np.any(rows) for word, rows in met.items()},
        **{word: _count(own) - (word in CHANGES) for word, own in level.items()},
        "pressure_loads": sum(n > 1 for n in pressures_at),
        "sideslips": levels.count(points.alpha, levels.SIDESLIP),
        "combined": levels.count(np.abs(points.alpha[driven]), levels.SIDESLIP) - 1 if np.any(driven) else 0,
        "curvature": curved,
    }
    return Design(
        run={word: int(count) for word, count in run.items()},
        met=met,
        level=level,
        both_flanks=_differ((towards * points.direction * points.mount)[slipping]),
        measured=points.measured,
        shifts=both_ways or not curved,
        symmetric=side == "symmetric",
    )


def _count(label: np.ndarray) -> int:
    """Number of different levels among the labels (n,)."""
    return len(np.unique(label[label != levels.NO_LEVEL]))


def _differ(values: np.ndarray) -> bool:
    """Whether values (n,) differ."""
    return len(np.unique(values)) > 1


def side_run(points: Points) -> bool:
    """Whether sideslip was run to exactly one side."""
    seen = points.alpha[np.abs(points.alpha) > STRAIGHT.rad]
    return len(np.unique(np.sign(seen))) == 1


UNSEEN = (
    "the formula misses these readings, and they do not tell an asymmetry from what it misses of turn slip: run more of the "
    "other side of the disc"
)
"""Why asymmetries of a tyre are held of which a disc shows nothing beside the model error."""


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
    run: Mapping[str, int]
    for run, among in ((seen.run, ""), _among(row, seen)):
        for need in row.needs:
            met = run[need.word] >= need.levels or (need.word == "both_sides" and _side_known(row, seen))
            if not met:
                own = run[need.word]
                where = "one load" if own else "different loads"
                return LACKING[need.word].format(needed=need.levels, run=own, where=where, among=among)
    return ""


def _among(row: Parameter, seen: Design) -> tuple[Mapping[str, int], str]:
    """The levels that were run where a coefficient acts, and the words for that: readings elsewhere show other effects."""
    words = [word for word in ACTS if any(need.word == word for need in row.needs)]
    run = dict(seen.run)
    for need in row.needs:
        of = [word for word in words if word != need.word]
        if need.word in seen.level and of and (need.word not in CHANGES or row.of_slip):
            run[need.word] = seen.levels_among(need.word, of) - (need.word in CHANGES)
    return run, f" with {ACTS[words[0]]}" if words else ""


def _side_known(row: Parameter, seen: Design) -> bool:
    """Whether a coefficient of asymmetry is determined although sideslip was run to one side only.

    On a disc its prior is narrow; elsewhere, conicity is determined if sideslip was run towards both flanks of the tyre.
    """
    small = bool(seen.run["curvature"]) and row.disc_spread is not None
    return small or (row.conicity and seen.both_flanks)
