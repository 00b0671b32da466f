"""The free numbers of a fit and their priors."""

from __future__ import annotations

import math
from collections.abc import Collection, Iterable, Mapping
from dataclasses import dataclass, field, replace

import numpy as np

from mffit.config import Config
from mffit.config.constants import PLAUSIBLE_CONICITY
from mffit.fit.by_hand import NO_HAND, Hand
from mffit.fit.coverage import StageCoverage, coverage, side_run
from mffit.fit.known import Known
from mffit.fit.priors import Prior, scatters
from mffit.fit.priors import scatter as scatter_of
from mffit.fit.problem import FitProblem
from mffit.fit.rig.rig_numbers import held_rig, rig_numbers, unseen_zeros
from mffit.fit.rig.zeros import TurningZeros
from mffit.fit.stages import BY_STAGE, ODD_TERMS, is_asymmetry
from mffit.fit.wheel.vertical import OF_ROLLING_RADIUS, SPREADS
from mffit.least_squares import EXACT, FreeNumber
from mffit.measured import Measured
from mffit.points import Points
from mffit.quantities import CHANNELS, SIDEWAYS
from tir.parameters import BY_NAME


@dataclass(frozen=True, slots=True)
class FitPlan:
    """The free numbers of a fit with their priors, and the held numbers."""

    cover: tuple[StageCoverage, ...]
    expected: Mapping[str, float]  #: centre of every coefficient's prior
    scatter: Mapping[str, float]  #: standard deviation of every coefficient's prior
    rig: tuple[FreeNumber, ...] = ()  #: free rig errors
    channels: tuple[str, ...] = tuple(SIDEWAYS)  #: channels that the fit uses
    extra: tuple[str, ...] = ()  #: free coefficients that belong to no stage
    held: Mapping[str, float] = field(default_factory=dict)
    """Standard uncertainty of coefficients that the fit takes as exact."""
    held_rig: Mapping[str, float] = field(default_factory=dict)
    """Standard uncertainty of declared rig errors that the fit takes as exact."""
    hand: Hand = NO_HAND  #: bounds, priors and held values from [coefficients]

    @property
    def free(self) -> list[str]:
        """Coefficients that the stages free."""
        return [name for row in self.cover for name in row.free]

    @property
    def asymmetries(self) -> list[str]:
        """Free numbers that are zero for a tyre of perfect mirror symmetry on a rig without zeros, but for those set by hand."""
        free = (*self.free, *(number.name for number in self.rig))
        return [name for name in free if is_asymmetry(name) and name not in self.hand.names]

    def holding(self, names: Collection[str], why: str) -> FitPlan:
        """The plan with some free numbers held, with the uncertainty of their priors; ``why`` their coverage says."""
        cover = tuple(
            replace(
                row,
                free=tuple(name for name in row.free if name not in names),
                held=(*row.held, *(name for name in row.free if name in names)),
                missing=(*row.missing, why),
            )
            if set(row.free) & set(names)
            else row
            for row in self.cover
        )
        rig = {number.name: number.spread for number in self.rig if number.name in names}
        return replace(
            self,
            cover=cover,
            rig=tuple(number for number in self.rig if number.name not in names),
            held={
                **self.held,
                **{n: BY_NAME[n].symmetric_spread or self.scatter[n] for n in names if n not in rig},
            },
            held_rig={**self.held_rig, **rig},
        )

    def coefficients(self, names: Iterable[str], problem: FitProblem) -> list[FreeNumber]:
        """The named coefficients with their bounds and priors, starting at their current values."""
        return [
            FreeNumber(
                name=name,
                start=self.hand.inside(name, float(problem.simulation.values[name])),
                lower=self.hand.bounds(name)[0],
                upper=self.hand.bounds(name)[1],
                expected=self.expected[name],
                spread=self._spread(name, float(problem.simulation.values[name])),
            )
            for name in names
        ]

    def _spread(self, name: str, value: float) -> float:
        """Standard deviation of the normal prior that pulls a value as hard as the coefficient's own prior does.

        A spread estimated from n published tyres is itself uncertain, so a further tyre follows Student's t with n - 1 degrees
        of freedom. The pull of this prior fades at values far from those of the published tyres.
        """
        spread, row = self.scatter.get(name, math.inf), BY_NAME[name]
        if spread != row.tyres_spread or not row.tyres:
            return spread
        return spread * math.sqrt((row.tyres - 1 + ((value - self.expected[name]) / spread) ** 2) / row.tyres)

    def numbers(self, problem: FitProblem) -> list[FreeNumber]:
        """All free coefficients and rig errors, starting at their current values."""
        return [*self.coefficients([*self.free, *self.extra], problem), *problem.starting_here(self.rig)]


