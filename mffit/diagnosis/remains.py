"""What a fit leaves of the readings: its structure, and the effect that would explain it best."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from mffit.diagnosis.one_step import BestEffect, best_effect, held_numbers
from mffit.diagnosis.remainder import left_out_sweeps, remainder
from mffit.diagnosis.structure import Structure, structure
from mffit.fit.fitted import Fitted
from mffit.suspicion import HeldNumber, LeftOutSweeps


@dataclass(frozen=True, slots=True)
class Remains:
    """The residuals of a fit, examined."""

    structure: Structure
    effect: BestEffect | None = None  #: the best of all effects, significant or not; None if none can be seen
    held: tuple[HeldNumber, ...] = ()  #: numbers at a bound or a physical limit
    left_out: Mapping[str, LeftOutSweeps] = field(
        default_factory=dict
    )  #: by channel, prediction of left-out sweeps


NOTHING_REMAINS = Remains(Structure(()))


def remains(fitted: Fitted) -> Remains:
    """The residuals of a fit at its solution, examined by all tests."""
    left = remainder(fitted)
    return Remains(structure(left), best_effect(left), held_numbers(left, fitted), left_out_sweeps(left))
