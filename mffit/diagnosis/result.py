"""The record of a diagnosis: everything that a report says of it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from mffit.brief import Brief
from mffit.diagnosis import wording
from mffit.diagnosis.limits import Limit
from mffit.diagnosis.noise import Noise
from mffit.diagnosis.notes import Note
from mffit.diagnosis.selection import Step
from mffit.diagnosis.smooth import Smooth
from mffit.diagnosis.ties import Separation
from mffit.diagnosis.unknown import Bump
from mffit.diagnosis.validate import Gap, Validation
from mffit.diagnosis.where import Region
from mffit.effects import Effect
from mffit.points import Points
from mffit.rig import RigFaults, Simulation
from mffit.suspicion import Outlier
from tir import Tyre


@dataclass(frozen=True, slots=True)
class Found:
    """One accepted effect."""

    effect: Effect
    confidence: float  #: weight of its evidence among all candidates, ties shared
    parameters: Mapping[str, tuple[float, float]]  #: name -> (value, standard error)
    before: Mapping[str, float]  #: the same as given
    gap_after: Gap  #: with this and all earlier effects
    tied_with: tuple[str, ...]  #: ids that the data do not tell from it
    separation: Separation | None  #: the run that would, if any is tied
    T_ref: float | None = None  #: temperature from which an effect of temperature counts [degC]


@dataclass(frozen=True, slots=True, repr=False)
class Diagnosis(Brief):
    """Where simulation and measurement disagree, what explains it, and what remains."""

    points: Points
    noise: Noise
    before: np.ndarray  #: readings of the given model (2n,), Fy [N] then Mz [Nm]
    after: np.ndarray  #: readings of the corrected model (2n,)
    gap_before: Gap
    gap_after: Gap
    validation: Validation
    where: tuple[Region, ...]
    effects: tuple[Found, ...]
    alternatives: Mapping[str, float]  #: id -> confidence of what was not accepted
    steps: tuple[Step, ...]
    unexplained: bool
    unexplained_where: tuple[Region, ...]
    bump: Bump | None
    smooth: Smooth | None  #: smooth structure without a name
    outliers: tuple[Outlier, ...]
    coefficients: Mapping[
        str, tuple[float, float]
    ]  #: inexact coefficients as estimated beside the effects: value and error
    limits: tuple[Limit, ...]  #: how large what was not named can be
    given: Simulation  #: the simulation as given
    state: Simulation  #: the simulation after all corrections
    signs: Mapping[str, float]  #: +1 or -1 per channel: what turns ISO-W into the rig's axes
    tyre: Tyre  #: the corrected property file
    notes: tuple[Note, ...]
    model_after: str  #: file name of the corrected model in the output folder

    @property
    def faults(self) -> RigFaults:
        """Rig faults and environment terms that were found."""
        return self.state.faults

    @property
    def headline(self) -> str:
        """The whole answer in one sentence."""
        return wording.headline(self)

    def ranked_alternatives(self) -> list[tuple[str, float]]:
        """Id and confidence of what was not accepted, likeliest first."""
        return sorted(self.alternatives.items(), key=lambda item: -item[1])
