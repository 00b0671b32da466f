"""Where the 95 % bands are narrow: of Fy at the pressure of most sweeps, of Fx at the sideslips with longitudinal slip."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass, replace

import numpy as np

from mffit.constants import COVERAGE_FACTOR_95, STRAIGHT
from mffit.fit import constants
from mffit.fit.coverage import side_run
from mffit.fit.posterior import Posterior, spread_through
from mffit.fit.ranges import sideslips_with_slip, tested_ranges
from mffit.points import Points, levels, main_pressure, make_points
from mffit.rig import Simulation
from mffit.scatter import rms
from tir.parameters import BY_NAME


@dataclass(frozen=True, slots=True)
class BandsByPressure:
    """Rms half width of the 95 % bands of Fy over the tested angles and loads, and what widens them."""

    main: float  #: pressure of most sweeps [Pa]
    half: float  #: at it [N]
    others: tuple[float, ...]  #: the other pressures that were run, and the nominal one [Pa]
    half_of_others: float  #: at these [N]; 0 without others
    unseen: str = (
        ""  #: the coefficient without effect in these sweeps that widens them most; empty without one
    )
    share: float = 0.0  #: its share of the variance there
    half_of_exact_zeros: float = 0.0
    """Half width at the pressure of most sweeps if the zeros of the rig were exactly known [N]."""

    @property
    def wider(self) -> bool:
        """Whether a coefficient that the sweeps do not show widens the bands at the other pressures."""
        return bool(self.unseen) and self.half_of_others > constants.WIDER_BANDS * self.half


@dataclass(frozen=True, slots=True)
class BandOfCombined:
    """Rms half width of the 95 % band of Fx over longitudinal slip and load, where slip was run at one sideslip only."""

    sideslip: float  #: the one at which it was run [rad], without its sign
    half_at: float  #: there [N]
    half_between: float  #: halfway to straight running [N]

    @property
    def wider(self) -> bool:
        """Whether the fit knows Fx clearly less well between the sideslips than at them."""
        return self.half_between > constants.WIDER_BANDS * self.half_at


@dataclass(frozen=True, slots=True)
class BandOfOtherSide:
    """Rms half width of the 95 % band of Fy over the tested loads, where sideslip was run to one side only."""

    sideslip: float  #: the largest that was run [rad]
    half: float  #: there [N]
    half_opposite: float  #: at the same angle to the other side [N]


def band_of_other_side(posterior: Posterior, tyre: Simulation, points: Points) -> BandOfOtherSide | None:
    """The band of Fy at the largest sideslip and opposite to it; None if both sides were run, and on a curved path."""
    if not side_run(points) or np.any(points.phi_t):
        return None
    alpha = float(points.alpha[np.argmax(np.abs(points.alpha))])
    return BandOfOtherSide(alpha, *(_half_at(posterior, tyre, points, "Fy", a) for a in (alpha, -alpha)))


def band_of_combined(posterior: Posterior, tyre: Simulation, points: Points) -> BandOfCombined | None:
    """The band of Fx at the one sideslip with longitudinal slip, and before it; None without such, and with several."""
    run = [alpha for alpha in sideslips_with_slip(points) if abs(alpha) > STRAIGHT.rad]
    sizes = {int(k) for k in levels.nearest_labels(np.abs(run), levels.SIDESLIP)} if run else set()
    if len(sizes) != 1 or "Fx" not in points.measured:
        return None
    halves = (_half_at(posterior, tyre, points, "Fx", alpha) for alpha in (run[-1], 0.5 * run[-1]))
    return BandOfCombined(abs(run[-1]), *halves)


def _half_at(posterior: Posterior, tyre: Simulation, points: Points, channel: str, alpha: float) -> float:
    """Rms half width of the 95 % band of a channel at a sideslip, over the tested loads and, of Fx, longitudinal slips."""
    tested = tested_ranges(points)
    ends = (tested["KPUMIN"], tested["KPUMAX"]) if channel == "Fx" else (0.0, 0.0)
    Fz, kappa = np.meshgrid(
        np.linspace(tested["FZMIN"], tested["FZMAX"], constants.LOADS_OF_A_GRID),
        np.linspace(*ends, constants.STEPS_OF_A_GRID if channel == "Fx" else 1),
    )
    p, V = float(np.median(points.p[main_pressure(points)])), float(np.median(points.V))
    where = make_points(alpha, 0.0, Fz.ravel(), kappa=kappa.ravel(), p=p, V=V, phi_t=0.0)
    return rms(posterior.band(tyre, where, (channel,))[channel])


def bands_by_pressure(
    posterior: Posterior,
    held: Collection[str],
    tyre: Simulation,
    points: Points,
    zeros: Collection[str] = (),
) -> BandsByPressure:
    """The bands of a fitted tyre on a straight path.

    ``held`` names the coefficients that the fit took as exact, ``zeros`` the zeros of the rig that it determined with the tyre.
    """
    main = float(np.median(points.p[main_pressure(points)]))
    pressures = [*levels.level_values(points.p, levels.PRESSURE), float(tyre.values["NOMPRES"])]
    others = tuple(sorted({float(p) for p in pressures if abs(p - main) > levels.PRESSURE.tolerance}))
    names = [name for name in posterior.names if name in BY_NAME]

    def half(slopes: np.ndarray, known: Collection[str] = ()) -> float:
        """Rms half width of the 95 % band, if some numbers were exactly known."""
        left = posterior.given(known)
        rows, columns = [left.names.index(n) for n in names if n in left.names], np.isin(names, left.names)
        covariance = left.covariance[np.ix_(rows, rows)]
        return COVERAGE_FACTOR_95 * rms(spread_through(slopes[:, columns], covariance))

    at_main = _over_tested(names, tyre, points, (main,))
    found = BandsByPressure(main, half(at_main), (), 0.0, half_of_exact_zeros=half(at_main, zeros))
    if not others:
        return found
    slopes = _over_tested(names, tyre, points, others)
    whole = half(slopes)
    known = {name: half(slopes, (name,)) for name in held if name in posterior.names}
    unseen = min(known, key=lambda name: known[name], default="")
    share = 1.0 - (known[unseen] / whole) ** 2 if unseen and whole else 0.0
    return replace(
        found, others=others, half_of_others=whole, unseen=unseen if share > 0.5 else "", share=share
    )


def _over_tested(
    names: Sequence[str], tyre: Simulation, points: Points, pressures: tuple[float, ...]
) -> np.ndarray:
    """Derivatives (n, k) of Fy by the named coefficients on a grid over the tested angles and loads."""
    tested = tested_ranges(points)
    axes = (
        np.linspace(tested["FZMIN"], tested["FZMAX"], constants.LOADS_OF_A_GRID),
        np.linspace(0.0, tested["CAMMAX"], constants.CAMBERS_OF_A_GRID if tested["CAMMAX"] > 0.0 else 1),
        np.linspace(tested["ALPMIN"], tested["ALPMAX"], constants.STEPS_OF_A_GRID),
        np.array(pressures),
    )
    Fz, gamma, alpha, p = (axis.ravel() for axis in np.meshgrid(*axes))
    where = make_points(alpha, gamma, Fz, p=p, V=float(np.median(points.V)), phi_t=0.0)
    return np.asarray(tyre.sensitivities(where, names)[1].Fy)
