"""Does a build find the truth, and do its intervals contain it? `python tests/studies/recovery_study.py 200 --jobs 2`.

Prints the three tables of docs/recovery.md (misfit, truth, coverage) for front and rear tyres, each with a base file up to 30 %
off, without a base file, and with a thin campaign.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Iterable
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[1] / "mffit" / "fit"))

from drawn_rigs import Draw, Kind, one_rig

KINDS = {
    f"{sample.split('-')[0]}, {words}": Kind(sample, base, thin, tyre_off=0.1)
    for words, base, thin in (
        ("base 30 % off", "another's", False),
        ("no base", "none", False),
        ("thin campaign", "another's", True),
    )
    for sample in ("front-120-70", "rear-190-55")
}
SMALLEST_SHARE_OF_BUILDS = 0.3
"""A coefficient fitted in a smaller share of the builds is left out of the table."""


def run(job: tuple[int, str]) -> tuple[str, Draw]:
    seed, kind = job
    return kind, one_rig(seed, KINDS[kind])


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
    names = list(everything[0].error)
    yield "| campaign | " + " | ".join(f"{n} rms (largest)" for n in names) + " |"
    yield "|---" * (len(names) + 1) + "|"
    for kind, rows in draws.items():
        cells = [np.array([d.error[n] for d in rows]) for n in names]
        texts = [f"{np.sqrt(np.mean(c**2)):.3g} ({np.max(np.abs(c)):.3g})" for c in cells]
        yield f"| {kind} | " + " | ".join(texts) + " |"
    yield "\n## Share of the truth inside 95 % intervals\n"
    yield "| quantity | builds | inside | mean pull | sd of pull |"
    yield "|---|---|---|---|---|"
    for name in dict.fromkeys(n for d in everything for n in d.pulls):
        x = np.array([d.pulls[name] for d in everything if name in d.pulls])
        if len(x) >= SMALLEST_SHARE_OF_BUILDS * len(everything):
            inside = np.mean([d.inside[name] for d in everything if name in d.inside])
            yield f"| {name} | {len(x)} | {inside:.0%} | {np.mean(x):+.2f} | {np.std(x):.2f} |"
    for name in everything[0].bands:
        inside = np.mean([d.bands[name] for d in everything])
        yield f"| band of {name} | {len(everything)} | {inside:.0%} | | |"


def main() -> None:
    ask = argparse.ArgumentParser()
    ask.add_argument("builds", type=int, nargs="?", default=200)
    ask.add_argument("--jobs", type=int, default=1)
    given = ask.parse_args()
    kinds = list(KINDS)
    jobs = [(seed, kinds[seed % len(kinds)]) for seed in range(given.builds)]
    draws: dict[str, list[Draw]] = {kind: [] for kind in kinds}
    with ProcessPoolExecutor(given.jobs) as pool:
        for kind, draw in pool.map(run, jobs):
            draws[kind].append(draw)
    print(f"{given.builds} builds\n")
    print("\n".join(tables({kind: rows for kind, rows in draws.items() if rows})))


if __name__ == "__main__":
    main()
