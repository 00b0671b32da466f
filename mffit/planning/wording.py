"""The sentences about a plan, for page, terminal and JSON."""

import math
from typing import NamedTuple

from mffit.additions import BY_ID
from mffit.additions.constants import WORTHWHILE_FALL
from mffit.fit.by_hand import HELD_BY_HAND
from mffit.planning.goals import BANDS, EPSILON, FILE, JOINT, ROAD
from mffit.planning.plan import Identified, NextRun, Plan
from mffit.quantities import DIRECT
from mffit.rounding import decimals_of
from tir.errors import counted

EPS = DIRECT["epsilon_gamma"].ascii
BACKWARD_CAMBER = BY_ID["backward-camber"]


def headline(plan: Plan) -> str:
    """The plan in one sentence."""
    if not plan.steps:
        limited = " The budget shows what limits it." if plan.identified.budget else ""
        return (
            f"{plan.goal.label}: {shown(plan, plan.now)}. None of the runs tried lowers it by {100 * WORTHWHILE_FALL:g} % or "
            f"more.{limited}"
        )
    runs, points = counted(len(plan.steps), "addition"), counted(plan.points, "point")
    return (
        f"{runs} with {points}: {plan.goal.label} from {shown(plan, plan.now)} to {shown(plan, plan.then)}."
    )


def measure(plan: Plan | NextRun) -> str:
    """The kind of uncertainty, for headings: u, or a 95 % band."""
    return "95 % band" if plan.goal.kind in (BANDS, FILE, ROAD) else "u"


def shown(plan: Plan | NextRun, u: float) -> str:
    """An uncertainty of the goal with three digits and its unit."""
    if not math.isfinite(u):
        return "not measured"
    unit = "" if plan.goal.unit in ("", "-") else f" {plan.goal.unit}"
    return f"{u:.{decimals_of(u, 3)}f}{unit}"


def next_sentence(found: NextRun) -> str:
    """The most informative run, and the uncertainty that it would reach."""
    run, step = found.step.run, found.step
    return f"{run.title}, {run.cost} points: {found.goal.label} from {shown(found, step.before)} to {shown(found, step.after)}"


ESTIMATES = {
    EPSILON: f"{EPS} of the direct method as a build states it%s: its own budget, computed from your points and from the "
    "readings that the fitted rig would give at the new points",
    JOINT: 'PECP1 of the joint fit of tyre and rig (spin.pecp1 = "model"), from its posterior, linearised at the present '
    "solution",
    BANDS: "the 95 % band of the fitted curves on a straight path: rms over the tested sideslip and camber at three loads, from "
    "the posterior, linearised at the present solution",
    FILE: "the 95 % bands of Fx, Fy, Mx and Mz over their largest values: rms over sideslip, camber and slip at three loads, at "
    "which the wheel has been steered, leaned or driven so far. What was not measured counts with its prior",
    ROAD: "the 95 % bands of Fy and Mz over their largest values on a straight path at nominal load, as `mffit predict` states "
    "them: rms over the tested sideslip, upright and leaned, with what the formula misses, linearised at the present solution",
}
OF_COEFFICIENT = "the standard error in the file, from the posterior, linearised at the present solution"


def promise(plan: Plan) -> str:
    """A sentence on the meaning of the numbers and the estimate for which they hold."""
    kind = plan.goal.kind
    debiased = plan.config.spin.pecp1 == "debiased"
    which = " (debiased, without the line of finite spin)" if debiased else ""
    estimate = ESTIMATES.get(kind, OF_COEFFICIENT).replace("%s", which)
    size = "" if kind in (BANDS, FILE, ROAD) else " are standard uncertainties (k = 1) and"
    return f"The prediction is for {estimate}. All numbers{size} assume the noise of your present points."


class StageStatus(NamedTuple):
    """Coefficients of a stage of the fit, by what determines them."""

    title: str
    by_data: tuple[str, ...]
    jointly: tuple[str, ...]  #: only in combination with another coefficient
    by_prior: tuple[str, ...]  #: as much by prior knowledge as by the data
    by_hand: tuple[str, ...]
    invisible: tuple[str, ...]  #: not moved by the data
    missing: str  #: what the data lack for these; empty without them


STATUSES = {
    "by_data": "determined by the data",
    "jointly": "determined only in combination",
    "by_prior": "determined mostly by prior knowledge",
    "by_hand": "held by hand",
    "invisible": "not visible",
}
"""The statuses of a stage in words."""


def statuses(found: Identified) -> dict[str, str]:
    """The statuses that any stage has, in words."""
    return {key: said for key, said in STATUSES.items() if any(getattr(row, key) for row in stages(found))}


def stages(found: Identified) -> list[StageStatus]:
    """The stages that have coefficients."""
    in_pairs = {name for *pair, _ in found.correlated for name in pair}
    rows = []
    for row in found.cover:
        invisible = tuple(name for name in row.held if name not in row.by_hand)
        missing = "; ".join(reason for reason in row.missing if reason != HELD_BY_HAND) if invisible else ""
        by_prior = tuple(name for name in row.free if name in found.from_prior)
        jointly = tuple(name for name in row.free if name in in_pairs - {*by_prior})
        by_data = tuple(name for name in row.free if name not in {*by_prior, *jointly})
        if row.free or row.by_hand or invisible:
            rows.append(
                StageStatus(row.title, by_data, jointly, by_prior, tuple(row.by_hand), invisible, missing)
            )
    return rows


def identified_by_now(plan: Plan) -> list[str]:
    """Sentences on the identifiability by the sweeps of a plan's project."""
    return [*remarks(plan), *map(_of_stage, stages(plan.identified))]


def remarks(plan: Plan) -> list[str]:
    """What the matrix of stages does not say: errors that no run shows yet, correlations, the largest contribution."""
    found = plan.identified
    pairs = [f"{a} and {b} ({correlation:+.2f})" for a, b, correlation in found.correlated]
    only = "Only the combination of these is determined, as they are strongly correlated: "
    return [
        *_unseen_skew(plan),
        *([f"{only}{', '.join(pairs)}."] if pairs else []),
        *_largest_contribution(found),
    ]


def _of_stage(row: StageStatus) -> str:
    """A stage as a sentence."""
    parts = [f"{said}: {' '.join(names)}" for key, said in STATUSES.items() if (names := getattr(row, key))]
    return f"{row.title}: {'; '.join(parts)}{f' ({row.missing})' if row.missing else ''}."


def _unseen_skew(plan: Plan) -> list[str]:
    """A sentence on the only run that detects a camber skew, and its place in the list; empty if it exists."""
    if plan.identified.unseen_skew is None:
        return []
    places = [k for k, step in enumerate(plan.steps, 1) if step.run.addition is BACKWARD_CAMBER]
    only = f"Only a {BACKWARD_CAMBER.title} shows it: {f'run {places[0]}' if places else 'none'} of the list."
    return [
        "A camber axis out of square by more than is declared goes unnoticed so far, because the fitted camber stiffness "
        f"imitates it; 1 deg would change {EPS} by {plan.identified.unseen_skew:.2f}. {only}"
    ]


def _largest_contribution(found: Identified) -> list[str]:
    if not found.budget:
        return []
    largest = max(found.budget, key=lambda line: abs(line.contribution))
    return [
        f"The largest contribution to the uncertainty of {EPS} (direct method) is {largest.source}: "
        f"{abs(largest.contribution):.3f}."
    ]
