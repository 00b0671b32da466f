"""Does a build find the truth, and do its intervals contain it? `python tests/studies/recovery_study.py 200 --jobs 2`.

Prints the tables of docs/recovery.md (misfit, truth, coverage, bands) for front and rear tyres in turn, each with a base file up
to 30 % off, without a base file, and with thinner campaigns. ``--rig-off`` is the size of the rig errors over the declared ones.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import harness
import numpy as np
from drawn_rigs import SAFE, Band, Draw, Kind, one_rig

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


def one(job: harness.Job) -> Draw:
    return one_rig(job.seed, replace(KINDS[job.world], rig_off=job.given.rig_off))


def page(_: Any, found: dict[str, list[Draw]]) -> Iterator[str]:
    every, refused = harness.sound(d for draws in found.values() for d in draws)
    yield f"{len(every) + len(refused)} builds, {len(refused)} refused, {sum(d.doubted > 0 for d in every)} with a doubted sweep"
    yield from refused
    groups = {kind: harness.sound(draws)[0] for kind, draws in found.items()}
    groups = {kind: draws for kind, draws in groups.items() if draws}
    yield from harness.misfits(groups)
    columns = {
        f"{n} rms (largest)": lambda of, n=n: harness.largest(d.error.get(n, np.nan) for d in of)
        for n in dict.fromkeys(name for d in every for name in d.error)
    }
    yield from harness.by_group(groups, columns, "Against the noise-free truth")
    yield from harness.coverage(every, SMALLEST_SHARE_OF_BUILDS, "Share of the truth inside 95 % intervals")
    bands = {
        f"{name}: {campaign}": [
            d.bands[name] for kind, of in groups.items() if kind.endswith(campaign) for d in of
        ]
        for name in every[0].bands
        for campaign in CAMPAIGNS
    }
    columns = {
        "inside": lambda of: f"{np.mean([b.inside for b in of]):.0%}",
        "rms error": lambda of: f"{_rms(of, 'error'):.3g}",
        "rms half width over 1.96": lambda of: f"{_rms(of, 'half') / SAFE:.3g}",
        "ratio": lambda of: f"{_rms(of, 'half') / SAFE / _rms(of, 'error'):.2f}",
    }
    yield from harness.by_group(bands, columns, "Bands of curves", "band: campaign")


def _rms(bands: list[Band], name: str) -> float:
    return rms(np.array([getattr(band, name) for band in bands]))


if __name__ == "__main__":
    harness.study(one, page, worlds=KINDS, draws=200, in_turn=True, rig_off=1.0)
