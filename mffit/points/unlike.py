"""Files whose forces differ under like conditions, as those of two tyres do."""

import itertools
from typing import NamedTuple

import numpy as np

from mffit.constants import FEWEST, STRAIGHT
from mffit.points import constants, levels
from mffit.points.like import MeanReading, conditions, mean_readings, noise, rolling
from mffit.points.points import Points
from mffit.quantities import CONDITIONS
from mffit.scatter import ALARM, rms

SETTINGS = (*levels.SETTINGS, "V")


class Unlike(NamedTuple):
    """Two files that differ at conditions that both hold."""

    first: str
    second: str
    share: float  #: difference of the side forces, rms, over their own rms; 0 if chance explains it
    gain: float  #: side force of the second file over that of the first
    newtons: float  #: difference at the condition at which they differ most, rms
    where: str  #: this condition, in words

    @property
    def sentence(self) -> str:
        """The remark about the two files."""
        return (
            f"{self.second} reads side forces that are {self.gain:.2f} times those of {self.first} at like conditions, "
            f"{self.newtons:.0f} N rms apart at {self.where}: two tyres, two states of one (warm, worn), or a wrong label; make "
            "a project of each if they are two tyres"
        )


def unlike_files(points: Points) -> tuple[Unlike, ...]:
    """Pairs of files whose side forces over sideslip differ by more than zeros of the rig explain, the worst pair first.

    Conditions are levels of load, camber, pressure and speed, direction, mount and path; only the freely rolling wheel is
    compared. What a zero of the force or of the sideslip makes is taken off.
    """
    used = rolling(points)
    files = np.unique(used.file).tolist()
    if len(files) < 2:
        return ()
    keys, u = conditions(used, SETTINGS), noise(used)
    readings = {k: mean_readings(used, np.flatnonzero(used.file == k), keys, u) for k in files}
    apart: dict[tuple[int, int], list[_Difference]] = {}
    for one, other in itertools.combinations(files, 2):
        common = np.array(sorted(readings[one].keys() & readings[other].keys())).reshape(-1, keys.shape[1])
        for rows in levels.rows_of_equal(common[:, :-1]):
            first, second = ([readings[k][tuple(key)] for key in common[rows].tolist()] for k in (one, other))
            in_cell = np.all(keys[:, :-1] == common[rows[0], :-1], axis=1) & np.isin(used.file, (one, other))
            found = _difference(first, second, used.select(in_cell, with_table=False))
            if found is not None:
                apart.setdefault((one, other), []).append(found)
    pairs = (_pair(points.files[one], points.files[other], found) for (one, other), found in apart.items())
    return tuple(
        sorted((pair for pair in pairs if pair.share > constants.UNLIKE_SHARE), key=lambda pair: -pair.share)
    )


class _Difference(NamedTuple):
    """Difference of two files at one condition; forces per load."""

    left: np.ndarray  #: (m,) without the effect of zeros
    size: np.ndarray  #: (m,) force of the first file
    error: np.ndarray  #: (m,) standard error of the difference
    gain: float
    load: float  #: [N]
    where: str


def _difference(first: list[MeanReading], second: list[MeanReading], cell: Points) -> _Difference | None:
    """The difference of two files at common steps of sideslip, in rising order; None with too few."""
    both = np.array(
        [
            [(one.alpha, one.Fy / one.Fz, np.nan_to_num(one.u) / one.Fz) for one in of]
            for of in (first, second)
        ]
    )
    # an angle that is held between two steps is in both
    apart = np.min(np.diff(both[:, :, 0], axis=1), axis=0) > 0.5 * STRAIGHT.rad
    both = both[:, np.append(True, apart)]
    if both.shape[1] < FEWEST + 2:  # two zeros are taken off
        return None
    (x, y, u), (x_other, y_other, u_other) = np.swapaxes(both, 1, 2)
    slope = np.gradient(y, x)
    change = y_other - y - slope * (x_other - x)
    zeros = np.column_stack([np.ones(len(x)), slope])  # of the force, and of the sideslip
    left = change - zeros @ np.linalg.lstsq(zeros, change, rcond=None)[0]
    centred = y - zeros @ np.linalg.lstsq(zeros, y, rcond=None)[0]
    if not np.any(centred):  # a dead channel
        return None
    gain = 1.0 + float(centred @ left) / float(centred @ centred)
    return _Difference(left, centred, np.hypot(u, u_other), gain, float(np.median(cell.Fz)), _named(cell))


def _named(cell: Points) -> str:
    load, camber, pressure = (
        CONDITIONS[column].of(float(np.median(cell.condition(column))))
        for column in ("Fz_N", "gamma_deg", "p_kPa")
    )
    return f"{load}, camber {camber}, {pressure}"


def _pair(first: str, second: str, found: list[_Difference]) -> Unlike:
    left, size, error = (
        np.concatenate([getattr(one, name) for one in found]) for name in ("left", "size", "error")
    )
    worst = max(found, key=lambda one: rms(one.left) * one.load)
    weights = [float(one.size @ one.size) for one in found]
    gain = float(np.average([one.gain for one in found], weights=weights))
    share = rms(left) / rms(size) if rms(left) > ALARM * rms(error) else 0.0
    return Unlike(first, second, share, gain, rms(worst.left) * worst.load, worst.where)
