"""Do the intervals of peaks hold, wherever the tested slip ends? `nice python tests/studies/peak_study.py 60`.

Draws tyres that follow a plain Magic Formula or a brush whose friction falls with slip, runs them over sideslip, and braked over
slip, up to 0.3 to 2.4 times the slip of the peak, builds, and prints for each number how often its 95 % interval holds: of the
true largest force over the tested slip, and of the true peak, where an interval that is "at least" is open to the high side.
Nothing but the build is code of ``mffit``.
"""

from __future__ import annotations

import tempfile
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import Any, NamedTuple

import harness
import numpy as np

import mffit
from mffit.comparison.characteristics import characteristics
from mffit.rounding import AtLeast

LOADS = (0.5, 1.0, 1.5)
"""Over the nominal one."""
GAIN = 0.005
"""Spread of the calibration of each force, of the moment and of the load: the default of [rig]."""
ENDS = (0.35, 0.5, 0.7, 0.9, 1.1, 1.4, 2.0)
"""Ends of the tested slip over the slip of the peak, each 10 % off to 20 % up."""
WHOLE = np.linspace(0.0, 1.2, 24001)
"""Slip over which the true peak is looked for."""

Force = Callable[[np.ndarray, float], np.ndarray]


class Tyre(NamedTuple):
    """Magnitudes over slip (n,) at a share of the nominal load; even in slip."""

    Fy: Force
    Mz: Force
    Fx: Force


def formula(rng: np.random.Generator, nominal: float) -> Tyre:
    """D sin(C atan(B s - E (B s - atan(B s)))), friction and stiffness linear in load."""

    def curve(stiffness: float, lower: float, upper: float) -> Force:
        D, fall, C = rng.uniform(0.8, 1.8), rng.uniform(-0.15, 0.0), rng.uniform(1.2, 1.7)
        E, K, less = rng.uniform(lower, upper), stiffness * rng.uniform(0.7, 1.4), rng.uniform(-0.3, 0.1)

        def force(s: np.ndarray, share: float) -> np.ndarray:
            peak = D * (1.0 + fall * (share - 1.0)) * share * nominal
            x = K * (1.0 + less * (share - 1.0)) * share * nominal / (C * peak) * s
            return peak * np.sin(C * np.arctan(x - E * (x - np.arctan(x))))

        return force

    side, drive = curve(15.0, -1.0, 0.5), curve(22.0, -0.5, 0.6)
    C, B, trail = rng.uniform(1.0, 1.3), rng.uniform(6.0, 11.0), rng.uniform(0.02, 0.05)

    def moment(s: np.ndarray, share: float) -> np.ndarray:
        return np.sqrt(share) * trail * np.cos(C * np.arctan(B * s)) * side(s, share)

    return Tyre(side, moment, drive)


def brush(rng: np.random.Generator, nominal: float) -> Tyre:
    """Parabolic pressure over a contact that grows with the root of the load; friction mu0 (1 - falling * slip)."""
    mu0, falling, half = rng.uniform(0.8, 1.8), rng.uniform(0.1, 0.9), rng.uniform(0.04, 0.09)
    K_y, K_x = 15.0 * rng.uniform(0.7, 1.4), 22.0 * rng.uniform(0.7, 1.4)

    def parts(s: np.ndarray, share: float, K: float) -> tuple[np.ndarray, np.ndarray]:
        """Friction force, and the share of the contact that slides."""
        limit = mu0 * (1.0 - falling * s) * (1.1 - 0.1 * share) * share * nominal
        return limit, np.minimum(K * share**-0.2 * s / (3.0 * mu0), 1.0)

    def force(s: np.ndarray, share: float, K: float) -> np.ndarray:
        limit, sliding = parts(s, share, K)
        return limit * (1.0 - (1.0 - sliding) ** 3)

    def moment(s: np.ndarray, share: float) -> np.ndarray:
        limit, sliding = parts(s, share, K_y)
        return limit * half * np.sqrt(share) * sliding * (1.0 - sliding) ** 3

    return Tyre(lambda s, share: force(s, share, K_y), moment, lambda s, share: force(s, share, K_x))


WORLDS = {"formula": formula, "brush": brush}
CHANNELS = {"mu_y": "Fy", "Mz_peak_Nm": "Mz", "mu_x": "Fx"}


