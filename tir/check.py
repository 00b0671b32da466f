"""What a simulation would stumble over: physical checks of a tyre over its own ranges. Raises nothing, repairs nothing."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from tir.equations import lateral, normalise, stiffness
from tir.errors import Problem
from tir.parameters import TABLE
from tir.tyre import Tyre

RANGES = (
    ("PRESMIN", "PRESMAX"),
    ("FZMIN", "FZMAX"),
    ("KPUMIN", "KPUMAX"),
    ("ALPMIN", "ALPMAX"),
    ("CAMMIN", "CAMMAX"),
)


def check(tyre: Tyre) -> list[Problem]:
    """Problems of the tyre; level "error" where it cannot be simulated sensibly, "warning" where one should look."""
    found = [*_dimensions(tyre), *_ranges(tyre)]
    if not any(problem.level == "error" for problem in found):
        found += [*_envelope(tyre), *_spin(tyre), *_moments(tyre)]
    return found


def _error(name: str, sentence: str) -> Problem:
    return Problem("error", sentence, name)


def _warning(name: str, sentence: str) -> Problem:
    return Problem("warning", sentence, name)


def _dimensions(tyre: Tyre) -> Iterator[Problem]:
    R0 = tyre["UNLOADED_RADIUS"]
    if not 0.05 < R0 < 1.5:
        hint = "it looks like millimetres" if R0 > 50 else "a radius in metres was expected"
        yield _error("UNLOADED_RADIUS", f"UNLOADED_RADIUS is {R0:g}: {hint}; correct it or [UNITS] LENGTH")
    if tyre["RIM_RADIUS"] >= R0:
        yield _warning(
            "RIM_RADIUS", f"RIM_RADIUS {tyre['RIM_RADIUS']:g} is not smaller than UNLOADED_RADIUS {R0:g}"
        )
    for name in [row.name for row in TABLE if row.divisor] + ["INFLPRES"]:
        if tyre[name] <= 0:
            remedy = "reverse its sign" if tyre[name] < 0 else "give its value"
            yield _error(name, f"{name} is {tyre[name]:g}, and it must be positive; {remedy}")
    if 0 < tyre["NOMPRES"] < 5e3:
        yield _warning("NOMPRES", f"NOMPRES is {tyre['NOMPRES']:g} Pa: it looks like kPa or bar; write Pa")
    scaled = [row.name for row in TABLE if row.scaling and tyre[row.name] != 1.0]
    if scaled:
        yield _warning(
            scaled[0], f"scaling factors differ from 1: {', '.join(scaled)}; fitted files have 1 throughout"
        )
    odd = [row.name for row in TABLE if row.odd and tyre[row.name]]
    if str(tyre["TYRESIDE"]).upper().startswith("SYM") and odd:
        yield _warning("TYRESIDE", f"TYRESIDE is symmetric, but the odd terms {', '.join(odd)} are not 0")


def _ranges(tyre: Tyre) -> Iterator[Problem]:
    for low, high in RANGES:
        if tyre[low] >= tyre[high]:
            yield _error(low, f"{low} {tyre[low]:g} is not below {high} {tyre[high]:g}")
    for name, largest in (("ALPMAX", 1.7), ("CAMMAX", 1.6)):
        if tyre[name] > largest:
            yield _warning(name, f"{name} is {tyre[name]:g}: it looks like degrees; write radians")
    if 0 < tyre["CAMMAX"] < 0.15 and tyre["MC_CONTOUR_A"] > 0:
        yield _warning(
            "CAMMAX",
            f"CAMMAX is {np.degrees(tyre['CAMMAX']):.1f} deg on a motorcycle tyre: simulations hold camber to it without notice",
        )
    if tyre["ALPMIN"] > 0 or tyre["CAMMIN"] > 0 or tyre["KPUMIN"] > 0:
        yield _error("ALPMIN", "the lower limits of slip and camber must not be positive")


def _grid(tyre: Tyre):
    Fz = np.linspace(max(tyre["FZMIN"], 0.02 * tyre["FNOMIN"]), tyre["FZMAX"], 7)
    gamma = np.linspace(max(tyre["CAMMIN"], -1.05), min(tyre["CAMMAX"], 1.05), 9)
    low, high = max(tyre["PRESMIN"], 0.5 * tyre["NOMPRES"]), min(tyre["PRESMAX"], 1.5 * tyre["NOMPRES"])
    pressure = np.linspace(low, high, 3) if low < high else np.array([tyre["NOMPRES"]])
    return [axis.ravel() for axis in np.meshgrid(Fz, gamma, pressure)]


def _envelope(tyre: Tyre) -> Iterator[Problem]:
    """Shape of the side force over the file's ranges of load, camber and pressure."""
    p = tyre.p
    Fz, gamma, pressure = _grid(tyre)
    q = normalise.inputs(p, Fz, Fz, 0.0, 0.0, gamma, 0.0, pressure, False, False)
    if p.PCY1 * p.LCY <= 0 or p.QCZ1 <= 0:
        yield _error("PCY1", "the shape factors PCY1 and QCZ1 must be positive")

    def where(broken):
        i = int(np.argmax(broken))
        return f"at {Fz[i]:.0f} N, {np.degrees(gamma[i]):.0f} deg camber, {pressure[i] / 1e3:.0f} kPa"

    mu = stiffness.lateral_friction(p, q, gamma)
    if np.any(mu <= 0):
        yield _error(
            "PDY1",
            f"the lateral friction coefficient is not positive {where(mu <= 0)}: narrow the ranges or refit",
        )
    elif np.any(mu > 4):
        yield _warning("PDY1", f"the lateral friction coefficient is {mu.max():.1f} {where(mu > 4)}")
    K = stiffness.cornering_stiffness(p, q, gamma)
    upright = np.abs(gamma) < 1e-9
    if np.any(K[upright] >= 0):
        yield _error(
            "PKY1",
            "the cornering stiffness is not negative at zero camber (ISO-W): the file is in other axes, or wrong",
        )
    elif np.any(K >= 0):
        yield _warning(
            "PKY3", f"the cornering stiffness changes sign {where(K >= 0)}: narrow CAMMIN and CAMMAX"
        )
    K_gamma = stiffness.camber_stiffness(p, q)
    if np.any(K_gamma > 0):
        yield _warning(
            "PKY6",
            f"camber pushes against the lean {where(K_gamma > 0)}: a normal tyre has PKY6 < 0 in ISO-W",
        )
    worst = max(float(lateral.curvature(p, q, gamma, side).max()) for side in (-1.0, 1.0))
    if worst > 1.0:
        yield _warning(
            "PEY1",
            f"the curvature E_y reaches {worst:.2f} > 1 within the ranges: simulations may hold it at 1",
        )
    ratio = tyre.state(float(p.FNOMIN)).Re / p.UNLOADED_RADIUS
    if not 0.85 < ratio < 1.05:
        yield _warning(
            "BREFF",
            f"the effective radius is {ratio:.2f} of the unloaded one: check BREFF, DREFF, FREFF, Q_RE0",
        )


