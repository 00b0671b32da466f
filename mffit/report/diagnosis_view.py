"""Everything that the diagnosis page shows, taken from the diagnosis in one place."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from mffit.diagnosis import AcceptedEffect, Diagnosis
from mffit.diagnosis.selection import ForwardStep
from mffit.diagnosis.where import Region
from mffit.effects import CATALOG
from mffit.points import Points
from mffit.report import constants, words
from mffit.report.channel import NamedChannel
from mffit.report.curves import Curve, CurveCondition, conditions, curves
from mffit.report.lines import CurveLine, model_lines
from tir.parameters import BY_NAME


@dataclass(frozen=True, slots=True, kw_only=True)
class GapChannel(NamedChannel):
    """One channel before and after: measured minus simulated in units of the noise of each point, (n,)."""

    before: np.ndarray
    after: np.ndarray
    noise: float  #: of a typical point, in ``unit``


@dataclass(frozen=True, slots=True, kw_only=True)
class Candidate:
    """One effect in one step."""

    name: str
    kind: str
    gain: float  #: of log evidence over the step before


@dataclass(frozen=True, slots=True, kw_only=True)
class RankedStep:
    """All candidates of one forward step, best first."""

    beside: tuple[str, ...]  #: names of the effects accepted before
    candidates: tuple[Candidate, ...]
    threshold: float  #: gain needed to be named

    @property
    def passed(self) -> bool:
        return bool(self.candidates) and self.candidates[0].gain > self.threshold


@dataclass(frozen=True, slots=True, kw_only=True)
class ShownNumber:
    """A number of an effect in the unit in which people read it."""

    value: float
    u: float
    unit: str
    before: float


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
    steps: tuple[RankedStep, ...]
    names: Mapping[str, str]  #: effect id -> plain name
    descriptions: Mapping[str, str]  #: coefficient -> its meaning
    words: Mapping[str, str]  #: of the numbers that are no coefficients of the property file
    shown: tuple[Shown, ...]  #: the worst and the typical sweep

    @property
    def changed(self) -> bool:
        """Whether effects are repaired, so that before and after differ."""
        return bool(self.diagnosis.repaired)

    def shown_number(self, found: AcceptedEffect, name: str) -> ShownNumber:
        """A number of an effect, now and before."""
        value, u, unit = words.in_unit(name, *found.parameters[name])
        return ShownNumber(
            value=value, u=u, unit=unit, before=words.in_unit(name, found.before[name], 0.0)[0]
        )

    def frames(self, channel: str) -> list[Region]:
        """Regions of a channel to be framed in the maps, unexplained ones first."""
        found = self.diagnosis.unexplained_where or self.diagnosis.where
        return [region for region in found if region.channel == channel][: constants.MOST_FRAMES]


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
    known = {e.id: e for e in (*CATALOG, *(t.effects[-1] for s in diagnosis.steps for t in s.trials))}
    freed = {name for found in diagnosis.effects for name in found.parameters}
    return DiagnosisView(
        title=diagnosis.model_after.removesuffix(".tir"),
        points=points,
        conditions=tuple(conditions(points)),
        channels=tuple(channels),
        diagnosis=diagnosis,
        steps=tuple(_ranked(step) for step in diagnosis.steps),
        names={key: effect.name for key, effect in known.items()},
        descriptions={name: BY_NAME[name].description for name in freed if name in BY_NAME},
        words={name: words.of_number(name) for name in freed if name not in BY_NAME},
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
        Shown(word=word, curve=curve, before=before[curve.key], after=after[curve.key])
        for word, curve in chosen.items()
    )


def _ranked(step: ForwardStep) -> RankedStep:
    candidates = (
        Candidate(
            name=trial.effects[-1].name,
            kind=trial.effects[-1].kind,
            gain=float(trial.log_evidence - step.before.log_evidence),
        )
        for trial in step.trials
    )
    return RankedStep(
        beside=tuple(effect.name for effect in step.before.effects),
        candidates=tuple(sorted(candidates, key=lambda c: -c.gain)),
        threshold=float(step.threshold),
    )


def shown_steps(view: DiagnosisView) -> Sequence[RankedStep]:
    """The steps that have candidates."""
    return [step for step in view.steps if step.candidates]
