"""The gap on left-out sweeps: it must shrink where the effects were not fitted."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from mffit.diagnosis import constants
from mffit.diagnosis.hypothesis import Hypothesis
from mffit.diagnosis.inexact import EXACT, Inexactness
from mffit.diagnosis.noise import Noise
from mffit.diagnosis.problem import DiagnosisProblem
from mffit.points import Points
from mffit.rig import Simulation
from mffit.rig_errors import RIG_ERRORS
from mffit.scatter import rms


@dataclass(frozen=True, slots=True)
class Gap:
    """Measured minus simulated, in one number per channel."""

    rmse: Mapping[str, float]  #: by channel, in its unit; NaN where it was not measured
    chi2_per_dof: float

    def rms(self, channel: str) -> float:
        """Of one channel, in its unit."""
        return self.rmse[channel]


@dataclass(frozen=True, slots=True)
class Validation:
    """The gap on left-out sweeps."""

    folds: int  #: groups of whole sweeps, left out in turn
    gap_before: Gap
    gap_after: Gap
    gap_file: Gap
    """After, with the rig and environment as in the given simulation: what the corrected property file does alone."""
    raised: tuple[str, ...] = ()
    """Channels whose gap grows by more than numbers fitted to mere noise would raise it by chance."""
    raised_by_file: tuple[str, ...] = ()
    """The same channels for the property file alone."""
    within_runs: bool = False
    """Whether parts of every run were left out instead of whole sweeps, because numbers of single runs were to be checked."""

    @property
    def helps(self) -> bool:
        """Whether the gap shrinks, and grows in no channel."""
        return self.gap_after.chi2_per_dof < self.gap_before.chi2_per_dof and not self.raised

    @property
    def file_helps(self) -> bool:
        """The same for the corrected property file alone."""
        return self.gap_file.chi2_per_dof < self.gap_before.chi2_per_dof and not self.raised_by_file

    def without_repair(self) -> Validation:
        """The check of the model as given."""
        return Validation(
            self.folds, self.gap_before, self.gap_before, self.gap_before, within_runs=self.within_runs
        )


def gap(residual: np.ndarray, noise: Noise) -> Gap:
    """Gap of residuals (c n,), channel after channel; chi2 without correlations, as the gap in newtons is."""
    z = residual[noise.used] / noise.u[noise.used]
    rmse = {name: rms(rows) for name, rows in noise.by_channel(residual).items()}
    return Gap(rmse, chi2_per_dof=float(z @ z) / max(len(z), 1))


def raw_gap(points: Points, given: Simulation, judged: np.ndarray, noise: Noise) -> Gap:
    """Gap of a simulation at all points (n,) as they were read.

    ``noise`` is that of the ``judged`` ones (mask (n,)); the others have the typical one of their channel.
    """
    residual, z, n = {}, [], len(points)
    for name, read in given.readings(points, noise.channels).items():
        residual[name] = points.channel(name) - read
        u = np.full(n, noise.typical(name))
        u[judged] = noise.of_channel(noise.u, name)
        z.append((residual[name] / u)[np.isfinite(residual[name]) & np.isfinite(u)])
    every = np.concatenate(z)
    return Gap(
        {name: rms(rows) for name, rows in residual.items()}, float(every @ every) / max(len(every), 1)
    )


def validate(
    problem: DiagnosisProblem,
    hypothesis: Hypothesis,
    inexact: Inexactness = EXACT,
    *,
    weights: Noise | None = None,
    seen: bool = False,
) -> Validation:
    """Refit the hypothesis without each group of sweeps and predict that group.

    Numbers of single runs say nothing about other runs: with such an effect, successive parts of every run are left out in turn.
    ``problem`` has the scatter of the readings alone, or whatever else the fits shall allow for. ``weights``: another noise for
    these fits. If the model was fitted to
    these points (``seen``), it is refitted without the group for the gap before too, which it would otherwise predict from
    itself.
    """
    points, channels = problem.points, problem.channels
    measured = np.concatenate([points.channel(name) for name in channels])
    before = measured - problem.predict(problem.start)
    after, alone = before.copy(), before.copy()
    fits = problem.seen_through(weights or problem.noise)
    within_runs = any(effect.differs_by_run for effect in hypothesis.effects)
    group = _part_of_run(points.file) if within_runs else _group_of_sweeps(points.sweep)
    for fold in range(int(group.max()) + 1):
        out = group == fold
        if not (hypothesis.effects or inexact) or out.all():
            continue
        rest, chosen, rows = fits.part(~out), points.select(out), np.tile(out, len(channels))
        fitted = rest.evaluate(hypothesis.effects, hypothesis.numbers)
        if hypothesis.effects and not inexact:
            fitted = rest.fit(hypothesis.effects, hypothesis.numbers)
        state = rest.refine(fitted, inexact)[0].state
        after[rows] = measured[rows] - state.predict(chosen, channels)
        alone[rows] = measured[rows] - file_alone(state, problem.start).predict(chosen, channels)
        if seen:
            unchanged = rest.refine(rest.null, inexact)[0].state
            before[rows] = measured[rows] - unchanged.predict(chosen, channels)
    noise, numbers = problem.noise, sum(len(e.free) for e in hypothesis.effects) + len(inexact.names)
    return Validation(
        folds=int(group.max()) + 1,
        gap_before=gap(before, noise),
        gap_after=gap(after, noise),
        gap_file=gap(alone, noise),
        raised=_raised(before, after, noise, numbers),
        raised_by_file=_raised(before, alone, noise, numbers),
        within_runs=within_runs,
    )


def file_alone(state: Simulation, given: Simulation) -> Simulation:
    """The simulation with the corrected property file, its rig and environment as ``given``."""
    tyre = {error.name: state.faults[error.name] for error in RIG_ERRORS if error.kind == "tyre"}
    return replace(state, faults=given.faults.replace(**tyre), of_parts=given.of_parts)


def _group_of_sweeps(sweep: np.ndarray) -> np.ndarray:
    """Number (n,) of the group of whole sweeps that each point belongs to."""
    sweeps, index = np.unique(sweep, return_inverse=True)
    many = len(sweep) >= constants.MANY_POINTS_TO_VALIDATE
    most = constants.VALIDATION_FOLDS_OF_MANY_POINTS if many else constants.MOST_VALIDATION_FOLDS
    return index % min(most, len(sweeps))


def _part_of_run(file: np.ndarray) -> np.ndarray:
    """Number (n,) of the part of its run that each point belongs to; successive points are in one part."""
    out = np.zeros(len(file), dtype=int)
    for k in np.unique(file):
        rows = np.flatnonzero(file == k)
        out[rows] = np.arange(len(rows)) * constants.PARTS_OF_A_RUN // len(rows)
    return out


def _raised(before: np.ndarray, after: np.ndarray, noise: Noise, numbers: int) -> tuple[str, ...]:
    """Channels whose chi2 rises beyond chance: ``numbers`` fitted to noise raise that of left-out sweeps by as much.

    Correlated errors raise a plain sum of squares by more than that, so the residuals are whitened.
    """
    change = noise.whiten(np.nan_to_num(after)) ** 2 - noise.whiten(np.nan_to_num(before)) ** 2
    channel = noise.used // (len(before) // len(noise.channels))
    chance = numbers + constants.RAISED_GAP * np.sqrt(2.0 * numbers)
    return tuple(name for k, name in enumerate(noise.channels) if change[channel == k].sum() > chance)
