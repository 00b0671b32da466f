"""The record of a diagnosis, and readings corrected for the rig errors found."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field

import numpy as np

from mffit.brief import Brief
from mffit.config.laboratory import LabTable
from mffit.diagnosis.bumps import Bump
from mffit.diagnosis.limits import Limit
from mffit.diagnosis.noise import Noise
from mffit.diagnosis.notes import DiagnosisNote
from mffit.diagnosis.selection import ForwardStep
from mffit.diagnosis.smooth import Smooth
from mffit.diagnosis.ties import Separation
from mffit.diagnosis.validation import Gap, Validation, gap
from mffit.diagnosis.where import Region
from mffit.effects import Effect
from mffit.made import Made
from mffit.points import Points
from mffit.points.left_out import LeftOut
from mffit.quantities import SIDEWAYS
from mffit.rig import Simulation
from mffit.rig_errors import Faults
from mffit.suspicion import SOUND, Outlier, Trust
from tir import Tyre

WITH_TERMS = "-with-terms.tir"
"""Ending of the name of the property file that is right only together with rig and environment terms."""


@dataclass(frozen=True, slots=True)
class AcceptedEffect:
    """One accepted effect."""

    effect: Effect
    confidence: float  #: weight of its evidence among all candidates, ties shared
    parameters: Mapping[str, tuple[float, float]]  #: name -> (value, standard error)
    before: Mapping[str, float]  #: name -> value in the given model
    gap_after: Gap  #: gap with this and all earlier effects
    tied: tuple[Effect, ...]  #: effects that explain the data equally well in its place
    separation: Separation | None  #: the run that separates them; None without a tie
    T_ref: float | None = None  #: reference temperature of an effect of temperature [degC]
    together: float = 0.0  #: confidence in this effect or one of the tied ones that are not likelier
    repaired: bool = True  #: whether model and readings are corrected for it; otherwise it is only suspected

    @property
    def tied_with(self) -> tuple[str, ...]:
        """Ids of the tied effects."""
        return tuple(effect.id for effect in self.tied)

    def confidence_of_tie(self, alternatives: Mapping[str, float]) -> float:
        """Confidence in this effect or any tied one; ``alternatives`` has confidences of other effects by id."""
        listed = self.confidence + sum(alternatives.get(other, 0.0) for other in self.tied_with)
        return max(listed, self.together)


@dataclass(frozen=True, slots=True, repr=False)
class Diagnosis(Brief):
    """Where simulation and measurement disagree, what explains it, and what remains."""

    headline: str = field()  #: the answer in one sentence; replaces the property of Brief
    points: Points
    noise: Noise
    before: np.ndarray  #: readings of the given model (c n,), in the channels of ``noise``
    after: np.ndarray  #: readings of the corrected model (c n,), with the repaired effects
    gap_before: Gap  #: gap of the given model at all points, with uncorrected readings
    gap_after: Gap  #: gap of the corrected model
    gap_named: Gap  #: gap with all named effects, repaired or not
    validation: Validation
    where: tuple[Region, ...]
    effects: tuple[AcceptedEffect, ...]
    alternatives: Mapping[str, float]  #: id -> confidence of effects that were not accepted
    steps: tuple[ForwardStep, ...]
    unexplained: bool
    unexplained_where: tuple[Region, ...]
    bump: Bump | None
    smooth: Smooth | None  #: unnamed smooth structure
    outliers: tuple[Outlier, ...]
    coefficients: Mapping[str, tuple[float, float]]
    """Coefficients estimated together with the effects: name -> (value, standard error)."""
    limits: tuple[Limit, ...]  #: upper limits of the effects that were not named
    given: Simulation  #: the given simulation
    state: Simulation  #: the simulation after all corrections
    signs: Mapping[str, float]  #: +1 or -1 per channel: the rig's axes over ISO-W
    tyre: Tyre  #: the corrected property file, or the given one if it is better without further terms
    notes: tuple[DiagnosisNote, ...]
    model_after: str  #: file name of the corrected model in the output folder
    with_terms: Tyre | None = None
    """The corrected property file if it is right only with rig and environment terms; ``tyre`` is then the given one."""
    made: Made | None = None  #: set by the command
    lab: LabTable = field(default_factory=LabTable)  #: set by the command
    left_out: tuple[LeftOut, ...] = ()  #: readings left out by hand and by rules; set by the command
    trust: Trust = SOUND  #: the judgement of the corrected model

    @property
    def trusted(self) -> bool:
        """Whether there is no reason against trusting the corrected model."""
        return self.trust.trusted

    @property
    def reasons(self) -> tuple[str, ...]:
        """Reasons against trust, as sentences; empty for a sound model."""
        return self.trust.reasons

    @property
    def gap_examined(self) -> Gap:
        """Gap of the given model at the examined points, after known errors were subtracted from the readings."""
        measured = np.concatenate([self.points.channel(name) for name in self.noise.channels])
        return gap(measured - self.before, self.noise)

    @property
    def repaired(self) -> tuple[AcceptedEffect, ...]:
        """The effects for which model and readings are corrected."""
        return tuple(found for found in self.effects if found.repaired)

    @property
    def is_corrected(self) -> bool:
        """Whether the model after is another than the given one."""
        return bool(self.repaired or self.coefficients)

    @property
    def suspected(self) -> tuple[AcceptedEffect, ...]:
        """The effects that are named but not repaired."""
        return tuple(found for found in self.effects if not found.repaired)

    @property
    def terms(self) -> tuple[AcceptedEffect, ...]:
        """The repaired effects of rig and environment, which a property file cannot contain."""
        return tuple(found for found in self.repaired if found.effect.kind != "tyre")

    @property
    def model_with_terms(self) -> str | None:
        """Name of the property file that is right only with rig and environment terms; None without one."""
        return None if self.with_terms is None else self.model_after.removesuffix(".tir") + WITH_TERMS

    @property
    def faults(self) -> Faults:
        """Rig faults and environment terms of the corrected simulation."""
        return self.state.faults

    def ranked_alternatives(self) -> list[tuple[str, float]]:
        """Id and confidence of effects that were not accepted, likeliest first."""
        return sorted(self.alternatives.items(), key=lambda item: -item[1])


def corrected_points(points: Points, state: Simulation, channels: Iterable[str] = SIDEWAYS) -> Points:
    """Points with the readings that a faultless rig at reference conditions would give at the same angle readings.

    The diagnosed model, the simulation after all corrections, supplies the influence of the faults. The angles are not shifted,
    because that would break the mirror symmetry of the set-points.
    """
    channels = tuple(channels)
    faulty, faultless = state.readings(points, channels), state.faultless.readings(points, channels)
    return points.replace(
        **{name: points.channel(name) - (faulty[name] - faultless[name]) for name in faulty}
    )
