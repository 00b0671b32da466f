"""Files that were perhaps measured with the tyre turned on its rim: by all files together, because several hide each other."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence
from itertools import combinations
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from mffit.constants import FEWEST, MOST
from mffit.points import Points
from mffit.scatter import robust
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

    The asymmetries of the tyre are refitted, because the files with another mount have distorted them. The model error is left
    aside, because a mount would hide in it.
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
    if gain > LIKELY_EVIDENCE and sum(share[list(files)]) < MOST:
        yield {"files": " and ".join(points.files[k] for k in sorted(files)), "sigma": math.sqrt(2.0 * gain)}


def _singles_and_pairs(count: int) -> Iterable[tuple[int, ...]]:
    return (*combinations(range(count), 1), *combinations(range(count), 2))


class _Told(NamedTuple):
    """What one channel of each file tells of the fit's numbers: first with the declared mount, then with the other one."""

    information: np.ndarray  #: (2, files, k, k)
    pull: np.ndarray  #: (2, files, k)
    square: np.ndarray  #: (2, files) sums of squared residuals
    stride: int  #: readings that each examined one represents

    def evidence(self, files: Sequence[int]) -> float:
        """Log evidence of the readings if these files have the other mount."""
        from mffit.linearised.gaussian import Informed

        which = list(files)
        information, pull, square = (
            one[0].sum(axis=0) + (one[1, which] - one[0, which]).sum(axis=0) for one in self[:3]
        )
        return self.stride * (Informed.by(information, pull).gain - 0.5 * float(square))


def _told(points: Points, fitted: FittedModel) -> Iterator[_Told]:
    """The sums of all channels, without the model error and random effects of runs, in which a mount would hide."""
    names = list(fitted.left.channels)
    other = points.replace(mount=-points.mount)
    here, there = (fitted.simulation.readings(one, names) for one in (points, other))
    odd = [number.name in BY_NAME and BY_NAME[number.name].odd for number in fitted.left.numbers]
    for name, channel in fitted.left.channels.items():
        size = channel.turn * np.exp(0.5 * channel.variances.common[len(channel.missed) :])
        change = (there[name] - here[name])[channel.rows] / channel.unit
        scale = max(robust(channel.model.residual), 1.0)
        columns = [
            turned @ size / scale for turned in (channel.slopes, np.where(odd, -1.0, 1.0) * channel.slopes)
        ]
        residuals = [one / scale for one in (channel.model.residual, channel.model.residual - change)]
        file = points.file[channel.rows]
        parts = [
            [(x[file == k], r[file == k]) for k in range(len(points.files))]
            for x, r in zip(columns, residuals, strict=True)
        ]
        yield _Told(
            np.array([[x.T @ x for x, _ in own] for own in parts]),
            np.array([[x.T @ r for x, r in own] for own in parts]),
            np.array([[r @ r for _, r in own] for own in parts]),
            channel.stride,
        )
