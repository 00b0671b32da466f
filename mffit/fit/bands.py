"""Widths of the 95 % bands inside the test plan and outside it: at other pressures and other sideslips."""

from collections.abc import Collection, Iterator
from dataclasses import dataclass

import numpy as np

from mffit.as_json import keys
from mffit.constants import COVERAGE_FACTOR_95, STRAIGHT
from mffit.fit import constants
from mffit.fit.coverage import side_run
from mffit.fit.ranges import sideslips_with_slip, tested_ranges
from mffit.points import Points, levels, main_pressure, make_points
from mffit.prediction import Predictor
from mffit.rig import Simulation
from mffit.rig_errors import V_REF
from mffit.scatter import rms


@dataclass(frozen=True, slots=True)
class BandBesideSweeps:
    """Rms half widths of a band over the tested loads, at the sideslip that was run and at one that was not."""

    channel: str
    sideslip: float  #: sideslip that was run [rad]
    half_at: float  #: half width at it [N]
    beside: float  #: sideslip that was not run [rad]
    half_beside: float  #: half width at that one [N]

    @property
    def wider(self) -> bool:
        """Whether the band is clearly wider at the sideslip that was not run."""
        return self.half_beside > constants.WIDER_BANDS * self.half_at


keys(BandBesideSweeps, "sideslip_deg Fx_N=half_at halfway_Fx_N=half_beside")


@dataclass(frozen=True, slots=True)
class Bands:
    """Rms half width of the 95 % bands of Fy over the tested angles and loads, and what widens them."""

    main: float  #: pressure of most sweeps [Pa]
    half: float  #: half width at the main pressure [N]
    others: tuple[float, ...] = ()  #: the other pressures that were run, and the nominal one [Pa]
    half_of_others: float = 0.0  #: half width at the other pressures [N]; 0 without others
    unseen: str = ""
    """The held coefficient that causes more than half of the variance at the other pressures; empty if there is none."""
    share: float = 0.0  #: largest share of that variance by one held coefficient
    half_of_exact_zeros: float = 0.0
    """Half width at the main pressure if the zeros of the rig were exactly known [N]."""
    combined: BandBesideSweeps | None = None  #: of Fx, if slip was run at one sideslip only
    other_side: BandBesideSweeps | None = None  #: of Fy, if sideslip was run to one side only

    @property
    def wider(self) -> bool:
        """Whether a coefficient that the sweeps do not show widens the bands at the other pressures."""
        return bool(self.unseen) and self.half_of_others > constants.WIDER_BANDS * self.half


keys(
    Bands,
    "pressure_kPa=main Fy_N=half Fy_exact_zeros_N=half_of_exact_zeros other_pressures_kPa=others other_Fy_N unseen? share "
    "combined",
    other_Fy_N=lambda found: found.half_of_others if found.others else None,
)


def bands(
    known: Predictor,
    held: Collection[str],
    tyre: Simulation,
    points: Points,
    exact_zeros: Predictor | None = None,
) -> Bands:
    """The 95 % bands for readings of a new run of the fitted tyre on a straight path.

    ``held`` names the coefficients that the fit took as exact; ``exact_zeros`` predicts with exactly known zeros of the rig.
    """
    main = float(np.median(points.p[main_pressure(points)]))
    pressures = [*levels.level_values(points.p, levels.PRESSURE), float(tyre.values["NOMPRES"])]
    others = tuple(sorted({float(p) for p in pressures if abs(p - main) > levels.PRESSURE.tolerance}))
    beside = {band.channel: band for band in _beside_sweeps(known, tyre, points)}
    elsewhere = _grid(known, points, others) if others else None
    unseen, share = _widest(known, held, tyre, elsewhere) if elsewhere is not None else ("", 0.0)
    return Bands(
        main=main,
        half=_half(known, tyre, _grid(known, points, (main,))),
        others=others,
        half_of_others=_half(known, tyre, elsewhere) if elsewhere is not None else 0.0,
        unseen=unseen if share > 0.5 else "",
        share=share,
        half_of_exact_zeros=_half(exact_zeros or known, tyre, _grid(known, points, (main,))),
        combined=beside.get("Fx"),
        other_side=beside.get("Fy"),
    )


