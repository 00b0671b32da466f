"""An order of the runs in which temperature does not change together with load, camber or pressure."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from mffit.fit.influences.confounding import LEVELS, SETTINGS
from mffit.planning import constants
from mffit.points import Points, levels


@dataclass(frozen=True, slots=True)
class RunOrder:
    """The present sweeps in another order."""

    sweeps: tuple[str, ...]  #: names, in the order in which to run them
    now: Mapping[str, float]  #: by setting, correlation ratio with the temperature in the present order
    then: Mapping[str, float]  #: the same in this order, if the tyre warms up as it did


def mixed_order(points: Points) -> RunOrder:
    """The order of the sweeps in which their settings tell least about the temperature, by swaps of two sweeps.

    The tyre is taken to warm up over the test as it did, whatever sweep is run when.
    """
    sweeps = list(dict.fromkeys(points.sweep.tolist()))
    label = {
        setting: levels.nearest_labels(np.abs(getattr(points, channel)), LEVELS[channel])
        for setting, (channel, _) in SETTINGS.items()
    }
    rows = [points.sweep == k for k in sweeps]
    size = np.array([float(np.sum(own)) for own in rows])
    mean = np.array([float(np.mean(points.T[own])) for own in rows])
    # By setting, the number of points of each sweep at each level (s, l).
    counts = {
        setting: np.array([np.bincount(found[own], minlength=found.max() + 1) for own in rows], dtype=float)
        for setting, found in label.items()
    }
    course = np.cumsum(size) - 0.5 * size

    def ratios(order: np.ndarray) -> dict[str, float]:
        ends = np.cumsum(size[order])
        T = np.empty(len(order))
        T[order] = np.interp(ends - 0.5 * size[order], course, mean)
        centre = float(size @ T) / float(size.sum())
        total = float(size @ (T - centre) ** 2)
        out = {}
        for setting, count in counts.items():
            held = count.sum(axis=0)
            used = held > 0.0
            between = held[used] @ (((T @ count)[used] / held[used]) - centre) ** 2
            out[setting] = float(np.sqrt(between / total)) if total > 0.0 else 0.0
        return out

    def misfit(order: np.ndarray) -> float:
        return sum(ratio**2 for ratio in ratios(order).values())

    here = np.arange(len(sweeps))
    random = np.random.default_rng(0)
    best, least = here, misfit(here)
    for _ in range(constants.SWAPS_OF_RUNS):
        i, j = random.choice(len(best), 2, replace=False)
        other = best.copy()
        other[[i, j]] = other[[j, i]]
        found = misfit(other)
        if found < least:
            best, least = other, found
    return RunOrder(
        sweeps=tuple(points.sweep_names[sweeps[k]] for k in best), now=ratios(here), then=ratios(best)
    )
