"""Combinations of conditions that were never tested, where each condition alone lies inside its tested range."""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Self

import numpy as np

from mffit.linearised.inputs import LEVELS, REVERSED, Input
from tir.correction import interpolated
from tir.frozen import ReadOnlyArrays

SLIP_OF = {"Fx": "kappa", "Fy": "alpha", "Mz": "alpha"}
"""By channel, the slip without which there is hardly a force."""


@dataclass(frozen=True, slots=True, eq=False)
class Combinations(ReadOnlyArrays):
    """The settings of the conditions of a test plan, a spacing apart: which combinations were tested, and how far others are.

    The arrays have an axis for each such condition, in the order of ``inputs``.
    """

    inputs: tuple[Input, ...]  #: (d,) all conditions
    tested: np.ndarray  #: whether readings show a combination
    strays: np.ndarray  #: variance of the formula's error over the square of the force; 0 where tested

    @classmethod
    def of(cls, inputs: tuple[Input, ...], settings: np.ndarray, growth: np.ndarray, channel: str) -> Self:
        """The combinations of readings of a channel at ``settings`` (n, d); ``growth`` (d,) as beyond the tested ranges.

        The mirror image of a tested combination counts as tested. From a tested one the error grows with each condition that
        differs, as beyond the tested range of that condition; of all ways, the one counts on which it grows least.
        """
        tested, start = _tested(inputs, settings), SLIP_OF.get(channel, "")
        near = _grown(inputs, growth, tested, np.where(tested, 0.0, np.inf), start)
        far = _grown(inputs, growth, tested, near, "")
        return cls(inputs, tested, np.where(np.isfinite(near), near, far))

    def at(self, settings: np.ndarray) -> np.ndarray:
        """Variance (n,) over the square of the force at conditions (n, d); beyond a range, that at its end."""
        which = planned(self.inputs)
        if not which:
            return np.zeros(len(settings))
        nodes = [self.inputs[i].settings() for i in which]
        return np.asarray(interpolated(nodes, self.strays[..., None], settings[:, which].T)[0])

    def untested(self, settings: np.ndarray) -> list[tuple[str, ...]]:
        """For each of the conditions (n, d), the names of two that were never combined there; empty where all were."""
        which = planned(self.inputs)
        places = np.clip(_places(self.inputs, settings), 0, np.array(self.tested.shape) - 1)
        found: list[tuple[str, ...]] = [()] * len(settings)
        for pair, known in _pairs(self.tested):
            for row in np.flatnonzero(~known.squeeze()[tuple(places[:, pair].T)]):
                found[row] = tuple(self.inputs[which[k]].name for k in pair)
        return found


def planned(inputs: Sequence[Input]) -> list[int]:
    """Places of the conditions of a test plan among all."""
    return [i for i, one in enumerate(inputs) if one.name in LEVELS]


def _places(inputs: Sequence[Input], settings: np.ndarray) -> np.ndarray:
    """Numbers (n, k) of the nearest settings of the planned conditions, from the lower end of the range."""
    which = planned(inputs)
    lower, spacing = (np.array([getattr(inputs[i], name) for i in which]) for name in ("lower", "spacing"))
    return np.asarray(np.rint((settings[:, which] - lower) / spacing), dtype=int)


def _tested(inputs: Sequence[Input], settings: np.ndarray) -> np.ndarray:
    """Whether readings at ``settings`` (n, d), or their mirror images, show each combination.

    They show two conditions at which, or on both sides of which, they lie; and more conditions if they show all pairs of these.
    """
    mirror = np.array([-1.0 if one.name in REVERSED else 1.0 for one in inputs])
    shape = [len(inputs[i].settings()) for i in planned(inputs)]
    places = _places(inputs, np.vstack([settings, settings * mirror]))
    places = places[np.all((places >= 0) & (places < shape), axis=1)]
    tested = np.zeros(shape, dtype=bool)
    tested[tuple(places.T)] = True
    for axis in range(len(shape)):
        below = np.logical_or.accumulate(tested, axis)
        above = np.flip(np.logical_or.accumulate(np.flip(tested, axis), axis), axis)
        tested = below & above
    return np.asarray(
        np.logical_and.reduce(np.broadcast_arrays(np.ones(shape, dtype=bool), *dict(_pairs(tested)).values()))
    )


def _pairs(tested: np.ndarray) -> Iterator[tuple[tuple[int, int], np.ndarray]]:
    """For each pair of axes, whether their settings were tested together at any of the others, whose axes are 1 long."""
    for pair in itertools.combinations(range(tested.ndim), 2):
        others = tuple(axis for axis in range(tested.ndim) if axis not in pair)
        yield pair, np.any(tested, axis=others, keepdims=True)


def _grown(
    inputs: Sequence[Input], growth: np.ndarray, tested: np.ndarray, strays: np.ndarray, slip: str
) -> np.ndarray:
    """The least variance at every combination on ways along the conditions, from combinations with ``strays``.

    A way along the ``slip`` that makes the force begins only where several settings of it were tested: no force shows nothing.
    """
    for axis, i in enumerate(planned(inputs)):
        one, own = inputs[i], inputs[i].settings()
        ways = np.moveaxis(strays, axis, -1)[..., None, :] + growth[i] ** 2 * one.strayed(own[:, None], own)
        if one.name == slip:
            there = np.moveaxis(tested, axis, -1)
            alone = there & (np.sum(there, axis=-1, keepdims=True) == 1)
            ways = np.where(alone[..., None, :] & ~np.eye(len(own), dtype=bool), np.inf, ways)
        strays = np.moveaxis(np.min(ways, axis=-1), -1, axis)
    return strays
