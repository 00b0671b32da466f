"""Where the 95 % bands are narrow: of Fy at the pressure of most sweeps, of Fx at the sideslips with longitudinal slip."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass

import numpy as np

from mffit.constants import COVERAGE_FACTOR_95, ZERO_SIDESLIP
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
    tested = tested_ranges(points)
    Fz = np.linspace(tested["FZMIN"], tested["FZMAX"], constants.LOADS_OF_A_GRID)
    p, V = float(np.median(points.p[main_pressure(points)])), float(np.median(points.V))
    half, opposite = (
        rms(posterior.band(tyre, make_points(a, 0.0, Fz, p=p, V=V, phi_t=0.0), ("Fy",)).Fy)
        for a in (alpha, -alpha)
    )
    return BandOfOtherSide(alpha, half, opposite)


def band_of_combined(posterior: Posterior, tyre: Simulation, points: Points) -> BandOfCombined | None:
    """The band of Fx at the one sideslip with longitudinal slip, and before it; None without such, and with several."""
    run = [alpha for alpha in sideslips_with_slip(points) if abs(alpha) > ZERO_SIDESLIP.rad]
    sizes = {int(k) for k in levels.nearest_labels(np.abs(run), levels.SIDESLIP)} if run else set()
    if len(sizes) != 1 or "Fx" not in points.measured:
        return None
    tested = tested_ranges(points)
    Fz, kappa = (
        axis.ravel()
        for axis in np.meshgrid(
            np.linspace(tested["FZMIN"], tested["FZMAX"], constants.LOADS_OF_A_GRID),
            np.linspace(tested["KPUMIN"], tested["KPUMAX"], constants.STEPS_OF_A_GRID),
        )
    )
    p, V = float(np.median(points.p[main_pressure(points)])), float(np.median(points.V))

    def half(alpha: float) -> float:
        where = make_points(alpha, 0.0, Fz, kappa=kappa, p=p, V=V, phi_t=0.0)
        return rms(posterior.band(tyre, where, ("Fx",)).Fx)

    return BandOfCombined(abs(run[-1]), half(run[-1]), half(0.5 * run[-1]))


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
    nominal = float(tyre.values["NOMPRES"])
    pressures = np.array([*levels.level_values(points.p, levels.PRESSURE), nominal])
    others = tuple(sorted({float(p) for p in pressures if abs(p - main) > levels.PRESSURE.tolerance}))
    at_main = _over_tested(posterior, tyre, points, (main,))
    half, exact = (rms(_half(at_main, one)) for one in (posterior, posterior.given(zeros)))
    if not others:
        return BandsByPressure(main, half, (), 0.0, half_of_exact_zeros=exact)
    slopes = _over_tested(posterior, tyre, points, others)
    variance = float(np.mean(_half(slopes, posterior) ** 2))
    by_held = {
        name: float(np.mean(_half(slopes, _only(posterior, name)) ** 2))
        for name in held
        if name in posterior.names
    }
    unseen = max(by_held, key=lambda name: by_held[name], default="")
    share = by_held[unseen] / variance if unseen and variance else 0.0
    return BandsByPressure(
        main,
        half,
        others,
        float(np.sqrt(variance)),
        unseen if share > 0.5 else "",
        share,
        exact,
    )


def _only(posterior: Posterior, name: str) -> Posterior:
    """The part of the covariance that the error of one held coefficient makes."""
    column = posterior.covariance[:, posterior.names.index(name)]
    variance = column[posterior.names.index(name)]
    return Posterior(posterior.names, np.outer(column, column) / variance)


def _half(slopes: np.ndarray, posterior: Posterior) -> np.ndarray:
    """Half widths (n,) of the 95 % band [N] for derivatives (n, k) by the coefficients."""
    rows = _coefficients(posterior)
    return COVERAGE_FACTOR_95 * spread_through(slopes, posterior.covariance[np.ix_(rows, rows)])


def _coefficients(posterior: Posterior) -> list[int]:
    return [i for i, name in enumerate(posterior.names) if name in BY_NAME]


def _over_tested(
    posterior: Posterior, tyre: Simulation, points: Points, pressures: tuple[float, ...]
) -> np.ndarray:
    """Derivatives (n, k) of Fy on a grid over the tested angles and loads."""
    tested = tested_ranges(points)
    axes = (
        np.linspace(tested["FZMIN"], tested["FZMAX"], constants.LOADS_OF_A_GRID),
        np.linspace(0.0, tested["CAMMAX"], constants.CAMBERS_OF_A_GRID if tested["CAMMAX"] > 0.0 else 1),
        np.linspace(tested["ALPMIN"], tested["ALPMAX"], constants.STEPS_OF_A_GRID),
        np.array(pressures),
    )
    Fz, gamma, alpha, p = (axis.ravel() for axis in np.meshgrid(*axes))
    where = make_points(alpha, gamma, Fz, p=p, V=float(np.median(points.V)), phi_t=0.0)
    names = [posterior.names[i] for i in _coefficients(posterior)]
    return np.asarray(tyre.sensitivities(where, names)[1].Fy)
