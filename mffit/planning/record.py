"""The records of a plan."""

from __future__ import annotations

from dataclasses import dataclass

from mffit.brief import Brief
from mffit.config import Config
from mffit.diagnosis.constants import SEPARATING_CHI2
from mffit.fit.coverage import StageCoverage
from mffit.measured import Contribution
from mffit.planning.goals import Goal
from mffit.planning.runs import PlannedRun


@dataclass(frozen=True, slots=True)
class Tie:
    """Two effects and how well the sweeps separate them."""

    effect: str  #: id
    other: str  #: id
    chi2: float  #: expected chi-squared between them for an effect of the usual size

    @property
    def told(self) -> bool:
        """Whether the sweeps separate them."""
        return self.chi2 >= SEPARATING_CHI2


@dataclass(frozen=True, slots=True)
class Identified:
    """What the present sweeps identify."""

    cover: tuple[StageCoverage, ...]  #: per stage: what is freed, what is held and why
    from_prior: tuple[str, ...]  #: freed coefficients that the prior determines more than the data
    correlated: tuple[tuple[str, str, float], ...]  #: pairs of coefficients and their correlation
    ties: tuple[Tie, ...]
    budget: tuple[Contribution, ...]  #: of eps_gamma by the direct method; empty on a flat track
    unseen_skew: float | None = None
    """Change of eps_gamma by a camber skew of 1 deg, where no backward camber sweep shows the skew; else None."""


@dataclass(frozen=True, slots=True)
class Trial:
    """A run made alone, and the uncertainty that it would leave."""

    run: PlannedRun
    u: float  #: of the goal, in its unit


@dataclass(frozen=True, slots=True)
class PlanStep:
    """One run of the list."""

    run: PlannedRun
    before: float  #: uncertainty of the goal without it
    after: float  #: with it
    direct: float | None  #: u(eps_gamma) of the direct method after it; None without a disc
    joint: float | None  #: u(PECP1) of the joint fit of tyre and rig after it


@dataclass(frozen=True, slots=True)
class Plan(Brief):
    """The answer of ``mffit plan``."""

    config: Config
    goal: Goal
    identified: Identified
    now: float  #: present uncertainty of the goal; infinite if it is not measured
    direct_now: float | None
    joint_now: float | None
    steps: tuple[PlanStep, ...]  #: the list, in the order in which the runs are made
    trials: tuple[Trial, ...]  #: every candidate made alone, best first
    told_below: float | None = None  #: of a tie: uncertainty below which the effects are separated

    @property
    def then(self) -> float:
        """Uncertainty of the goal once all runs of the list are made."""
        return self.steps[-1].after if self.steps else self.now

    @property
    def points(self) -> int:
        """Points of the whole list."""
        return sum(step.run.cost for step in self.steps)
