"""What the diagnosis page shows, taken from the diagnosis in this one place."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from mffit.points import Points
from mffit.report.curves import Condition

UNITS = {"Fy": "N", "Mz": "Nm"}
GAP_KEYS = {"Fy": "Fy_rmse_N", "Mz": "Mz_rmse_Nm"}
FLOOR_KEYS = {"Fy": "Fy_N", "Mz": "Mz_Nm"}


@dataclass(frozen=True, slots=True)
class GapChannel:
    """One channel before and after; arrays (n,), in units of the noise of each point."""

    name: str
    before: np.ndarray
    after: np.ndarray

    @property
    def unit(self) -> str:
        return UNITS[self.name]


@dataclass(frozen=True, slots=True)
class DiagnosisView:
    """Everything the diagnosis page needs; the mappings are those of ``diagnosis.json``."""

    tyre: str
    headline: str
    points: Points
    conditions: tuple[Condition, ...]
    channels: tuple[GapChannel, ...]
    gap_before: Mapping[str, float]
    gap_after: Mapping[str, float]
    validation: Mapping[str, Any]
    noise_floor: Mapping[str, float]
    where: Sequence[Mapping[str, Any]]
    effects: Sequence[Mapping[str, Any]]
    alternatives: Sequence[Mapping[str, Any]]
    kinds: Mapping[str, str]  #: effect id -> tyre, rig or environment
    names: Mapping[str, str]  #: effect id -> plain name
    physics: Mapping[str, str]  #: effect id -> one sentence
    unexplained: bool
    unexplained_where: Sequence[Mapping[str, Any]]
    notes: tuple[str, ...]
    model_before: str
    model_after: str
    seconds: float


def view_of(diagnosis: Any) -> DiagnosisView:
    """Take a diagnosis apart; the only function that knows its attributes."""
    raise NotImplementedError
