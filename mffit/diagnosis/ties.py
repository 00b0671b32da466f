"""Effects that the data cannot tell apart, and the run that would."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum, auto

import numpy as np

from mffit.diagnosis.candidates import Hypothesis
from mffit.points import Points, main_pressure

TELLING = 9.0
"""Expected chi2 between two explanations at which a run is worth making."""


class Run(Enum):
    """A run that could be added to the programme."""

    BACKWARD = auto()
    TURNED_ON_RIM = auto()
    OTHER_LOAD = auto()
    CAMBER = auto()
    BACKWARD_CAMBER = auto()
    LEANED = auto()
    LOW_PRESSURE = auto()
    FAST = auto()
    WARM = auto()
    LATE = auto()
    STRAIGHT = auto()
    WIDE = auto()
    STRAIGHT_CAMBER = auto()


@dataclass(frozen=True, slots=True)
class Separation:
    """The best run to tell two explanations apart, and what it would bring."""

    run: Run
    load: float  #: at which it would be run [N]
    chi2: float  #: expected, for the explanations as fitted


def candidate_runs(points: Points) -> tuple[tuple[Run, Points], ...]:
    """Runs a rig could add: the other direction or mount, other loads, radii, cambers, pressures and speeds."""
    main = points.select(main_pressure(points) & (points.direction > 0) & (points.mount > 0))
    loads = np.unique(np.round(main.Fz, -1))
    load = float(np.median(main.Fz))
    reach = float(np.max(np.abs(main.alpha)))
    slip = _line(main, load, alpha=np.linspace(-reach, reach, 13))
    camber = _line(main, load, gamma=np.radians([-40, -25, -15, -8, -4, 0, 4, 8, 15, 25, 40]))
    backward = -np.ones(len(slip), int)
    warmer = np.nan_to_num(slip.T, nan=25.0) + 20.0
    later = np.full(len(slip), 1.2 * float(np.max(np.nan_to_num(points.t))) + 600.0)
    runs = [
        (Run.BACKWARD, slip.replace(direction=backward)),
        (Run.TURNED_ON_RIM, slip.replace(mount=backward)),
        (Run.OTHER_LOAD, slip.replace(Fz=np.full(len(slip), 1.4 * loads.max()))),
        (Run.OTHER_LOAD, slip.replace(Fz=np.full(len(slip), 0.5 * loads.min()))),
        (Run.CAMBER, camber),
        (Run.BACKWARD_CAMBER, camber.replace(direction=backward[: len(camber)])),
        (Run.LEANED, slip.replace(gamma=np.full(len(slip), np.radians(20.0)))),
        (Run.LOW_PRESSURE, slip.replace(p=0.8 * slip.p)),
        (Run.FAST, slip.replace(V=2.0 * slip.V)),
        (Run.WARM, slip.replace(T=warmer)),
        (Run.LATE, slip.replace(t=later)),
    ]
    if np.any(points.phi_t):
        runs += [
            (Run.STRAIGHT, slip.replace(phi_t=np.zeros(len(slip)))),
            (Run.WIDE, slip.replace(phi_t=slip.phi_t / 2.0)),
            (Run.STRAIGHT_CAMBER, camber.replace(phi_t=np.zeros(len(camber)))),
        ]
    return tuple(runs)


def separation(points: Points, a: Hypothesis, b: Hypothesis, noise_Fy: float, noise_Mz: float) -> Separation:
    """The candidate run at which the two refitted explanations differ most."""
    found = []
    for run, added in candidate_runs(points):
        n, difference = len(added), a.state.predict(added) - b.state.predict(added)
        chi2 = float(np.sum((difference[:n] / noise_Fy) ** 2))
        if np.isfinite(noise_Mz):
            chi2 += float(np.sum((difference[n:] / noise_Mz) ** 2))
        found.append(Separation(run, float(added.Fz[0]), chi2))
    return max(found, key=lambda s: s.chi2)


def _line(points: Points, load: float, alpha=0.0, gamma=0.0) -> Points:
    """Steady points along one angle, everything else as at the point nearest the load."""
    n = max(np.size(alpha), np.size(gamma))
    nearest = int(np.argmin(np.abs(points.Fz - load)))
    line = points.select(np.full(n, nearest))
    return line.replace(
        alpha=np.broadcast_to(alpha, n),
        gamma=np.broadcast_to(gamma, n),
        Fz=np.full(n, load),
        continuous=np.zeros(n, bool),
        time=np.full(n, np.nan),
    )
