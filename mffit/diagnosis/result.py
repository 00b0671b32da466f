"""The record of a diagnosis: everything that a report says of it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from mffit.diagnosis.noise import Noise
from mffit.diagnosis.selection import Step
from mffit.diagnosis.state import State
from mffit.diagnosis.unknown import Bump
from mffit.diagnosis.validate import Gap, Validation
from mffit.diagnosis.where import Region
from mffit.effects import Effect
from mffit.points import Points
from mffit.rig import RigFaults
from tir import Tyre


@dataclass(frozen=True, slots=True)
class Found:
    """One accepted effect."""

    effect: Effect
    confidence: float  #: weight of its evidence among all candidates, ties shared
    parameters: Mapping[str, tuple[float, float]]  #: name -> (value, standard error)
    gap_after: Gap  #: with this and all earlier effects
    tied_with: tuple[str, ...]  #: ids that the data do not tell from it
    separate_by: str  #: the run that would

    def to_json(self) -> dict[str, Any]:
        return {
            "id": self.effect.id,
            "name": self.effect.name,
            "kind": self.effect.kind,
            "physics": self.effect.physics,
            "confidence": self.confidence,
            "parameters": {n: {"value": v, "stderr": s} for n, (v, s) in self.parameters.items()},
            "gap_after": self.gap_after.to_json(),
            "tied_with": list(self.tied_with),
            "separate_by": self.separate_by,
        }


@dataclass(frozen=True, slots=True)
class Diagnosis:
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
    state: State  #: the simulation after all corrections
    tyre: Tyre  #: the corrected property file
    turn_slip_before: bool
    headline: str  #: one sentence
    notes: tuple[str, ...]
    model_after: str  #: file name of the corrected model in the output folder

    @property
    def faults(self) -> RigFaults:
        """Rig faults and environment terms that were found."""
        return self.state.faults

    def to_json(self) -> dict[str, Any]:
        """The content of diagnosis.json."""
        return {
            "headline": self.headline,
            "gap_before": self.gap_before.to_json(),
            "gap_after": self.gap_after.to_json(),
            "validation": {
                "method": self.validation.method,
                "gap_before": self.validation.gap_before.to_json(),
                "gap_after": self.validation.gap_after.to_json(),
            },
            "where": [region.to_json() for region in self.where],
            "effects": [found.to_json() for found in self.effects],
            "alternatives": [
                {"id": name, "confidence": weight}
                for name, weight in sorted(self.alternatives.items(), key=lambda item: -item[1])
            ],
            "unexplained": self.unexplained,
            "unexplained_where": [region.to_json() for region in self.unexplained_where],
            "noise_floor": {"Fy_N": self.noise.Fy, "Mz_Nm": self.noise.Mz, "source": self.noise.source},
            "model_after": self.model_after,
            "notes": list(self.notes),
        }
