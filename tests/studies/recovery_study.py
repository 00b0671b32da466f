"""Does a build find the truth, and do its intervals contain it? `python tests/studies/recovery_study.py 200 --jobs 2`.

Prints the three tables of docs/recovery.md (misfit, truth, coverage) for front and rear tyres, each with a base file up to 30 %
off, without a base file, and with a thin campaign.
"""

from __future__ import annotations

import argparse
import pickle
import sys
from collections.abc import Iterable, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import replace
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[1] / "mffit" / "fit"))

from drawn_rigs import SAFE, Draw, Kind, one_rig

from mffit.scatter import rms

CAMPAIGNS = {
    "base 30 % off": Kind(tyre_off=0.1),
    "no base": Kind(base="none", tyre_off=0.1),
    "thin campaign": Kind(thin=True, tyre_off=0.1),
    "pressures at one load": Kind(one_load=True, tyre_off=0.1),
    "upright": Kind(upright=True, tyre_off=0.1),
}
KINDS = {
    f"{sample.split('-')[0]}, {words}": replace(kind, sample=sample)
    for words, kind in CAMPAIGNS.items()
    for sample in ("front-120-70", "rear-190-55")
}
SMALLEST_SHARE_OF_BUILDS = 0.3
"""A coefficient fitted in a smaller share of the builds is left out of the table."""


def run(job: tuple[int, str, float]) -> tuple[str, Draw]:
    seed, kind, rig_off = job
    return kind, one_rig(seed, replace(KINDS[kind], rig_off=rig_off))


def tables(draws: dict[str, list[Draw]]) -> Iterable[str]:
    ended = [(kind, d) for kind, rows in draws.items() for d in rows if d.refused]
    draws = {kind: [d for d in rows if not d.refused] for kind, rows in draws.items()}
    everything = [d for rows in draws.values() for d in rows]
    yield f"Sound campaigns refused: {len(ended)}. Builds with a doubted sweep: {sum(d.doubted > 0 for d in everything)}.\n"
    for kind, d in ended:
        yield f"* {kind}: {d.refused}"
    yield "## Misfit over stated noise\n"
    yield "| campaign | builds | Fy median | largest | Mz median | largest | above 1.05 | above 1.3 | fit [s] |"
    yield "|---|---|---|---|---|---|---|---|---|"
    for kind, rows in draws.items():
        x = np.array([[d.misfit["Fy"], d.misfit["Mz"]] for d in rows])
        above = [int(np.sum(np.any(x > limit, axis=1))) for limit in (1.05, 1.3)]
        median, largest = np.median(x, axis=0), x.max(axis=0)
        yield (
            f"| {kind} | {len(rows)} | {median[0]:.2f} | {largest[0]:.2f} | {median[1]:.2f} | {largest[1]:.2f} "
            f"| {above[0]} | {above[1]} | {np.median([d.seconds for d in rows]):.2f} |"
        )
    yield "\n## Against the noise-free truth\n"
    names = list(dict.fromkeys(name for d in everything for name in d.error))
    yield "| campaign | " + " | ".join(f"{n} rms (largest)" for n in names) + " |"
    yield "|---" * (len(names) + 1) + "|"
    for kind, rows in draws.items():
        cells = [np.array([d.error.get(n, np.nan) for d in rows]) for n in names]
        texts = [f"{np.sqrt(np.mean(c**2)):.3g} ({np.max(np.abs(c)):.3g})" for c in cells]
        yield f"| {kind} | " + " | ".join(texts) + " |"
    yield from coverage(everything)
    yield "\n## Bands of curves\n"
    yield "| band | campaign | inside | rms error | rms half width over 1.96 | ratio |"
    yield "|---" * 6 + "|"
    for name in everything[0].bands:
        for campaign in CAMPAIGNS:
            bands = [d.bands[name] for kind, rows in draws.items() if kind.endswith(campaign) for d in rows]
            inside, half, error = (
                np.array([getattr(b, key) for b in bands]) for key in ("inside", "half", "error")
            )
            if bands:
                yield (
                    f"| {name} | {campaign} | {np.mean(inside):.0%} | {rms(error):.3g} | {rms(half) / SAFE:.3g} "
                    f"| {rms(half) / SAFE / rms(error):.2f} |"
                )


def coverage(draws: Sequence[Draw]) -> Iterable[str]:
    """Lines of the table of coverage; a number of few builds is left out."""
    yield "\n## Share of the truth inside 95 % intervals\n"
    yield "| quantity | builds | inside | rms error | rms standard error | ratio | mean pull | sd of pull |"
    yield "|---" * 8 + "|"
    for name in sorted(dict.fromkeys(n for d in draws for n in d.pulls), key=_order):
        rows = [d for d in draws if name in d.pulls]
        x, u = (np.array([getattr(d, key)[name] for d in rows]) for key in ("pulls", "stderr"))
        if len(x) >= SMALLEST_SHARE_OF_BUILDS * len(draws):
            inside = np.mean([d.inside[name] for d in rows])
            yield (
                f"| {name} | {len(x)} | {inside:.0%} | {rms(x * u):.3g} | {rms(u):.3g} | {rms(u) / rms(x * u):.2f} "
                f"| {np.mean(x):+.2f} | {np.std(x):.2f} |"
            )


def _order(name: str) -> tuple[bool, bool]:
    """Coefficients, then those that the priors decide, then the rig."""
    return name.startswith("rig."), "(" in name


def main() -> None:
    ask = argparse.ArgumentParser()
    ask.add_argument("builds", type=int, nargs="?", default=200)
    ask.add_argument("--jobs", type=int, default=1)
    ask.add_argument("--rig-off", type=float, default=1.0, help="rig errors over the declared ones")
    ask.add_argument("--campaigns", nargs="*", default=list(CAMPAIGNS))
    ask.add_argument("--first", type=int, default=0, help="first seed")
    ask.add_argument("--pickle", help="file for all draws")
    given = ask.parse_args()
    kinds = [name for name in KINDS if name.split(", ", 1)[1] in given.campaigns]
    seeds = range(given.first, given.first + given.builds)
    jobs = [(seed, kinds[seed % len(kinds)], given.rig_off) for seed in seeds]
    draws: dict[str, list[Draw]] = {kind: [] for kind in kinds}
    with ProcessPoolExecutor(given.jobs) as pool:
        for kind, draw in pool.map(run, jobs):
            draws[kind].append(draw)
    if given.pickle:
        Path(given.pickle).write_bytes(pickle.dumps(draws))
    print(f"{given.builds} builds\n")
    print("\n".join(tables({kind: rows for kind, rows in draws.items() if rows})))


if __name__ == "__main__":
    main()
