"""How often is a temperature found that the points just show, and one that is not there?

`python tests/studies/nuisance_study.py 200 --jobs 2`

Every campaign is small: 10 to 32 sweeps of a drawn tyre that warms by 28 K, in the plan's order or in any. The sizes of the
terms are standard uncertainties of a joint fit with them to readings without any effect. Both terms have this size; their signs
are drawn.
"""

from __future__ import annotations

import tempfile
from collections import Counter
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import harness
import numpy as np
import small_rigs
from drawn_rigs import scaled
from rigs_study import RUN_NUMBERS, SHARE, TERMS, warm

import mffit
from mffit.fit.fitted import Fitted
from mffit.least_squares import inverse

WORLDS = ("none", "runs differ by 1 %", "3 u", "4 u", "5 u")
WARMING = 28.0 / (1.0 - np.exp(-1.0 / SHARE))  # K, of which 28 are reached
PLANS = (((250,), 2, 4), ((250, 200), 1, 2), ((250, 200, 300), 1, 1))
"""Pressures [kPa], and how often a plan is run."""


def plan(seed: int, rng: np.random.Generator) -> dict[str, Any]:
    """Sweeps in an order, each with its temperatures."""
    content = small_rigs.flat()
    pressures, *repeats = PLANS[seed % len(PLANS)]
    sweeps = [
        {**sweep, "file": f"{again}_{pressure}_{sweep['file']}", "p_kPa": pressure}
        for again in range(repeats[seed % 2])
        for pressure in pressures
        for sweep in content["sweep"]
        if "forward" not in sweep["file"] and (pressure == 250 or "sideslip" in sweep["file"])
    ]
    if rng.random() < 0.5:
        sweeps = [sweeps[k] for k in rng.permutation(len(sweeps))]
    warm(sweeps, WARMING)
    return content | {"sweep": sweeps}


def fitted(seed: int, terms: dict[str, float], scatter: float = 0.0) -> Any:
    """The fit of a drawn campaign."""
    rng = np.random.default_rng(500 + seed)
    content = plan(seed, rng) | {"faults": terms}
    true = scaled(small_rigs.truth(), 0.1, rng)
    for sweep in content["sweep"] if scatter else ():
        sweep["faults"] = dict(zip(RUN_NUMBERS, (scatter * rng.standard_normal(2)).tolist(), strict=True))
    with tempfile.TemporaryDirectory() as made:
        true.write(Path(made) / "drawn.tir")
        content["truth"] = {"tyre": f"{made}/drawn.tir"}
        small_rigs.simulated(content, Path(made) / "rig", seed + 1)
        return mffit.build(Path(made) / "rig" / "tyre.toml", with_report=False).fit


def standard_errors(first: Fitted) -> np.ndarray:
    """Of the two terms, fitted together with all numbers of the fit."""
    problem = first.problem
    problem = problem.with_values({"T_ref_degC": round(float(np.nanmean(problem.points.T)), 1)})
    names = [*(number.name for number in first.numbers), *TERMS[:2]]
    slope = problem.free(names).linear(np.array([problem.value(name) for name in names])).slope
    priors = np.diag([*(number.spread**-2.0 for number in first.numbers), 0.0, 0.0])
    return np.sqrt(np.diag(inverse(slope.T @ slope + priors))[-2:])


def one(job: harness.Job) -> tuple[str, ...]:
    """The influences that are chosen in a campaign of a world."""
    if job.world.endswith("u"):
        signs = np.random.default_rng(77 + job.seed).choice([-1.0, 1.0], 2)
        sizes = float(job.world[:-1]) * standard_errors(fitted(job.seed, {}).search) * signs
        found = fitted(job.seed, dict(zip(TERMS, sizes.tolist(), strict=False)))
    else:
        found = fitted(job.seed, {}, scatter=0.0 if job.world == "none" else 0.01)
    return tuple(nuisance.id for nuisance in found.choice.modelled)


def page(world: str, rows: list[tuple[str, ...]]) -> Iterator[str]:
    found = sum("temperature" in row for row in rows)
    every = ", ".join(f"{' + '.join(row) or 'nothing'} {count}" for row, count in Counter(rows).most_common())
    yield f"{world}: temperature in {found} of {len(rows)} ({every})"


if __name__ == "__main__":
    harness.study(one, page, worlds=WORLDS, draws=200)
