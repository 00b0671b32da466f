"""The record of a diagnosis: everything that a report says of it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from mffit.diagnosis import wording
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
from tir import Tyre


@dataclass(frozen=True, slots=True)
class Found:
    """One accepted effect."""

    effect: Effect
    confidence: float  #: weight of its evidence among all candidates, ties shared
    parameters: Mapping[str, tuple[float, float]]  #: name -> (value, standard error)
    gap_after: Gap  #: with this and all earlier effects
    tied_with: tuple[str, ...]  #: ids that the data do not tell from it
    separation: Separation | None  #: the run that would, if any is tied


@dataclass(frozen=True, slots=True)
class Outlier:
    """One reading that contradicts all others and lost its weight."""

    channel: str  #: "Fy" | "Mz"
    sweep: str
    file: str
    line: int  #: in that file, from 1; 0 if unknown
    residual: float  #: measured minus simulated after all corrections [N] or [Nm]
    z: float  #: in units of the noise of its neighbours


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
    smooth: Smooth | None  #: smooth structure without a name
    outliers: tuple[Outlier, ...]
    coefficients: Mapping[
        str, tuple[float, float]
    ]  #: inexact coefficients as estimated beside the effects: value and error
    state: Simulation  #: the simulation after all corrections
    tyre: Tyre  #: the corrected property file
    notes: tuple[Note | str, ...]  #: facts, and sentences of whoever ran the diagnosis
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

    def to_json(self) -> dict[str, Any]:
        """The content of diagnosis.json."""
        return {
            "headline": self.headline,
            "gap_before": _gap(self.gap_before),
            "gap_after": _gap(self.gap_after),
            "validation": {
                "method": wording.method(self.validation),
                "gap_before": _gap(self.validation.gap_before),
                "gap_after": _gap(self.validation.gap_after),
            },
            "where": [_region(region) for region in self.where],
            "effects": [_found(found) for found in self.effects],
            "alternatives": [
                {"id": name, "confidence": weight} for name, weight in self.ranked_alternatives()
            ],
            "unexplained": self.unexplained,
            "unexplained_where": [_region(region) for region in self.unexplained_where],
            "noise_floor": _noise(self.noise),
            "outliers": [asdict(outlier) for outlier in self.outliers],
            "coefficients": {n: {"value": v, "stderr": s} for n, (v, s) in self.coefficients.items()},
            "model_after": self.model_after,
            "notes": wording.notes(self),
        }


def _noise(noise: Noise) -> dict[str, Any]:
    """The noise that was found, beside the one that was stated."""
    n = len(noise.u) // 2
    stated = [u[np.isfinite(u)] for u in (noise.stated[:n], noise.stated[n:])]
    return {
        "Fy_N": noise.Fy,
        "Mz_Nm": noise.Mz,
        "source": noise.source,
        "stated_Fy_N": float(np.median(stated[0])) if len(stated[0]) else None,
        "stated_Mz_Nm": float(np.median(stated[1])) if len(stated[1]) else None,
        **{name: {k: v for k, v in asdict(s).items() if np.isfinite(v)} for name, s in noise.scatter.items()},
    }


def _gap(gap: Gap) -> dict[str, float]:
    return {"Fy_rmse_N": gap.Fy_rmse_N, "Mz_rmse_Nm": gap.Mz_rmse_Nm, "chi2_per_dof": gap.chi2_per_dof}


def _region(region: Region) -> dict[str, Any]:
    limits = {name: list(limits) for name, limits in region.region.items()}
    return {"channel": region.channel, "region": limits, "bias": region.bias, "z": region.z}


def _found(found: Found) -> dict[str, Any]:
    return {
        "id": found.effect.id,
        "name": found.effect.name,
        "kind": found.effect.kind,
        "physics": found.effect.physics,
        "confidence": found.confidence,
        "parameters": {n: {"value": v, "stderr": s} for n, (v, s) in found.parameters.items()},
        "gap_after": _gap(found.gap_after),
        "tied_with": list(found.tied_with),
        "separate_by": wording.separation(found.separation),
    }
