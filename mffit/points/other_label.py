"""Sweeps that read as their neighbours do under another label: another load, camber or pressure."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from scipy.special import chdtrc, chdtri, stdtrit

from mffit.constants import EXPLAINED_SHARE, FALSE_ALARM, FEWEST
from mffit.points import levels
from mffit.points.like import MeanReadings, conditions, mean_readings, noise, rolling
from mffit.points.points import Points, of_si
from mffit.quantities import COLUMNS, CONDITIONS
from mffit.scatter import ALARM, rms


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
        own, other = (f"{round(x, 1) + 0.0:.4g} {unit}" for x in (self.label, self.other))
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
    """The sweeps whose side forces agree with those of other sweeps at another load, camber or pressure, and not with their own.

    All other settings are alike. That the own label is wrong is seen from other sweeps at it, or, without any, from what the
    change of label does under other conditions; beyond chance, with every label of every sweep counted as a candidate, and beyond
    what repeated sweeps differ by, to which the lag of the force adds where some go up and some down.
    """
    used = rolling(points)
    u = noise(used)
    found: list[OtherLabel] = []
    while len(np.unique(used.sweep)) > 2:
        labelled = [_Labelled.of(setting, used, u) for setting in levels.SETTINGS]
        candidates = sum(len(one.label) * (len(one.values) - 1) for one in labelled)
        suspects = [one for each in labelled for one in each.suspects(used, candidates)]
        if not suspects:
            break
        worst = max(suspects, key=lambda one: (one.of_own, one.expected / one.noise))
        found.append(worst)
        # A wrong label makes suspects of its neighbours, so the others are judged without it.
        rest = used.sweep != used.sweep_names.index(worst.sweep)
        used, u = used.select(rest, with_table=False), u[rest]
    return tuple(found)


class _Compared(NamedTuple):
    """Differences of sweeps at settings that both have."""

    apart: np.ndarray  #: (n,) [N]
    u: np.ndarray  #: (n,) standard error by noise [N]
    force: np.ndarray  #: (n,) [N]
    conditions: int  #: number of combinations of the other labels

    @classmethod
    def joined(cls, parts: Sequence[_Compared]) -> _Compared | None:
        """All differences together; None without any."""
        if not parts:
            return None
        apart, u, force = (np.concatenate(one) for one in list(zip(*parts, strict=True))[:3])
        return cls(apart, u, force, sum(one.conditions for one in parts))

    @property
    def scatter(self) -> float:
        """Difference over the force beyond noise, rms."""
        beyond = float(np.sum(self.apart**2 - self.u**2)) / float(np.sum(self.force**2))
        return math.sqrt(max(beyond, 0.0))

    def variance(self, scatter: float) -> np.ndarray:
        """Of the differences (n,), by noise and by a scatter over the force [N^2]."""
        return self.u**2 + (scatter * self.force) ** 2

    def is_beyond(self, sound: _Compared, chance: float) -> bool:
        """Whether the differences are beyond noise and the scatter of sound repetitions, with this probability.

        A scatter over the force is common to a sweep, and known from few conditions, no better than noise lets it be.
        """
        noise = np.mean(self.u**2) * chdtri(len(self.apart), chance) / len(self.apart)
        uncertain = math.sqrt(2.0 * np.sum(sound.u**4)) / np.sum(sound.force**2)
        scatter = np.mean(self.force**2) * max(sound.scatter**2, uncertain)
        most = noise + scatter * stdtrit(sound.conditions, 1.0 - 0.5 * chance) ** 2
        return bool(np.mean(self.apart**2) > most)

    def is_noise(self, scatter: float) -> bool:
        """Whether noise and a scatter over the force explain the differences."""
        chi2 = float(np.sum(self.apart**2 / self.variance(scatter)))
        return float(chdtrc(len(self.apart), chi2)) >= FALSE_ALARM


@dataclass(frozen=True, slots=True)
class _Labelled:
    """Sweeps with one label of a setting each, and their differences from one another."""

    setting: str
    values: Mapping[int, float]  #: of the labels, in SI
    label: Mapping[int, int]  #: by sweep
    pairs: Mapping[tuple[int, int], _Compared]  #: by sweeps, the lower one first

    @classmethod
    def of(cls, setting: str, points: Points, u: np.ndarray) -> _Labelled:
        """The sweeps of some points under a setting; ``u`` (n,) are standard errors [N]."""
        label = levels.labels_of_setting(points, setting)
        values = {
            k: float(np.median(getattr(points, setting)[label == k])) for k in np.unique(label).tolist()
        }
        if len(values) < 2:
            return cls(setting, values, {}, {})
        keys = _keys(setting, points)
        swept: dict[int, MeanReadings] = {}
        labels: dict[int, int] = {}
        for k, own in points.rows_of_sweeps.items():
            if len(np.unique(label[own])) == 1:  # a sweep over this setting has no label of it
                swept[k], labels[k] = mean_readings(points, own, keys, u), int(label[own[0]])
        pairs = {
            (a, b): found
            for a, b in itertools.combinations(swept, 2)
            if (found := _compared(setting, swept[a], swept[b])) is not None
        }
        return cls(setting, values, labels, pairs)

    def between(self, first: int, second: int, *, without: int) -> list[_Compared]:
        """The differences of sweeps at two labels that are not those of one sweep."""
        return [
            found
            for (a, b), found in self.pairs.items()
            if without not in (a, b) and {self.label[a], self.label[b]} == {first, second}
        ]

    def from_others(self, sweep: int, label: int) -> _Compared | None:
        """The differences of a sweep from the others at a label."""
        return _Compared.joined(
            [
                found
                for (a, b), found in self.pairs.items()
                if sweep in (a, b) and self.label[b if a == sweep else a] == label
            ]
        )

    def suspects(self, points: Points, candidates: int) -> Iterator[OtherLabel]:
        """The sweeps that fit another label, of so many candidates."""
        column = COLUMNS[self.setting]
        scale = of_si(column)
        for sweep, at in self.label.items():
            sound = _Compared.joined([one for k in self.values for one in self.between(k, k, without=sweep)])
            scatter = 0.0 if sound is None else sound.scatter
            own = self.from_others(sweep, at)
            if own is not None and (sound is None or not own.is_beyond(sound, FALSE_ALARM / candidates)):
                continue
            for other in self.values.keys() - {at}:
                fit = self.from_others(sweep, other)
                if fit is None or not fit.is_noise(scatter):
                    continue
                expected = rms(own.apart) if own is not None else self._missing(sweep, other, fit, candidates)
                if expected > ALARM * rms(fit.u) * math.sqrt(2.0 / len(fit.apart)):
                    yield OtherLabel(
                        points.sweep_names[sweep],
                        column,
                        scale * self.values[at],
                        scale * self.values[other],
                        rms(fit.apart),
                        len(fit.apart),
                        expected,
                        rms(fit.u),
                        own is not None,
                    )

    def _missing(self, sweep: int, other: int, fit: _Compared, candidates: int) -> float:
        """What a change of label does under other conditions, rms at the forces of a sweep [N], if it lacks that; else 0."""
        effects = np.array([one.scatter for one in self.between(self.label[sweep], other, without=sweep)])
        if len(effects) < 2:
            return 0.0
        usual, spread = float(np.mean(effects)), float(np.std(effects, ddof=1))
        beyond = stdtrit(len(effects) - 1, 1.0 - FALSE_ALARM / candidates) * math.sqrt(
            1.0 + 1.0 / len(effects)
        )
        lacks = usual - fit.scatter > beyond * spread and fit.scatter < EXPLAINED_SHARE * usual
        return usual * rms(fit.force) if lacks else 0.0


def _keys(setting: str, points: Points) -> np.ndarray:
    """Per point (n, 7) what must be alike to compare sweeps under a setting: the labels of the others first, sideslip last."""
    others = [name for name in levels.SETTINGS if name != setting]
    alike = conditions(points, others)
    return np.column_stack([alike[:, : len(others)], points.setup, alike[:, len(others) :]])


def _differences(
    setting: str, first: MeanReadings, second: MeanReadings
) -> Iterator[tuple[float, float, float]]:
    """Difference of two sweeps [N], its standard error, and the force, at the settings that both have."""
    for key in first.keys() & second.keys():
        a, b = first[key], second[key]
        scale = 1.0 if setting == "Fz" else a.Fz / b.Fz
        moved = scale * b.Fy + a.slope * (a.alpha - b.alpha)
        yield moved - a.Fy, float(np.hypot(a.u, scale * b.u)), a.Fy


def _compared(setting: str, first: MeanReadings, second: MeanReadings) -> _Compared | None:
    """Two sweeps; None with too few common readings, without noise, or of a dead channel."""
    common = first.keys() & second.keys()
    if len(common) < FEWEST:
        return None
    apart, u, force = np.transpose(list(_differences(setting, first, second)))
    if not np.all(u > 0.0) or not np.any(force):
        return None
    return _Compared(apart, u, force, len({key[:2] for key in common}))
