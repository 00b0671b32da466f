"""What a diagnosis has to remark beside its findings: facts, put into sentences by :mod:`mffit.diagnosis.wording`."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from mffit.suspicion import Misread
from tir import Quantity

if TYPE_CHECKING:
    from mffit.diagnosis.validate import Validation


@dataclass(frozen=True, slots=True)
class OneSweep:
    """There is one sweep only, which cannot tell causes apart."""


@dataclass(frozen=True, slots=True)
class NotVisible:
    """Effects that the data cannot show."""

    needs: tuple[str, ...]  #: what the data lack, keys of ``mffit.effects.NEEDS``
    effects: tuple[str, ...]  #: ids


@dataclass(frozen=True, slots=True)
class HardlyThisTyre:
    """The model is so wrong, whatever is added, that naming an effect would be a guess."""

    misfit: float  #: in units of the noise
    channel: str  #: "Fy" | "Mz", the better


@dataclass(frozen=True, slots=True)
class NoRepair:
    """The best explanation raises the gap on left-out sweeps, so that nothing is repaired."""

    effects: tuple[str, ...]  #: their names
    validation: Validation


@dataclass(frozen=True, slots=True)
class ModelOfLastBuild:
    """The model is a file of the last build that does not carry the plain name."""

    file: str


@dataclass(frozen=True, slots=True)
class ModelFittedFirst:
    """No model was given and no build was there, so one was fitted to the same points."""

    turn_slip: bool  #: whether the simulation computes it


@dataclass(frozen=True, slots=True)
class DirectMethodRedone:
    """eps_gamma with the rig's faults in the readings and without them; None where it could not be measured."""

    causes: tuple[str, ...]  #: plain names of the faults
    before: Quantity | None
    after: Quantity | None


Note = (
    OneSweep
    | Misread
    | NotVisible
    | HardlyThisTyre
    | NoRepair
    | ModelOfLastBuild
    | ModelFittedFirst
    | DirectMethodRedone
)