def _beside_sweeps(known: Predictor, tyre: Simulation, points: Points) -> Iterator[BandBesideSweeps]:
    """The bands of Fx at half the only sideslip with longitudinal slip, and of Fy on the side that was not run."""
    found = []
    run = [alpha for alpha in sideslips_with_slip(points) if abs(alpha) > STRAIGHT.rad]
    if run and "Fx" in known.channels and len(set(levels.nearest_labels(np.abs(run), levels.SIDESLIP))) == 1:
        found.append(("Fx", run[-1], 0.5 * run[-1]))
    if side_run(points) and not np.any(points.phi_t):
        alpha = float(points.alpha[np.argmax(np.abs(points.alpha))])
        found.append(("Fy", alpha, -alpha))
    for channel, at, beside in found:
        halves = [_half(known, tyre, _at_sideslip(known, points, channel, x), channel) for x in (at, beside)]
        yield BandBesideSweeps(channel, at, halves[0], beside, halves[1])


def _half(known: Predictor, tyre: Simulation, where: Points, channel: str = "Fy") -> float:
    """Rms half width of the 95 % band of a channel."""
    return rms(known.band(tyre, tyre, where, (channel,))[channel])


def _widest(known: Predictor, held: Collection[str], tyre: Simulation, where: Points) -> tuple[str, float]:
    """The held coefficient whose exact value would narrow the band of Fy most, and its share of the variance."""
    covariance = known.channels["Fy"].covariance
    slopes = tyre.sensitivities(where, known.names, ("Fy",))[1].Fy
    across = np.mean((slopes @ covariance) ** 2, axis=0) / np.maximum(np.diag(covariance), 1e-300)
    whole = (_half(known, tyre, where) / COVERAGE_FACTOR_95) ** 2
    shares = {n: float(x) / whole for n, x in zip(known.names, across, strict=True) if n in held and whole}
    return max(shares.items(), key=lambda row: row[1], default=("", 0.0))


def _grid(known: Predictor, points: Points, pressures: tuple[float, ...]) -> Points:
    """Conditions on a straight path over the tested angles and loads."""
    tested = tested_ranges(points)
    axes = (
        np.linspace(tested["FZMIN"], tested["FZMAX"], constants.LOADS_OF_A_GRID),
        np.linspace(0.0, tested["CAMMAX"], constants.CAMBERS_OF_A_GRID if tested["CAMMAX"] > 0.0 else 1),
        np.linspace(tested["ALPMIN"], tested["ALPMAX"], constants.STEPS_OF_A_GRID),
        np.array(pressures),
    )
    Fz, gamma, alpha, p = (axis.ravel() for axis in np.meshgrid(*axes))
    return make_points(alpha, gamma, Fz, p=p, V=_speed(known, points), phi_t=0.0)


def _at_sideslip(known: Predictor, points: Points, channel: str, alpha: float) -> Points:
    """Conditions of the upright wheel at a sideslip, over the tested loads and, for Fx, longitudinal slips."""
    tested = tested_ranges(points)
    ends = (tested["KPUMIN"], tested["KPUMAX"]) if channel == "Fx" else (0.0, 0.0)
    Fz, kappa = np.meshgrid(
        np.linspace(tested["FZMIN"], tested["FZMAX"], constants.LOADS_OF_A_GRID),
        np.linspace(*ends, constants.STEPS_OF_A_GRID if channel == "Fx" else 1),
    )
    p, V = float(np.median(points.p[main_pressure(points)])), _speed(known, points)
    return make_points(alpha, 0.0, Fz.ravel(), kappa=kappa.ravel(), p=p, V=V, phi_t=0.0)


def _speed(known: Predictor, points: Points) -> float:
    """Speed [m/s] at which the files hold, else the usual one."""
    return known.beside.get(V_REF, float(np.median(points.V)))
