"""Set-ups of the rig: the zeros of each by themselves, and the scatter of repeated ones in addition to what is declared."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from scipy.special import chdtrc
from uncertainties import UFloat

from mffit.config import Config
from mffit.constants import FALSE_ALARM
from mffit.measured import camber_reduction as method
from mffit.measured import wording
from mffit.measured.axis import slip_stiffness, split_of_zero
from mffit.measured.evidence import DirectEvidence
from mffit.measured.result import Measured, SetupResult, SetupScatter
from mffit.measured.turning import Turning
from mffit.measured.uncertain import named, quantity, quantity_if
from mffit.measured.zeros import LoadGroup, PathZeros, forces_of_sweeps, u_of, zeros, zeros_by_path
from mffit.points import Points
from mffit.rig_errors import DECLARED, AtZero
from mffit.scatter import rms

Stiffness = tuple[LoadGroup, UFloat | None, UFloat | None]
"""The points of a load, and their cornering and camber stiffness [N/rad]."""
SCATTER = "scatter of repeated set-ups"
"""Its name in the uncertainty budget."""


def results_of_setups(
    evidence: DirectEvidence, found: Turning, C_alpha: float, C_gamma: UFloat, r_e: UFloat
) -> tuple[SetupResult, ...]:
    """Turn slip and eps_gamma of every path and set-up alone; empty if there is only one.

    Parameters
    ----------
    evidence : has alpha_M of the set-ups that were run both ways
    found : the zeros and turn-slip forces of one load
    C_alpha, C_gamma : cornering and camber stiffness, this less what the rig adds to it [N/rad]
    r_e : effective radius [m]
    """
    if len(found.paths) < 2:
        return ()
    out, left = [], evidence.config.rig.u("alpha_0_deg")
    for zero, path in zip(found.found, found.paths, strict=True):
        alone = method.camber_reduction(path.force, C_gamma, r_e, path.R, path.sign)
        axis = evidence.axes.get(zero.setup)
        alpha_M = axis and axis.at(zero.group.load)
        beyond = alpha_M is not None and bool(abs(C_alpha * alpha_M.nominal_value) > left)
        split = split_of_zero(alpha_M, C_alpha, left)
        out.append(
            SetupResult(
                zero.setup,
                zero.phi_t,
                quantity(path.force, "N"),
                quantity(alone.C_phit, "Nm"),
                quantity(alone.epsilon_gamma, "-"),
                quantity_if(alpha_M, "rad"),
                beyond,
                beyond and split is not None and split.axis_is_clear,
            )
        )
    return tuple(out)


class _Variance(NamedTuple):
    """Pooled variance of groups of values about their own means; NaN without degrees of freedom."""

    square: float
    degrees_of_freedom: int

    @classmethod
    def within(cls, groups: Sequence[np.ndarray]) -> _Variance:
        """That of some groups."""
        freedom = sum(len(group) - 1 for group in groups)
        squares = sum(float(np.sum((group - group.mean()) ** 2)) for group in groups)
        return cls(squares / freedom if freedom else math.nan, freedom)


def setup_scatter(
    points: Points, stiffnesses: Sequence[Stiffness], rig: method.UncertainRig, config: Config
) -> SetupScatter | None:
    """Scatter of the zeros of set-ups that were repeated on one path; None if none was.

    One-way analysis of variance at the load nearest to the nominal one: the variance between set-ups is that of their mean
    zeros less that of a mean within a set-up. Where it exceeds the declared variance, the difference becomes a source of
    uncertainty of its own, a type A evaluation with as many degrees of freedom as set-ups less paths (JCGM 100, 4.2).
    """
    nominal = config.tyre.nominal_load
    for group, C_alpha, C_gamma in sorted(stiffnesses, key=lambda row: abs(row[0].load - nominal)):
        found = zeros_by_path(points, group, C_alpha, config)
        of_paths = [[x for x in found if x.phi_t == path] for path in dict.fromkeys(x.phi_t for x in found)]
        repeated = [of_path for of_path in of_paths if len(of_path) > 1]
        if repeated:
            slope = float(slip_stiffness(C_alpha, None, group.load).C_alpha.nominal_value)
            lean = 0.0 if C_gamma is None else float(C_gamma.nominal_value)
            return _scatter(points, repeated, AtZero(slope, lean, 0.0), rig)
    return None


def _scatter(
    points: Points, repeated: Sequence[Sequence[PathZeros]], at: AtZero, rig: method.UncertainRig
) -> SetupScatter:
    paths = [path for of_path in repeated for path in of_path]
    both = all(path.backward is not None for path in paths)
    # Sweep to sweep within a set-up, in addition to the noise that the points state.
    sweeps = [_of_sweeps(points, path, at.C_alpha) for path in paths]
    inside = _Variance.within([values for of_path in sweeps for values, _ in of_path if len(values) > 1])
    stated = rms(np.array([u for of_path in sweeps for _, u in of_path]))
    beyond_noise = max(inside.square - stated**2, 0.0) if inside.degrees_of_freedom else 0.0
    per_setup = float(np.mean([np.mean([len(values) for values, _ in of_path]) for of_path in sweeps]))
    of_noise = rms(np.array([path.mean(both=both).std_dev for path in paths])) ** 2 + beyond_noise / per_setup
    # Set-up to set-up.
    outside = _Variance.within(
        [np.array([path.mean(both=both).nominal_value for path in of_path]) for of_path in repeated]
    )
    declared = math.hypot(
        *(
            float(declared.force_at_zero(rig.errors[error.name].std_dev, at))
            for error, declared in DECLARED
            if error.of_setup and declared.force_at_zero and not (both and declared.turns_with_direction)
        )
    )
    between = math.sqrt(max(outside.square - of_noise, 0.0))
    chi2 = outside.degrees_of_freedom * outside.square / (declared**2 + of_noise)
    between_alpha = declared_alpha = None
    if both:
        turned = [
            np.array([path.slip.nominal_value / at.C_alpha for path in of_path]) for of_path in repeated
        ]
        between_alpha = math.sqrt(max(_Variance.within(turned).square - of_noise / at.C_alpha**2, 0.0))
        declared_alpha = abs(float(rig.errors["alpha_0_deg"].std_dev) / at.C_alpha)
    return SetupScatter(
        load=paths[0].group.load,
        setups=tuple(dict.fromkeys(path.setup for path in paths)),
        between=between,
        degrees_of_freedom=outside.degrees_of_freedom,
        declared=declared,
        chance=float(chdtrc(outside.degrees_of_freedom, chi2)),
        within=math.sqrt(inside.square) if inside.degrees_of_freedom else None,
        degrees_of_freedom_within=inside.degrees_of_freedom,
        stated=stated if inside.degrees_of_freedom else None,
        between_alpha=between_alpha,
        declared_alpha=declared_alpha,
        excess=math.sqrt(max(between**2 - declared**2, 0.0) + beyond_noise / per_setup),
    )


def excess_forces(scatter: SetupScatter | None, rig: method.UncertainRig) -> dict[str, UFloat]:
    """The force [N] of each set-up that scatters beyond what is declared; empty if it does not."""
    if scatter is None or not scatter.excess:
        return {}
    shown = {"kind": "A", "dof": float(scatter.degrees_of_freedom)}
    return {name: named(0.0, scatter.excess, SCATTER, "N", **shown) for name in rig.of_setups}


def _of_sweeps(points: Points, path: PathZeros, slope: float) -> list[tuple[np.ndarray, float]]:
    """By direction, the mean force at zero of every sweep (m,) [N], and the stated uncertainty of such a mean."""
    u = u_of(points, "Fy")
    out = []
    for direction in (1, -1):
        i = zeros(points, path.group, direction)
        i = i[np.isfinite(points.Fy[i])]
        means = forces_of_sweeps(points, i, direction, slope)
        if means:
            rows = [i[points.sweep[i] == k] for k in means]
            stated = rms(np.array([np.linalg.norm(u[own]) / len(own) for own in rows]))
            out.append((np.array(list(means.values())), stated))
    return out


class SetupRemarks(NamedTuple):
    """Sentences about the set-ups: to know, and to act on."""

    notes: tuple[str, ...]
    warnings: tuple[str, ...]


def of_setups(
    points: Points, measured: Measured, scatter: SetupScatter | None, config: Config
) -> SetupRemarks:
    """What to know about the set-ups of a disc in addition to the numbers; nothing if there is only one on one path."""
    used = points.used_setups
    paths = {name: np.unique(points.phi_t[points.setup == points.setups.index(name)]) for name in used}
    if not config.rig.on_disc or (len(used) < 2 and all(len(found) < 2 for found in paths.values())):
        return SetupRemarks((), ())
    known, act = [], []
    if len(used) > 1:
        known.append(wording.several_setups(used))
    known += [wording.one_setup_on_paths(name, len(found)) for name, found in paths.items() if len(found) > 1]
    steady = {
        name: np.flatnonzero((points.setup == points.setups.index(name)) & ~points.continuous)
        for name in used
    }
    without = [name for name, rows in steady.items() if not len(zeros(points, LoadGroup(math.nan, rows), 1))]
    act += [wording.setup_without_zeros(name) for name in without] if len(used) > 1 else []
    act += _undeclared(config)
    row = measured.nominal
    for found in row.setups if row else ():
        first = row is not None and found is row.setups[0]
        if found.axis_off and not first and found.alpha_M is not None:
            act.append(wording.setup_misaligned(found.name, found.alpha_M))
    if scatter is not None:
        sentence = wording.setup_scatter(scatter)
        (act if scatter.chance < FALSE_ALARM else known).append(sentence)
    return SetupRemarks(tuple(known), tuple(act))


def _undeclared(config: Config) -> list[str]:
    """A sentence about sweeps that name no set-up although others on their path do."""
    named = {_path(config, k) for k, sweep in enumerate(config.sweep) if sweep.setup is not None}
    bare = [
        sweep.file
        for k, sweep in enumerate(config.sweep)
        if sweep.setup is None and _path(config, k) in named
    ]
    return [wording.sweeps_without_setup(bare)] if bare else []


def _path(config: Config, k: int) -> tuple[str | None, float | None]:
    sweep = config.sweep[k]
    return sweep.path_centre or config.rig.path_centre, sweep.path_radius or config.rig.radius
