"""Does the fit find that friction and stiffness differ from run to run, and leave runs that do not differ alone?

`python tests/studies/run_scale_study.py 30 --jobs 2`

For every scatter it draws rigs and tyres, front and rear in turn; every sweep has a friction and
a cornering stiffness of its own. It prints how often they are modelled, the scatter that is found, how far the coefficients of
grip and stiffness are from the truth in standard errors, and how well the file alone gives the tyre without scatter. Every
campaign is built twice, the second time with `[fit] run_scale = false`.
"""

from __future__ import annotations

import tomllib
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import tomli_w
import worlds
from drawn_rigs import SAFE, front_or_rear, on_disk, plan_content, scaled

import mffit
import tir
from mffit.errors import InputError
from mffit.rig import Simulation

SCATTERS = (0.0, 0.003, 0.01, 0.02)
NAMES = ("run_grip", "run_stiffness")
CONCERNED = ("PDY1", "PDY2", "PKY1", "PKY2", "PPY1", "PPY3")


@dataclass(frozen=True)
class Scattered:
    """One build of a drawn campaign against the truth."""

    modelled: bool = False
    scatter: Mapping[str, float] = field(default_factory=dict)  #: found
    pulls: Mapping[str, float] = field(default_factory=dict)  #: (found - true) / standard error
    error: float = 0.0  #: rms of Fy of the file at the points, against the tyre of the mean run [N]
    over_noise: float = 0.0
    seconds: float = 0.0
    refused: str = ""


def one(job: tuple[int, float, Any]) -> dict[str, Scattered]:
    """Draw, simulate and build one rig, with the default and with run_scale = false."""
    seed, scatter, _ = job
    rng = np.random.default_rng(9000 + seed)
    sample, true = front_or_rear(seed, rng)
    content = plan_content(sample)
    for sweep in content["sweep"]:
        sweep["faults"] = dict(zip(NAMES, (scatter * rng.standard_normal(2)).tolist(), strict=True))
    out = {}
    with on_disk(true, content, seed, base=scaled(true, 0.3, rng)) as (path, _):
        config = tomllib.loads(path.read_text(encoding="utf-8"))
        for words, key in (("auto", "auto"), ("false", False)):
            path.write_text(tomli_w.dumps({**config, "fit": {"run_scale": key}}), encoding="utf-8")
            try:
                out[words] = _compared(mffit.build(path), true)
            except InputError as error:
                out[words] = Scattered(refused=str(error))
    return out


def _compared(result: Any, true: tir.Tyre) -> Scattered:
    fit = result.fit
    rows = {name: fit.coefficients[name] for name in CONCERNED}
    own, aim = (Simulation.of(tyre).readings(result.points).Fy for tyre in (fit.tyre, true))
    return Scattered(
        modelled=fit.runs is not None,
        scatter=dict(fit.choice.scatter),
        pulls={name: (row.value - true[name]) / row.stderr for name, row in rows.items() if row.stderr},
        error=float(np.sqrt(np.mean((own - aim) ** 2))),
        over_noise=fit.channels["Fy"].rmse / float(np.sqrt(np.nanmean(result.points.u_Fy**2))),
        seconds=fit.seconds,
    )


def table(scatter: float, found: list[dict[str, Scattered]]) -> list[str]:
    """Lines of one scatter."""
    out = [f"\n## scatter {100 * scatter:g} %: {len(found)} rigs\n"]
    for words in ("auto", "false"):
        rows = [row[words] for row in found if not row[words].refused]
        sizes = ", ".join(
            f"{name} {100 * np.median([row.scatter[name] for row in rows if row.modelled]):.2f} %"
            for name in NAMES
            if any(row.modelled for row in rows)
        )
        pulls = np.array([pull for row in rows for pull in row.pulls.values()])
        out.append(
            f"* run_scale = {words}: modelled in {sum(row.modelled for row in rows)} of {len(rows)} ({sizes or 'none'}); "
            f"sd of pull {np.sqrt(np.mean(pulls**2)):.2f}, inside 95 % {np.mean(np.abs(pulls) < SAFE):.0%}; "
            f"file against the mean tyre {np.median([row.error for row in rows]):.1f} N; "
            f"misfit over noise {np.median([row.over_noise for row in rows]):.2f}; "
            f"fit {np.median([row.seconds for row in rows]):.1f} s; refused {len(found) - len(rows)}"
        )
    return out


if __name__ == "__main__":
    worlds.run(one, table, worlds.asked(30, SCATTERS))
