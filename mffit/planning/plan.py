"""Identifiability by the present sweeps, and a short list of runs: each step takes the run that lowers the uncertainty most."""

from collections.abc import Callable, Collection, Sequence
from dataclasses import dataclass
from itertools import combinations

from mffit.additions import Addition, PlannedRun, candidates
from mffit.additions.constants import WORTHWHILE_FALL
from mffit.as_json import keys
from mffit.brief import Brief
from mffit.config import Config
from mffit.fit import FitResult
from mffit.fit.coverage import StageCoverage
from mffit.measured import Contribution, Measured, adding_to_camber
from mffit.planning.goals import Goal
from mffit.planning.prospect import Prospect
from mffit.points import Points
from mffit.progress import Progress, silent

U = Callable[[Sequence[PlannedRun]], float]
"""Returns the uncertainty of the goal after some runs."""


@dataclass(frozen=True, slots=True)
class Identified:
    """Identifiability of the coefficients by the present sweeps."""

    cover: tuple[StageCoverage, ...]  #: per stage: free coefficients, held ones and why
    from_prior: tuple[str, ...]  #: free coefficients that depend on their priors as much as on the data
    correlated: tuple[tuple[str, str, float], ...]  #: pairs of coefficients with strong correlations
    budget: tuple[Contribution, ...]  #: of eps_gamma by the direct method; empty on a flat track
    unseen_skew: float | None = None
    """Change of eps_gamma by a camber skew of 1 deg; None if backward camber sweeps measure the skew."""


@dataclass(frozen=True, slots=True)
class PlanStep:
    """A run, either in the list or alone, and its effect on the uncertainty."""

    run: PlannedRun
    before: float  #: uncertainty of the goal without the run, in the unit of the goal
    after: float  #: uncertainty of the goal with the run


keys(PlanStep, "**run u_before=before u_after=after")


@dataclass(frozen=True, slots=True)
class NextRun:
    """The run that lowers the uncertainty of a goal most."""

    goal: Goal
    step: PlanStep


@dataclass(frozen=True, slots=True)
class Plan(Brief):
    """The answer of ``mffit plan``."""

    config: Config
    goal: Goal
    identified: Identified
    now: float  #: present uncertainty of the goal; infinite if it is not measured
    steps: tuple[PlanStep, ...]  #: the list of runs, in order
    trials: tuple[PlanStep, ...]  #: every candidate alone, best first

    @property
    def then(self) -> float:
        """Uncertainty of the goal once all runs of the list are made."""
        return self.steps[-1].after if self.steps else self.now

    @property
    def helpful(self) -> tuple[PlanStep, ...]:
        """The candidates that lower the uncertainty of the goal, each alone."""
        return tuple(trial for trial in self.trials if trial.after < self.now)

    @property
    def points(self) -> int:
        """Points of the whole list."""
        return sum(step.run.cost for step in self.steps)


keys(
    Plan,
    "goal headline promise identified u_now=now u_then=then runs=steps alone=trials",
    headline="mffit.planning.wording.headline",
    promise="mffit.planning.wording.promise",
    identified="mffit.planning.wording.identified_by_now",
)


def plan(
    prospect: Prospect,
    goal: Goal,
    *,
    most: int = 3,
    without: Collection[Addition] = (),
    progress: Progress = silent,
) -> Plan:
    """Identifiability by the points of a build, and the runs that lower the goal's uncertainty most.

    The list has at most ``most`` runs; ``without`` are the additions that this rig cannot run.
    """
    config = prospect.config
    u = prospect.u_of(goal)
    possible = [
        run
        for run in candidates(config, prospect.points, prospect.unspun)
        if most and run.addition not in without
    ]
    progress(f"trying {len(possible)} runs one by one")
    trials = sorted((PlanStep(run, u([]), u([run])) for run in possible), key=lambda trial: trial.after)
    chosen = _without_superfluous(u, _chosen(u, possible, most, progress))
    after = [chosen[:k] for k in range(len(chosen) + 1)]
    return Plan(
        config=config,
        goal=goal,
        identified=_identified(prospect.found, prospect.measured),
        now=u([]),
        steps=tuple(
            PlanStep(run, u(before), u(then))
            for run, before, then in zip(chosen, after, after[1:], strict=False)
        ),
        trials=tuple(trials),
    )


def next_run(config: Config, points: Points, goal: Goal, u: U) -> NextRun | None:
    """The first run of a plan by the uncertainties ``u``; None if no run lowers that of the goal enough."""
    chosen = _chosen(u, candidates(config, points), 1, silent)
    return NextRun(goal, PlanStep(chosen[0], u([]), u(chosen[:1]))) if chosen else None


def _identified(found: FitResult, measured: Measured) -> Identified:
    """Coverage, correlations and budget of a build."""
    staged = {name for row in found.coverage for name in row.free}
    correlated: dict[frozenset[str], tuple[str, str, float]] = {}
    for name, row in found.coefficients.items():
        if row.correlated_with and {name, row.correlated_with} <= staged:
            pair = (name, row.correlated_with, row.correlation)
            correlated.setdefault(frozenset(pair[:2]), pair)
    return Identified(
        cover=found.coverage,
        from_prior=tuple(
            n for n, row in found.coefficients.items() if row.status == "regularised" and n in staged
        ),
        correlated=tuple(correlated.values()),
        budget=measured.budget,
        unseen_skew=_unseen_skew(measured),
    )


def _unseen_skew(measured: Measured) -> float | None:
    """Change of eps_gamma by 1 deg of camber skew; None if sweeps in both directions measure it."""
    sources = {declared.source for _, declared in adding_to_camber()}
    line = next((line for line in measured.budget if line.source in sources and line.u), None)
    if line is None or measured.camber_skew is not None:
        return None
    return abs(line.contribution / line.u)


def _chosen(u: U, possible: Sequence[PlannedRun], most: int, progress: Progress) -> list[PlannedRun]:
    """Up to ``most`` runs by forward selection, in the order of selection."""
    chosen: list[PlannedRun] = []
    while len(chosen) < most:
        progress(f"looking for run {len(chosen) + 1}")
        left = [run for run in possible if run not in chosen]
        more = _best(u, chosen, [[run] for run in left])
        if not more and len(chosen) + 1 < most:  # some runs help only in pairs, like pressures at two loads
            pairs = [
                pair
                for pair in combinations(left, 2)
                if pair[0].addition is pair[1].addition and pair[0].load != pair[1].load
            ]
            more = _best(u, chosen, pairs)
        if not more:
            break
        chosen += more
    return chosen


def _best(
    u: U, chosen: Sequence[PlannedRun], possible: Sequence[Sequence[PlannedRun]]
) -> Sequence[PlannedRun]:
    """The best run or pair of runs to add; empty if none lowers the uncertainty enough."""
    after = [u([*chosen, *more]) for more in possible]
    if not min(after, default=float("inf")) < (1.0 - WORTHWHILE_FALL) * u(chosen):
        return ()
    equally_good = [
        (sum(run.cost for run in more), then, k)
        for k, (more, then) in enumerate(zip(possible, after, strict=True))
        if then <= (1.0 + WORTHWHILE_FALL) * min(after)
    ]
    return possible[min(equally_good)[2]]


def _without_superfluous(u: U, chosen: Sequence[PlannedRun]) -> list[PlannedRun]:
    """The list without runs that later runs have made superfluous."""
    kept = list(chosen)
    for run in chosen:
        fewer = [other for other in kept if other is not run]
        if fewer and u(fewer) <= (1.0 + WORTHWHILE_FALL) * u(kept):
            kept = fewer
    return kept
