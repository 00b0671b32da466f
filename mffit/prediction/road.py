"""The tyre on the road: side force and aligning moment on a straight path, as they are best known, with their uncertainty."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass

import numpy as np
import pandas as pd

from mffit.as_json import keys
from mffit.constants import COVERAGE_FACTOR_95, STEPS_OF_LINE, UPRIGHT
from mffit.prediction import constants
from mffit.prediction.conditions import PATH
from mffit.prediction.predictor import Predictor
from mffit.quantities import CHANNELS, DIRECT, SIDEWAYS
from mffit.rig import Simulation
from mffit.rounding import AtLeast
from mffit.scatter import rms
from mffit.tested import tested_limit
from tir import Quantity, Tyre
from tir.frozen import ReadOnlyArrays


@dataclass(frozen=True, slots=True, eq=False)
class RoadCurve(ReadOnlyArrays):
    """Forces over sideslip on a straight path at one camber, by channel in its unit; ISO-W axes."""

    camber: float  #: [rad]
    sideslip: np.ndarray  #: (n,) over the tested range [rad]
    best: Mapping[str, np.ndarray]  #: (n,) best estimate, as ``predict`` gives it
    u: Mapping[str, np.ndarray]  #: (n,) its standard uncertainty as the tyre's mean force
    off: Mapping[str, np.ndarray]
    """(n,) how far the file for turn slip off is from the best estimate; empty if no such file was derived."""

    def half_width(self, channel: str) -> float:
        """Half width of the 95 % band, rms over the curve."""
        return COVERAGE_FACTOR_95 * rms(self.u[channel])


@dataclass(frozen=True, slots=True)
class RoadSide:
    """What the tyre does upright at sideslip of one sign; a quantity is None if its channel was not measured."""

    Fy: Quantity | None  #: at the sideslip of the record
    Mz: Quantity | None  #: at this sideslip, too
    mu_y: Quantity | None
    """Largest side force over the load; :class:`AtLeast` what was reached if it is no peak."""
    M_zmax: Quantity | None  #: largest size of the aligning moment


def lesser(sides: Iterable[Quantity | None]) -> Quantity | None:
    """The smaller of a number's values on both sides, which stands for the tyre as a whole; None if one is not known."""
    known = list(sides)
    found = [one for one in known if one is not None]
    return min(found, key=lambda one: one.value) if found and len(found) == len(known) else None


@dataclass(frozen=True, slots=True)
class RoadMiss:
    """How far the file for turn slip off is from the best estimate in one channel, over one curve."""

    rms: float  #: in the unit of the channel
    share: float  #: over the largest force of the upright wheel


@dataclass(frozen=True, slots=True, eq=False)
class OnRoad:
    """The tyre on a straight path at nominal load and pressure."""

    load: float  #: [N]
    pressure: float  #: [Pa]
    sideslip: float  #: at which Fy and Mz are stated, to both sides [rad]
    sides: Mapping[str, RoadSide]  #: "negative" and "positive" sideslip
    upright: RoadCurve
    leaned: RoadCurve | None  #: at a usual camber of those tested; None if no camber was tested
    better: tuple[str, ...] = ()
    """What would narrow the bands, most useful first; the right parts of sentences."""

    @property
    def curves(self) -> dict[str, RoadCurve]:
        """The curves by posture."""
        return {"upright": self.upright} | ({} if self.leaned is None else {"leaned": self.leaned})

    @property
    def missed(self) -> dict[str, dict[str, RoadMiss]]:
        """By posture and channel, how far the file for turn slip off is from the best estimate; empty without such a file."""
        return {
            posture: {
                name: RoadMiss(rms(off), rms(off) / float(np.max(np.abs(self.upright.best[name]))))
                for name, off in curve.off.items()
            }
            for posture, curve in self.curves.items()
            if curve.off
        }


def _of_curve(curve: RoadCurve) -> dict[str, object]:
    """A curve in the units of its keys, and its 95 % bands."""
    found: dict[str, object] = {
        "gamma_deg": math.degrees(curve.camber),
        "alpha_deg": np.degrees(curve.sideslip),
    }
    for name, best in curve.best.items():
        unit = CHANNELS[name].unit
        found |= {f"{name}_{unit}": best, f"u_{name}_{unit}": curve.u[name]}
        found[f"half_width_{name}_{unit}"] = curve.half_width(name)
        if name in curve.off:
            found[f"off_{name}_{unit}"] = curve.off[name]
    return found


keys(
    OnRoad,
    "load_N=load pressure_kPa alpha_deg=sideslip sides missed_by_normal=missed curves better",
    alpha_deg=lambda road: math.degrees(road.sideslip),
    sides=lambda road: {side: _of_side(found) for side, found in road.sides.items()},
    curves=lambda road: {posture: _of_curve(curve) for posture, curve in road.curves.items()},
)


def _of_side(side: RoadSide) -> dict[str, object]:
    units = {name: quantity.unit_behind for name, quantity in (SIDEWAYS | DIRECT).items()}
    named = {name: getattr(side, name) for name in ("Fy", "Mz", "mu_y", "M_zmax")}
    return {"_".join(filter(None, (name, units[name]))): q for name, q in named.items()}


