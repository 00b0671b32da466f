"""The record of a diagnosis, and readings corrected for the rig errors found."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np

from mffit.as_json import document, estimates, keys
from mffit.brief import Brief
from mffit.config.laboratory import LabTable
from mffit.diagnosis.bumps import Bump
from mffit.diagnosis.limits import Limit
from mffit.diagnosis.noise import Noise
from mffit.diagnosis.notes import DiagnosisNote
from mffit.diagnosis.rest import Answer, Rest
from mffit.diagnosis.selection import Contest
from mffit.diagnosis.smooth import Smooth
from mffit.diagnosis.ties import Separation
from mffit.diagnosis.validation import Gap, Validation, gap
from mffit.diagnosis.where import Region
from mffit.effects import Effect
from mffit.made import Made
from mffit.points import Points
from mffit.points.left_out import LeftOut
from mffit.rig import Simulation
from mffit.rig_errors import Faults
from mffit.scatter import rms
from mffit.suspicion import Outlier
from tir import Tyre
from tir.frozen import ReadOnlyArrays
from tir.parameters import BY_NAME

WITH_TERMS = "-with-terms.tir"
"""Ending of the name of the given property file with its coefficients estimated anew, next to the errors found."""


@dataclass(frozen=True, slots=True)
class Apart:
    """How far the given and the delivered property file are apart, over some conditions."""

    where: str  #: the conditions in words
    rms: Mapping[str, float]  #: by channel, in its unit
    largest: Mapping[str, float]


keys(Apart, "where rms largest")


@dataclass(frozen=True, slots=True)
class AcceptedEffect:
    """One accepted effect."""

    effect: Effect
    confidence: float  #: weight of its evidence among all candidates, ties shared
    parameters: Mapping[str, tuple[float, float]]  #: name -> (value, standard error)
    before: Mapping[str, float]  #: name -> value in the given model
    gap_after: Gap  #: gap with this and all earlier effects
    held_out: Gap  #: the same gap on left-out sweeps
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


keys(
    AcceptedEffect,
    "id=effect.id name=effect.name kind=effect.kind physics=effect.physics confidence repaired parameters to_do "
    "gap_after tied_with separate_by [T_ref_degC]",
    parameters=lambda found: {
        name: {"was": found.before[name], "value": value, "stderr": u}
        for name, (value, u) in found.parameters.items()
    },
    to_do=lambda _: None,  # by the signs of the rig, which the diagnosis has
    separate_by="mffit.diagnosis.wording.separate_by",
)


class GapStep(NamedTuple):
    """The gap after a correction and all those before it."""

    id: str  #: of the effect
    name: str
    gap: Gap
    held_out: Gap


@dataclass(frozen=True, slots=True, repr=False)
class Diagnosis(ReadOnlyArrays, Brief):
    """Where simulation and measurement disagree, what explains it, and what remains."""

    headline: str = field()  #: the answer in one sentence; replaces the property of Brief
    reasons: tuple[str, ...]  #: why the corrected model is not to be trusted, as sentences; empty if it is
    answer: Answer
    rest: tuple[Rest, ...]  #: what remains beyond chance, the most certain first
    name: str  #: name of the tyre, stem of the file names
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
    contests: tuple[Contest, ...]  #: all candidates in the place of each effect, or alone
    unexplained_where: tuple[Region, ...]
    bump: Bump | None
    smooth: Smooth | None  #: unnamed smooth structure
    outliers: tuple[Outlier, ...]
    coefficients: Mapping[str, tuple[float, float]]
    """Coefficients and rig errors estimated together with the effects: name -> (value, standard error)."""
    limits: tuple[Limit, ...]  #: upper limits of the effects that were not named
    given: Simulation  #: the given simulation
    state: Simulation  #: the simulation after all corrections
    signs: Mapping[str, float]  #: +1 or -1 per channel: the rig's axes over ISO-W
    delivers: (
        bool  #: whether a corrected property file is written, because an effect of the tyre was accepted
    )
    tyre: Tyre  #: the corrected property file if an effect of the tyre was accepted, else the given one
    notes: tuple[DiagnosisNote, ...]
    apart: tuple[
        Apart, ...
    ] = ()  #: given and corrected property file, at conditions measured and not measured
    with_terms: Tyre | None = None
    """The given property file with coefficients estimated anew, with errors of rig and environment if such were found, if no
    effect of the tyre was accepted."""
    given_file: str = (
        "the given file"  #: name of the given property file, from the output folder; set by the command
    )
    written_anyway: bool = False  #: whether the given model exists only here, and is written as well
    seen: bool = False  #: whether the model was fitted to these points
    made: Made | None = None  #: set by the command
    lab: LabTable = field(default_factory=LabTable)  #: set by the command
    left_out: tuple[LeftOut, ...] = ()  #: readings left out by hand and by rules; set by the command

    @property
    def unexplained(self) -> bool:
        """Whether something is missing that no effect of the library is."""
        return self.answer is Answer.UNKNOWN

    @property
    def trusted(self) -> bool:
        """Whether the corrected model is to be trusted: no rule found a reason against it."""
        return not self.reasons

    @property
    def model_after(self) -> str:
        """Path of the property file to use, relative to the output folder."""
        return f"{self.name}.tir" if self.delivers or self.written_anyway else self.given_file

    @property
    def file_said(self) -> str:
        """Bare name of the property file to use, as sentences say it: its readers are in any folder."""
        return self.model_after.rpartition("/")[2]

    @property
    def steps(self) -> tuple[GapStep, ...]:
        """The gap as given, with one repaired effect after the other, and with the coefficients estimated with them.

        Rig errors that were estimated together with them do not have a step of their own.
        """
        check = self.validation
        found = [GapStep("given", "as given", self.gap_examined, check.gap_before)]
        found += [
            GapStep(one.effect.id, one.effect.name, one.gap_after, one.held_out) for one in self.repaired
        ]
        if self.anew:
            found.append(
                GapStep("coefficients", "coefficients estimated anew", self.gap_after, check.gap_after)
            )
        return tuple(found)

    @property
    def anew(self) -> bool:
        """Whether coefficients of the property file were estimated together with the effects."""
        return any(name in BY_NAME for name in self.coefficients)

    @property
    def gap_examined(self) -> Gap:
        """Gap of the given model at the examined points, after known errors were subtracted from the readings."""
        return gap(self.noise.measured(self.points) - self.before, self.noise)

    @property
    def repaired(self) -> tuple[AcceptedEffect, ...]:
        """The effects for which model and readings are corrected."""
        return tuple(found for found in self.effects if found.repaired)

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
        """Name of the property file with coefficients estimated anew; None without one."""
        return None if self.with_terms is None else f"{self.name}{WITH_TERMS}"

    @property
    def faults(self) -> Faults:
        """Rig faults and environment terms of the corrected simulation."""
        return self.state.faults

    def ranked_alternatives(self) -> list[tuple[str, float]]:
        """Id and confidence of effects that were not accepted, likeliest first."""
        return sorted(self.alternatives.items(), key=lambda item: -item[1])


keys(
    Diagnosis,
    "trusted reasons headline verdict gap_before gap_after gap_by_effect validation where effects alternatives limits "
    "unexplained unexplained_where "
    "noise_floor=noise outliers coefficients model_after model_with_terms advice apart notes lab left_out [made]",
    verdict=lambda found: found.answer.name.lower(),
    gap_by_effect=lambda found: [
        {"id": step.id, "gap": document(step.gap), "held_out": document(step.held_out)}
        for step in found.steps
    ],
    advice="mffit.diagnosis.wording.advice",
    effects="mffit.diagnosis.wording.effects_with_remedies",
    alternatives=lambda found: [
        {"id": name, "confidence": weight} for name, weight in found.ranked_alternatives()
    ],
    coefficients=lambda found: estimates(found.coefficients),
    notes="mffit.diagnosis.wording.notes",
)


def corrected_points(points: Points, state: Simulation) -> Points:
    """Points with the readings that a faultless rig at reference conditions would give at the same angle readings.

    The diagnosed model, the simulation after all corrections, supplies the influence of the faults. The angles are not shifted,
    because that would break the mirror symmetry of the set-points.
    """
    faulty, faultless = state.readings(points), state.faultless.readings(points)
    return points.replace(
        **{name: points.channel(name) - (faulty[name] - faultless[name]) for name in faulty}
    )


def apart(
    points: Points, given: Simulation, corrected: Simulation, channels: Iterable[str]
) -> tuple[Apart, ...]:
    """How far two property files are apart on a perfect rig: at the conditions of the points, and where none was measured."""
    channels = tuple(channels)
    over = {"at the conditions measured": points}
    if np.any(points.phi_t):
        over["at the same on a straight path"] = points.replace(phi_t=0.0)
    over["over the tested ranges" + (" on a straight path" if np.any(points.phi_t) else "")] = _over_ranges(
        points
    )
    out = []
    for where, at in over.items():
        before, after = (one.faultless.readings(at, channels) for one in (given, corrected))
        change = {name: np.abs(after[name] - before[name]) for name in channels}
        out.append(
            Apart(
                where, {n: rms(x) for n, x in change.items()}, {n: float(x.max()) for n, x in change.items()}
            )
        )
    return tuple(out)


def _over_ranges(points: Points) -> Points:
    """A grid over the ranges of sideslip, camber, load and pressure of the points, on a straight path."""
    ranges = [
        np.linspace(x.min(), x.max(), n)
        for x, n in ((points.alpha, 9), (points.gamma, 7), (points.Fz, 3), (points.p, 3))
    ]
    alpha, gamma, Fz, p = (np.ravel(x) for x in np.meshgrid(*map(np.unique, ranges)))
    start = points.select(np.zeros(len(alpha), dtype=int))
    return start.replace(
        alpha=alpha,
        gamma=gamma,
        Fz=Fz,
        p=p,
        phi_t=0.0,
        kappa=0.0,
        direction=1,
        mount=1,
        continuous=False,
        time=np.nan,
    )
