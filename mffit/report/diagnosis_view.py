"""Everything that the diagnosis page shows, taken from the diagnosis in one place."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from mffit.constants import NAMED_IN_SENTENCE
from mffit.diagnosis import Diagnosis
from mffit.diagnosis.selection import ForwardStep
from mffit.diagnosis.where import Region
from mffit.points import Points
from mffit.quantities import CHANNELS, QuantityName
from mffit.report.curves import Curve, CurveCondition, CurveLine, conditions, curves, model_lines


@dataclass(frozen=True, slots=True, kw_only=True)
class GapChannel:
    """One channel before and after: measured minus simulated in units of the noise of each point, (n,)."""

    name: str
    before: np.ndarray
    after: np.ndarray
    noise: float  #: of a typical point, in the channel's unit

    @property
    def known(self) -> QuantityName:
        return CHANNELS[self.name]


@dataclass(frozen=True, slots=True, kw_only=True)
class Shown:
    """One sweep with the simulation before and after."""

    word: str  #: "Worst" or "Typical"
    curve: Curve
    before: CurveLine
    after: CurveLine


@dataclass(frozen=True, slots=True, kw_only=True)
class DiagnosisView:
    """All content of the diagnosis page."""

    title: str
    points: Points
    conditions: tuple[CurveCondition, ...]
    channels: tuple[GapChannel, ...]
    diagnosis: Diagnosis
    shown: tuple[Shown, ...]  #: the worst and the typical sweep

    @property
    def changed(self) -> bool:
        """Whether effects are repaired, so that before and after differ."""
        return bool(self.diagnosis.repaired)

    @property
    def steps(self) -> list[ForwardStep]:
        """The forward steps that had candidates."""
        return [step for step in self.diagnosis.steps if step.trials]

    def frames(self, channel: str) -> list[Region]:
        """Regions of a channel to be framed in the maps, unexplained ones first."""
        found = self.diagnosis.unexplained_where or self.diagnosis.where
        return [region for region in found if region.channel == channel][:NAMED_IN_SENTENCE]


def view_of(diagnosis: Diagnosis) -> DiagnosisView:
    """The view of a diagnosis: residuals in units of noise, conditions, ranked candidates."""
    points, noise = diagnosis.points, diagnosis.noise
    channels = []
    for name, u in noise.by_channel(noise.u).items():
        u = np.where(np.isfinite(u), u, np.nan)
        before, after = (
            (points.channel(name) - noise.of_channel(model, name)) / u
            for model in (diagnosis.before, diagnosis.after)
        )
        if np.isfinite(before).any():
            channels.append(GapChannel(name=name, before=before, after=after, noise=noise.typical(name)))
    return DiagnosisView(
        title=diagnosis.model_after.removesuffix(".tir"),
        points=points,
        conditions=tuple(conditions(points)),
        channels=tuple(channels),
        diagnosis=diagnosis,
        shown=_shown(diagnosis, channels),
    )


def _shown(diagnosis: Diagnosis, channels: Sequence[GapChannel]) -> tuple[Shown, ...]:
    """The sweep with the largest and the one with the median misfit of the given model, in units of the noise."""
    found = curves(diagnosis.points)
    if not found or not channels:
        return ()
    squares = np.nanmean([c.before**2 for c in channels], axis=0)
    order = sorted(found, key=lambda curve: float(np.nanmean(squares[curve.index])))
    chosen = {"Worst": order[-1], "Typical": order[(len(order) - 1) // 2]}
    if len(order) == 1:
        chosen.pop("Typical")
    before, after = (
        model_lines(simulation, diagnosis.points, list(chosen.values()), diagnosis.noise.channels)
        for simulation in (diagnosis.given, diagnosis.state)
    )
    return tuple(
        Shown(word=word, curve=curve, before=before[curve], after=after[curve])
        for word, curve in chosen.items()
    )
