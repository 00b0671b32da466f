"""How far do new sweeps lie from a prediction? `python tests/studies/prediction_study.py tyre.toml --folds 8`.

The sweeps of a project are divided at random. The tyre is built without each part, and `mffit predict` says the forces of the
part's readings. Printed for every channel: the errors of the file and of the best estimate, the share of readings inside their
95 % intervals, and the usual half width over the error; all of it again without the temperature of the readings. With
`--truth FILE.tir` the forces of the tyre that was drawn are compared instead, with the interval of the tyre's mean force.
"""

from __future__ import annotations

import argparse
import tempfile
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pandas as pd

import mffit
import tir
from mffit import config as configuration
from mffit.config.lines import ExcludeTable
from mffit.constants import COVERAGE_FACTOR_95
from mffit.pipeline.inputs import read_points
from mffit.points import Points
from mffit.prediction.conditions import PATH
from mffit.quantities import column, u_column
from mffit.rig import Simulation
from mffit.scatter import rms

STATED = ("alpha_deg", "gamma_deg", "Fz_N", "kappa", "p_kPa", "V_mps")


class Found(NamedTuple):
    """Readings less predictions, and stated uncertainties (n,)."""

    of_file: np.ndarray
    u_file: np.ndarray
    of_best: np.ndarray
    u_best: np.ndarray


def without(config: configuration.Config, points: Points, rows: np.ndarray) -> configuration.Config:
    """The project without the lines of some points."""
    entries = list(config.fit.exclude)
    for k in np.unique(points.file[rows]):
        lines = np.unique(points.line[rows & (points.file == k)])
        parts = np.split(lines, np.flatnonzero(np.diff(lines) > 1) + 1)
        text = ", ".join(f"{part[0]}-{part[-1]}" for part in parts)
        entries.append(ExcludeTable(file=points.files[k], lines=text, why="left out by the study"))
    return config.model_copy(update={"fit": config.fit.model_copy(update={"exclude": tuple(entries)})})


def conditions(points: Points, stated: tuple[str, ...]) -> pd.DataFrame:
    """What a user would write for these points."""
    return pd.DataFrame({name: points.condition(name) for name in stated} | {PATH: points.phi_t})


def errors(points: Points, found: pd.DataFrame, channel: str, truth: tir.Tyre | None) -> Found:
    """The predictions of a channel against the readings, or against the true forces."""
    file, best = (found[name].to_numpy() for name in (column(channel), column(channel, "best")))
    if truth is None:
        run = found[f"u_{column(channel, 'run')}"].to_numpy()
        measured = points.channel(channel)
        return Found(measured - file, found[u_column(channel)].to_numpy(), measured - best, run)
    curved = bool(np.any(points.phi_t))
    true = Simulation.of(truth, turn_slip=curved).readings(points, [channel])[channel]
    u = found[f"u_{column(channel, 'best')}"].to_numpy()
    return Found(true - file, np.hypot(u, best - file), true - best, u)


def line(channel: str, parts: list[Found]) -> str:
    """The figures of a channel."""
    found = Found(*(np.concatenate(own) for own in zip(*parts, strict=True)))
    found = Found(*(values[np.isfinite(found.of_file)] for values in found))

    def figures(error: np.ndarray, u: np.ndarray) -> str:
        half = COVERAGE_FACTOR_95 * u
        return f"{rms(error):7.4g} {100 * np.mean(np.abs(error) < half):5.1f} % {rms(half) / rms(error):5.2f}"

    return f"{channel:3s} file {figures(found.of_file, found.u_file)}   best {figures(found.of_best, found.u_best)}"


def main() -> None:
    ask = argparse.ArgumentParser()
    ask.add_argument("project", type=Path)
    ask.add_argument("--folds", type=int, default=8)
    ask.add_argument("--seed", type=int, default=5)
    ask.add_argument("--truth", type=tir.read, help="property file of the drawn tyre")
    given = ask.parse_args()
    config = configuration.load(given.project)
    points = read_points(config).points
    forward = np.unique(points.sweep[points.direction > 0])  # conditions have no direction
    parts = np.array_split(np.random.default_rng(given.seed).permutation(forward), given.folds)
    ways = {"": STATED}
    if np.all(np.isfinite(points.T)):
        ways = {"": (*STATED, "T_degC"), " without temperature": STATED}
    found: dict[str, dict[str, list[Found]]] = {way: {} for way in ways}
    for k, part in enumerate(parts):
        rows = np.isin(points.sweep, part)
        with tempfile.TemporaryDirectory() as folder:
            result = mffit.build(without(config, points, rows), folder, with_report=False)
            print(f"part {k + 1}: {len(part)} sweeps, {result.seconds:.0f} s", flush=True)
            assert result.prediction is not None
            held = points.select(np.flatnonzero(rows))
            for way, stated in ways.items():
                table = mffit.predict(folder, conditions(held, stated))
                for channel in result.prediction.channels:
                    found[way].setdefault(channel, []).append(errors(held, table, channel, given.truth))
    for way, channels in found.items():
        print(f"errors rms [N], [Nm], share inside 95 %, half width over error{way}")
        for channel, own in channels.items():
            print(line(channel, own))


if __name__ == "__main__":
    main()
