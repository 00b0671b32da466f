"""Points by load, and those among them that the direct method reads as zeros."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from mffit.constants import ZERO_CAMBER, ZERO_SIDESLIP
from mffit.measured import constants
from mffit.points import Points, levels, main_pressure


@dataclass(frozen=True, slots=True)
class LoadGroup:
    """The points of one load at the main pressure, normal mount."""

    load: float  #: mean load [N]
    index: np.ndarray  #: (m,) into the points


def load_groups(points: Points) -> tuple[LoadGroup, ...]:
    """Group the steady points at the programme's main pressure by load, rising; points between loads are left out."""
    used = np.flatnonzero(main_pressure(points) & (points.mount > 0) & ~points.continuous)
    level = levels.labels(points.Fz[used], levels.LOAD)
    parts = [used[level == k] for k in range(level.max(initial=levels.NO_LEVEL) + 1)]
    return tuple(LoadGroup(float(np.mean(points.Fz[part])), part) for part in parts)


def last_setup(points: Points, group: LoadGroup) -> LoadGroup:
    """The group's points of the last set-up among them."""
    setup = points.setup[group.index]
    return LoadGroup(group.load, group.index[setup == setup.max(initial=0)]) if len(setup) else group


def flipped(points: Points, group: LoadGroup) -> LoadGroup:
    """The points at the group's load and the main pressure with the tyre turned on its rim."""
    used = np.flatnonzero(main_pressure(points) & (points.mount < 0) & ~points.continuous)
    near = np.abs(points.Fz[used] - group.load) < levels.LOAD.tolerance * group.load
    return LoadGroup(group.load, used[near])


def zeros(points: Points, group: LoadGroup, direction: int) -> np.ndarray:
    """Indices of the group's points at zero sideslip and camber, rolling in ``direction`` (+1, -1)."""
    i = group.index
    near = (
        (np.abs(points.alpha[i]) < ZERO_SIDESLIP.rad)
        & (np.abs(points.gamma[i]) < ZERO_CAMBER.rad)
        & (points.direction[i] == direction)
    )
    i = i[near]
    return (
        i[np.abs(points.alpha[i]) < np.min(np.abs(points.alpha[i])) + constants.AVERAGED_ZEROS.rad]
        if len(i)
        else i
    )
