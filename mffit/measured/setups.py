"""Set-ups of the rig: the zeros of each by themselves, and the scatter of repeated ones beside what is declared."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from typing import NamedTuple

import numpy as np
from scipy.special import chdtrc
from uncertainties import UFloat

from mffit.config import Config
from mffit.constants import USUAL_CORNERING_STIFFNESS, USUAL_U_FORCE
from mffit.measured import camber_reduction as method
from mffit.measured import constants, setup_notes
from mffit.measured.at_zero import PathZeros, zeros_by_path
from mffit.measured.groups import LoadGroup, zeros
from mffit.measured.paths import PathForce
from mffit.measured.result import Measured, SetupResult, SetupScatter
from mffit.measured.sideslip_zero import SetupAngle
from mffit.measured.sources import named
from mffit.measured.zero_split import split_of_zero
from mffit.points import Points
from mffit.rig_errors import DECLARED, AtZero

Stiffness = tuple[LoadGroup, UFloat | None, UFloat | None]
"""The points of a load, and their cornering and camber stiffness [N/rad]."""
SCATTER = "scatter of repeated set-ups"
"""Its name in the uncertainty budget."""


def results_of_setups(
    found: Sequence[PathZeros],
    paths: Sequence[PathForce],
    axes: Mapping[str, SetupAngle],
    C_gamma: UFloat,
    r_e: UFloat,
    config: Config,
) -> tuple[SetupResult, ...]:
    """Turn slip and eps_gamma of every path and set-up alone; empty if there is only one.

    Parameters
    ----------
    found, paths : (k,) readings at zero and turn-slip force
    axes : alpha_M of the set-ups that were run both ways
    C_gamma : camber stiffness, less what the rig adds to it [N/rad]
    r_e : effective radius [m]
    config : declares what the alignment leaves
    """
    if len(paths) < 2:
        return ()
    out = []
    for zero, path in zip(found, paths, strict=True):
        alone = method.camber_reduction(path.force, C_gamma, r_e, path.R, path.sign)
        left = config.rig.u("alpha_0_deg")
        alpha_M = axes[path.setup].at(zero.group.load) if path.setup in axes else None
        beyond = alpha_M is not None and bool(abs(path.at.C_alpha * alpha_M.nominal_value) > left)
        split = split_of_zero(alpha_M, path.at.C_alpha, left)
        out.append(
            SetupResult(
                path.setup,
                zero.phi_t,
                method.known_quantity(path.force, "N"),
                method.known_quantity(alone.C_phit, "Nm"),
                method.known_quantity(alone.epsilon_gamma, "-"),
                method.quantity(alpha_M, "rad"),
                beyond,
                beyond and split is not None and split.axis_is_clear,
            )
        )
    return tuple(out)


class _Mean(NamedTuple):
    """Mean square of deviations from the means of their groups."""

    square: float
    degrees_of_freedom: int


def _pooled(groups: Sequence[np.ndarray]) -> _Mean:
    """Pooled variance of groups of values about their own means; NaN without degrees of freedom."""
    freedom = sum(len(group) - 1 for group in groups)
    squares = sum(float(np.sum((group - group.mean()) ** 2)) for group in groups)
    return _Mean(squares / freedom if freedom else math.nan, freedom)


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
        repeated = list(_repeated(zeros_by_path(points, group, C_alpha, config)))
        if repeated:
            return _scatter(points, repeated, (C_alpha, C_gamma), rig)
    return None


def _repeated(found: Sequence[PathZeros]) -> Iterator[list[PathZeros]]:
    """The zeros of every path that was run in several set-ups; with backward zeros if all of them have these."""
    for phi_t in dict.fromkeys(path.phi_t for path in found):
        of_path = [path for path in found if path.phi_t == phi_t]
        if len(of_path) > 1:
            yield of_path


def _scatter(
    points: Points,
    repeated: Sequence[Sequence[PathZeros]],
    stiffness: tuple[UFloat | None, UFloat | None],
    rig: method.UncertainRig,
) -> SetupScatter:
    paths = [path for of_path in repeated for path in of_path]
    load = paths[0].group.load
    C_alpha, C_gamma = (
        float(C.nominal_value) if C is not None else usual
        for C, usual in zip(stiffness, (-USUAL_CORNERING_STIFFNESS * load, 0.0), strict=True)
    )
    both = all(math.isfinite(path.readings.backward) for path in paths)
    # Sweep to sweep within a set-up, beside the noise that the points state.
    sweeps = [_of_sweeps(points, path, C_alpha) for path in paths]
    inside = _pooled([values for of_path in sweeps for values, _ in of_path if len(values) > 1])
    stated = _rms([u for of_path in sweeps for _, u in of_path])
    beyond_noise = max(inside.square - stated**2, 0.0) if inside.degrees_of_freedom else 0.0
    per_setup = float(np.mean([np.mean([len(values) for values, _ in of_path]) for of_path in sweeps]))
    of_noise = _rms([_u_mean(path, both=both) for path in paths]) ** 2 + beyond_noise / per_setup
    # Set-up to set-up.
    outside = _pooled([np.array([_mean(path, both=both) for path in of_path]) for of_path in repeated])
    declared = _declared_force(rig, AtZero(C_alpha, C_gamma, 0.0), both=both)
    between = math.sqrt(max(outside.square - of_noise, 0.0))
    chi2 = outside.degrees_of_freedom * outside.square / (declared**2 + of_noise)
    excess = math.sqrt(max(between**2 - declared**2, 0.0) + beyond_noise / per_setup)
    between_alpha = declared_alpha = None
    if both:
        turned = [np.array([_difference(path) / C_alpha for path in of_path]) for of_path in repeated]
        of_noise_alpha = of_noise / C_alpha**2
        between_alpha = math.sqrt(max(_pooled(turned).square - of_noise_alpha, 0.0))
        declared_alpha = abs(float(rig.errors["alpha_0_deg"].std_dev) / C_alpha)
    names = tuple(dict.fromkeys(path.setup for path in paths))
    return SetupScatter(
        load=load,
        setups=names,
        between=between,
        degrees_of_freedom=outside.degrees_of_freedom,
        declared=declared,
        chance=float(chdtrc(outside.degrees_of_freedom, chi2)),
        within=math.sqrt(inside.square) if inside.degrees_of_freedom else None,
        degrees_of_freedom_within=inside.degrees_of_freedom,
        stated=stated if inside.degrees_of_freedom else None,
        between_alpha=between_alpha,
        declared_alpha=declared_alpha,
        excess=excess,
    )


def excess_forces(scatter: SetupScatter | None, rig: method.UncertainRig) -> dict[str, UFloat]:
    """The force [N] of each set-up that scatters beyond what is declared; empty if it does not."""
    if scatter is None or not scatter.excess:
        return {}
    shown = {"kind": "A", "dof": float(scatter.degrees_of_freedom)}
    return {name: named(0.0, scatter.excess, SCATTER, "N", **shown) for name in rig.of_setups}


def _mean(path: PathZeros, *, both: bool) -> float:
    """Force at zero [N]: the mean of both directions, or that of the forward runs."""
    zero = path.readings
    return (zero.forward + zero.backward) / 2.0 if both else zero.forward


def _u_mean(path: PathZeros, *, both: bool) -> float:
    zero = path.readings
    return math.hypot(zero.u_forward, zero.u_backward) / 2.0 if both else zero.u_forward


def _difference(path: PathZeros) -> float:
    """Half the difference of both directions [N], the force of the sideslip zero."""
    return (path.readings.forward - path.readings.backward) / 2.0


def _of_sweeps(points: Points, path: PathZeros, slope: float) -> list[tuple[np.ndarray, float]]:
    """By direction, the mean force at zero of every sweep (m,) [N], and the stated uncertainty of such a mean."""
    u = np.where(np.isfinite(points.u_Fy), points.u_Fy, USUAL_U_FORCE)
    out = []
    for direction in (1, -1):
        i = zeros(points, path.group, direction)
        i = i[np.isfinite(points.Fy[i])]
        force = points.Fy[i] - direction * slope * points.alpha[i]
        rows = [points.sweep[i] == k for k in np.unique(points.sweep[i])]
        if rows:
            means = np.array([np.mean(force[own]) for own in rows])
            out.append((means, _rms([float(np.linalg.norm(u[i][own])) / own.sum() for own in rows])))
    return out


def _declared_force(rig: method.UncertainRig, at: AtZero, *, both: bool) -> float:
    """Standard uncertainty of the force at zero [N] that the declared zeros of a set-up cause."""
    square = 0.0
    for error, declared in DECLARED:
        if error.of_setup and declared.force_at_zero and not (both and declared.turns_with_direction):
            square += float(declared.force_at_zero(rig.errors[error.name].std_dev, at)) ** 2
    return math.sqrt(square)


def _rms(values: Sequence[float]) -> float:
    return float(np.sqrt(np.mean(np.square(values))))


class SetupRemarks(NamedTuple):
    """Sentences about the set-ups: to know, and to act on."""

    notes: tuple[str, ...]
    warnings: tuple[str, ...]


def of_setups(
    points: Points, measured: Measured, scatter: SetupScatter | None, config: Config
) -> SetupRemarks:
    """What to know about the set-ups of a disc beside the numbers; nothing if there is only one on one path."""
    used = points.used_setups
    paths = {name: np.unique(points.phi_t[points.setup == points.setups.index(name)]) for name in used}
    if not config.rig.on_disc or (len(used) < 2 and all(len(found) < 2 for found in paths.values())):
        return SetupRemarks((), ())
    known, act = [], []
    if len(used) > 1:
        known.append(setup_notes.several_setups(used))
    known += [
        setup_notes.one_setup_on_paths(name, len(found)) for name, found in paths.items() if len(found) > 1
    ]
    without = [name for name in used if not _has_zeros(points, name)]
    act += [setup_notes.setup_without_zeros(name) for name in without] if len(used) > 1 else []
    act += _undeclared(config)
    row = measured.nominal
    for found in row.setups if row else ():
        first = row is not None and found is row.setups[0]
        if found.axis_off and not first and found.alpha_M is not None:
            act.append(setup_notes.setup_misaligned(found.name, found.alpha_M))
    if scatter is not None:
        sentence = setup_notes.setup_scatter(scatter)
        (act if scatter.chance < constants.SETUP_SCATTER_CHANCE else known).append(sentence)
    return SetupRemarks(tuple(known), tuple(act))


def _has_zeros(points: Points, setup: str) -> bool:
    """Whether a set-up has a point at zero sideslip and camber, rolled forwards."""
    index = np.flatnonzero((points.setup == points.setups.index(setup)) & ~points.continuous)
    return len(zeros(points, LoadGroup(math.nan, index), 1)) > 0


def _undeclared(config: Config) -> list[str]:
    """A sentence about sweeps that name no set-up although others on their path do."""
    named = {_path(config, k) for k, sweep in enumerate(config.sweep) if sweep.setup is not None}
    bare = [
        sweep.file
        for k, sweep in enumerate(config.sweep)
        if sweep.setup is None and _path(config, k) in named
    ]
    return [setup_notes.sweeps_without_setup(bare)] if bare else []


def _path(config: Config, k: int) -> tuple[str | None, float | None]:
    sweep = config.sweep[k]
    return sweep.path_centre or config.rig.path_centre, sweep.path_radius or config.rig.radius
