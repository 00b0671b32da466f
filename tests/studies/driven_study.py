"""What does a build say of a driven and braked tyre that is no Magic Formula? `nice python tests/studies/driven_study.py 20`.

Brush tyres on a belt, whose bristles are stiffer along the wheel than across, on a carcass that yields sideways, on rigs whose
errors are drawn from what `tyre.toml` declares, with runs that differ. Sideslip under combined slip is run to both sides or to
one. True mean forces are asked for between the tested conditions and beyond them: at half of the lowest and 1.3 times the largest
load, at more sideslip, at more slip. Printed: shares of them inside the 95 % interval of the best estimate and of readings of new
runs inside that of the file, rms errors, and half widths over errors.
"""

from __future__ import annotations

import tempfile
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import foreign_study
import harness
import numpy as np
import pandas as pd
from brush import Brush
from disc_project import Project
from drawn_rigs import Draw
from foreign_study import RUN_OFFSET, RUN_SCALE
from harness import shares

import mffit
from mffit.scatter import rms

NOISE = {"Fx_N": 8.0, "Fy_N": 6.0, "Mz_Nm": 0.5}
SHARES, CAMBERS = (0.6, 1.0, 1.5), (0.0, -4.0, 4.0)
SLIP = np.round(np.linspace(-0.15, 0.15, 21), 4)
ANGLES = np.array([-8, -6, -4, -3, -2, -1, 0, 1, 2, 3, 4, 6, 8], dtype=float)
SIDES = {"both sides": (0.0, -2.0, 2.0, -5.0, 5.0), "one side": (0.0, 2.5, 5.0)}
ASKED = 150
"""Drawn conditions of each range."""
Rows = Mapping[str, np.ndarray]


def drawn(rng: np.random.Generator) -> Brush:
    tyre, _ = foreign_study.drawn("brush", rng)
    return tyre._replace(drive=rng.uniform(1.0, 1.6), carcass=rng.uniform(1.2e5, 3e5))


def programme(world: str, load: float) -> dict[str, Rows]:
    """Settings of every sweep: sideslip at all cambers, slip at all sideslips and, upright or leaned, at all loads."""
    rows = {}
    for Fz in (share * load for share in SHARES):
        for lean in CAMBERS:
            rows[f"sideslip_{Fz:.0f}_{lean:g}"] = setting(ANGLES, lean, Fz)
            for alpha in SIDES[world] if lean >= 0.0 else ():
                rows[f"slip_{Fz:.0f}_{lean:g}_{alpha:g}"] = setting(alpha, lean, Fz, SLIP)
    return rows


def setting(alpha: Any, gamma: Any, Fz: Any, kappa: Any = 0.0) -> Rows:
    names = ("alpha_deg", "gamma_deg", "Fz_N", "kappa")
    return dict(zip(names, np.broadcast_arrays(alpha, gamma, Fz, kappa), strict=True))


def ranges(world: str, load: float, rng: np.random.Generator) -> dict[str, Rows]:
    """Conditions (n,) between and beyond the tested ones; sideslip to the side that was run."""
    n, one = ASKED, world == "one side"
    low, high = load * SHARES[0], load * SHARES[-1]
    side = 1.0 if one else rng.choice([-1.0, 1.0], n)
    alpha, lean = side * rng.uniform(0.0, 5.0, n), rng.uniform(0.0, 4.0, n)
    Fz, slip = rng.uniform(low, high, n), rng.uniform(-0.15, 0.15, n)
    more = rng.choice([-1.0, 1.0], n) * rng.uniform(0.15, 0.25, n)
    return {
        "between": setting(alpha, lean, Fz, slip),
        "between, sideslip alone": setting(rng.uniform(-8.0, 8.0, n), lean, Fz),
        "half of the lowest load": setting(alpha, lean, 0.5 * low, slip),
        "1.3 times the largest load": setting(alpha, lean, 1.3 * high, slip),
        "sideslip of 5 to 8 deg": setting(side * rng.uniform(5.0, 8.0, n), lean, Fz, slip),
        "slip of 0.15 to 0.25": setting(alpha, lean, Fz, more),
    }


