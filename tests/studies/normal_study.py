"""How close the file for turn slip off comes to the limit of the formula, for tyres of known truth.

    python tests/studies/normal_study.py [TRUE.tir ...]

All misfits are rms over sideslip 8 deg, camber 50 deg, 0.7 to 1.4 nominal load, against the tyre itself with turn slip on and a
straight path. "limit": the same terms optimised for these conditions alone, without weights, ties or limits outside them.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Mapping
from pathlib import Path
from types import SimpleNamespace
from typing import Any, NamedTuple

import numpy as np
from scipy.optimize import least_squares

import tir
from mffit.fit.constraints import Envelope, violations
from mffit.fit.ranges import plausible_ranges
from mffit.fit.written.normal import CAMBER_FORCE, CAMBER_MOMENT, derive
from mffit.fit.written.road import Road, forces, weights
from tir.parameters import BY_NAME

SAMPLES = Path(__file__).parents[2] / "samples"
STARTS: tuple[Mapping[str, float], ...] = (
    {}, {"PEY5": 5.0, "QEZ5": 3.0}, {"PVY3": 0.5, "QDZ4": -2.0}, {"PDY3": 1.0, "QBZ5": 1.0}, {"QBZ5": -0.5, "QEZ5": -3.0}
)  # fmt: skip


class Outcome(NamedTuple):
    """Misfit of the normal file over the box, and the least possible one."""

    limit_Fy: float
    Fy: float
    weighted_Fy: float
    limit_Mz: float
    Mz: float
    largest_Fy: float
    stiffness: float  #: slope of Fy over camber at zero, of the file over the tyre
    seconds: float


def box(nominal_load: float, pressure: float) -> Road:
    """The conditions at which files are compared."""
    axes = np.meshgrid(
        np.linspace(0.7, 1.4, 5) * nominal_load,
        np.radians(np.linspace(-8, 8, 17)),
        np.radians(np.linspace(-50, 50, 11)),
        [pressure],
        indexing="ij",
    )
    return Road(*(axis.ravel() for axis in axes))


def tested(tyre: tir.Tyre) -> dict[str, float]:
    """The ranges of the usual campaign."""
    load, pressure = tyre["FNOMIN"], tyre["NOMPRES"]
    alpha, gamma = np.radians(8.0), np.radians(50.0)
    return {
        "FZMIN": 0.6 * load, "FZMAX": 1.5 * load, "ALPMIN": -alpha, "ALPMAX": alpha, "CAMMIN": -gamma,
        "CAMMAX": gamma, "PRESMIN": 0.8 * pressure, "PRESMAX": 1.2 * pressure,
    }  # fmt: skip


def limit(values: Mapping[str, Any], road: Road) -> tuple[float, float]:
    """The smallest rms misfits of Fy [N] and Mz [Nm] that the camber terms can reach on the road."""
    best = dict(values)
    ends = []
    for channel, names in (("Fy", CAMBER_FORCE), ("Mz", CAMBER_MOMENT)):
        found = [_least(values, {**best, **start}, names, channel, road) for start in STARTS]
        misfit, ended = min(found, key=lambda pair: pair[0])
        best.update(ended)
        ends.append(misfit)
    return ends[0], ends[1]


def _least(values, start, names, channel, road: Road) -> tuple[float, dict[str, float]]:
    target = getattr(forces(values, road, turn_slip=True), channel)
    limits = Envelope(
        (road.Fz.min(), road.Fz.max()),
        road.gamma.max(),
        road.alpha.max(),
        (road.pressure[0], road.pressure[0]),
    )
    unit = {"Fy": 10.0, "Mz": 0.5}[channel]

    def residual(x: np.ndarray) -> np.ndarray:
        tried = {**start, **dict(zip(names, x, strict=True))}
        misfit = getattr(forces(tried, road, turn_slip=False), channel) - target
        return np.concatenate([misfit / unit, 300.0 * violations(SimpleNamespace(**tried), limits)])

    lower, upper = (np.array([BY_NAME[n].bounds[i] for n in names]) for i in (0, 1))
    begun = np.clip([start[n] for n in names], lower + 1e-3 * (upper - lower), upper - 1e-3 * (upper - lower))
    out = least_squares(residual, begun, bounds=(lower, upper), x_scale="jac", max_nfev=100)
    return unit * float(np.sqrt(np.mean(out.fun[: len(target)] ** 2))), dict(zip(names, out.x, strict=True))


def outcome(tyre: tir.Tyre, *, with_limit: bool = True) -> Outcome:
    """Derive the normal file of a tyre and compare it with the tyre."""
    values, data = dict(tyre.values), tested(tyre)
    began = time.perf_counter()
    written = plausible_ranges(values, data, turn_slip=True)
    normal = {**values, **derive(values, data, written)}
    seconds = time.perf_counter() - began
    road = box(values["FNOMIN"], values["NOMPRES"])
    true, made = forces(values, road, turn_slip=True), forces(normal, road, turn_slip=False)
    weight = weights(road, data)
    step = np.radians([-0.1, 0.1])
    lean = Road(np.full(2, values["FNOMIN"]), np.zeros(2), step, np.full(2, values["NOMPRES"]))
    slopes = [np.diff(forces(v, lean, turn_slip=on).Fy)[0] for v, on in ((normal, False), (values, True))]
    limits = limit(values, road) if with_limit else (np.nan, np.nan)
    return Outcome(
        limit_Fy=limits[0],
        Fy=float(np.sqrt(np.mean((made.Fy - true.Fy) ** 2))),
        weighted_Fy=float(np.sqrt(np.average((made.Fy - true.Fy) ** 2, weights=weight))),
        limit_Mz=limits[1],
        Mz=float(np.sqrt(np.mean((made.Mz - true.Mz) ** 2))),
        largest_Fy=float(np.max(np.abs(made.Fy - true.Fy))),
        stiffness=float(slopes[0] / slopes[1]),
        seconds=seconds,
    )


def main(files: list[str]) -> None:
    """Print the table."""
    paths = [Path(file) for file in files] or sorted(SAMPLES.glob("*/true.tir"))
    print(
        f"{'tyre':28} {'limit Fy':>8} {'Fy':>6} {'ratio':>6} {'weighted':>8} {'largest':>8} {'limit Mz':>8} {'Mz':>5} "
        f"{'ratio':>6} {'stiffness':>9} {'s':>5}"
    )
    for path in paths:
        o = outcome(tir.read(path))
        name = f"{path.parent.name}/{path.stem}"
        print(
            f"{name:28} {o.limit_Fy:8.1f} {o.Fy:6.1f} {o.Fy / o.limit_Fy:6.2f} {o.weighted_Fy:8.1f} "
            f"{o.largest_Fy:8.0f} {o.limit_Mz:8.2f} {o.Mz:5.2f} {o.Mz / o.limit_Mz:6.2f} {o.stiffness:9.2f} {o.seconds:5.2f}"
        )


if __name__ == "__main__":
    main(sys.argv[1:])