class Number(NamedTuple):
    """One number of one draw."""

    name: str
    open: bool  #: at least reached
    value: float
    u: float
    reached: float  #: true largest force over the tested slip
    peak: float  #: true peak

    @property
    def holds(self) -> tuple[bool, bool]:
        """Whether the interval holds what was reached, and the peak."""
        below = self.value - self.peak <= (1.645 if self.open else 1.96) * self.u
        above = self.open or self.peak - self.value <= 1.96 * self.u
        return abs(self.value - self.reached) <= 1.96 * self.u, below and above


def one(job: harness.Job) -> list[Number]:
    """The numbers of a drawn campaign."""
    rng = np.random.default_rng((job.seed, len(job.world)))
    nominal = float(rng.choice([700.0, 1500.0, 4000.0]))
    tyre = WORLDS[job.world](rng, nominal)
    at_peak = {name: WHOLE[np.argmax(getattr(tyre, name)(WHOLE, 1.0))] for name in ("Fy", "Fx")}
    ends = {
        name: min(x * rng.choice(ENDS) * rng.uniform(0.9, 1.2), 0.5 if name == "Fx" else 0.4)
        for name, x in at_peak.items()
    }
    with tempfile.TemporaryDirectory() as folder:
        found = built(Path(folder), tyre, nominal, ends, rng)
    rows = []
    for key, name in CHANNELS.items():
        force = getattr(tyre, name)(WHOLE, 1.0) / (1.0 if name == "Mz" else nominal)
        tested = ends["Fx" if name == "Fx" else "Fy"] * (1.0 + 1e-9)
        reached = force[: np.searchsorted(WHOLE, tested, side="right")].max()
        q = found[key]
        rows.append(Number(key, isinstance(q, AtLeast), q.value, q.u, reached, force.max()))
    return rows


def built(
    folder: Path, tyre: Tyre, nominal: float, ends: Mapping[str, float], rng: np.random.Generator
) -> Mapping[str, Any]:
    """The characteristics of a build of the tyre, run up to slips ``ends``."""
    (*gains, of_load), sweeps = rng.normal(1.0, GAIN, 4), []
    alpha, kappa = np.linspace(-1.0, 1.0, 33) * np.arctan(ends["Fy"]), np.linspace(-1.0, 0.0, 25) * ends["Fx"]
    for share in LOADS:
        for kind, angle, slip in (("side", alpha, 0.0 * alpha), ("brake", 0.0 * kappa, kappa)):
            s, side = np.tan(np.abs(angle)), np.sign(angle)
            Fx = np.sign(slip) * tyre.Fx(np.abs(slip), share)
            forces = (Fx, -side * tyre.Fy(s, share), side * tyre.Mz(s, share))
            noise = 0.004 * nominal * np.sqrt(share) * np.array([1.0, 1.0, 0.03])
            read = [g * x + rng.normal(0.0, u, len(x)) for g, x, u in zip(gains, forces, noise, strict=True)]
            load = np.full(len(angle), share * nominal / of_load)
            table = np.column_stack([np.degrees(angle), 0.0 * angle, slip, load, *read])
            file, head = f"{kind}_{share}.csv", "alpha_deg,gamma_deg,kappa,Fz_N,Fx_N,Fy_N,Mz_Nm"
            np.savetxt(folder / file, table, fmt="%.6g", delimiter=",", header=head, comments="")
            sweeps.append(f'[[sweep]]\nfile = "{file}"\n')
    (folder / "tyre.toml").write_text(
        f'[tyre]\nname = "drawn"\nunloaded_radius = 0.3\nnominal_load = {nominal}\nnominal_pressure = 200\n'
        f'nominal_speed = 15\n[rig]\ntype = "flat-track"\naxes = "iso"\n{"".join(sweeps)}'
    )
    result = mffit.build(folder / "tyre.toml", with_report=False)
    known, predictor = result.fit.posterior, result.prediction
    tyre_file = result.tyres[result.fitted]
    return characteristics(tyre_file, nominal, turn_slip=False, known=known, predictor=predictor)


def page(world: str, rows: list[list[Number]]) -> Iterator[str]:
    every = [one for row in rows for one in row]
    groups = {
        f"{name}, {word}": [one for one in every if (one.name, one.open) == (name, word == "at least")]
        for name in CHANNELS
        for word in ("peak", "at least")
    }
    columns = {
        "tested slip": lambda of: harness.percent([one.holds[0] for one in of]),
        "peak": lambda of: harness.percent([one.holds[1] for one in of]),
        "u": lambda of: f"{np.median([one.u / one.value for one in of]):.1%}",
    }
    yield from harness.by_group(groups, columns, f"{world}, {len(rows)} draws", "number")


if __name__ == "__main__":
    harness.study(one, page, worlds=WORLDS, draws=60)
