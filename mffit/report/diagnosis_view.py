"""What the diagnosis page shows, taken from the diagnosis in this one place."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from mffit.effects import CATALOG
from mffit.points import Points
from mffit.report.curves import Condition, conditions
from tir.parameters import BY_NAME

MOST_FRAMES = 3
UNITS = {"Fy": "N", "Mz": "Nm"}
GAP_KEYS = {"Fy": "Fy_rmse_N", "Mz": "Mz_rmse_Nm"}
FLOOR_KEYS = {"Fy": "Fy_N", "Mz": "Mz_Nm"}


@dataclass(frozen=True, slots=True)
class GapChannel:
    """One channel before and after: measured minus simulated in units of the noise of each point, (n,)."""

    name: str
    before: np.ndarray
    after: np.ndarray

    @property
    def unit(self) -> str:
        return UNITS[self.name]


@dataclass(frozen=True, slots=True)
class Candidate:
    """One effect as it did in one step."""

    id: str
    name: str
    kind: str
    gain: float  #: in log evidence over the step before


@dataclass(frozen=True, slots=True)
class RankedStep:
    """All candidates of one forward step, best first."""

    beside: tuple[str, ...]  #: names of the effects accepted before
    candidates: tuple[Candidate, ...]
    threshold: float  #: gain needed to be named

    @property
    def passed(self) -> bool:
        return bool(self.candidates) and self.candidates[0].gain > self.threshold


@dataclass(frozen=True, slots=True)
class DiagnosisView:
    """Everything the diagnosis page needs; ``summary`` is the content of ``diagnosis.json``."""

    title: str
    points: Points
    conditions: tuple[Condition, ...]
    channels: tuple[GapChannel, ...]
    summary: Mapping[str, Any]
    steps: tuple[RankedStep, ...]
    kinds: Mapping[str, str]  #: effect id -> tyre, rig or environment
    names: Mapping[str, str]  #: effect id -> plain name
    descriptions: Mapping[str, str]  #: coefficient -> what it is

    @property
    def changed(self) -> bool:
        """Whether anything was added, so that before and after differ."""
        return bool(self.summary["effects"])

    def frames(self, channel: str) -> list[Mapping[str, Any]]:
        """Regions of a channel to be framed in the maps; more of them would hide the map."""
        own = [
            r for r in (*self.summary["unexplained_where"], *self.summary["where"]) if r["channel"] == channel
        ]
        return own[:MOST_FRAMES]


def view_of(diagnosis: Any) -> DiagnosisView:
    """Take a diagnosis apart; the only function that knows its attributes."""
    points, summary = diagnosis.points, diagnosis.to_json()
    n = len(points)
    channels = []
    for i, (name, measured) in enumerate((("Fy", points.Fy), ("Mz", points.Mz))):
        rows = slice(i * n, (i + 1) * n)
        u = np.where(np.isfinite(diagnosis.noise.u[rows]), diagnosis.noise.u[rows], np.nan)
        before, after = ((measured - model[rows]) / u for model in (diagnosis.before, diagnosis.after))
        if np.isfinite(before).any():
            channels.append(GapChannel(name, before, after))
    known = {e.id: e for e in (*CATALOG, *(t.effects[-1] for s in diagnosis.steps for t in s.trials))}
    freed = {name for effect in summary["effects"] for name in effect["parameters"]}
    return DiagnosisView(
        title=diagnosis.model_after.removesuffix(".tir"),
        points=points,
        conditions=tuple(conditions(points)),
        channels=tuple(channels),
        summary=summary,
        steps=tuple(_ranked(step) for step in diagnosis.steps),
        kinds={key: effect.kind for key, effect in known.items()},
        names={key: effect.name for key, effect in known.items()},
        descriptions={name: BY_NAME[name].description for name in freed if name in BY_NAME},
    )


def _ranked(step: Any) -> RankedStep:
    candidates = (
        Candidate(e.id, e.name, e.kind, float(t.log_evidence - step.before.log_evidence))
        for t, e in ((t, t.effects[-1]) for t in step.trials)
    )
    ordered = sorted(candidates, key=lambda c: -c.gain)
    return RankedStep(tuple(e.name for e in step.before.effects), tuple(ordered), float(step.threshold))


def shown_steps(view: DiagnosisView) -> Sequence[RankedStep]:
    """The steps worth a picture: those with candidates, at most three."""
    return [step for step in view.steps if step.candidates][:3]
