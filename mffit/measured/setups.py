"""Set-ups of the rig: results of each set-up alone, and the scatter of repeated set-ups beyond the declared uncertainty."""

import math
from collections.abc import Iterable, Sequence

import numpy as np
from scipy.special import chdtrc
from uncertainties import UFloat

from mffit.config import Config, path_curvature
from mffit.constants import FALSE_ALARM, NAMED_IN_SENTENCE
from mffit.measured import wording
from mffit.measured.axis import slope_at, split_of_zero
from mffit.measured.camber_reduction import camber_reduction
from mffit.measured.evidence import DirectEvidence
from mffit.measured.result import LoadResult, SetupResult, SetupScatter, is_clear
from mffit.measured.stiffnesses import LoadSlopes
from mffit.measured.turning import Turning
from mffit.measured.uncertain import named, quantity, quantity_if
from mffit.measured.zeros import LoadGroup, zeros, zeros_by_path
from mffit.points import Points
from mffit.rig_errors import DECLARED, AtZero
from mffit.scatter import rms

SCATTER = "scatter of repeated set-ups"
"""Name of the scatter in the uncertainty budget."""


def results_of_setups(
    evidence: DirectEvidence, found: Turning, C_alpha: UFloat | None, C_gamma: UFloat, r_e: UFloat
) -> tuple[SetupResult, ...]:
    """Turn-slip force and eps_gamma of every path and set-up alone; empty if there is only one.

    Stiffnesses are in N/rad, that of camber corrected for rig errors; r_e is the effective radius [m].
    """
    if len(found.paths) < 2:
        return ()
    out, left = [], evidence.config.rig.u("alpha_0_deg")
    slope = slope_at(C_alpha, found.zeros.group.load)
    for path in found.paths:
        zero, C_phit = path.zeros, path.stiffness
        axis = evidence.axes.get(zero.setup)
        alpha_M = axis and axis.at(zero.group.load)
        beyond = alpha_M is not None and bool(abs(slope * alpha_M.nominal_value) > left)
        split = split_of_zero(alpha_M, slope, left)
        out.append(
            SetupResult(
                zero.setup,
                zero.phi_t,
                quantity(path.force, "N"),
                quantity(C_phit, "Nm"),
                quantity(camber_reduction(C_phit, C_gamma, r_e), "-"),
                quantity_if(alpha_M, "rad"),
                beyond,
                beyond and split is not None and is_clear(quantity(split.misalignment, "rad")),
            )
        )
    return tuple(out)


def setup_scatter(
    evidence: DirectEvidence, stiffnesses: Sequence[tuple[LoadGroup, LoadSlopes]]
) -> SetupScatter | None:
    """Scatter of the zeros of repeated set-ups on one path, at the load nearest to the nominal one; None without repetition.

    One-way analysis of variance. If set-ups scatter by more than declared zeros and noise explain, the excess is a source of
    uncertainty of its own: a type A evaluation whose degrees of freedom are set-ups less paths (JCGM 100, 4.2).
    """
    config, rig = evidence.config, evidence.rig
    assert rig is not None
    for group, slopes in sorted(stiffnesses, key=lambda row: abs(row[0].load - config.tyre.nominal_load)):
        found = zeros_by_path(evidence.points, group, slopes.C_alpha, config)
        of_paths = [[x for x in found if x.phi_t == path] for path in dict.fromkeys(x.phi_t for x in found)]
        repeated = [of_path for of_path in of_paths if len(of_path) > 1]
        if repeated:
            break
    else:
        return None
    paths = [path for of_path in repeated for path in of_path]
    both = all(path.backward is not None for path in paths)
    means = [np.array([path.mean(both=both).nominal_value for path in of_path]) for of_path in repeated]
    freedom = len(paths) - len(repeated)
    square = sum(float(np.sum((mean - mean.mean()) ** 2)) for mean in means) / freedom
    of_noise = rms(np.array([path.mean(both=both).std_dev for path in paths])) ** 2
    slope = slope_at(slopes.C_alpha, group.load)
    at = AtZero(slope, 0.0 if slopes.C_gamma is None else slopes.C_gamma.nominal_value, 0.0)
    declared = math.hypot(
        *(
            float(declared.force_at_zero(rig.errors[error.name].std_dev, at))
            for error, declared in DECLARED
            if error.of_setup and declared.force_at_zero and not (both and declared.turns_with_direction)
        )
    )
    between = math.sqrt(max(square - of_noise, 0.0))
    return SetupScatter(
        load=group.load,
        setups=tuple(dict.fromkeys(path.setup for path in paths)),
        between=between,
        degrees_of_freedom=freedom,
        declared=declared,
        chance=float(chdtrc(freedom, freedom * square / (declared**2 + of_noise))),
        excess=math.sqrt(max(between**2 - declared**2, 0.0)),
    )


def excess_forces(scatter: SetupScatter | None, setups: Iterable[str]) -> dict[str, UFloat]:
    """By set-up, the force [N] of its scatter in excess of the declared one; empty without excess."""
    if scatter is None or not scatter.excess:
        return {}
    shown = {"kind": "A", "dof": float(scatter.degrees_of_freedom)}
    return {name: named(0.0, scatter.excess, SCATTER, "N", **shown) for name in setups}


def warnings_of_setups(
    points: Points, row: LoadResult | None, scatter: SetupScatter | None, config: Config
) -> list[str]:
    """Warnings about the set-ups of a disc, from the results at the nominal load; empty with only one set-up."""
    used = points.used_setups
    if not config.rig.on_disc or len(used) < 2:
        return []
    out = []
    for name in used:
        steady = np.flatnonzero((points.setup == points.setups.index(name)) & ~points.continuous)
        if not len(zeros(points, LoadGroup(math.nan, steady), 1)):
            out.append(wording.SETUP_WITHOUT_ZEROS.format(name=name))
    out += _undeclared(config)
    # The first set-up is covered by the sentence on the alignment of the whole test.
    for found in row.setups[1:] if row else ():
        if found.axis_off and found.alpha_M is not None:
            out.append(
                wording.SETUP_MISALIGNED.format(name=found.name, angle=wording.angle_text(found.alpha_M))
            )
    if scatter is not None and scatter.chance < FALSE_ALARM:
        out.append(wording.setup_scatter(scatter))
    return out


def _undeclared(config: Config) -> list[str]:
    """A sentence about sweeps that name no set-up although others on their path do."""
    paths = [path_curvature(config.rig, sweep) for sweep in config.sweep]
    named = {path for path, sweep in zip(paths, config.sweep, strict=True) if sweep.setup is not None}
    bare = [
        sweep.file
        for path, sweep in zip(paths, config.sweep, strict=True)
        if sweep.setup is None and path in named
    ]
    files = ", ".join(bare[:NAMED_IN_SENTENCE]) + " and others" * (len(bare) > NAMED_IN_SENTENCE)
    return [wording.SWEEPS_WITHOUT_SETUP.format(files=files)] if bare else []
