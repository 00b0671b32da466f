"""Rig errors that camber sweeps in both directions measure: the camber skew."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

from mffit.measured import constants, notes
from mffit.measured.agreed import agreed
from mffit.measured.camber_reduction import known_quantity
from mffit.measured.evidence import DirectEvidence
from mffit.measured.load_slopes import LoadSlopes
from mffit.rig_errors import DECLARED, AtZero, Declared, RigError
from tir import Quantity


def with_measured_skew(
    evidence: DirectEvidence, slopes: Sequence[LoadSlopes]
) -> tuple[DirectEvidence, Quantity | None]:
    """The evidence with the rig error that adds to the camber stiffness as measured, and its value in the declared unit.

    Rolling backwards the camber force keeps its sign and the slip force changes it: half the difference of both slopes is
    what the rig adds, half their sum is the camber stiffness. One difference determines one number: if several errors add
    to the slope, it is their sum, and the one that is declared most uncertain takes it.
    """
    both = [
        (row.C_alpha, row.C_gamma, row.C_gamma_backward)
        for row in slopes
        if row.C_alpha is not None and row.C_gamma is not None and row.C_gamma_backward is not None
    ]
    if evidence.rig is None or not both:
        return evidence, None
    errors = dict(evidence.rig.errors)
    error, declared = max(adding_to_camber(), key=lambda pair: errors[pair[0].name].std_dev)
    assert declared.camber_stiffness is not None
    found = agreed(
        errors[error.name],
        [
            (forward - backward) / (2.0 * declared.camber_stiffness(1.0, AtZero(C_alpha, forward, 0.0)))
            for C_alpha, forward, backward in both
        ],
    )
    errors[error.name] = found
    measured = replace(evidence, rig=replace(evidence.rig, errors=errors))
    return measured, known_quantity(found, declared.unit)


def skew_warning(evidence: DirectEvidence, skew: Quantity | None) -> list[str]:
    """A sentence if the measured skew is far beyond its declaration."""
    if skew is None:
        return []
    declared = max(evidence.config.rig.u(error.name) for error, _ in adding_to_camber())
    beyond = abs(skew.value) > constants.SKEW_BEYOND_DECLARATION * math.hypot(declared, skew.u)
    return [notes.camber_skew_beyond(skew, declared)] if beyond else []


def adding_to_camber() -> tuple[tuple[RigError, Declared], ...]:
    """The declared rig errors that add to the slope over camber, each with its declaration."""
    return tuple((error, declared) for error, declared in DECLARED if declared.camber_stiffness)
