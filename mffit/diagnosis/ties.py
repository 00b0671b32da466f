"""Effects that the data cannot tell apart, and the run that would."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from mffit.diagnosis.candidates import Hypothesis
from mffit.points import Points, main_pressure

TELLING = 9.0
"""Expected chi2 between two explanations at which a run is worth making."""


@dataclass(frozen=True, slots=True)
class Run:
    """A run that could be added to the programme."""

    description: str
    points: Points


@dataclass(frozen=True, slots=True)
class Separation:
    """The best run to tell two explanations apart, and what it would bring."""

    run: str
    chi2: float  #: expected, for the explanations as fitted

    def sentence(self) -> str:
        if self.chi2 < TELLING:
            return (
                f"none of the usual runs separates them at this size; the best would be {self.run} "
                f"(expected chi2 {self.chi2:.1f})"
            )
        return f"{self.run} (expected chi2 {self.chi2:.0f})"


def candidate_runs(points: Points) -> tuple[Run, ...]:
    """Runs a rig could add: the other direction or mount, other loads, radii, cambers, pressures and speeds."""
    main = points.select(
        main_pressure(points) & (points.direction > 0) & (points.mount > 0) & ~points.continuous
    )
    loads = np.unique(np.round(main.Fz, -1))
    load = float(np.median(main.Fz))
    reach = float(np.max(np.abs(main.alpha)))
    slip = _line(main, load, alpha=np.linspace(-reach, reach, 13))
    camber = _line(main, load, gamma=np.radians([-40, -25, -15, -8, -4, 0, 4, 8, 15, 25, 40]))
    warmer = np.nan_to_num(slip.T, nan=25.0) + 20.0
    later = np.full(len(slip), 1.2 * float(np.max(np.nan_to_num(points.t))) + 600.0)
    runs = [
        Run(f"a backward sideslip sweep at {load:.0f} N", slip.replace(direction=-np.ones(len(slip), int))),
        Run(f"a sideslip sweep at {load:.0f} N with the tyre turned on its rim", slip.replace(mount=-np.ones(len(slip), int))),
        Run(f"a sideslip sweep at {1.4 * loads.max():.0f} N", slip.replace(Fz=np.full(len(slip), 1.4 * loads.max()))),
        Run(f"a sideslip sweep at {0.5 * loads.min():.0f} N", slip.replace(Fz=np.full(len(slip), 0.5 * loads.min()))),
        Run(f"a camber sweep to 40 deg at {load:.0f} N", camber),
        Run(
            f"a backward camber sweep at {load:.0f} N", camber.replace(direction=-np.ones(len(camber), int))
        ),
        Run(f"a sideslip sweep at 20 deg camber and {load:.0f} N", slip.replace(gamma=np.full(len(slip), np.radians(20.0)))),
        Run(f"a sideslip sweep at 0.8 of the pressure and {load:.0f} N", slip.replace(p=0.8 * slip.p)),
        Run(f"a sideslip sweep at twice the speed and {load:.0f} N", slip.replace(V=2.0 * slip.V)),
        Run(f"a repeated sideslip sweep at {load:.0f} N with the tyre 20 K warmer", slip.replace(T=warmer)),
        Run(f"a repeated sideslip sweep at {load:.0f} N at the end of the test", slip.replace(t=later)),
    ]  # fmt: skip
    if np.any(points.phi_t):
        runs.append(
            Run(
                f"a sideslip sweep at {load:.0f} N on a straight path",
                slip.replace(phi_t=np.zeros(len(slip))),
            )
        )
        runs.append(
            Run(
                f"a sideslip sweep at {load:.0f} N on a path of twice the radius",
                slip.replace(phi_t=slip.phi_t / 2.0),
            )
        )
        runs.append(
            Run(
                f"a camber sweep at {load:.0f} N on a straight path",
                camber.replace(phi_t=np.zeros(len(camber))),
            )
        )
    return tuple(runs)


def separation(points: Points, a: Hypothesis, b: Hypothesis, noise_Fy: float, noise_Mz: float) -> Separation:
    """The candidate run at which the two refitted explanations differ most."""
    best = Separation("", -1.0)
    for run in candidate_runs(points):
        difference = a.state.predict(run.points) - b.state.predict(run.points)
        n = len(run.points)
        chi2 = float(np.sum((difference[:n] / noise_Fy) ** 2))
        if np.isfinite(noise_Mz):
            chi2 += float(np.sum((difference[n:] / noise_Mz) ** 2))
        if chi2 > best.chi2:
            best = Separation(run.description, chi2)
    return best


def _line(points: Points, load: float, alpha=0.0, gamma=0.0) -> Points:
    """Points along one angle, everything else as at the point nearest the load."""
    n = max(np.size(alpha), np.size(gamma))
    nearest = int(np.argmin(np.abs(points.Fz - load)))
    line = points.select(np.full(n, nearest))
    return line.replace(alpha=np.broadcast_to(alpha, n), gamma=np.broadcast_to(gamma, n), Fz=np.full(n, load))
