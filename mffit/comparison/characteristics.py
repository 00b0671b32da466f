"""Characteristic numbers for the comparison of tyres: stiffnesses, peaks, trail, radius."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from types import SimpleNamespace
from typing import Any, NamedTuple

import numpy as np
import pandas as pd

from mffit.constants import COVERAGE_FACTOR_95, UPRIGHT
from mffit.numbers import Numbers
from mffit.points import make_points
from mffit.points.points import of_si
from mffit.prediction import Predictor
from mffit.prediction.conditions import PATH
from mffit.quantities import CHARACTERISTICS, COLUMNS
from mffit.rounding import AtLeast
from mffit.tested import tested_limit
from tir import Quantity, Tyre
from tir.constants import SLIP_BEYOND_PEAK
from tir.derivatives import gradient, plain, traced
from tir.outputs import outputs_of

OUTPUTS = ("Fx", "Fy", "Mz", "Re")
SETTINGS = ("alpha", "gamma", "Fz", "kappa", "phi_t", "pressure")
STEP = 1e-3
"""Step of central differences for slopes at zero [rad, -, 1/m]."""
PLACES = 201
"""Places on a curve among which the largest force is found."""
FALL = "fall behind "
"""Precedes the name of a largest force: by how much its curve falls from there up to the end of the tested range."""


class Decided(NamedTuple):
    """The readings that determine a number."""

    channel: str
    over: str  #: the varied angle or slip
    largest: bool = False  #: the number is the largest of the curve


DECIDED_BY = {
    "C_alpha_N_per_rad": Decided("Fy", "alpha"),
    "mu_y": Decided("Fy", "alpha", largest=True),
    "K_xk_N": Decided("Fx", "kappa"),
    "mu_x": Decided("Fx", "kappa", largest=True),
    "C_gamma_N_per_rad": Decided("Fy", "gamma"),
    "Mz_peak_Nm": Decided("Mz", "alpha", largest=True),
    "C_Mz_alpha_Nm_per_rad": Decided("Mz", "alpha"),
    "trail_m": Decided("Mz", "alpha"),
}
"""By number, the readings that determine it; the numbers that engineers ask for first come first."""
PEAKS = tuple(key for key, by in DECIDED_BY.items() if by.largest)


class Tested(NamedTuple):
    """Ends of the ranges that were tested."""

    alpha: float  #: sideslip [rad], to either side
    gamma: float  #: camber [rad], to either side
    kappa: float  #: longitudinal slip; negative if it is the braked end

    @classmethod
    def of(cls, tyres: Sequence[Tyre]) -> Tested:
        """The ranges that some files have in common: tested ones as a build writes them, else those of the files.

        Of longitudinal slip the end that lies farther from zero, at most 0.3 away; the driven end if both are equally far.
        """
        braked = max(tested_limit(tyre, "KPUMIN") for tyre in tyres)
        driven = min(tested_limit(tyre, "KPUMAX") for tyre in tyres)
        ends = max(braked, -float(SLIP_BEYOND_PEAK)), min(driven, float(SLIP_BEYOND_PEAK))
        alpha, gamma = (min(tested_limit(tyre, key) for tyre in tyres) for key in ("ALPMAX", "CAMMAX"))
        return cls(alpha, gamma, ends[0] if -ends[0] > ends[1] else ends[1])

    def varied(self, key: str) -> bool:
        """Whether the angle or slip that a number needs was varied by more than the scatter of a held one."""
        return bool(abs(getattr(self, DECIDED_BY[key].over)) > UPRIGHT.rad)

    def end(self, key: str) -> str:
        """The end of the range in which a largest force is looked for, in words."""
        slip = DECIDED_BY[key].over == "kappa"
        return f"a slip of {self.kappa:.2g}" if slip else f"{math.degrees(self.alpha):.1f} deg"


def characteristics(
    tyre: Tyre,
    load: float,
    *,
    turn_slip: bool,
    tested: Tested | None = None,
    known: Numbers | None = None,
    predictor: Predictor | None = None,
) -> dict[str, Quantity]:
    """The numbers of ``mffit.quantities.CHARACTERISTICS`` on a straight path; SI units, ISO signs; at the file's pressure.

    ``turn_slip``: whether the simulation computes spin; without it there is no turn-slip stiffness. ``tested``, by default the
    file's, are the ranges in which the largest forces are looked for. Such a force is a peak if the curve falls by more than its
    uncertainty up to the end of that range; otherwise it is :class:`AtLeast` what was reached. Without ``known``, or if a number
    depends on none of its coefficients, the number's uncertainty is 0. With ``predictor``, the difference that the model error
    makes to a number counts as well.
    """
    tested = Tested.of([tyre]) if tested is None else tested
    names = () if known is None else [name for name in known.names if name in tyre.values]
    found, slopes = with_slopes(tyre, load, names, turn_slip=turn_slip, tested=tested)
    own = np.zeros(len(found)) if known is None else known.spread_of(slopes, names)
    best = found
    if predictor is not None:
        best, _ = with_slopes(tyre, load, (), turn_slip=turn_slip, tested=tested, predictor=predictor)
    u = dict(zip(found, own.tolist(), strict=True))
    if predictor is not None:
        u |= {
            key: max(u[key], between) for key, between in _u_of_slopes(predictor, tyre, load, found).items()
        }
    numbers: dict[str, Quantity] = {}
    for key, known_as in CHARACTERISTICS.items():
        if key not in found:
            continue
        fall = FALL + key
        kind = AtLeast if fall in found and best[fall] <= COVERAGE_FACTOR_95 * u[fall] else Quantity
        numbers[key] = kind(found[key], math.hypot(u[key], best[key] - found[key]), known_as.unit)
    return numbers


def _u_of_slopes(
    predictor: Predictor, tyre: Tyre, load: float, found: Mapping[str, float]
) -> dict[str, float]:
    """Standard uncertainties of the slopes ``found`` at zero, as readings know them together with the model error."""
    still = {
        "alpha_deg": 0.0,
        "gamma_deg": 0.0,
        "Fz_N": load,
        "p_kPa": 1e-3 * float(tyre["INFLPRES"]),
        PATH: 0.0,
    }
    u = {}
    for key, by in DECIDED_BY.items():
        if not by.largest and key != "trail_m" and by.channel in predictor.channels:
            heading = COLUMNS[by.over]
            ends = of_si(heading) * STEP * np.array([-1.0, 1.0])
            at = pd.DataFrame(still | {heading: ends})
            u[key] = predictor.u_between(tyre, at, by.channel) / (2.0 * STEP)
    of_trail = [
        u.get(key, 0.0) / found[key] for key in ("C_alpha_N_per_rad", "C_Mz_alpha_Nm_per_rad") if found[key]
    ]
    return u | {"trail_m": abs(found["trail_m"]) * math.hypot(*of_trail)}


def with_slopes(
    tyre: Tyre,
    load: float,
    names: Sequence[str],
    *,
    turn_slip: bool,
    tested: Tested,
    predictor: Predictor | None = None,
) -> tuple[dict[str, float], np.ndarray]:
    """The numbers of :func:`characteristics` (m,) without uncertainty, and their derivatives (m, k) by some coefficients.

    They include, as :data:`FALL` names it, by how much the curve of each largest force falls up to the end of the slip.
    With ``predictor``, they are those of the file's forces plus the model error.
    """
    uncertain = traced({name: float(tyre[name]) for name in names})
    values: dict[str, Any] = {**vars(tyre.p), **uncertain}
    wheel = _Wheel(SimpleNamespace(**values), load, turn_slip, predictor)
    by_slip = wheel.slopes("alpha")
    dfz = load / (float(tyre["FNOMIN"]) * float(tyre["LFZO"])) - 1.0
    found = {
        "epsilon_gamma": values["PECP1"] * (1.0 + values["PECP2"] * dfz),
        "C_alpha_N_per_rad": by_slip["Fy"],
        "C_gamma_N_per_rad": wheel.slopes("gamma")["Fy"],
        "C_Mz_alpha_Nm_per_rad": by_slip["Mz"],
        "K_xk_N": wheel.slopes("kappa")["Fx"],
        "trail_m": -by_slip["Mz"] / by_slip["Fy"] if plain(by_slip["Fy"]) else math.nan,
        "r_e_m": wheel.at("alpha", 0.0)["Re"],
    }
    if turn_slip:
        found["C_phit_Nm"] = wheel.slopes("phi_t")["Fy"]
    for key in filter(tested.varied, PEAKS):
        of_load = load if CHARACTERISTICS[key].unit == "-" else 1.0
        found[key], found[FALL + key] = (x / of_load for x in wheel.largest(DECIDED_BY[key], tested))
    jacobian = np.array([gradient(x, list(uncertain.values())) for x in found.values()], dtype=float)
    return {key: float(plain(x)) for key, x in found.items()}, jacobian.reshape(len(found), -1)


class _Wheel(NamedTuple):
    """A tyre at a load on a straight path, its coefficients plain or traced."""

    p: SimpleNamespace
    load: float
    turn_slip: bool
    predictor: Predictor | None  #: adds the model error

    def at(self, over: str, x: Any) -> dict[str, Any]:
        """The outputs at values of one angle or slip, the others zero."""
        pressure, still = float(self.p.INFLPRES), dict.fromkeys(("alpha", "gamma", "kappa", "phi_t"), 0.0)
        where = {**still, "Fz": self.load, "pressure": pressure, over: x}
        found = dict(zip(OUTPUTS, outputs_of(OUTPUTS, self.p, where, turn_slip=self.turn_slip), strict=True))
        if self.predictor is None:
            return found
        given = np.broadcast_arrays(*(where[name] for name in SETTINGS))
        alpha, gamma, Fz, kappa, phi_t, p = (np.atleast_1d(values) for values in given)
        points = make_points(alpha, gamma, Fz, kappa=kappa, p=p, V=float(self.p.LONGVL), phi_t=phi_t)
        missed = [name for name in self.predictor.channels if name in found]
        shape = given[0].shape
        return found | {n: found[n] + self.predictor.missed(n, points).reshape(shape) for n in missed}

    def slopes(self, over: str) -> dict[str, Any]:
        """The slopes of the outputs at zero."""
        below, above = self.at(over, -STEP), self.at(over, STEP)
        return {name: (above[name] - below[name]) / (2.0 * STEP) for name in OUTPUTS}

    def largest(self, by: Decided, tested: Tested) -> tuple[Any, Any]:
        """The largest force over the tested range, and its fall up to the end."""
        x = np.linspace(0.0, getattr(tested, by.over), PLACES)
        place = int(np.argmax(np.abs(plain(self.at(by.over, x)[by.channel]))))
        value, end = (self.at(by.over, float(x[i]))[by.channel] for i in (place, -1))
        sign = 1.0 if plain(value) >= 0.0 else -1.0
        return sign * value, sign * (value - end)
