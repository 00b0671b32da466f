"""Does the fit find the temperature terms of a tyre that warms up during the test, and leave a tyre without them alone?

`python tests/studies/temperature_study.py 40 --jobs 2`

For every world it draws rigs and tyres, front and rear in turn, whose tread warms from 25 to 48 degC over the campaign, in the
order of its sweeps. It prints how often the temperature is modelled, how far its terms and the coefficients that warming
disturbs most (PPY4, PDY2) are from the truth, and what both files leave.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import worlds
from drawn_rigs import SAFE, front_or_rear, on_disk, plan_content, scaled

import mffit
import tir
from mffit.errors import InputError

COLD, WARM, SHARE = 25.0, 48.0, 0.4
"""First and last temperature [degC], and the share of the test in which 63 % of the difference is covered."""
PARTS = ("k_T_grip_per_K", "k_T_stiffness_per_K", "k_T_camber_per_K")
WORLDS = ("all forces", "grip and stiffness apart", "none")
DISTURBED = ("PPY4", "PDY2")


@dataclass(frozen=True)
class Warmed:
    """One build of a drawn campaign against the truth."""

    modelled: bool = False
    curved: bool = False  #: with a curvature of the friction
    of_runs: bool = False  #: with numbers of every run
    pulls: Mapping[str, float] = field(default_factory=dict)  #: (found - true) / standard error
    ratios: Mapping[str, float] = field(default_factory=dict)  #: found over true, of temperature terms
    over_noise: Mapping[str, float] = field(default_factory=dict)  #: misfit of Fy over its noise, by file
    trusted: bool = True
    seconds: float = 0.0
    refused: str = ""


def drawn_terms(world: str, rng: np.random.Generator) -> dict[str, float]:
    """Temperature terms of a tyre: those of all forces, or one each of friction and stiffnesses."""
    if world == "none":
        return {}
    size = rng.choice([-1.0, 1.0]) * rng.uniform(0.002, 0.005)
    if world == "all forces":
        return {"k_T_per_K": size}
    return {name: size * factor for name, factor in zip(PARTS, rng.uniform(0.4, 1.6, 3), strict=True)}


def one(job: tuple[int, str, Any]) -> Warmed:
    """Draw, simulate and build one rig."""
    seed, world, _ = job
    rng = np.random.default_rng(7000 + seed)
    sample, true = front_or_rear(seed, rng)
    content = plan_content(sample)
    terms = drawn_terms(world, rng)
    content["faults"] |= terms
    ends = COLD + (WARM - COLD) * (1.0 - np.exp(-np.linspace(0.0, 1.0 / SHARE, len(content["sweep"]) + 1)))
    for sweep, first, last in zip(content["sweep"], ends[:-1], ends[1:], strict=True):
        sweep["T_degC"] = [float(first), float(last)]
    with on_disk(true, content, seed, base=scaled(true, 0.3, rng)) as (path, _):
        try:
            result = mffit.build(path)
        except InputError as error:
            return Warmed(refused=str(error))
    return _compared(result, true, terms)


def _compared(result: Any, true: tir.Tyre, terms: Mapping[str, float]) -> Warmed:
    fit, found = result.fit, result.fit.temperature
    noise = float(np.sqrt(np.nanmean(result.points.u_Fy**2)))
    over = {"plain": fit.channels["Fy"].rmse / noise}
    pulls, ratios = {}, {}
    coefficients = fit.coefficients if found is None else found.coefficients
    for name in DISTURBED:
        row = coefficients[name]
        if row.stderr:
            pulls[name] = (row.value - true[name]) / row.stderr
            pulls[f"{name} of the plain file"] = (
                fit.coefficients[name].value - true[name]
            ) / fit.coefficients[name].stderr
    if found is not None:
        over["at temperature"] = found.channels["Fy"].rmse / noise
        for name, (value, u) in found.terms.items():
            at_cold = terms.get(name, terms.get("k_T_per_K", 0.0))
            k = at_cold / (1.0 + at_cold * (found.T_ref - COLD))  # relative to the reference of the build
            pulls[name] = (value - k) / u
            if k:
                ratios[name] = value / k
    curved = found is not None and "k_T_grip_per_K2" in found.terms
    return Warmed(
        found is not None, curved, fit.runs is not None, pulls, ratios, over, result.trusted, fit.seconds
    )


def table(world: str, rows: list[Warmed]) -> list[str]:
    """Lines of one world."""
    sound = [row for row in rows if not row.refused]
    modelled = sum(row.modelled for row in sound)
    out = [
        f"\n## {world}: {len(rows)} rigs, {len(rows) - len(sound)} refused, temperature modelled in {modelled}, "
        f"its curvature in {sum(row.curved for row in sound)}, runs in {sum(row.of_runs for row in sound)}, "
        f"trusted {sum(row.trusted for row in sound)}, median fit {np.median([row.seconds for row in sound]):.1f} s\n"
    ]
    for name in ("plain", "at temperature"):
        over = [row.over_noise[name] for row in sound if name in row.over_noise]
        if over:
            out.append(
                f"* Fy over noise, file {name}: median {np.median(over):.2f}, largest {np.max(over):.2f}"
            )
    for name in dict.fromkeys(name for row in sound for name in row.pulls):
        pulls = np.array([row.pulls[name] for row in sound if name in row.pulls])
        ratios = np.array([row.ratios[name] for row in sound if name in row.ratios])
        near = f", within 20 %: {np.mean(np.abs(ratios - 1.0) < 0.2):.0%}" if len(ratios) else ""
        out.append(
            f"* {name}: sd of pull {np.sqrt(np.mean(pulls**2)):.2f}, inside 95 % {np.mean(np.abs(pulls) < SAFE):.0%}, "
            f"within 3 stderr {np.mean(np.abs(pulls) < 3.0):.0%}{near} ({len(pulls)})"
        )
    return out + [f"* {row.refused}" for row in rows if row.refused]


if __name__ == "__main__":
    worlds.run(one, table, worlds.asked(40, WORLDS))
