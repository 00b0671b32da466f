"""Characteristic numbers for the comparison of tyres: stiffnesses, peaks, trail, radius."""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping, Sequence
from types import SimpleNamespace
from typing import Any, NamedTuple

import numpy as np

from mffit.constants import COVERAGE_FACTOR_95, SLIP_BEYOND_THE_PEAK, UPRIGHT
from mffit.numbers import Numbers
from mffit.points import make_points
from mffit.prediction import Predictor
from mffit.quantities import CHARACTERISTICS
from mffit.rounding import AtLeast
from mffit.tested import tested_limit
from tir import Quantity, Tyre
from tir.derivatives import gradient, plain, traced
from tir.outputs import outputs_of

OUTPUTS = ("Fx", "Fy", "Mz", "Re")
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
        ends = max(braked, -float(SLIP_BEYOND_THE_PEAK)), min(driven, float(SLIP_BEYOND_THE_PEAK))
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
    numbers: dict[str, Quantity] = {}
    for key, known_as in CHARACTERISTICS.items():
        if key not in found:
            continue
        fall = FALL + key
        kind = AtLeast if fall in found and best[fall] <= COVERAGE_FACTOR_95 * u[fall] else Quantity
        numbers[key] = kind(found[key], math.hypot(u[key], best[key] - found[key]), known_as.unit)
    return numbers


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
    p = SimpleNamespace(**values)
    still = {"alpha": 0.0, "gamma": 0.0, "kappa": 0.0, "phi_t": 0.0}
    still |= {"Fz": load, "pressure": float(tyre["INFLPRES"])}

    def at(over: str, x: Any) -> dict[str, Any]:
        where = {**still, over: x}
        found = dict(zip(OUTPUTS, outputs_of(OUTPUTS, p, where, turn_slip=turn_slip), strict=True))
        if predictor is not None:
            missed = _missed(predictor, where, float(tyre["LONGVL"]), found.keys())
            found |= {name: found[name] + own for name, own in missed.items()}
        return found

    def slopes(over: str) -> dict[str, Any]:
        below, above = at(over, -STEP), at(over, STEP)
        return {name: (above[name] - below[name]) / (2.0 * STEP) for name in OUTPUTS}

    def largest(by: Decided) -> tuple[Any, Any]:
        """The largest force over the tested range, and its fall up to the end."""
        x = np.linspace(0.0, getattr(tested, by.over), PLACES)
        place = int(np.argmax(np.abs(plain(at(by.over, x)[by.channel]))))
        value, end = (at(by.over, float(x[i]))[by.channel] for i in (place, -1))
        sign = 1.0 if plain(value) >= 0.0 else -1.0
        return sign * value, sign * (value - end)

    by_slip = slopes("alpha")
    dfz = load / (float(tyre["FNOMIN"]) * float(tyre["LFZO"])) - 1.0
    found = {
        "epsilon_gamma": values["PECP1"] * (1.0 + values["PECP2"] * dfz),
        "C_alpha_N_per_rad": by_slip["Fy"],
        "C_gamma_N_per_rad": slopes("gamma")["Fy"],
        "C_Mz_alpha_Nm_per_rad": by_slip["Mz"],
        "K_xk_N": slopes("kappa")["Fx"],
        "trail_m": -by_slip["Mz"] / by_slip["Fy"] if plain(by_slip["Fy"]) else math.nan,
        "r_e_m": at("alpha", 0.0)["Re"],
    }
    if turn_slip:
        found["C_phit_Nm"] = slopes("phi_t")["Fy"]
    for key in filter(tested.varied, PEAKS):
        of_load = load if CHARACTERISTICS[key].unit == "-" else 1.0
        found[key], found[FALL + key] = (x / of_load for x in largest(DECIDED_BY[key]))
    jacobian = np.array([gradient(x, list(uncertain.values())) for x in found.values()], dtype=float)
    return {key: float(plain(x)) for key, x in found.items()}, jacobian.reshape(len(found), -1)


def _missed(
    predictor: Predictor, where: Mapping[str, Any], V: float, names: Collection[str]
) -> dict[str, np.ndarray]:
    """The model error of some channels at conditions of a number or of a curve (n,)."""
    settings = ("alpha", "gamma", "Fz", "kappa", "phi_t", "pressure")
    alpha, gamma, Fz, kappa, phi_t, p = (
        np.atleast_1d(x) for x in np.broadcast_arrays(*(where[name] for name in settings))
    )
    points = make_points(alpha, gamma, Fz, kappa=kappa, p=p, V=V, phi_t=phi_t)
    shape = np.broadcast_shapes(*(np.shape(where[name]) for name in settings))
    return {n: predictor.missed(n, points).reshape(shape) for n in predictor.channels if n in names}
