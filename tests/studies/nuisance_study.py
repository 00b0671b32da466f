"""How often is a temperature found that the points just show, and one that is not there?

`python tests/studies/nuisance_study.py 200 --jobs 2`

Every campaign is small: 10 to 32 sweeps of a drawn tyre that warms by 28 K, in the plan's order or in any. The fit without
influences is made once, and the choice of influences is called with it; no whole build. The sizes of the terms are standard
uncertainties of a joint fit with them to readings without any effect. Both terms have this size; their signs are drawn.
"""

from __future__ import annotations

import sys
import tempfile
from collections import Counter
from pathlib import Path
from typing import Any

import numpy as np
import worlds
from drawn_rigs import scaled  # worlds makes it importable

sys.path.insert(0, str(Path(__file__).parents[1] / "mffit"))
import small_rigs

import mffit
from mffit.fit.fitted import Fitted
from mffit.fit.influences import with_nuisances
from mffit.fit.influences.nuisance_choice import choose
from mffit.least_squares import inverse

WORLDS = ("none", "runs differ by 1 %", "3 u", "4 u", "5 u")
TERMS = ("k_T_grip_per_K", "k_T_stiffness_per_K")
COLD, WARMING, SHARE = 25.0, 28.0, 0.4
"""First temperature [degC], its change, and the share of the test in which 63 % of it is covered."""
PLANS = (((250,), 2, 4), ((250, 200), 1, 2), ((250, 200, 300), 1, 1))
"""Pressures [kPa], and how often a plan is run."""


class _Fitted(Exception):
    """Ends a build before its choice of influences."""


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
    shape = 1.0 - np.exp(-np.linspace(0.0, 1.0 / SHARE, len(sweeps) + 1))
    ends = (COLD + WARMING * shape / shape[-1]).tolist()
    for sweep, first, last in zip(sweeps, ends[:-1], ends[1:], strict=True):
        sweep["T_degC"] = [first, last]
    return content | {"sweep": sweeps}


def fitted(seed: int, terms: dict[str, float], scatter: float = 0.0) -> tuple[Any, Fitted]:
    """The configuration of a drawn campaign, and its fit without influences."""
    rng = np.random.default_rng(500 + seed)
    content = plan(seed, rng) | {"faults": terms}
    true = scaled(small_rigs.truth(), 0.1, rng)
    for sweep in content["sweep"] if scatter else ():
        drawn = (scatter * rng.standard_normal(2)).tolist()
        sweep["faults"] = dict(zip(("run_grip", "run_stiffness"), drawn, strict=True))

    def stop(*found: Any) -> None:
        raise _Fitted(*found)

    with tempfile.TemporaryDirectory() as made:
        folder = Path(made)
        true.write(folder / "drawn.tir")
        content["truth"] = {"tyre": str(folder / "drawn.tir")}
        small_rigs.simulated(content, folder / "rig", seed + 1)
        usual = with_nuisances.choose
        with_nuisances.choose = stop  # type: ignore[assignment]
        try:
            mffit.build(folder / "rig" / "tyre.toml", with_report=False)
        except _Fitted as found:
            return found.args  # type: ignore[return-value]
        finally:
            with_nuisances.choose = usual
    raise RuntimeError("the build ended without a choice of influences")


def standard_errors(first: Fitted) -> np.ndarray:
    """Of the two terms, fitted together with all numbers of the fit."""
    problem = first.problem
    problem = problem.with_values({"T_ref_degC": round(float(np.nanmean(problem.points.T)), 1)})
    names = [*(number.name for number in first.numbers), *TERMS]
    slope = problem.free(names).linear(np.array([problem.value(name) for name in names])).slope
    priors = np.diag([*(number.spread**-2.0 for number in first.numbers), 0.0, 0.0])
    return np.sqrt(np.diag(inverse(slope.T @ slope + priors))[-2:])


def one(job: tuple[int, str, Any]) -> tuple[str, ...]:
    """The influences that are chosen in a campaign of a world."""
    seed, world, _ = job
    if world.endswith("u"):
        signs = np.random.default_rng(77 + seed).choice([-1.0, 1.0], 2)
        sizes = float(world[:-1]) * standard_errors(fitted(seed, {})[1]) * signs
        found = fitted(seed, dict(zip(TERMS, sizes.tolist(), strict=True)))
    else:
        found = fitted(seed, {}, scatter=0.0 if world == "none" else 0.01)
    return tuple(nuisance.id for nuisance in choose(*found).modelled)


def table(world: str, rows: list[tuple[str, ...]]) -> list[str]:
    """Lines of one world."""
    found = sum("temperature" in row for row in rows)
    every = ", ".join(f"{' + '.join(row) or 'nothing'} {count}" for row, count in Counter(rows).most_common())
    return [f"{world}: temperature in {found} of {len(rows)} ({every})"]


if __name__ == "__main__":
    worlds.run(one, table, worlds.asked(200, WORLDS))