def forces(tyre: Brush, rows: Rows, rig: Mapping[str, float]) -> dict[str, np.ndarray]:
    alpha, gamma = (np.radians(rows[f"{n}_deg"] + rig.get(f"{n}_0", 0.0)) for n in ("alpha", "gamma"))
    return dict(zip(NOISE, tyre.driven(alpha, gamma, rows["Fz_N"], rows["kappa"]), strict=True))


def read(tyre: Brush, rows: Rows, rig: Mapping[str, float], rng: np.random.Generator) -> pd.DataFrame:
    """The readings of a run, which differs from others."""
    out = {**rows, "p_kPa": 250.0, "V_mps": 10.0}
    for name, true in forces(tyre, rows, rig).items():
        own = RUN_OFFSET * rng.normal() if name != "Mz_Nm" else 0.0
        scale = 1.0 + RUN_SCALE * rng.normal()
        out[name] = scale * true + own + rig.get(name, 0.0) + NOISE[name] * rng.normal(size=len(true))
        out[f"u_{name}"] = NOISE[name]
    return pd.DataFrame(out)


@dataclass
class Driven(Draw):
    """A draw: by range and channel, share inside, rms half width and rms error."""

    trusted: bool = False
    reasons: list[str] = field(default_factory=list)
    predicted: dict[str, tuple[float, float, float]] = field(default_factory=dict)

    def line(self) -> str:
        return self.refused or "; ".join(
            f"{k} {v[0]:.2f} {v[1]:.0f} {v[2]:.0f}" for k, v in self.predicted.items()
        )


def one(job: harness.Job) -> Driven:
    """Draw, build and predict one campaign."""
    rng = np.random.default_rng(11_000 + job.seed)
    tyre = drawn(rng)
    rig = {"Fy_N": 10.0 * rng.normal(), "Fx_N": 10.0 * rng.normal(), "gamma_0": 0.3 * rng.normal()}
    rig["alpha_0"] = 0.05 * rng.normal()
    tables = {name: read(tyre, rows, rig, rng) for name, rows in programme(job.world, tyre.nominal).items()}
    files = {f"{name}.csv": table for name, table in tables.items()}
    with tempfile.TemporaryDirectory() as made:
        folder, content = Path(made), foreign_study.project(tyre, tyre.nominal, rig, False, files)
        result = harness.built(Project(folder, content, files).write(), out=folder / "out")
        if isinstance(result, str):
            return Driven(refused=result)
        out = Driven(trusted=result.trusted, reasons=list(result.trust.reasons))
        for word, rows in ranges(job.world, tyre.nominal, rng).items():
            asked = pd.DataFrame({**rows, "p_kPa": 250.0, "V_mps": 10.0})
            found, truth = mffit.predict(folder / "out", asked), forces(tyre, rows, {})
            new = read(tyre, rows, rig, rng)
            for name, true in truth.items():
                best = found[name.replace("_", "_best_")]
                out.predicted[f"{word}: {name} best"] = shares(
                    true - best, found["u_" + name.replace("_", "_best_")]
                )
                out.predicted[f"{word}: {name} file"] = shares(new[name] - found[name], found[f"u_{name}"])
        return out


def page(world: str, rows: list[Driven]) -> Iterator[str]:
    draws, refused = harness.sound(rows)
    yield f"\n## {world}: {len(rows)} builds, {len(refused)} refused, {sum(d.trusted for d in draws)} trusted"
    yield from [f"* {text[:200]}" for d in draws for text in d.reasons][:4]
    head = ("range, channel, estimate", "inside, mean", "least", "error", "half width over error")
    columns = {key: np.array([d.predicted[key] for d in draws]).T for key in draws[0].predicted}
    yield from harness.table(
        head,
        (
            (
                key,
                f"{inside.mean():.1%}",
                f"{inside.min():.0%}",
                f"{rms(error):.3g}",
                f"{rms(half) / rms(error):.2f}",
            )
            for key, (inside, half, error) in columns.items()
        ),
    )


if __name__ == "__main__":
    harness.study(one, page, worlds=SIDES, draws=20)
