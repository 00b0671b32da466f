"""The records of a plan."""

from __future__ import annotations

from dataclasses import dataclass

from mffit.brief import Brief
from mffit.config import Config
from mffit.diagnosis.constants import SEPARATING_CHI2
from mffit.fit.coverage import StageCoverage
from mffit.measured import Contribution
from mffit.planning.goals import Goal
from mffit.planning.runs import Run


@dataclass(frozen=True, slots=True)
class Tie:
    """Two effects and whether the sweeps tell them apart."""

    effect: str  #: id
    other: str  #: id
    chi2: float  #: expected between them for an effect of the usual size

    @property
    def told(self) -> bool:
        """Whether they are told apart."""
        return self.chi2 >= SEPARATING_CHI2


@dataclass(frozen=True, slots=True)
class Identified:
    """What the sweeps at hand say."""

    cover: tuple[StageCoverage, ...]  #: per stage what is freed, what is held and why
    tied: tuple[str, ...]  #: freed coefficients of which the data say less than what is known beforehand
    correlated: tuple[tuple[str, str, float], ...]  #: coefficients that trade places, and their correlation
    ties: tuple[Tie, ...]
    budget: tuple[Contribution, ...]  #: of eps_gamma by the direct method; empty on a flat track


@dataclass(frozen=True, slots=True)
class Trial:
    """A run and what it would leave uncertain, made alone or after those before it."""

    run: Run
    u: float  #: of the goal, in its unit


@dataclass(frozen=True, slots=True)
class Step:
    """A run of the plan, in the order in which they are made."""

    run: Run
    before: float  #: uncertainty of the goal without it
    after: float  #: and with it
    direct: float | None  #: u(eps_gamma) by the direct method after it; None where there is none
    joint: float | None  #: u(PECP1) of the joint fit of tyre and rig after it


@dataclass(frozen=True, slots=True)
class Plan(Brief):
    """The answer of ``mffit plan``."""

    config: Config
    goal: Goal
    identified: Identified
    now: float  #: uncertainty of the goal as it is; infinite where it is not measured
    direct_now: float | None
    joint_now: float | None
    steps: tuple[Step, ...]  #: the shortest list
    trials: tuple[Trial, ...]  #: every candidate made alone, best first
    told_below: float | None = None  #: of a tie: uncertainty from which on the effects are told apart

    @property
    def then(self) -> float:
        """Uncertainty of the goal once all runs of the list are made."""
        return self.steps[-1].after if self.steps else self.now

    @property
    def points(self) -> int:
        """Points of the whole list."""
        return sum(step.run.cost for step in self.steps)
