"""The rows of docs/benchmark.md: ``python tests/studies/benchmark_study.py DIR``, some minutes.

Makes the campaigns of samples/benchmark in DIR, builds each with mffit, and fits each with what a script of twenty lines does:
``scipy.optimize.least_squares`` from the base file, or else the defaults, on the points of the sweeps, all coefficients free that
the measured channels have, readings weighted by the rms of each channel; no zeros of the rig, priors or limits but the bounds.
Writes ``scores.csv``: errors, and seconds of processor.
"""

from __future__ import annotations

import argparse
import sys
import time
from pathlib import Path

import numpy as np
import pandas as pd
from scipy.optimize import least_squares

import mffit
import tir
from mffit import config as configuration
from mffit.pipeline.inputs import read_base, read_points
from mffit.scatter import rms
from tir.parameters import TABLE

sys.path.insert(0, str(Path(__file__).parents[2] / "samples" / "benchmark"))
from benchmark import CAMPAIGNS, make, score

CHANNELS = ("Fx", "Fy", "Mz")


def plain(project: Path) -> tir.Tyre:
    """Least squares as a script would do it."""
    config = configuration.load(project)
    at = read_points(config).points
    base = (
        read_base(config)
        or tir.Tyre.from_values(
            {
                "UNLOADED_RADIUS": config.tyre.unloaded_radius,
                "FNOMIN": config.tyre.nominal_load,
                "NOMPRES": 1e3 * config.tyre.nominal_pressure,
                "INFLPRES": 1e3 * config.tyre.nominal_pressure,
            }
        ).expand()
    )
    channels = [name for name in CHANNELS if np.any(np.isfinite(at.channel(name)))]
    rows = [row for row in TABLE if row.stage and row.channel in channels and np.all(np.isfinite(row.bounds))]
    start = np.array([row.inside(float(base[row.name])) for row in rows])
    wanted = {name: at.channel(name) for name in channels}
    weight = {name: 1.0 / rms(y[np.isfinite(y)]) for name, y in wanted.items()}
    on_disc = {"phi_t": at.phi_t} if config.rig.on_disc else {}

    def residual(x: np.ndarray) -> np.ndarray:
        tyre = base.replace(**{row.name: float(v) for row, v in zip(rows, x, strict=True)})
        read = tyre(at.Fz, at.alpha, at.gamma, at.kappa, p=at.p, Vx=at.V, **on_disc)
        left = [weight[name] * (getattr(read, name) - y)[np.isfinite(y)] for name, y in wanted.items()]
        return np.concatenate(left)

    lower, upper = np.array([row.bounds for row in rows]).T
    scale = np.array([row.width for row in rows])
    found = least_squares(residual, start, bounds=(lower, upper), x_scale=scale, max_nfev=100)
    tyre = base.replace(**{row.name: float(v) for row, v in zip(rows, found.x, strict=True)})
    return tyre.replace(USE_MODE=125.0 if config.rig.on_disc else 124.0)


def main() -> None:
    ask = argparse.ArgumentParser()
    ask.add_argument("out", type=Path)
    ask.add_argument("--only", nargs="+", default=[*CAMPAIGNS], choices=CAMPAIGNS)
    given = ask.parse_args()
    rows = []
    for name in given.only:
        project, folder = make(given.out, name), given.out / name
        began = time.process_time()
        built = mffit.build(project, folder / "out", with_report=False)
        rows.append({"campaign": name, "by": "mffit build", "seconds": time.process_time() - began})
        rows[-1] |= {"trusted": built.trusted, **score(given.out, name, folder / "out" / built.tir_path)}
        began = time.process_time()
        plain(project).write(folder / "plain.tir")
        rows.append({"campaign": name, "by": "least squares", "seconds": time.process_time() - began})
        rows[-1] |= score(given.out, name, folder / "plain.tir")
        print(pd.DataFrame(rows[-2:]).round(2).T.to_string(), flush=True)
    pd.DataFrame(rows).round(3).to_csv(given.out / "scores.csv", index=False)


if __name__ == "__main__":
    main()
