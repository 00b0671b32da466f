"""Sweeps that read as their neighbours do under another label: another load, camber or pressure."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import NamedTuple

import numpy as np
from scipy.special import chdtrc

from mffit.constants import EXPLAINED_SHARE, FALSE_ALARM
from mffit.points import constants, levels
from mffit.points.like import MeanReadings, conditions, mean_readings, noise, rolling
from mffit.points.points import Points, of_si
from mffit.quantities import CONDITIONS
from mffit.scatter import ALARM, rms

LABELS = {"Fz": ("Fz_N", levels.LOAD), "p": ("p_kPa", levels.PRESSURE), "gamma": ("gamma_deg", levels.CAMBER)}
"""By setting, its column and its levels."""


class OtherLabel(NamedTuple):
    """A sweep that fits its neighbours under another label."""

    sweep: str
    column: str
    label: float  #: in the column's unit
    other: float  #: the label that it fits
    apart: float  #: difference from the neighbours at the other label, rms [N]
    n: int  #: number of compared readings
    expected: float  #: difference that the label makes, rms [N]
    noise: float  #: standard error of a difference, rms [N]
    of_own: bool  #: whether neighbours at its own label contradict it

    @property
    def sentence(self) -> str:
        """The remark about the sweep."""
        word, _, unit = CONDITIONS[self.column][:3]
        own, other = (f"{x:.4g} {unit}" for x in (self.label, self.other))
        why = (
            f"is {self.expected:.0f} N off the sweeps at its own {own}"
            if self.of_own
            else f"where {own} moves such readings by about {self.expected:.0f} N in other sweeps"
        )
        link = ", and " if self.of_own else ", "
        return (
            f"{self.sweep}, labelled {own}, reads as the sweeps at a {word} of {other} do ({self.n} readings, "
            f"{self.apart:.0f} N rms apart){link}{why}: is its {word} {other}? Correct {self.column} there if it is"
        )


def other_labels(points: Points) -> tuple[OtherLabel, ...]:
    """The sweeps whose side forces agree within their noise with those of other sweeps at another load, camber or pressure.

    All other settings are alike, and the one in doubt moves the forces.

    That it does is seen at the sweep's own label, where other sweeps differ from it, or elsewhere in the campaign.
    """
    used = rolling(points)
    u = noise(used)
    found: list[OtherLabel] = []
    while len(np.unique(used.sweep)) > 2:
        suspects = [one for setting in LABELS for one in _under(setting, used, u)]
        if not suspects:
            break
        worst = max(suspects, key=lambda one: (one.of_own, one.expected / one.noise))
        found.append(worst)
        # A wrong label makes suspects of its neighbours, so the others are judged without it.
        rest = used.sweep != used.sweep_names.index(worst.sweep)
        used, u = used.select(rest, with_table=False), u[rest]
    return tuple(found)


def _under(setting: str, points: Points, u: np.ndarray) -> Iterator[OtherLabel]:
    """The sweeps that fit another level of one setting."""
    column, kind = LABELS[setting]
    label = levels.labels_of_setting(getattr(points, setting), points.sweep, kind)
    values = {k: float(np.median(getattr(points, setting)[label == k])) for k in np.unique(label).tolist()}
    if len(values) < 2:
        return
    others = [(name, one) for name, (_, one) in LABELS.items() if name != setting]
    keys = np.column_stack([points.setup, conditions(points, others)])
    swept: dict[tuple[int, int], MeanReadings] = {}
    for k in np.unique(points.sweep).tolist():
        own = np.flatnonzero(points.sweep == k)
        if len(np.unique(label[own])) == 1:  # a sweep over this setting has no label of it
            swept[k, int(label[own[0]])] = mean_readings(points, own, keys, u)
    matter = {
        pair: share
        for pair in {(a, b) for _, a in swept for _, b in swept if a != b}
        if (share := _effect(setting, swept, *pair)) is not None
    }
    for (k, at), readings in swept.items():
        rest = {key: one for key, one in swept.items() if key[0] != k}
        same = _compared(setting, readings, [one for (_, b), one in rest.items() if b == at])
        contradicts = same is not None and same.chance < FALSE_ALARM
        for other in values:
            if other == at:
                continue
            fit = _compared(setting, readings, [one for (_, b), one in rest.items() if b == other])
            if fit is None or fit.chance < FALSE_ALARM:
                continue
            if same is not None and contradicts:
                expected = same.apart
            elif same is None and (at, other) in matter:
                expected = matter[at, other] * fit.size
                if fit.beyond_noise > EXPLAINED_SHARE * expected:
                    continue
            else:
                continue
            if expected > ALARM * fit.noise * np.sqrt(2.0 / fit.n):
                scale = of_si(column)
                yield OtherLabel(
                    points.sweep_names[k],
                    column,
                    scale * values[at],
                    scale * values[other],
                    fit.apart,
                    fit.n,
                    expected,
                    fit.noise,
                    contradicts,
                )


class _Compared(NamedTuple):
    n: int
    apart: float  #: rms [N]
    noise: float  #: standard error of a difference, rms [N]
    size: float  #: side force, rms [N]
    chance: float  #: probability of such differences by noise

    @property
    def beyond_noise(self) -> float:
        """Difference without the part that noise makes, rms [N]."""
        return float(np.sqrt(max(self.apart**2 - self.noise**2, 0.0)))


def _differences(
    setting: str, first: MeanReadings, second: MeanReadings
) -> Iterator[tuple[float, float, float]]:
    """Difference of two sweeps [N], its standard error, and the force, at the settings that both have."""
    for key in first.keys() & second.keys():
        a, b = first[key], second[key]
        scale = 1.0 if setting == "Fz" else a.Fz / b.Fz
        moved = scale * b.Fy + a.slope * (a.alpha - b.alpha)
        yield moved - a.Fy, float(np.hypot(a.u, scale * b.u)), a.Fy


def _compared(setting: str, readings: MeanReadings, others: list[MeanReadings]) -> _Compared | None:
    """A sweep against others; None with too few common readings."""
    all_of = [one for other in others for one in _differences(setting, readings, other)]
    if len(all_of) < constants.FEWEST_COMPARED_LABELS:
        return None
    apart, u, force = np.transpose(all_of)
    if not np.all(u > 0.0) or not np.any(force):  # without noise, or of a dead channel
        return None
    chi2 = float(np.sum((apart / u) ** 2))
    return _Compared(len(apart), rms(apart), rms(u), rms(force), float(chdtrc(len(apart), chi2)))


def _effect(setting: str, swept: Mapping[tuple[int, int], MeanReadings], at: int, other: int) -> float | None:
    """Difference over force that a change of label makes in pairs of sweeps, rms over all; None without pairs."""
    found = [
        _compared(setting, one, [second])
        for (_, a), one in swept.items()
        if a == at
        for (_, b), second in swept.items()
        if b == other
    ]
    known = [one for one in found if one is not None]
    beyond = [one for one in known if one.chance < FALSE_ALARM]
    return rms(np.array([one.apart / one.size for one in beyond])) if beyond else None
