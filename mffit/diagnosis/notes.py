"""What a diagnosis has to remark beside its findings: facts, put into sentences by :mod:`mffit.diagnosis.wording`."""

from __future__ import annotations

from dataclasses import dataclass


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


@dataclass(frozen=True, slots=True)
class UncertaintiesEnlarged:
    """The misfit that nothing explains was counted as noise."""

    factor: float


Note = OneSweep | NotVisible | HardlyThisTyre | UncertaintiesEnlarged
