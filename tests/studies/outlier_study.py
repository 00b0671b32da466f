"""Are true readings left out, and wrong ones found? `nice python tests/studies/outlier_study.py 40`.

Brush tyres and tyres of the formula on a disc, as foreign_study draws them, with sweeps of uneven steps, up to a third of the
range. Every reading is true but for its noise, except three of every campaign, drawn inside the sweeps, that are 8 noises off.
Printed: true readings without weight, and wrong readings found.
"""

from __future__ import annotations

import tempfile
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import foreign_study
import harness
import numpy as np
import pandas as pd
from disc_project import Project
from foreign_study import NOISE, RADIUS, Bent, project, read

from mffit.points import make_points
from mffit.rig import Simulation
from mffit.suspicion import Outlier

WRONG, BY = 3, 8.0
"""Wrong readings of a campaign, and their errors in noises."""
U = {"Fy": ("Fy_N", NOISE[0]), "Mz": ("Mz_Nm", NOISE[1])}


class Formula(Bent):
    """A tyre of the formula, without the term that it lacks."""

    def forces(self, alpha, gamma, Fz, phi_t: float = 0.0, direction: float = 1.0):
        points = make_points(alpha, gamma, Fz, p=250e3, V=6.0, phi_t=phi_t, direction=direction)
        found = Simulation.of(self.tyre, turn_slip=self.turns).readings(points)
        return found["Fy"], found["Mz"]


def uneven(largest: float, rng: np.random.Generator) -> np.ndarray:
    """Angles (n,) [deg] to both sides, with steps that differ by up to ten times."""
    ends = np.cumsum(np.exp(rng.uniform(0.0, np.log(10.0), rng.integers(5, 9))))
    one_side = largest * ends / ends[-1]
    return np.round(np.concatenate([-one_side[::-1], [0.0], one_side]), 1)


def programme(load: float, rng: np.random.Generator) -> dict[str, tuple[Any, ...]]:
    """Sideslip [deg], camber [deg], load [N] and direction of every sweep."""
    rows: dict[str, tuple[Any, ...]] = {}
    for Fz in (share * load for share in (0.6, 1.0, 1.5)):
        rows[f"sideslip_{Fz:.0f}"] = (uneven(8.0, rng), 0.0, Fz, 1.0)
        rows[f"camber_{Fz:.0f}"] = (0.0, uneven(45.0, rng), Fz, 1.0)
        for way, sign in (("forward", 1.0), ("backward", -1.0)):
            rows[f"align_{Fz:.0f}_{way}"] = (np.linspace(-1.0, 1.0, 5), 0.0, Fz, sign)
    for gamma, Fz in ((15, load), (35, load), (20, 1.5 * load)):
        angles = uneven(7.0, rng)
        lean = np.repeat([-1.0 * gamma, 1.0 * gamma], len(angles))
        rows[f"coupled_{Fz:.0f}_{gamma}"] = (np.tile(angles, 2), lean, Fz, 1.0)
    return {n: (*np.broadcast_arrays(a, g), Fz, way) for n, (a, g, Fz, way) in rows.items()}


def spoil(tables: dict[str, pd.DataFrame], rng: np.random.Generator) -> set[tuple[str, int, str]]:
    """Make some readings wrong; returns file, line and channel of each."""
    names = [name for name in tables if not name.startswith("align")]
    wrong = set()
    while len(wrong) < WRONG:
        name, channel = str(rng.choice(names)), str(rng.choice([*U]))
        row = int(rng.integers(2, len(tables[name]) - 2))
        if (name, row + 2, channel) not in wrong:
            column, u = U[channel]
            tables[name].loc[row, column] += BY * u * rng.choice([-1.0, 1.0])
            wrong.add((name, row + 2, channel))
    return wrong


@dataclass
class Rejected:
    """A campaign's readings without weight."""

    refused: str = ""
    readings: int = 0
    true: list[Outlier] = field(default_factory=list)
    found: int = 0  #: of the wrong ones


def one(job: harness.Job) -> Rejected:
    """Draw, spoil and build one campaign."""
    rng = np.random.default_rng(9000 + job.seed)
    tyre, load = foreign_study.drawn("brush" if job.world == "brush" else "term on a disc", rng)
    if job.world != "brush":
        tyre = Formula(tyre.tyre, tyre.turns, tyre.r_e)
    rig = {"F0": 10.0 * rng.normal(), "gamma_0": 0.5 * rng.normal(), "alpha_0": 0.05 * rng.normal()}
    rig |= {"R": RADIUS + 0.0018 * rng.normal(), "r_e": tyre.r_e + 0.0005 * rng.normal()}
    plan = programme(load, rng)
    files = {f"{name}.csv": read(tyre, rows, rig, True, rng) for name, rows in plan.items()}
    wrong = spoil(files, rng)
    with tempfile.TemporaryDirectory() as made:
        result = harness.built(Project(Path(made), project(tyre, load, rig, True, files), files).write())
    if isinstance(result, str):
        return Rejected(refused=result)
    places = {(Path(o.file).name, o.line, o.channel): o for o in result.fit.outliers}
    true = [o for place, o in places.items() if place not in wrong]
    return Rejected(readings=2 * sum(map(len, files.values())), true=true, found=len(wrong & places.keys()))


def page(world: str, rows: list[Rejected]) -> Iterator[str]:
    built = [row for row in rows if not row.refused]
    true = [o for row in built for o in row.true]
    yield f"\n## {world}: {len(rows)} campaigns, {len(rows) - len(built)} refused"
    of, hit = sum(row.readings for row in built), sum(bool(row.true) for row in built)
    yield f"true readings without weight: {len(true)} of {of}, in {hit} campaigns"
    yield f"wrong readings found: {sum(row.found for row in built)} of {WRONG * len(built)}"
    yield from (
        f"* {o.place} {o.channel} {o.measured:.5g} for {o.expected:.5g}, {o.ratio:.0f} noises" for o in true
    )


if __name__ == "__main__":
    harness.study(one, page, worlds=["brush", "formula"], draws=40)
