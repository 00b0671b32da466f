"""The gap on left-out sweeps: effects must reduce it on sweeps to which they were not fitted."""

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
from mffit.rig_errors import RIG_ERRORS, error_of
from mffit.scatter import rms


@dataclass(frozen=True, slots=True)
class Gap:
    """Measured minus simulated, in one number per channel."""

    rmse: Mapping[str, float]  #: by channel, in its unit; NaN where it was not measured
    chi2_per_dof: float

    def rms(self, channel: str) -> float:
        """Rms gap of one channel, in its unit."""
        return self.rmse[channel]


@dataclass(frozen=True, slots=True)
class Validation:
    """The gap on left-out sweeps."""

    folds: int  #: number of groups left out in turn: sweeps, or parts of every run
    gap_before: Gap
    gap_after: Gap
    gap_file: Gap
    """Gap of the corrected property file alone, with rig and environment as in the given simulation."""
    raised: tuple[str, ...] = ()
    """Channels whose gap grows by more than numbers fitted to pure noise would raise it by chance."""
    raised_by_file: tuple[str, ...] = ()
    """Channels whose gap grows in this way with the corrected property file alone."""
    within_runs: bool = False
    """Whether parts of every run were left out instead of whole sweeps, because some effects have numbers for every run."""

    @property
    def helps(self) -> bool:
        """Whether the gap shrinks, and grows in no channel."""
        return self.gap_after.chi2_per_dof < self.gap_before.chi2_per_dof and not self.raised

    @property
    def file_helps(self) -> bool:
        """Whether the gap shrinks, and grows in no channel, with the corrected property file alone."""
        return self.gap_file.chi2_per_dof < self.gap_before.chi2_per_dof and not self.raised_by_file

    def without_repair(self) -> Validation:
        """The validation of the given model, without a repair."""
        return Validation(
            self.folds, self.gap_before, self.gap_before, self.gap_before, within_runs=self.within_runs
        )


def gap(residual: np.ndarray, noise: Noise) -> Gap:
    """Gap of residuals (c n,), channel by channel; chi2 without correlations, like the rms."""
    z = residual[noise.used] / noise.u[noise.used]
    rmse = {name: rms(rows) for name, rows in noise.by_channel(residual).items()}
    return Gap(rmse, chi2_per_dof=float(z @ z) / max(len(z), 1))


def raw_gap(points: Points, given: Simulation, judged: np.ndarray, noise: Noise) -> Gap:
    """Gap of a simulation at all points (n,) with uncorrected readings.

    ``noise`` is the noise of the ``judged`` points (mask (n,)); for the others the typical noise of the channel is used.
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
    """The gap if each group of points is predicted from all others, to first order from one fit.

    Groups are sweeps. With an effect that has numbers for every run, successive parts of every run are left out instead, because
    its numbers do not carry over to other runs. ``problem`` has the pure scatter of the readings; ``weights`` is another noise
    for the fit. If the model was fitted to these points (``seen``), its coefficients are re-estimated without the group for the
    gap before too, as the model would otherwise be tested on its own data.
    """
    points = problem.points
    before = problem.measured - problem.predict(problem.start)
    after = alone = before
    fits = problem.seen_through(weights or problem.noise)
    within_runs = any(effect.differs_by_run for effect in hypothesis.effects)
    group = _part_of_run(points.file) if within_runs else np.unique(points.sweep, return_inverse=True)[1]
    if (hypothesis.effects or inexact) and group.any():
        after, alone = _left_out(fits, hypothesis, inexact, group)
        if seen:
            before, _ = _left_out(fits, fits.refine(fits.null, inexact)[0], inexact, group)
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


def _left_out(
    problem: DiagnosisProblem, hypothesis: Hypothesis, inexact: Inexactness, group: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Measured less predicted (c n,), with each group (n,) predicted from all others; and this for the property file alone."""
    found, state = problem.linearised(hypothesis, inexact), hypothesis.state
    plain = file_alone(state, problem.start)
    after, alone = (problem.measured - problem.predict(one) for one in (state, plain))
    errors = [error_of(name) for name in found.names]
    kept = [k for k, error in enumerate(errors) if error is None or error.kind == "tyre"]
    slopes = np.zeros_like(found.slopes)
    if kept:
        of_file = plain.sensitivities(problem.points, [found.names[k] for k in kept], problem.channels)[1]
        slopes[:, kept] = np.nan_to_num(of_file.stacked)
    every = np.tile(group, len(problem.channels))
    for number in range(int(group.max()) + 1):
        change = found.moved_without(np.flatnonzero(every[problem.noise.used] == number))
        rows = every == number
        after[rows] -= found.slopes[rows] @ change
        alone[rows] -= slopes[rows] @ change
    return after, alone


def file_alone(state: Simulation, given: Simulation) -> Simulation:
    """The simulation with the corrected property file, and with rig and environment of ``given``."""
    tyre = {error.name: state.faults[error.name] for error in RIG_ERRORS if error.kind == "tyre"}
    return replace(state, faults=given.faults.replace(**tyre), of_parts=given.of_parts)


def _part_of_run(file: np.ndarray) -> np.ndarray:
    """Index (n,) of the part of its run to which each point belongs; parts are successive points."""
    out = np.zeros(len(file), dtype=int)
    for k in np.unique(file):
        rows = np.flatnonzero(file == k)
        out[rows] = np.arange(len(rows)) * constants.PARTS_OF_A_RUN // len(rows)
    return out


def _raised(before: np.ndarray, after: np.ndarray, noise: Noise, numbers: int) -> tuple[str, ...]:
    """Channels whose chi2 rises by more than chance: fitting ``numbers`` to pure noise raises that of left-out sweeps, too.

    Residuals are whitened, because correlated errors would raise a plain sum of squares further.
    """
    change = noise.whiten(np.nan_to_num(after)) ** 2 - noise.whiten(np.nan_to_num(before)) ** 2
    channel = noise.used // (len(before) // len(noise.channels))
    chance = numbers + constants.TWO_SIGMA * np.sqrt(2.0 * numbers)
    return tuple(name for k, name in enumerate(noise.channels) if change[channel == k].sum() > chance)
