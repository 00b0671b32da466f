"""Remarks of a diagnosis beside its findings: facts, put into sentences by :mod:`mffit.diagnosis.wording`."""

from __future__ import annotations

from dataclasses import dataclass

from mffit.diagnosis.validation import Validation
from mffit.effects import Effect
from mffit.suspicion import Misread
from tir import Quantity


@dataclass(frozen=True, slots=True)
class OneSweep:
    """There is only one sweep, which cannot separate causes."""


@dataclass(frozen=True, slots=True)
class CampaignsTogether:
    """Several campaigns of one tyre were looked at together."""

    counts: tuple[tuple[str, int], ...]  #: name of the campaign, number of its points
    grips: tuple[tuple[str, float, float], ...]
    """Name of the campaign, grip of its surface over that of the first, standard error."""


@dataclass(frozen=True, slots=True)
class AnotherTyre:
    """The model states other dimensions or nominal conditions than the configuration."""

    differences: tuple[
        tuple[str, float, float], ...
    ]  #: key of the property file, its value in the model, its value in tyre.toml


@dataclass(frozen=True, slots=True)
class TakenOff:
    """An error of the rig that was taken off the readings before effects were looked for."""

    sentence: str


@dataclass(frozen=True, slots=True)
class WithoutNoise:
    """The readings of some channels hardly scatter, as those of a simulation."""

    assumed: tuple[tuple[str, float], ...]  #: channel, and the noise that is assumed [N], [Nm]


@dataclass(frozen=True, slots=True)
class NoiseBeyondStated:
    """The readings of a channel scatter far more than stated, which hides misfit that nothing explains."""

    channel: str
    noise: float  #: typical, [N] or [Nm]
    stated: float  #: the same as stated
    sweep: str = ""  #: the sweep that is off much further than all others, if any


@dataclass(frozen=True, slots=True)
class OffsetsOrMemory:
    """Errors of a channel that are correlated along sweeps may be offsets of runs; these data cannot separate them."""

    channel: str
    memory: float  #: correlation from one point to the next
    noise: float  #: typical, [N] or [Nm]
    effects: tuple[Effect, ...]  #: offsets of runs that are as likely


@dataclass(frozen=True, slots=True)
class NotVisible:
    """Effects that the data cannot show."""

    needs: tuple[str, ...]  #: what the data lack, keys of ``mffit.effects.NEEDS``
    effects: tuple[Effect, ...]


@dataclass(frozen=True, slots=True)
class HardlyThisTyre:
    """The model is so wrong even with the best effects that naming one would be a guess."""

    misfit: float  #: in units of the noise
    channel: str  #: "Fy" | "Mz", whichever fits better


@dataclass(frozen=True, slots=True)
class NoRepair:
    """The best explanation raises the gap on left-out sweeps and is not written."""

    effects: tuple[str, ...]  #: their names
    validation: Validation


@dataclass(frozen=True, slots=True)
class FileKept:
    """The corrected property file without its rig and environment terms is worse than the given one, which is kept."""

    terms: tuple[str, ...]  #: names of the effects that no file contains
    validation: Validation


@dataclass(frozen=True, slots=True)
class ModelOfLastBuild:
    """The model is a file of the last build, other than the one with the plain name."""

    file: str


@dataclass(frozen=True, slots=True)
class ModelFittedFirst:
    """Without a given model or an earlier build, a model was fitted to the same points."""

    turn_slip: bool  #: whether the simulation computes turn slip


@dataclass(frozen=True, slots=True)
class DirectMethodRedone:
    """eps_gamma with and without the rig's faults in the readings; None where it could not be measured."""

    causes: tuple[str, ...]  #: names of the faults
    before: Quantity | None
    after: Quantity | None


Note = (
    OneSweep
    | CampaignsTogether
    | Misread
    | AnotherTyre
    | TakenOff
    | WithoutNoise
    | OffsetsOrMemory
    | NoiseBeyondStated
    | NotVisible
    | HardlyThisTyre
    | NoRepair
    | FileKept
    | ModelOfLastBuild
    | ModelFittedFirst
    | DirectMethodRedone
)
