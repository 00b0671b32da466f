"""The run that would separate two explanations."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from enum import Enum

import numpy as np

from mffit.diagnosis import constants
from mffit.diagnosis.hypothesis import Hypothesis
from mffit.points import Points, main_pressure


class SeparatingRun(Enum):
    """A run that could be added to the programme, in words."""

    BACKWARD = "a backward sideslip sweep at {load:.0f} N"
    TURNED_ON_RIM = "a sideslip sweep at {load:.0f} N with the tyre turned on its rim"
    OTHER_LOAD = "a sideslip sweep at {load:.0f} N"
    CAMBER = f"a camber sweep to {constants.TIE_RUN_CAMBER:g} deg at {{load:.0f}} N"
    BACKWARD_CAMBER = "a backward camber sweep at {load:.0f} N"
    LEANED = f"a sideslip sweep at {constants.TIE_RUN_LEANED:g} deg camber and {{load:.0f}} N"
    LOW_PRESSURE = (
        f"a sideslip sweep at {constants.TIE_RUN_LOW_PRESSURE:g} of the pressure and {{load:.0f}} N"
    )
    FAST = f"a sideslip sweep at {constants.TIE_RUN_FAST:g} times the speed and {{load:.0f}} N"
    WARM = f"a repeated sideslip sweep at {{load:.0f}} N with the tyre {constants.TIE_RUN_WARMER:g} K warmer"
    LATE = "a repeated sideslip sweep at {load:.0f} N at the end of the test"
    STRAIGHT = "a sideslip sweep at {load:.0f} N on a straight path"
    WIDE = f"a sideslip sweep at {{load:.0f}} N on a path of {constants.TIE_RUN_WIDE:g} times the radius"
    STRAIGHT_CAMBER = "a camber sweep at {load:.0f} N on a straight path"
    DRIVE = "a sweep of longitudinal slip at {load:.0f} N"
    BACKWARD_DRIVE = "a backward sweep of longitudinal slip at {load:.0f} N"
    DRIVE_TURNED_ON_RIM = "a sweep of longitudinal slip at {load:.0f} N with the tyre turned on its rim"
    STEERED_DRIVE = (
        f"a sweep of longitudinal slip at {constants.TIE_RUN_STEERED:g} deg sideslip and {{load:.0f}} N"
    )
    LEANED_DRIVE = (
        f"a sweep of longitudinal slip at {constants.TIE_RUN_STEERED:g} deg sideslip, "
        f"{constants.TIE_RUN_LEANED:g} deg camber and {{load:.0f}} N"
    )


@dataclass(frozen=True, slots=True)
class Separation:
    """The run that separates two explanations best."""

    run: SeparatingRun
    load: float  #: of the run [N]
    chi2: float  #: expected chi2 between the two fitted explanations

    @property
    def worthwhile(self) -> bool:
        """Whether the run is expected to decide between the two."""
        return self.chi2 >= constants.SEPARATING_CHI2


def separation(points: Points, a: Hypothesis, b: Hypothesis, noise: Mapping[str, float]) -> Separation:
    """The candidate run in which two refitted explanations differ most.

    ``noise`` is the standard uncertainty of a reading by channel; NaN for channels that were not measured.
    """
    found = []
    for run, added in candidate_runs(points):
        of_a, of_b = (one.state.readings(added, noise) for one in (a, b))
        chi2 = sum(
            float(np.sum(((of_a[name] - of_b[name]) / u) ** 2)) for name, u in noise.items() if np.isfinite(u)
        )
        found.append(Separation(run=run, load=float(added.Fz[0]), chi2=chi2))
    return max(found, key=lambda s: s.chi2)


def candidate_runs(points: Points) -> tuple[tuple[SeparatingRun, Points], ...]:
    """Runs that a rig could add: the other direction or mount, other loads, radii, cambers, pressures and speeds."""
    main = points.select(main_pressure(points) & (points.direction > 0) & (points.mount > 0))
    load = float(np.median(main.Fz))
    loads = np.unique(np.round(main.Fz, -1))
    lower, higher = np.array(constants.TIE_RUN_OTHER_LOADS) * (loads.min(), loads.max())
    reach, along = float(np.max(np.abs(main.alpha))), np.linspace(-1.0, 1.0, constants.TIE_RUN_POINTS)
    slip = _line(main, load, alpha=reach * along)
    camber = _line(main, load, gamma=constants.TIE_RUN_CAMBER.rad * along)
    warmer = np.nan_to_num(slip.T) + constants.TIE_RUN_WARMER
    later = float(np.max(np.nan_to_num(points.t))) + constants.TIE_RUN_LATER
    runs = [
        (SeparatingRun.BACKWARD, slip.replace(direction=-1)),
        (SeparatingRun.TURNED_ON_RIM, slip.replace(mount=-1)),
        (SeparatingRun.OTHER_LOAD, slip.replace(Fz=higher)),
        (SeparatingRun.OTHER_LOAD, slip.replace(Fz=lower)),
        (SeparatingRun.CAMBER, camber),
        (SeparatingRun.BACKWARD_CAMBER, camber.replace(direction=-1)),
        (SeparatingRun.LEANED, slip.replace(gamma=constants.TIE_RUN_LEANED.rad)),
        (SeparatingRun.LOW_PRESSURE, slip.replace(p=constants.TIE_RUN_LOW_PRESSURE * slip.p)),
        (SeparatingRun.FAST, slip.replace(V=constants.TIE_RUN_FAST * slip.V)),
        (SeparatingRun.WARM, slip.replace(T=warmer)),
        (SeparatingRun.LATE, slip.replace(t=later)),
    ]
    if np.any(points.phi_t):
        runs += [
            (SeparatingRun.STRAIGHT, slip.replace(phi_t=0.0)),
            (SeparatingRun.WIDE, slip.replace(phi_t=slip.phi_t / constants.TIE_RUN_WIDE)),
            (SeparatingRun.STRAIGHT_CAMBER, camber.replace(phi_t=0.0)),
        ]
    if not np.all(points.free_rolling):
        reach = float(np.max(np.abs(main.kappa)))
        drive = _line(main, load, kappa=reach * along)
        steered = drive.replace(alpha=constants.TIE_RUN_STEERED.rad)
        runs += [
            (SeparatingRun.DRIVE, drive.replace(Fz=higher)),
            (SeparatingRun.DRIVE, drive.replace(Fz=lower)),
            (SeparatingRun.BACKWARD_DRIVE, drive.replace(direction=-1)),
            (SeparatingRun.DRIVE_TURNED_ON_RIM, drive.replace(mount=-1)),
            (SeparatingRun.STEERED_DRIVE, steered),
            (SeparatingRun.LEANED_DRIVE, steered.replace(gamma=constants.TIE_RUN_LEANED.rad)),
        ]
    return tuple(runs)


def _line(
    points: Points,
    load: float,
    alpha: np.ndarray | float = 0.0,
    gamma: np.ndarray | float = 0.0,
    kappa: np.ndarray | float = 0.0,
) -> Points:
    """Steady points along one angle or the slip; all other settings are those of the point nearest the load."""
    n = max(np.size(alpha), np.size(gamma), np.size(kappa))
    nearest = int(np.argmin(np.abs(points.Fz - load)))
    line = points.select(np.full(n, nearest))
    return line.replace(alpha=alpha, gamma=gamma, kappa=kappa, Fz=load, continuous=False, time=np.nan)
