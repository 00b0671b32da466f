"""Nuisance parameters of the tyre's state and of the rig that a fit may free in addition to the coefficients, in one list."""

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

from mffit.config import Config
from mffit.constants import FEWEST_SWEEPS_TO_PREDICT, LEAST_SHARE_OF_A_SENSE, UPRIGHT, VISIBLE_TEMPERATURE
from mffit.fit.problem import FitProblem
from mffit.least_squares import FreeNumber
from mffit.points import Points, levels
from mffit.points.clock import sense
from mffit.rig import distance_km
from mffit.rig_errors import BY_NAME, OF_RUN, number_of
from mffit.suspicion import parts_of_sweeps
from tir.errors import counted

TEMPERATURE = "temperature"
"""Key of [fit] for the influences of the tyre's temperature, whose fit is written to a second file."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Nuisance:
    """One influence: the numbers of :mod:`mffit.rig_errors` that it frees, and the data that it needs."""

    id: str
    name: str  #: in words
    key: str  #: key of [fit]: "auto", true, false, or the id
    numbers: tuple[str, ...]
    lacking: Callable[[Points], str]  #: why these points cannot show it, in words; empty if they can
    after: str = ""  #: id of the influence that must be modelled first
    rival: str = ""  #: id of an influence with nearly the same effect: one of the two is modelled
    per_run: bool = False
    """Whether each run (sweep) has its own numbers, random effects around their undisturbed values."""

    def free(self, points: Points, scatter: Mapping[str, float]) -> tuple[FreeNumber, ...]:
        """The free numbers with their bounds; ``scatter`` gives, by name, the prior standard deviation of random effects."""
        if not self.per_run:
            return tuple(_number(name) for name in self.numbers)
        runs = [points.sweep_names[k] for k in np.unique(points.sweep)]
        return tuple(_number(name, run, scatter[name]) for name in self.numbers for run in runs)

    def of_no_rig(self, problem: FitProblem) -> bool:
        """Whether a number is zero or has a sign that is physically impossible."""
        signs = {name: BY_NAME[name].known_sign for name in self.numbers}
        return any(sign and sign * problem.value(name) <= 0.0 for name, sign in signs.items())

    def setting(self, config: Config) -> bool | None:
        """The demand of [fit]: True or False, or None if the data decide."""
        given = getattr(config.fit, self.key)
        if given is False:
            return False
        if given == "auto" or self.after:
            return None
        return given is True or given == self.id


def _number(name: str, run: str = "", spread: float = math.inf) -> FreeNumber:
    error, value = BY_NAME[name], BY_NAME[name].undisturbed
    return FreeNumber(number_of(name, run), value, error.lower, error.upper, expected=value, spread=spread)


MIDDLE = (25.0, 75.0)
"""Percentiles between which the angles of one sense of sweeping must overlap those of the other."""


def _temperatures(points: Points) -> str:
    known = np.isfinite(points.T)
    if not np.any(known):
        return "T_degC was not measured"
    if not np.all(known):
        return f"T_degC is missing at {int(np.sum(~known))} of {len(points)} points"
    moved = float(np.ptp(points.T))
    least = VISIBLE_TEMPERATURE
    return "" if moved > least else f"T_degC moves by {moved:.1f} K only, and {least:g} K are needed"


def _cambers(points: Points) -> str:
    tilted = float(np.max(np.abs(points.gamma)))
    return "" if tilted > UPRIGHT.rad else "there are no sweeps at camber"


def _slips(points: Points) -> str:
    driven = ~points.free_rolling & np.isfinite(points.Fx)
    return "" if np.any(driven) else "no sweep varies longitudinal slip"


def _speeds(points: Points) -> str:
    return "" if levels.count(points.V, levels.SPEED) > 1 else "a single speed was run"


def _pressures_of_moment(points: Points) -> str:
    if not np.any(np.isfinite(points.Mx)):
        return "Mx_Nm was not measured"
    return "" if levels.count(points.p, levels.PRESSURE) > 1 else "a single pressure was run"


def _senses(points: Points) -> str:
    """Whether both senses go through the same angles, and conditions alone do not tell which sense it was.

    A sense that follows load, camber or pressure looks like their effect; they are separated inside a sweep that goes there and
    back, by sweeps of one condition in either sense, and by senses that alternate over several conditions.
    """
    moving, part = sense(points), parts_of_sweeps(points)
    sizes = np.bincount(part)
    for way in (1.0, -1.0):
        # A single jump back to repeat a sweep at another load or camber is not a sweep down.
        rare = np.bincount(part, moving == way) < LEAST_SHARE_OF_A_SENSE * sizes
        moving[(moving == way) & rare[part]] = 0.0
    low, high = zip(*(_middle(points.alpha[moving == way]) for way in (1.0, -1.0)), strict=True)
    if not max(low) < min(high):
        return "no sweeps go through the same angles up and down"
    moved = moving != 0.0
    q = LEAST_SHARE_OF_A_SENSE
    if _beyond_conditions(points, moving, moved) < 4.0 * q * (1.0 - q) * np.median(sizes):
        return "sweeps up and sweeps down differ in load, camber, pressure or set-up, whose effect theirs looks like"
    return ""


def _middle(alpha: np.ndarray) -> tuple[float, float]:
    """The middle of the angles (n,); an empty interval without any."""
    low, high = np.percentile(alpha, MIDDLE) if len(alpha) else (math.inf, -math.inf)
    return float(low), float(high)


def _beyond_conditions(points: Points, moving: np.ndarray, rows: np.ndarray) -> float:
    """Sum of squares of the sense over the mask ``rows``, less what it shares with the levels of the conditions."""
    labels = (
        levels.labels_of_setting(points, "Fz"),
        levels.nearest_labels(points.gamma, levels.CAMBER),
        levels.nearest_labels(points.p, levels.PRESSURE),
        points.direction,
        points.mount,
        points.setup,
    )
    design = np.hstack([label[rows, None] == np.unique(label[rows]) for label in labels]).astype(float)
    known = design @ np.linalg.lstsq(design, moving[rows], rcond=None)[0]
    return float(np.sum((moving[rows] - known) ** 2))


def _times(points: Points) -> str:
    known = np.isfinite(points.time)
    return "" if np.any(known) else "the times within the sweeps (time_s) are not known"


def _distances(points: Points) -> str:
    if not np.all(np.isfinite(points.t)):
        return "the time of every point (t_s) is not known"
    return "" if np.ptp(distance_km(points)) > 0.0 else "the wheel does not roll between the points"


def _runs(points: Points) -> str:
    count = len(np.unique(points.sweep))
    enough = count >= FEWEST_SWEEPS_TO_PREDICT
    return "" if enough else f"{counted(count, 'run')} cannot show how runs differ"


NUISANCES = (
    Nuisance(
        id=TEMPERATURE,
        name="tyre temperature",
        key=TEMPERATURE,
        numbers=("k_T_grip_per_K", "k_T_stiffness_per_K"),
        lacking=_temperatures,
    ),
    Nuisance(
        id="temperature-curvature",
        name="curvature of friction over tyre temperature",
        key=TEMPERATURE,
        numbers=("k_T_grip_per_K2",),
        lacking=_temperatures,
        after=TEMPERATURE,
    ),
    Nuisance(
        id="temperature-camber",
        name="camber stiffness over tyre temperature",
        key=TEMPERATURE,
        numbers=("k_T_camber_per_K",),
        lacking=lambda points: _temperatures(points) or _cambers(points),
        after=TEMPERATURE,
    ),
    Nuisance(
        id="hysteresis",
        name="hysteresis of sideslip sweeps",
        key="sense",
        numbers=("hysteresis_deg",),
        lacking=_senses,
        rival="lag",
    ),
    Nuisance(
        id="lag",
        name="lag of sideslip sweeps over the rolled distance",
        key="sense",
        numbers=("relaxation_m",),
        lacking=lambda points: _senses(points) or _times(points),
        rival="hysteresis",
    ),
    Nuisance(
        id="warm-up", name="warm-up at the start", key="warm_up", numbers=("warm_up",), lacking=_distances
    ),
    Nuisance(
        id="wear",
        name="wear over the distance rolled",
        key="wear",
        numbers=("wear_per_km",),
        lacking=_distances,
    ),
    Nuisance(
        id="temperature-slip",
        name="longitudinal friction and slip stiffness over tyre temperature",
        key=TEMPERATURE,
        numbers=("k_T_drive_grip_per_K", "k_T_slip_stiffness_per_K"),
        lacking=lambda points: _temperatures(points) or _slips(points),
        after=TEMPERATURE,
    ),
    Nuisance(
        id="speed",
        name="change of friction and cornering stiffness with speed",
        key="speed",
        numbers=("k_V_grip_per_mps", "k_V_stiffness_per_mps"),
        lacking=_speeds,
    ),
    Nuisance(
        id="speed-slip",
        name="change of longitudinal friction and slip stiffness with speed",
        key="speed",
        numbers=("k_V_drive_grip_per_mps", "k_V_slip_stiffness_per_mps"),
        lacking=lambda points: _speeds(points) or _slips(points),
        after="speed",
    ),
    Nuisance(
        id="pressure-arm",
        name="arm of the side force in Mx over pressure",
        key="pressure",
        numbers=("k_p_arm_per_kPa",),
        lacking=_pressures_of_moment,
    ),
    Nuisance(
        id="run-scale",
        name="scatter of grip and stiffness from run to run",
        key="run_scale",
        numbers=("run_grip", "run_stiffness"),
        lacking=_runs,
        per_run=True,
    ),
)
"""In the order in which sentences name them; random effects of the runs come last."""


def of_run(name: str) -> bool:
    """Whether a rig number is a random effect of one run."""
    whole, _, run = name.partition(OF_RUN)
    return bool(run) and any(nuisance.per_run and whole in nuisance.numbers for nuisance in NUISANCES)