def _spin(tyre: Tyre) -> Iterator[Problem]:
    p = tyre.p
    load = np.linspace(max(p.FZMIN, 0.02 * p.FNOMIN), p.FZMAX, 21)
    eps = normalise.camber_reduction(p, normalise.relative_load(p, load))
    if np.any(np.abs(eps - 1.0) < 0.02) or np.ptp(np.sign(eps - 1.0)) > 0:
        yield _warning(
            "PECP1", "eps_gamma comes near 1 within the load range, where the turn-slip stiffness is infinite"
        )
    if (p.PECP1, p.PECP2) == (0.5, 0.0):
        yield _warning(
            "PECP1", "PECP1 is the common default 0.5, not a measurement: motorcycle tyres have about 0"
        )
    gamma = np.array([-1e-4, 1e-4])
    Fz = float(p.FNOMIN)
    with_spin, without = (float(np.diff(tyre(Fz, gamma=gamma, turn_slip=on).Fy)[0]) for on in (True, False))
    expected = without * p.UNLOADED_RADIUS / tyre.state(Fz).Re
    if abs(without) > 1e-9 and abs(with_spin - expected) > 0.01 * abs(expected):
        yield _warning(
            "PHYP1",
            "camber force with turn slip on is not that with turn slip off times R0/Re: check PHYP1-4",
        )


def _moments(tyre: Tyre) -> Iterator[Problem]:
    p = tyre.p
    first = any(tyre[f"QSX{i}"] for i in range(4, 12))
    second = any(tyre[f"QSX{i}"] for i in (12, 13, 14))
    if first and second:
        yield _warning(
            "QSX12", "QSX4-11 and QSX12-14 are both used: they are alternatives for the same effect"
        )
    step = np.array([-1e-3, 1e-3])
    if float(np.diff(tyre(float(p.FNOMIN), step).Mz)[0]) <= 0:
        yield _warning(
            "QDZ1",
            "the aligning moment does not align at nominal load (dMz/dalpha should be positive in ISO-W)",
        )
