"""The notes of a finished measurement, in the order in which they are read."""

from __future__ import annotations

import numpy as np

from mffit.measured import constants, notes
from mffit.measured.evidence import DirectEvidence
from mffit.measured.result import LoadResult
from mffit.measured.zero_split import AlignmentVerdict
from mffit.points import levels, main_pressure
from tir import Quantity


def remarks(
    evidence: DirectEvidence,
    row: LoadResult,
    skew: Quantity | None,
    warmer: float,
    axis: AlignmentVerdict,
    load_note: str,
) -> tuple[str, ...]:
    """Notes beside the numbers of the nominal load.

    Parameters
    ----------
    evidence : with the declared uncertainties
    row : the results at the nominal load
    skew : camber skew from sweeps in both directions [deg]
    warmer : temperature of the camber sweep above that of the zeros [K]
    axis : verdict on the sideslip axis
    load_note : about PECP2
    """
    one_setup = len({setup.name for setup in row.setups}) < 2
    several = (
        [notes.several_paths([-1.0 / phi_t for phi_t in row.paths], one_setup=one_setup)]
        if len(row.paths) > 1
        else []
    )
    return (
        *([axis.sentence] if axis.sentence and not axis.misaligned else []),
        *([notes.camber_skew(skew)] if skew else []),
        *several,
        *_conicity(evidence, row),
        *_temperature(evidence, row, warmer),
        *([] if row.secant_bias is None else [notes.secant_bias(row.secant_bias, evidence.published)]),
        load_note,
        notes.ON_THE_PATH,
        *_pressure(evidence),
        notes.STANDARD_UNCERTAINTIES,
        notes.CONTACT_WANDERS,
    )


def _pressure(evidence: DirectEvidence) -> list[str]:
    """At which pressure everything holds, if that is not the nominal one."""
    used = float(np.mean(evidence.points.p[main_pressure(evidence.points)]))
    nominal = 1e3 * evidence.config.tyre.nominal_pressure
    near = abs(used - nominal) < levels.PRESSURE.tolerance
    return [] if near else [notes.off_nominal_pressure(used, nominal)]


def _conicity(evidence: DirectEvidence, row: LoadResult) -> list[str]:
    """The sentence on conicity; none where paths on both sides of the disc cancel it."""
    if row.conicity is not None:
        return [notes.conicity_measured(row.conicity)]
    force = evidence.config.rig.u_conicity * row.load
    shift = row.shift_by(force)
    if min(row.paths) < 0.0 < max(row.paths) or not force:
        return []
    return [notes.conicity(evidence.config.rig.u_conicity, force, shift)]


def _temperature(evidence: DirectEvidence, row: LoadResult, warmer: float) -> list[str]:
    assert row.epsilon_gamma is not None
    if abs(warmer) < constants.TEMPERATURE_APART:
        return []
    spread = evidence.shared.warming.std_dev
    return [notes.temperature(warmer, spread, abs((1.0 - row.epsilon_gamma.value) * warmer * spread))]
