"""The run that would separate two explanations."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from mffit.constants import CAMBER_OF_SLOPES
from mffit.diagnosis import constants
from mffit.diagnosis.hypothesis import Hypothesis
from mffit.points import Points, main_pressure

LEAN = f"{CAMBER_OF_SLOPES:g} deg camber"


@dataclass(frozen=True, slots=True)
class Separation:
    """The run that separates two explanations best."""

    run: str  #: in words, with its load
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
        found.append(Separation(run, chi2))
    return max(found, key=lambda s: s.chi2)


def candidate_runs(points: Points) -> list[tuple[str, Points]]:
    """Runs that a rig could add, in words: the other direction or mount, other loads, radii, cambers, pressures and speeds."""
    main = points.select(main_pressure(points) & (points.direction > 0) & (points.mount > 0))
    load, loads = float(np.median(main.Fz)), np.unique(np.round(main.Fz, -1))
    lower, higher = np.array(constants.TIE_RUN_OTHER_LOADS) * (loads.min(), loads.max())
    slip = _line(main, load, "alpha", float(np.max(np.abs(main.alpha))))
    sweep = "a sideslip sweep at"
    warmer, later = constants.TIE_RUN_WARMER, constants.TIE_RUN_LATER
    pressure, fast = constants.TIE_RUN_LOW_PRESSURE, constants.TIE_RUN_FAST
    sideslip = [
        (f"a backward sideslip sweep at {load:.0f} N", slip.replace(direction=-1)),
        (f"{sweep} {load:.0f} N with the tyre turned on its rim", slip.replace(mount=-1)),
        (f"{sweep} {higher:.0f} N", slip.replace(Fz=higher)),
        (f"{sweep} {lower:.0f} N", slip.replace(Fz=lower)),
        (f"{sweep} {LEAN} and {load:.0f} N", slip.replace(gamma=CAMBER_OF_SLOPES.rad)),
        (f"{sweep} {pressure:g} of the pressure and {load:.0f} N", slip.replace(p=pressure * slip.p)),
        (f"{sweep} {fast:g} times the speed and {load:.0f} N", slip.replace(V=fast * slip.V)),
        (
            f"a repeated sideslip sweep at {load:.0f} N with the tyre {warmer:g} K warmer",
            slip.replace(T=np.nan_to_num(slip.T) + warmer),
        ),
        (
            f"a repeated sideslip sweep at {load:.0f} N at the end of the test",
            slip.replace(t=float(np.max(np.nan_to_num(points.t))) + later),
        ),
    ]
    if np.any(points.phi_t):
        wide = constants.TIE_RUN_WIDE
        on_wider = slip.replace(phi_t=slip.phi_t / wide)
        sideslip += [
            (f"{sweep} {load:.0f} N on a straight path", slip.replace(phi_t=0.0)),
            (f"{sweep} {load:.0f} N on a path of {wide:g} times the radius", on_wider),
        ]
    drive = [] if np.all(points.free_rolling) else _driven(main, load, lower, higher)
    return [*sideslip, *_leaning(main, load), *drive]


def _leaning(main: Points, load: float) -> list[tuple[str, Points]]:
    """Sweeps of camber."""
    camber = _line(main, load, "gamma", constants.TIE_RUN_CAMBER.rad)
    straight = (f"a camber sweep at {load:.0f} N on a straight path", camber.replace(phi_t=0.0))
    return [
        (f"a camber sweep to {constants.TIE_RUN_CAMBER:g} deg at {load:.0f} N", camber),
        (f"a backward camber sweep at {load:.0f} N", camber.replace(direction=-1)),
        *([straight] if np.any(main.phi_t) else []),
    ]


def _driven(main: Points, load: float, lower: float, higher: float) -> list[tuple[str, Points]]:
    """Sweeps of longitudinal slip."""
    drive = _line(main, load, "kappa", float(np.max(np.abs(main.kappa))))
    steered = drive.replace(alpha=constants.TIE_RUN_STEERED.rad)
    sweep, steer = "sweep of longitudinal slip at", f"{constants.TIE_RUN_STEERED:g} deg sideslip"
    return [
        (f"a {sweep} {higher:.0f} N", drive.replace(Fz=higher)),
        (f"a {sweep} {lower:.0f} N", drive.replace(Fz=lower)),
        (f"a backward {sweep} {load:.0f} N", drive.replace(direction=-1)),
        (f"a {sweep} {load:.0f} N with the tyre turned on its rim", drive.replace(mount=-1)),
        (f"a {sweep} {steer} and {load:.0f} N", steered),
        (f"a {sweep} {steer}, {LEAN} and {load:.0f} N", steered.replace(gamma=CAMBER_OF_SLOPES.rad)),
    ]


def _line(points: Points, load: float, over: str, reach: float) -> Points:
    """Steady points along one angle or the slip, up to ``reach``; all other settings are those of the point nearest the load."""
    along = reach * np.linspace(-1.0, 1.0, constants.TIE_RUN_POINTS)
    line = points.select(np.full(len(along), int(np.argmin(np.abs(points.Fz - load)))))
    angles = {"alpha": 0.0, "gamma": 0.0, "kappa": 0.0} | {over: along}
    return line.replace(**angles, Fz=load, continuous=False, time=np.nan)