def road_of(
    known: Predictor, fitted: Tyre, normal: Tyre | None = None, better: tuple[str, ...] = ()
) -> OnRoad | None:
    """The tyre on a straight path, from the predictor of a build; None if no sideslip was tested.

    ``fitted`` is the file of the fitted model, whose tested ranges count, ``normal`` the file for turn slip off that was derived
    from it, ``better`` says what would narrow the bands. Everything is the best estimate of :meth:`Predictor.predict` with its
    uncertainty, at the usual temperature.
    """
    at = postures(fitted)
    if at is None:
        return None
    sideslip, camber = at
    half = len(sideslip) // 2
    tyre = _TyreOnRoad(known, fitted, normal)
    upright = tyre.curve(0.0, sideslip)
    k = round(half * float(constants.USUAL_SHARE))
    halves = {"negative": np.arange(half, -1, -1), "positive": np.arange(half, 2 * half + 1)}
    return OnRoad(
        load=float(fitted["FNOMIN"]),
        pressure=float(fitted["NOMPRES"]),
        sideslip=float(sideslip[half + k]),
        sides={side: tyre.side(upright, rows, k) for side, rows in halves.items()},
        upright=upright,
        leaned=tyre.curve(camber, sideslip) if camber else None,
        better=better,
    )


def postures(fitted: Tyre) -> tuple[np.ndarray, float] | None:
    """Sideslip angles (n,) [rad] to both sides, and the camber [rad] of the leaned wheel, 0 if no camber was tested.

    None if no sideslip was tested.
    """
    ends = {key: tested_limit(fitted, key) for key in ("ALPMIN", "ALPMAX", "CAMMIN", "CAMMAX")}
    most, camber = (max(-ends[f"{name}MIN"], ends[f"{name}MAX"]) for name in ("ALP", "CAM"))
    if not most > UPRIGHT.rad:
        return None
    half = int(STEPS_OF_LINE) // 2
    leaned = float(constants.USUAL_SHARE) * camber
    return np.linspace(-1.0, 1.0, 2 * half + 1) * most, leaned if leaned > UPRIGHT.rad else 0.0


def conditions(fitted: Tyre, camber: float, sideslip: np.ndarray) -> pd.DataFrame:
    """The conditions of a curve on the road, for :meth:`Predictor.points`."""
    angles = {"alpha_deg": np.degrees(sideslip), "gamma_deg": math.degrees(camber)}
    return pd.DataFrame({**angles, "Fz_N": float(fitted["FNOMIN"]), PATH: 0.0})


@dataclass(frozen=True, slots=True)
class _TyreOnRoad:
    """A tyre at nominal load and pressure on a straight path."""

    known: Predictor
    fitted: Tyre
    normal: Tyre | None

    def curve(self, camber: float, sideslip: np.ndarray) -> RoadCurve:
        """The best estimate over sideslip, and how far the file for turn slip off is from it."""
        points = self.known.points(self.fitted, conditions(self.fitted, camber, sideslip))
        model = Simulation.of(self.fitted, turn_slip=self.known.curved)
        found = self.known.forces(model, model, points, SIDEWAYS)
        off = {}
        if self.normal is not None:
            file = Simulation.of(self.normal, turn_slip=False).readings(points, tuple(found))
            off = {name: file[name] - one.best for name, one in found.items()}
        return RoadCurve(
            camber,
            sideslip,
            {name: one.best for name, one in found.items()},
            {name: np.sqrt(one.variance) for name, one in found.items()},
            off,
        )

    def side(self, curve: RoadCurve, rows: np.ndarray, k: int) -> RoadSide:
        """The numbers at sideslip of one sign, ``rows`` of the curve from zero outwards; Fy and Mz at the ``k``-th of them."""
        at = {
            name: Quantity(float(best[rows[k]]), float(curve.u[name][rows[k]]), CHANNELS[name].unit)
            for name, best in curve.best.items()
        }
        largest = {name: self._largest(curve, name, rows) for name in curve.best}
        grip = largest.get("Fy")
        load = float(self.fitted["FNOMIN"])
        mu_y = grip and type(grip)(grip.value / load, grip.u / load, DIRECT["mu_y"].unit)
        return RoadSide(at.get("Fy"), at.get("Mz"), mu_y, largest.get("Mz"))

    def _largest(self, curve: RoadCurve, name: str, rows: np.ndarray) -> Quantity:
        """The largest size of a force; a peak if the curve falls behind it by more than the uncertainty of the fall."""
        size = np.abs(curve.best[name][rows])
        peak = int(np.argmax(size))
        ends = curve.sideslip[rows[[peak, -1]]]
        u_fall = self.known.u_between(self.fitted, conditions(self.fitted, curve.camber, ends), name)
        kind = Quantity if size[peak] - size[-1] > COVERAGE_FACTOR_95 * u_fall else AtLeast
        return kind(float(size[peak]), float(curve.u[name][rows[peak]]), CHANNELS[name].unit)
