"""The sentences about a plan, for page, terminal and JSON."""

from __future__ import annotations

import math

from mffit.fit.by_hand import HELD_BY_HAND
from mffit.planning import constants
from mffit.planning.goals import BANDS, EPSILON, FILE, JOINT
from mffit.planning.plan import Identified, NextRun, Plan
from mffit.planning.runs import PlannedRun
from mffit.quantities import CONDITIONS, DIRECT
from mffit.rounding import decimals_of

EPS = DIRECT["epsilon_gamma"].ascii
LOAD = CONDITIONS["Fz_N"]


def title(run: PlannedRun) -> str:
    """The run in a few words."""
    more = f", {run.held_deg:g} deg" if run.held_deg else ""
    more += f", {CONDITIONS['p_kPa'].of(run.pressure_kPa)}" if run.pressure_kPa else ""
    return f"{run.addition.title}, {LOAD.of(run.load)}{more}"


def headline(plan: Plan) -> str:
    """The plan in one sentence."""
    if not plan.steps:
        least = f"{100 * constants.WORTHWHILE_FALL:g} %"
        return (
            f"None of the runs tried lowers {plan.goal.label} by {least} or more; it is {shown(plan, plan.now)}. The budget "
            "shows what limits it."
        )
    count = len(plan.steps)
    runs = "1 addition" if count == 1 else f"{count} additions"
    return f"{runs} with {plan.points} points: {plan.goal.label} from {shown(plan, plan.now)} to {shown(plan, plan.then)}."


def measure(plan: Plan | NextRun) -> str:
    """The kind of uncertainty, for headings: u, or a 95 % band."""
    return "95 % band" if plan.goal.kind in (BANDS, FILE) else "u"


def shown(plan: Plan | NextRun, u: float) -> str:
    """An uncertainty of the goal with three digits and its unit."""
    if not math.isfinite(u):
        return "not measured"
    unit = "" if plan.goal.unit in ("", "-") else f" {plan.goal.unit}"
    return f"{u:.{decimals_of(u, 3)}f}{unit}"


def next_sentence(found: NextRun) -> str:
    """The most informative run, and the uncertainty that it would reach."""
    run, step = found.step.run, found.step
    return f"{title(run)}, {run.cost} points: {found.goal.label} from {shown(found, step.before)} to {shown(found, step.after)}"


ESTIMATES = {
    EPSILON: f"{EPS} of the direct method as a build states it%s: its own budget, computed from your points and from the "
    "readings that the fitted rig would give at the new points",
    JOINT: 'PECP1 of the joint fit of tyre and rig (spin.pecp1 = "model"), from its posterior, linearised at the present '
    "solution",
    BANDS: "the 95 % band of the fitted curves on a straight path: rms over the tested sideslip and camber at three loads, from "
    "the posterior, linearised at the present solution",
    FILE: "the 95 % bands of Fx, Fy, Mx and Mz over their largest values: rms over sideslip, camber and slip at three loads, at "
    "which the wheel has been steered, leaned or driven so far. What was not measured counts with its prior",
}
OF_COEFFICIENT = "the standard error in the file, from the posterior, linearised at the present solution"


def promise(plan: Plan) -> str:
    """A sentence on the meaning of the numbers and the estimate for which they hold."""
    kind = plan.goal.kind
    debiased = plan.config.spin.pecp1 == "debiased"
    which = " (debiased, without the line of finite spin)" if debiased else ""
    estimate = ESTIMATES.get(kind, OF_COEFFICIENT).replace("%s", which)
    size = "" if kind in (BANDS, FILE) else " are standard uncertainties (k = 1) and"
    return f"The prediction is for {estimate}. All numbers{size} assume the noise of your present points."


def identified_by_now(plan: Plan) -> list[str]:
    """:func:`identified` of the sweeps of a plan's project."""
    return identified(plan.identified)


def identified(found: Identified) -> list[str]:
    """Sentences on the identifiability by the present sweeps."""
    return [
        *_first_of_all(found),
        *_coverage(found),
        *(
            f"{a} and {b} are strongly correlated ({correlation:+.2f}): only their combination is determined."
            for a, b, correlation in found.correlated
        ),
        *_largest_contribution(found),
    ]


def _coverage(found: Identified) -> list[str]:
    """Per stage, the coefficients that the data determine, those that the prior determines, and the held ones."""
    out = []
    for row in found.cover:
        by_data = [name for name in row.free if name not in found.from_prior]
        by_prior = [name for name in row.free if name in found.from_prior]
        parts = []
        if by_data:
            parts.append(f"determined by the data: {' '.join(by_data)}")
        if by_prior:
            parts.append(f"determined mostly by prior knowledge: {' '.join(by_prior)}")
        if row.by_hand:
            parts.append(f"held by hand: {' '.join(row.by_hand)}")
        invisible = [name for name in row.held if name not in row.by_hand]
        if invisible:
            missing = "; ".join(reason for reason in row.missing if reason != HELD_BY_HAND)
            parts.append(f"not visible: {' '.join(invisible)} ({missing})")
        if parts:
            out.append(f"{row.title}: {'; '.join(parts)}.")
    return out


def _first_of_all(found: Identified) -> list[str]:
    """A sentence on the backward camber sweep, the only run that detects a camber skew; empty if it exists."""
    if found.unseen_skew is None:
        return []
    return [
        "Run first a backward camber sweep at the nominal load, 11 angles: without one, a camber axis out of square by more "
        f"than is declared goes unnoticed, because the fitted camber stiffness imitates it; 1 deg would change {EPS} by "
        f"{found.unseen_skew:.2f}."
    ]


def _largest_contribution(found: Identified) -> list[str]:
    if not found.budget:
        return []
    largest = max(found.budget, key=lambda line: abs(line.contribution))
    return [
        f"The largest contribution to the uncertainty of {EPS} (direct method) is {largest.source}: "
        f"{abs(largest.contribution):.3f}."
    ]
