"""A rig written from the definitions of the documentation, for blind sets; it uses nothing of ``mffit``.

Forces of the tyre come from ``tir``, everything around them from here: programme, causes of the library, causes outside it.
The diagnosis of a set is judged against the noise-free readings between the settings.
"""

from __future__ import annotations

import tempfile
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from blind_scores import Verdict
from blind_set import SAMPLES
from disc_files import write_project, write_sweep
from scipy.optimize import brentq
from scipy.special import chdtri, chndtr

import tir
from mffit import pipeline
from mffit.rig import Simulation
from mffit.scatter import rms
from tir import Tyre

U_FY, U_MZ = 6.0, 0.6  # N, Nm
UP = (-8, -6, -4.5, -3, -2, -1, 0, 1, 2, 3, 4.5, 6, 8)  # deg
CAMBERS = (-45, -35, -25, -15, -8, 0, 8, 15, 25, 35, 45)  # deg
RADIUS = 1.323  # m, centre of the disc to the left


@dataclass(frozen=True)
class Run:
    """Set-points in the order in which they were run; arrays (n,)."""

    file: np.ndarray  #: name of the sweep
    alpha: np.ndarray  #: [deg]
    gamma: np.ndarray  #: [deg]
    Fz: np.ndarray  #: [N]
    p: np.ndarray  #: [kPa]
    V: np.ndarray  #: [m/s], positive
    backward: np.ndarray  #: bool
    sense: np.ndarray  #: 1 rising sideslip, -1 falling, 0 held
    t: np.ndarray  #: [s]
    T: np.ndarray  #: [degC]
    km: np.ndarray  #: distance rolled

    def __len__(self) -> int:
        return len(self.alpha)


def programme(load: float, p: float, rng: np.random.Generator) -> Run:
    """319 points: sideslip up and down, camber, zeros, leaned sweeps; two more pressures; slow first, then fast."""
    runs = []
    for Fz in (0.6 * load, load, 1.5 * load):
        runs += [(f"up_{Fz:.0f}", UP, (0,), Fz, p, 0), (f"down_{Fz:.0f}", UP[::-1], (0,), Fz, p, 0)]
        runs += [(f"camber_{Fz:.0f}", (0,), CAMBERS, Fz, p, 0)]
        runs += [(f"zeros_{Fz:.0f}_{b}", (-1, -0.5, 0, 0.5, 1), (0,), Fz, p, b) for b in (0, 1)]
    for lean, Fz in ((10, load), (20, load), (35, load), (20, 1.5 * load)):
        runs += [(f"lean_{Fz:.0f}_{g}", UP if g > 0 else UP[::-1], (g,), Fz, p, 0) for g in (lean, -lean)]
    for other in (p - 50.0, p + 50.0):
        runs += [(f"slip_{other:.0f}kPa", UP, (0,), load, other, 0)]
        runs += [(f"back_{other:.0f}kPa", UP[::-1], (0,), load, other, 0)]
        runs += [(f"camber_{other:.0f}kPa", (0,), CAMBERS, load, other, 0)]
    rows = []
    for place, k in enumerate(rng.permutation(len(runs))):
        name, alphas, gammas, Fz, pressure, back = runs[k]
        V = 3.0 if place < len(runs) // 2 else 15.0
        way = float(np.sign(alphas[-1] - alphas[0])) if len(alphas) > 1 else 0.0
        rows += [(name, a, g, Fz, pressure, V, bool(back), way) for g in gammas for a in alphas]
    file, alpha, gamma, Fz, pressure, V, backward, sense = map(np.array, zip(*rows, strict=True))
    seconds = float(rng.uniform(15.0, 30.0))
    t = seconds * np.arange(len(rows))
    km = np.concatenate([[0.0], np.cumsum(0.5 * (V[1:] + V[:-1]) * seconds)]) / 1e3
    T = 38.0 + 8.0 * np.sin(t / rng.uniform(250.0, 900.0)) + rng.normal(0.0, 0.5, len(t))
    return Run(
        file, alpha.astype(float), gamma.astype(float), np.round(Fz, 1), pressure, V, backward, sense, t,
        np.round(T, 2), km,
    )  # fmt: skip


