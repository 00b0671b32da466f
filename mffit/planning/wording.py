"""The sentences about a plan, for page, terminal and JSON: written here and nowhere else."""

from __future__ import annotations

import math

from mffit.diagnosis.constants import SEPARATING_CHI2
from mffit.effects import NAMES
from mffit.planning.goals import BANDS, EPSILON, JOINT, TIE
from mffit.planning.record import Identified, Plan, Step, Tie
from mffit.planning.runs import BETTER, DECLARED, NARROWER, Kind, Run
from mffit.quantities import CONDITIONS, DIRECT

EPS = DIRECT["epsilon_gamma"].ascii
LOAD = CONDITIONS["Fz_N"]

TITLES = {
    Kind.ZEROS: "zeros both ways again",
    Kind.OTHER_SIDE: "zeros both ways on the other side of the disc",
    Kind.OTHER_SIDE_CAMBER: "small cambers on the other side of the disc",
    Kind.SECOND_RADIUS: f"zeros both ways at {NARROWER:g} of the path radius",
    Kind.FLIPPED: "sideslip sweep with the tyre turned on its rim",
    Kind.SMALL_CAMBER: "small cambers, closely spaced",
    Kind.CAMBER: "camber sweep",
    Kind.SIDESLIP: "sideslip sweep",
    Kind.COUPLED: "sideslip sweeps at camber of both signs",
    Kind.LOAD: "sideslip and camber sweep at a new load",
    Kind.PRESSURE: "sideslip and camber sweep at another pressure",
    Kind.REVOLUTION: "one revolution of the disc",
    Kind.CAMBER_ZERO: "better zero of the camber axis",
    Kind.LOADCELL_ZERO: "better zero of the side-force cell",
    Kind.SIDESLIP_ZERO: "better zero of the sideslip axis",
    Kind.PATH_RADIUS: "better path radius",
}
REASONS = {
    Kind.ZEROS: "More points at zero take the noise out of the turn-slip force.",
    Kind.OTHER_SIDE: (
        "The path curves the other way, so the turn-slip force changes sign, while load-cell offset, zeros of the axes, "
        "ply-steer and conicity push as before: half the difference is turn slip alone."
    ),
    Kind.OTHER_SIDE_CAMBER: (
        "Camber and path curvature add on one side of the disc and oppose on the other; zero is among the cambers, so that the "
        "turn-slip force shows as well."
    ),
    Kind.SECOND_RADIUS: (
        "Turn slip grows with the path's curvature; load-cell offset, zeros of the axes and conicity do not."
    ),
    Kind.FLIPPED: "Conicity changes sign with the tyre turned on its rim, everything of the rig stays.",
    Kind.SMALL_CAMBER: "The camber stiffness is the slope at zero; cambers up to 20 deg decide it.",
    Kind.CAMBER: "More points over camber, for the camber stiffness and the shape of the camber force.",
    Kind.SIDESLIP: "More points over sideslip, for cornering stiffness, peak and trail.",
    Kind.COUPLED: "What camber does to the curves over sideslip shows only where both angles act together.",
    Kind.LOAD: "What changes with load is known better the farther the loads are apart.",
    Kind.PRESSURE: "What pressure does shows at two pressures, and at two loads whether it acts on the stiffness or on its load.",
    Kind.REVOLUTION: f"Without an effective radius there is no {EPS}.",
    Kind.CAMBER_ZERO: f"A camber that is not zero pushes like turn slip; it is often the largest line of the budget of {EPS}.",
    Kind.LOADCELL_ZERO: "A side-force cell that does not read zero unloaded adds to the turn-slip force.",
    Kind.SIDESLIP_ZERO: "A geometric zero of the steering tells misalignment from ply-steer, which no run on one rig does.",
    Kind.PATH_RADIUS: "The curvature of the path is known as well as its radius.",
}


def title(run: Run) -> str:
    """The run in a few words."""
    if run.kind in DECLARED:
        (value,) = run.rig.values()
        return f"{TITLES[run.kind]}, known to {value:.2g} {DECLARED[run.kind].unit}"
    more = f", {run.camber_deg:g} deg" if run.camber_deg else ""
    more += f", {CONDITIONS['p_kPa'].of(run.pressure_kPa)}" if run.pressure_kPa else ""
    return f"{TITLES[run.kind]}, {LOAD.of(run.load)}{more}"


def reason(run: Run) -> str:
    """Why it helps."""
    return REASONS[run.kind]


def effort(run: Run) -> str:
    """What it costs."""
    return f"{run.cost} points" if run.cost else "a measurement"


def headline(plan: Plan) -> str:
    """The plan in one sentence."""
    if not plan.steps:
        return (
            f"No run in the list lowers {plan.goal.label}, which is {shown(plan, plan.now)}, by 5 % or more: look at the "
            f"budget and the ties for what holds it.{_reached(plan)}"
        )
    count = len(plan.steps)
    runs = "1 addition" if count == 1 else f"{count} additions"
    cost = f" with {plan.points} points" if plan.points else ""
    return f"{runs}{cost}: {plan.goal.label} from {shown(plan, plan.now)} to {shown(plan, plan.then)}.{_reached(plan)}"


