"""Files that were perhaps measured with the tyre turned on its rim: by all files together, because several hide each other."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence
from itertools import combinations
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from mffit.constants import FEWEST, MOST
from mffit.points import Points
from mffit.suspicion.rule import Facts, Outcome, When, rule
from tir.parameters import BY_NAME

if TYPE_CHECKING:
    from mffit.suspicion.others import FittedModel


@rule(
    id="undeclared-mount",
    when=When.AFTER,
    outcome=Outcome.WARNED,
    sentence="{files} would agree with the other files better if the tyre had been turned on its rim there ({sigma:.1f} standard "
    'deviations): was it? Then write mount = "flipped" (or "normal") in the [[sweep]] of each',
)
def undeclared_mount(points: Points, fitted: FittedModel) -> Iterator[Facts]:
    """Evidence for another mount of one file or several.

    The asymmetries of the tyre are refitted, because the files with another mount have distorted them. The model error is one of
    each file, as large as estimated: what the formula misses anyway, it may miss anywhere in a file alike. What is beyond that
    and the noise must mostly be due to the mount, because the formula misses more in some files than estimated for all.
    """
    from mffit.linearised.components import LIKELY_EVIDENCE  # after a fit only

    count = len(points.files)
    if count < FEWEST:
        return
    told = list(_told(points, fitted))
    share = np.bincount(points.file, minlength=count) / len(points)

    def evidence(files: Sequence[int]) -> float:
        return sum(one.evidence(files) for one in told) - math.log(math.comb(count, len(files)))

    best, files = max((evidence(one), one) for one in _singles_and_pairs(count))
    while True:
        longer = [(*files, k) for k in range(count) if k not in files]
        better, more = max(((evidence(one), one) for one in longer), default=(best, files))
        if better <= best:
            break
        best, files = better, more
    gain = best - evidence(())
    beyond = sum(max(one.stride * float(one.square[0].sum()) - one.readings, 0.0) for one in told)
    if gain > LIKELY_EVIDENCE and 2.0 * gain > MOST * beyond and sum(share[list(files)]) < MOST:
        yield {"files": " and ".join(points.files[k] for k in sorted(files)), "sigma": math.sqrt(2.0 * gain)}


def _singles_and_pairs(count: int) -> Iterable[tuple[int, ...]]:
    return (*combinations(range(count), 1), *combinations(range(count), 2))


class _Told(NamedTuple):
    """What one channel of each file tells of the fit's numbers: first with the declared mount, then with the other one."""

    information: np.ndarray  #: (2, files, k, k)
    pull: np.ndarray  #: (2, files, k)
    square: np.ndarray  #: (2, files) sums of squared residuals
    stride: int  #: readings that each examined one represents
    readings: int  #: number of readings

    def evidence(self, files: Sequence[int]) -> float:
        """Log evidence of the readings if these files have the other mount."""
        from mffit.linearised.gaussian import Informed

        which = list(files)
        information, pull, square = (
            one[0].sum(axis=0) + (one[1, which] - one[0, which]).sum(axis=0) for one in self[:3]
        )
        return self.stride * (Informed.by(information, pull).gain - 0.5 * float(square))


def _told(points: Points, fitted: FittedModel) -> Iterator[_Told]:
    """The sums of all channels, weighted by the covariance of noise and model error within each file."""
    names = list(fitted.left.channels)
    other = points.replace(mount=-points.mount)
    here, there = (fitted.simulation.readings(one, names) for one in (points, other))
    odd = [number.name in BY_NAME and BY_NAME[number.name].odd for number in fitted.left.numbers]
    for name, channel in fitted.left.channels.items():
        m, given = len(channel.missed), channel.variances
        size = channel.turn * np.exp(0.5 * given.common[m:])
        change = (there[name] - here[name])[channel.rows] / channel.unit
        residual = channel.model.residual
        sides = [
            np.column_stack([channel.slopes @ size, residual]),
            np.column_stack([np.where(odd, -1.0, 1.0) * channel.slopes @ size, residual - change]),
        ]
        error = channel.model.common[:, :m] * np.exp(0.5 * (given.common[:m] - given.noise))
        files = [points.file[channel.rows] == k for k in range(len(points.files))]
        sums = np.exp(-given.noise) * np.array([[_weighted(x[f], error[f]) for f in files] for x in sides])
        yield _Told(
            sums[..., :-1, :-1],
            sums[..., :-1, -1],
            sums[..., -1, -1],
            channel.stride,
            channel.stride * len(residual),
        )


def _weighted(x: np.ndarray, error: np.ndarray) -> np.ndarray:
    """Products (k, k) of columns (n, k) over the covariance of unit noise and of an error that is ``error`` (n, m) times
    independent numbers of unit variance.
    """
    across = error.T @ x
    return np.asarray(x.T @ x - across.T @ np.linalg.solve(np.eye(error.shape[1]) + error.T @ error, across))
