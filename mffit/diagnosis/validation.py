"""The gap on left-out sweeps: effects must reduce it on sweeps to which they were not fitted."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from mffit.as_json import keys
from mffit.diagnosis import constants
from mffit.diagnosis.hypothesis import Hypothesis
from mffit.diagnosis.inexact import EXACT, slopes_of
from mffit.diagnosis.noise import Noise
from mffit.diagnosis.problem import DiagnosisProblem
from mffit.numbers import Numbers
from mffit.points import Points
from mffit.quantities import column
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


keys(Gap, "**rmse chi2_per_dof", rmse=lambda gap: {column(name, "rmse"): x for name, x in gap.rmse.items()})


@dataclass(frozen=True, slots=True)
class Validation:
    """The gap on left-out sweeps."""

    folds: int  #: number of groups left out in turn: sweeps, or parts of every run
    gap_before: Gap
    gap_after: Gap
    gap_given_file: Gap
    """Gap of the given property file, the rig errors and environment terms found being taken out of the readings."""
    gain: float = 0.0
    """Log likelihood of all channels together by which the left-out readings are predicted better than before."""
    gain_of_file: float = 0.0
    """The same by which the corrected property file predicts them better than the given one, without rig and environment."""
    within_runs: bool = False
    """Whether parts of every run were left out instead of whole sweeps, because some effects have numbers for every run."""

    def without_repair(self) -> Validation:
        """The validation of the given model, without a repair."""
        before = self.gap_before
        return Validation(self.folds, before, before, before, within_runs=self.within_runs)


keys(Validation, "method gap_before gap_after gap_given_file gain", method="mffit.diagnosis.wording.method")


def gap(residual: np.ndarray, noise: Noise) -> Gap:
    """Gap of residuals (c n,) of the readings that count, channel by channel; chi2 without correlations, like the rms."""
    z = residual[noise.used] / noise.u[noise.used]
    counted = np.where(np.isfinite(noise.u), residual, np.nan)
    rmse = {name: rms(rows) for name, rows in noise.by_channel(counted).items()}
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
    inexact: Numbers = EXACT,
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
    after = given_file = before
    fits = problem.seen_through(weights or problem.noise)
    within_runs = any(effect.differs_by_run for effect in hypothesis.effects)
    group = _part_of_run(points.file) if within_runs else np.unique(points.sweep, return_inverse=True)[1]
    if (hypothesis.effects or inexact.names) and group.any():
        after, given_file = _left_out(fits, hypothesis, inexact, group)
        if seen:
            before, _ = _left_out(fits, fits.refine(fits.null, inexact)[0], inexact, group)
    noise = problem.noise
    cost = [float(np.sum(noise.whiten(np.nan_to_num(one)) ** 2)) for one in (before, given_file, after)]
    return Validation(
        folds=int(group.max()) + 1,
        gap_before=gap(before, noise),
        gap_after=gap(after, noise),
        gap_given_file=gap(given_file, noise),
        gain=0.5 * (cost[0] - cost[2]),
        gain_of_file=0.5 * (cost[1] - cost[2]),
        within_runs=within_runs,
    )


def _left_out(
    problem: DiagnosisProblem, hypothesis: Hypothesis, inexact: Numbers, group: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Measured less predicted (c n,), with each group (n,) predicted from all others; and this for the given property file."""
    names, slopes, changes = problem.without_groups(hypothesis, inexact, group)
    given = with_given_file(hypothesis.state, problem.start)
    after, before = (problem.measured - problem.predict(one) for one in (hypothesis.state, given))
    of_rig = [k for k, name in enumerate(names) if (e := error_of(name)) is not None and e.kind != "tyre"]
    there = np.zeros_like(slopes)
    there[:, of_rig] = slopes_of(given, problem.points, [names[k] for k in of_rig], problem.channels)
    every = np.tile(group, len(problem.channels))
    for number, change in enumerate(changes):
        rows = every == number
        after[rows] -= slopes[rows] @ change
        before[rows] -= there[rows] @ change
    return after, before


def with_given_file(state: Simulation, given: Simulation) -> Simulation:
    """The simulation with its errors of rig and environment, and with the property file of ``given``."""
    tyre = {error.name: given.faults[error.name] for error in RIG_ERRORS if error.kind == "tyre"}
    return replace(state, values=given.values, turn_slip=given.turn_slip, faults=state.faults.replace(**tyre))


def _part_of_run(file: np.ndarray) -> np.ndarray:
    """Index (n,) of the part of its run to which each point belongs; parts are successive points."""
    out = np.zeros(len(file), dtype=int)
    for k in np.unique(file):
        rows = np.flatnonzero(file == k)
        out[rows] = np.arange(len(rows)) * constants.PARTS_OF_A_RUN // len(rows)
    return out