def fitted_channels(cover: Iterable[StageCoverage], points: Points) -> tuple[str, ...]:
    """Channels that a fit uses: Fy, Mz, and every other measured channel for which a stage frees a coefficient.

    A channel without a free coefficient would cost time and change no result.
    """
    fitted = {channel for row in cover if row.free for channel in BY_STAGE[row.stage].channels}
    wanted = {*SIDEWAYS, *(fitted.intersection(points.measured))}
    return tuple(name for name in CHANNELS if name in wanted)


def channels_of(points: Points) -> tuple[str, ...]:
    """Channels that a fit to these points would use."""
    return fitted_channels(coverage(points, "left"), points)


def fit_plan(
    config: Config,
    points: Points,
    measured: Measured,
    known: Known,
    start: Mapping[str, float],
    fleet: Mapping[str, Prior],
    turning: TurningZeros | None = None,
) -> FitPlan:
    """The plan of the fit to these points.

    ``turning`` holds the turn-slip zeros that determine PECP1 where eps_gamma was not measured.
    """
    cover = coverage(points, config.tyre.side, known.hand.held)
    channels = fitted_channels(cover, points)
    unseen_of_rig = unseen_zeros(points)
    rig = rig_numbers(config, measured, points.used_setups, channels, unseen=unseen_of_rig)
    staged = {name: start[name] for row in cover for name in (*row.free, *row.held)}
    unseen = {name for row in cover for name in row.held if side_run(points)}
    scatter = scatters(staged, known.origin, curved=bool(np.any(points.phi_t)), unseen=unseen)
    if config.rig.on_disc and "PVY1" in scatter and config.rig.u_conicity != PLAUSIBLE_CONICITY:
        scatter["PVY1"] = config.rig.u_conicity or EXACT
    scatter |= {name: prior.spread for name, prior in fleet.items()}
    absent = ODD_TERMS if config.tyre.side == "symmetric" else frozenset()
    held = {name: scatter[name] for row in cover for name in row.held if name not in absent}
    extra = [*OF_ROLLING_RADIUS] if config.rolling_radius else []
    scatter = {**{n: known.u.get(n) or SPREADS[n] for n in extra}, **scatter}
    expected = {**start, **{name: prior.expected for name, prior in fleet.items()}}
    if measured.carried is not None and measured.carried.is_free:
        extra.append("PECP1")
    elif measured.carried is not None:
        held["PECP1"] = measured.carried.pecp1.u
    elif turning is not None:
        scatter.setdefault("PECP1", scatter_of("PECP1", start["PECP1"], from_base=False, curved=True))
        for name in turning.start:
            held.pop(name, None)
            expected[name] = turning.before[name]
        extra += [name for name in turning.start if not any(name in row.free for row in cover)]
    plan = FitPlan(
        cover=cover,
        expected=expected,
        scatter=scatter,
        rig=rig,
        channels=channels,
        extra=tuple(extra),
        held=held,
        held_rig=held_rig(config, measured, points.used_setups, channels, unseen=unseen_of_rig),
    )
    return _by_hand(plan, known.hand)


def _by_hand(plan: FitPlan, hand: Hand) -> FitPlan:
    """The plan with the entries of [coefficients], which override free numbers, bounds and priors."""
    priors = hand.priors
    return replace(
        plan,
        expected={**hand.within(plan.expected), **{name: prior.expected for name, prior in priors.items()}},
        scatter={**plan.scatter, **{name: prior.spread for name, prior in priors.items()}},
        extra=tuple(hand.without_held(plan.extra)),
        held={
            name: priors[name].spread if name in priors else u
            for name, u in plan.held.items()
            if name not in hand.held
        },
        hand=hand,
    )