Numbers = Mapping[str, float]


def readings(
    tyre: Tyre, run: Run, numbers: Numbers, outside: Outside | None = None
) -> tuple[np.ndarray, np.ndarray]:
    """Fy [N] and Mz [Nm] of a rig with some errors, without noise; arrays (n,)."""
    x = {name: numbers.get(name, 0.0) for name in NUMBERS}
    if outside is not None:
        run = outside.settings(run)
    gamma = np.deg2rad(run.gamma + x["gamma_0_deg"])
    load = run.Fz * (1.0 + x["load_camber"] * (1.0 - np.cos(2.0 * gamma)) / 2.0)
    alpha = np.deg2rad(
        run.alpha + x["alpha_0_deg"] + x["camber_skew_deg"] * np.sin(gamma) - x["hysteresis_deg"] * run.sense
        + _per_run(run, numbers, "alpha_0_deg@")
    )  # fmt: skip
    grip, stiff = (
        1.0 + x[name] * (run.T - np.mean(run.T)) for name in ("k_T_grip_per_K", "k_T_stiffness_per_K")
    )

    def tyre_at(angle: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        if not (x["k_T_grip_per_K"] or x["k_T_stiffness_per_K"]):
            out = _forces(tyre, run, load, angle, gamma, slice(None))
            return out.Fy, out.Mz
        Fy, Mz = np.empty(len(run)), np.empty(len(run))
        for i in range(len(run)):  # one tyre per temperature
            one = tyre.replace(LMUY=tyre["LMUY"] * grip[i], LKY=tyre["LKY"] * stiff[i])
            out = _forces(one, run, load, angle, gamma, slice(i, i + 1))
            Fy[i], Mz[i] = float(out.Fy[0]), float(out.Mz[0])
        return Fy, Mz

    Fy, Mz = tyre_at(alpha)
    for _ in range(30 if x["compliance_deg_per_Nm"] else 0):
        Fy, Mz = tyre_at(alpha + np.deg2rad(x["compliance_deg_per_Nm"]) * Mz)
    around = (1.0 + x["wear_per_km"] * run.km) * (1.0 - x["warm_up"] * np.exp(-run.km))
    Fy, Mz = Fy * around, Mz * around
    if outside is not None:
        Fy, Mz = outside.forces(run, Fy, Mz)
    Fy = Fy + x["nonlinearity_per_kN"] * Fy * np.abs(Fy) / 1e3
    return Fy + x["F0_N"] + _per_run(run, numbers, "F0_N@"), Mz + x["M0_Nm"] + _per_run(
        run, numbers, "M0_Nm@"
    )


def _forces(tyre: Tyre, run: Run, load, alpha, gamma, rows):
    V = np.where(run.backward, -run.V, run.V)[rows]
    return tyre(
        load[rows], alpha=alpha[rows], gamma=gamma[rows], phi_t=-1.0 / RADIUS, Vx=V, p=1e3 * run.p[rows], turn_slip=True
    )  # fmt: skip


def _per_run(run: Run, numbers: Numbers, start: str) -> np.ndarray:
    return np.array([numbers.get(start + name, 0.0) for name in run.file])


NUMBERS = (
    "gamma_0_deg", "load_camber", "alpha_0_deg", "camber_skew_deg", "hysteresis_deg", "k_T_grip_per_K",
    "k_T_stiffness_per_K", "compliance_deg_per_Nm", "wear_per_km", "warm_up", "nonlinearity_per_kN", "F0_N", "M0_Nm",
)  # fmt: skip
LIBRARY = {
    "steering-compliance": "compliance_deg_per_Nm",
    "loadcell-nonlinearity": "nonlinearity_per_kN",
    "hysteresis": "hysteresis_deg",
    "run-offsets-fy": "F0_N@",
    "run-offsets-mz": "M0_Nm@",
    "run-offsets-alpha": "alpha_0_deg@",
    "temperature-grip": "k_T_grip_per_K",
    "temperature-stiffness": "k_T_stiffness_per_K",
    "wear": "wear_per_km",
    "warm-up": "warm_up",
    "camber-skew": "camber_skew_deg",
    "load-camber": "load_camber",
    "camber-misalignment": "gamma_0_deg",
}
"""Effect -> the number that it frees; ``@``: one for every run."""
UNIT = {
    "k_T_grip_per_K": 1e-4, "k_T_stiffness_per_K": 1e-4, "compliance_deg_per_Nm": 1e-4, "wear_per_km": 1e-4, "warm_up": 1e-3,
    "nonlinearity_per_kN": 1e-4, "load_camber": 1e-3,
}  # fmt: skip
"""A small size of each number, to scale from; 0.01 for the others, which are in degrees, newtons or newton metres."""


@dataclass(frozen=True)
class Outside:
    """A cause outside the library: what it does to the settings or to the readings, in proportion to ``size``."""

    settings: Callable[[Run], Run] = lambda run: run
    forces: Callable[[Run, np.ndarray, np.ndarray], tuple[np.ndarray, np.ndarray]] = lambda run, *F: F
    part: tuple[str, ...] = ()  #: effects that describe a part of it correctly


def _sliding(s: float, rng: np.random.Generator) -> Outside:
    knee = rng.uniform(2.5, 4.5)
    return Outside(
        forces=lambda run, Fy, Mz: (Fy * (1.0 - s * np.maximum(np.abs(run.alpha) - knee, 0.0)), Mz)
    )


def _turned(s: float, rng: np.random.Generator) -> Outside:
    """Mx from its lever under Fy, My from rolling resistance."""
    roll, pitch, yaw = s * rng.normal(size=3)

    def forces(run, Fy, Mz):
        Fx, Mx, My = -0.012 * run.Fz, 0.3 * Fy, -0.004 * run.Fz
        return Fy + roll * run.Fz - yaw * Fx, Mz - roll * My + pitch * Mx

    return Outside(forces=forces, part=("crosstalk-fz-fy",))


def _ripple(s: float, rng: np.random.Generator) -> Outside:
    pitch, phase = rng.uniform(1.1, 3.4), rng.uniform(0.0, 2.0 * np.pi)
    wave = lambda run: s * np.sin(2.0 * np.pi * run.alpha / pitch + phase)  # noqa: E731
    return Outside(settings=lambda run: replace(run, alpha=run.alpha + wave(run)))


def _pressure(s: float, rng: np.random.Generator) -> Outside:
    drawn = rng.integers(1 << 31)

    def settings(run):
        names = sorted(set(run.file.tolist()))
        wrong = np.random.default_rng(drawn).permutation(names)[: len(names) // 3]
        return replace(run, p=run.p * np.where(np.isin(run.file, wrong), 1.0 + s, 1.0))

    return Outside(settings=settings)


def _clipped(s: float, rng: np.random.Generator) -> Outside:
    sign, knee = rng.choice((-1.0, 1.0)), rng.uniform(600.0, 1200.0)
    return Outside(forces=lambda run, Fy, Mz: (Fy - s * sign * np.maximum(sign * Fy - knee, 0.0), Mz))


OUTSIDE: dict[str, Callable[[float, np.random.Generator], Outside]] = {
    "friction that falls with sliding": _sliding,
    "spring beside the moment cell": lambda s, _: Outside(forces=lambda r, Fy, Mz: (Fy, Mz - s * r.alpha)),
    "load cell turned in three axes": _turned,
    "edge of the belt, alpha^3": lambda s, _: Outside(forces=lambda r, Fy, Mz: (Fy - s * r.alpha**3, Mz)),
    "ripple of the sideslip drive": _ripple,
    "pressure wrong in a third of the runs": _pressure,
    "scale of the camber axis": lambda s, _: Outside(lambda run: replace(run, gamma=run.gamma * (1.0 + s))),
    "scale of the sideslip axis": lambda s, _: Outside(lambda run: replace(run, alpha=run.alpha * (1.0 + s))),
    "side force in the moment channel": lambda s, _: Outside(forces=lambda r, Fy, Mz: (Fy, Mz + s * Fy)),
    "compression of one sign of the force": _clipped,
}
"""Causes outside the library, each drawn with its size."""


@dataclass(frozen=True)
class Set:
    """One set of sweeps, and what is hidden in it; the model given is exact."""

    name: str
    tyre: Tyre
    run: Run
    numbers: Numbers
    outside: Outside | None
    part: tuple[str, ...]  #: ids that count as right

    def noise_free(self, run: Run) -> tuple[np.ndarray, np.ndarray]:
        return readings(self.tyre, run, self.numbers, self.outside)

    def gap(self) -> float:
        """Square root of the chi2 of what is hidden."""
        gap = np.concatenate(self.noise_free(self.run)) - np.concatenate(readings(self.tyre, self.run, {}))
        return float(np.sqrt(np.sum((gap / np.repeat((U_FY, U_MZ), len(self.run))) ** 2)))


def drawn_tyre(rng: np.random.Generator) -> Tyre:
    """A front or rear tyre whose force coefficients are some per cent off those of the sample."""
    tyre = tir.read(SAMPLES / str(rng.choice(("front-120-70", "rear-190-55"))) / "true.tir")
    names = [
        n
        for n, v in tyre.values.items()
        if len(n) < 6 and n[0] in "PQ" and n[2:3] in ("Y", "Z") and isinstance(v, float) and v and n != "PCY1"
    ]
    changes = {n: float(tyre[n]) * (1.0 + 0.08 * rng.normal()) for n in names}
    return tyre.replace(**changes, PECP1=float(rng.uniform(-0.25, 0.1)))


def detection_limit(numbers: int) -> float:
    """Chi2 of a gap that a test at 5 % detects with 95 % (ISO 11843), for so many free numbers."""
    level = chdtri(numbers, 0.05)
    return float(brentq(lambda c: chndtr(level, numbers, c) - 0.05, 1.0, 500.0))


def sized(goal: float, of_size: Callable[[float], Set], size: float = 1.0) -> Set:
    """The set whose gap has the wanted size."""
    for _ in range(8):
        size *= goal / of_size(size).gap()
    return of_size(size)


def library_set(cause: str, seed: int, low: float = 3.0, high: float = 10.0) -> tuple[Set, Any]:
    """A set with one effect of the library, ``low`` to ``high`` times its detection limit, and the generator of its noise."""
    rng = np.random.default_rng((seed, *cause.encode()))
    tyre = drawn_tyre(rng)
    run = programme(float(tyre["FNOMIN"]), float(tyre["NOMPRES"]) / 1e3, rng)
    number = LIBRARY[cause]
    if number.endswith("@"):
        files = sorted(set(run.file.tolist()))
        sizes = rng.normal(size=len(files))
        counts = np.array([np.sum(run.file == f) for f in files])
        sizes -= np.sum(counts * sizes) / np.sum(counts)  # the common part is another effect
        unit = {number + f: 0.01 * s for f, s in zip(files, sizes, strict=True)}
    else:
        unit = _unit(number, rng)
    times = float(np.exp(rng.uniform(np.log(low), np.log(high))))

    def of_size(size: float) -> Set:
        return Set(f"{cause}-{seed}", tyre, run, {n: size * v for n, v in unit.items()}, None, (cause,))

    return sized(times * np.sqrt(detection_limit(len(unit))), of_size), rng


def _unit(number: str, rng: np.random.Generator) -> dict[str, float]:
    return {number: float(rng.choice((-1.0, 1.0))) * UNIT.get(number, 0.01)}


def _plain(rng: np.random.Generator) -> float:
    """Size of a gap whose chi2 is between 150 and 15000."""
    return float(np.sqrt(np.exp(rng.uniform(np.log(150.0), np.log(15000.0)))))


def outside_set(cause: str, seed: int) -> tuple[Set, Any]:
    """A set with a cause outside the library."""
    rng = np.random.default_rng((seed, *cause.encode()))
    tyre = drawn_tyre(rng)
    run = programme(float(tyre["FNOMIN"]), float(tyre["NOMPRES"]) / 1e3, rng)
    goal = _plain(rng)
    sign, drawn = float(rng.choice((-1.0, 1.0))), int(rng.integers(1 << 31))

    def of_size(size: float) -> Set:
        made = OUTSIDE[cause](sign * size, np.random.default_rng(drawn))
        return Set(f"{cause}-{seed}", tyre, run, {}, made, made.part)

    return sized(goal, of_size, 1e-3), rng


def mixed_set(cause: str, other: str, seed: int) -> tuple[Set, Any]:
    """A set with an effect of the library and a cause outside it."""
    rng = np.random.default_rng((seed, *cause.encode(), *other.encode()))
    unknown, _ = outside_set(other, int(rng.integers(1 << 31)))
    unit = _unit(LIBRARY[cause], rng)

    def of_size(size: float) -> Set:
        numbers = {n: size * v for n, v in unit.items()}
        return replace(unknown, numbers=numbers, outside=None, part=(cause, *unknown.part))

    alone = sized(_plain(rng), of_size)
    return replace(alone, name=f"{cause} + {other}-{seed}", outside=unknown.outside), rng


def write(drawn: Set, rng: np.random.Generator, folder: Path) -> None:
    """``tyre.toml``, sweeps with noise and ``given.tir`` of a set."""
    drawn.tyre.write(folder / "given.tir")
    run, tyre, files = drawn.run, drawn.tyre, list(dict.fromkeys(drawn.run.file.tolist()))
    Fy, Mz = (
        x + rng.normal(0, u, len(run)) for x, u in zip(drawn.noise_free(run), (U_FY, U_MZ), strict=True)
    )
    columns = (run.alpha, run.gamma, run.Fz, run.p, run.V, run.backward, np.round(run.t, 3), run.T)
    for name in files:
        rows = run.file == name
        own = (column[rows] for column in columns)
        write_sweep(folder / f"{name}.csv", *own, Fy=Fy[rows], Mz=Mz[rows], u=(U_FY, U_MZ))
    Re = float(tyre.state(float(tyre["FNOMIN"]), Vx=6.0).Re)
    model = {"turn_slip": True, "u_coefficients": 0.0}
    write_project(folder, "set", tyre, files, path_radius=RADIUS, effective_radius=Re, **model)


def judge(drawn: Set, rng: np.random.Generator) -> Verdict:
    """The verdict on a diagnosis from files, as a user would make it."""
    with tempfile.TemporaryDirectory() as scratch:
        write(drawn, rng, Path(scratch))
        began = time.process_time()
        found = pipeline.diagnose(Path(scratch) / "tyre.toml", Path(scratch) / "given.tir")
        seconds = time.process_time() - began
    run, points = _between(drawn.run, found.points)
    truth = drawn.noise_free(run)

    def gap(model: Sequence[np.ndarray]) -> float:
        return rms(np.array([(t - m) / u for t, m, u in zip(truth, model, (U_FY, U_MZ), strict=True)]))

    given, file = (Simulation.of(t, turn_slip=True).readings(points) for t in (drawn.tyre, found.tyre))
    after = gap(np.split(found.state.predict(points), 2))
    if dict(found.tyre.values) != dict(drawn.tyre.values):
        after = max(after, gap((file.Fy, file.Mz)))
    return Verdict(
        name=drawn.name,
        causes=drawn.part,
        structure="",
        named=tuple(one.effect.id for one in found.effects),
        ties=tuple(tuple(one.tied_with) for one in found.effects),
        unexplained=found.unexplained,
        right_region=False,
        shrink=gap((given.Fy, given.Mz)) / max(after, 1e-6),
        seconds=seconds,
        confidence=tuple(one.confidence for one in found.effects),
    )


def _between(run: Run, points: Any) -> tuple[Run, Any]:
    """The settings moved by a quarter of a degree of sideslip and a tenth of the camber, in the order of the points."""
    names = [points.sweep_names[k].removesuffix(".csv") for k in dict.fromkeys(points.sweep.tolist())]
    order = np.concatenate([np.flatnonzero(run.file == name) for name in names])
    moved = Run(**{name: values[order] for name, values in vars(run).items()})
    moved = replace(moved, alpha=moved.alpha + 0.25 * (np.abs(moved.alpha) < 7.5), gamma=0.93 * moved.gamma)
    return moved, points.replace(alpha=np.radians(moved.alpha), gamma=np.radians(moved.gamma))
