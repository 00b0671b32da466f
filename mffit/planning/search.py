"""The shortest list of runs towards a goal: greedy, each step takes the run that lowers the uncertainty most."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from itertools import combinations

from mffit.config import Config
from mffit.fit import FitResult
from mffit.measured import Measured
from mffit.planning import constants
from mffit.planning.additions import Addition
from mffit.planning.goals import Goal
from mffit.planning.identified import identified
from mffit.planning.outlook import Direct, Outlook
from mffit.planning.record import Plan, PlanStep, Trial
from mffit.planning.runs import PlannedRun, candidates
from mffit.points import Points
from mffit.progress import Progress, silent


def plan(
    config: Config,
    points: Points,
    measured: Measured,
    found: FitResult,
    goal: Goal,
    direct: Direct,
    *,
    most: int = 3,
    without: Collection[Addition] = (),
    progress: Progress = silent,
) -> Plan:
    """What these points identify, and the runs that lower the goal's uncertainty most.

    Parameters
    ----------
    config : what is declared of tyre and rig
    points : the programme so far, with readings
    measured, found : the build of these points
    goal : the number whose uncertainty is to fall
    direct : the direct method's own u(eps_gamma), as a build would state it
    most : largest number of runs in the list
    without : additions that this rig cannot make
    progress : called with a sentence before each step
    """
    outlook = Outlook(config, points, measured, found, goal, direct)
    r_e = float(found.tyre.state(config.tyre.nominal_load).Re) if config.rig.on_disc else None
    possible = [run for run in candidates(config, points, r_e) if most and run.addition not in without]
    progress(f"trying {len(possible)} runs one by one")
    trials = sorted((Trial(run, outlook.u([run])) for run in possible), key=lambda trial: trial.u)
    chosen = _without_superfluous(outlook, _chosen(outlook, possible, most, progress))
    steps = [
        PlanStep(run, outlook.u(chosen[:k]), outlook.u(chosen[: k + 1]), *outlook.epsilons(chosen[: k + 1]))
        for k, run in enumerate(chosen)
    ]
    direct_now, joint_now = outlook.epsilons([])
    return Plan(
        config=config,
        goal=goal,
        identified=identified(outlook.knowledge, found, measured),
        now=outlook.u([]),
        direct_now=direct_now,
        joint_now=joint_now,
        steps=tuple(steps),
        trials=tuple(trials),
        told_below=outlook.told_below,
    )


def _chosen(
    outlook: Outlook, possible: Sequence[PlannedRun], most: int, progress: Progress
) -> list[PlannedRun]:
    """Up to ``most`` runs, in the order in which they were found."""
    chosen: list[PlannedRun] = []
    while len(chosen) < most:
        progress(f"looking for run {len(chosen) + 1}")
        left = [run for run in possible if run not in chosen]
        more = _best(outlook, chosen, [[run] for run in left])
        if not more and len(chosen) + 1 < most:  # some runs help only in pairs, like pressures at two loads
            more = _best(outlook, chosen, _pairs(left))
        if not more:
            break
        chosen += more
    return chosen


def _best(
    outlook: Outlook, chosen: Sequence[PlannedRun], possible: Sequence[Sequence[PlannedRun]]
) -> Sequence[PlannedRun]:
    """The best choice of one or several runs to add; empty if none lowers the uncertainty enough."""
    if not possible:
        return ()
    after = [outlook.u([*chosen, *more]) for more in possible]
    least = min(after)
    if not least < (1.0 - constants.WORTHWHILE_FALL) * outlook.u(chosen):
        return ()
    equally_good = [
        (sum(run.cost for run in more), u, k)
        for k, (more, u) in enumerate(zip(possible, after, strict=True))
        if u <= (1.0 + constants.EQUALLY_GOOD) * least
    ]
    return possible[min(equally_good)[2]]


def _pairs(possible: Sequence[PlannedRun]) -> list[tuple[PlannedRun, PlannedRun]]:
    """Pairs of runs of one kind at different loads."""
    return [(a, b) for a, b in combinations(possible, 2) if a.addition is b.addition and a.load != b.load]


def _without_superfluous(outlook: Outlook, chosen: Sequence[PlannedRun]) -> list[PlannedRun]:
    """The list without runs whose information later runs supply as well."""
    kept = list(chosen)
    for run in chosen:
        fewer = [other for other in kept if other is not run]
        limit = (1.0 + constants.EQUALLY_GOOD) * outlook.u(kept)
        if len(kept) > 1 and outlook.u(fewer) <= limit:
            kept = fewer
    return kept