def _reached(plan: Plan) -> str:
    """Whether a tie is broken by the whole list; empty for other goals."""
    if plan.told_below is None:
        return ""
    below = f"below {shown(plan, plan.told_below)}"
    if plan.now < plan.told_below:
        return f" It is told apart already, which is so {below}."
    if plan.then < plan.told_below:
        return f" That tells it apart, which is so {below}."
    return f" The tie stays: told apart would be {below}."


def measure(plan: Plan) -> str:
    """What the goal's number is, for headings: a band is no standard uncertainty."""
    return "95 % band" if plan.goal.kind == BANDS else "u"


def shown(plan: Plan, u: float) -> str:
    """An uncertainty of the goal with its unit."""
    if not math.isfinite(u):
        return "not measured"
    unit = "" if plan.goal.unit in ("", "-") else f" {plan.goal.unit}"
    return f"{u:.3g}{unit}"


def promise(plan: Plan) -> str:
    """What the numbers mean, and for which estimate they hold."""
    estimate = {
        EPSILON: (
            f"The promise is for {EPS} of the direct method as a build states it"
            + (" (debiased, without the line of finite spin)" if plan.config.spin.pecp1 == "debiased" else "")
            + ": its own budget, computed on your points and on what the rig, as the fit found it, would read in the new ones."
        ),
        JOINT: (
            'The promise is for PECP1 decided by the joint fit of tyre and rig (spin.pecp1 = "model"), from its posterior, '
            "linear around the present solution."
        ),
        BANDS: (
            "The promise is for the 95 % band of the fitted curves on a straight path, over the tested sideslip and camber at "
            "three loads, rms; from the posterior, linear around the present solution."
        ),
        TIE: (
            f"The promise is for {NAMES.get(plan.goal.name, plan.goal.name)} from the data, beside everything that is fitted "
            f"and with the effects that it is confused with free; told apart where it is below {_third(plan)}."
        ),
    }.get(
        plan.goal.kind,
        "The promise is for the standard error in the file, from the posterior, linear around the present solution.",
    )
    size = "" if plan.goal.kind == BANDS else " one standard deviation (k = 1),"
    return f"{estimate} All numbers are{size} at the noise that your points have now."


def _third(plan: Plan) -> str:
    return (
        f"a third of its usual size, {shown(plan, plan.told_below)}"
        if plan.told_below
        else "a third of its usual size"
    )


def estimates(plan: Plan) -> str:
    """Both uncertainties of eps_gamma, now and after the list; empty without a disc."""
    if plan.joint_now is None and plan.direct_now is None and not any(step.direct for step in plan.steps):
        return ""
    last: Step | None = plan.steps[-1] if plan.steps else None
    pairs = [
        ("direct method", plan.direct_now, last.direct if last else None),
        ("joint fit", plan.joint_now, last.joint if last else None),
    ]
    said = [
        f"{name} {_u(now)}" + (f" -> {_u(then)}" if last is not None else "") for name, now, then in pairs
    ]
    return f"u({EPS}): {'; '.join(said)}."


def _u(u: float | None) -> str:
    return "not measured" if u is None else f"{u:.3g}"


def identified(found: Identified) -> list[str]:
    """What the sweeps identify, in words."""
    out = []
    tied = set(found.tied)
    for row in found.cover:
        decided = [name for name in row.free if name not in tied]
        near = [name for name in row.free if name in tied]
        said = []
        if decided:
            said.append(f"decided by the data: {' '.join(decided)}")
        if near:
            said.append(f"hardly more than what was known before: {' '.join(near)}")
        if row.held:
            said.append(f"not seen: {' '.join(row.held)} ({'; '.join(row.missing)})")
        if said:
            out.append(f"{row.title}: {'; '.join(said)}.")
    for a, b, correlation in found.correlated:
        out.append(
            f"{a} and {b} trade places (correlation {correlation:+.2f}): only together do they mean something."
        )
    out += [tie(pair) for pair in found.ties if not pair.told]
    told = [f"{NAMES[t.effect]} from {NAMES[t.other]}" for t in found.ties if t.told]
    if told:
        out.append(f"Told apart, at their usual size: {'; '.join(told)}.")
    if found.budget:
        largest = max(found.budget, key=lambda line: abs(line.contribution))
        out.append(
            f"Most of the uncertainty of {EPS} (direct method) is {largest.source}: {abs(largest.contribution):.3f}."
        )
    return out


def tie(pair: Tie) -> str:
    """Two effects that the sweeps do not tell apart."""
    return (
        f"Not told apart: {NAMES[pair.effect]} and {NAMES[pair.other]} (expected chi2 {pair.chi2:.1f} between them, "
        f"{SEPARATING_CHI2:g} would do)."
    )


def instructions(run: Run) -> list[str]:
    """Lines for tyre.toml, without the readings."""
    if run.rig:
        share = f"{BETTER:.2g} of what is declared now"
        # As comments: tyre.toml has its [rig] already, and a table stands in a file once.
        return [f"# change in [rig]: {key} = {value:.3g} ({share})" for key, value in run.rig.items()]
    if run.revolution is not None:
        return [
            "[[rolling_radius]]",
            f"load_N = {run.load:.0f}",
            "# revolutions, angle_start_deg, angle_end_deg",
        ]
    return []
