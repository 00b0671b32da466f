"""How far do new sweeps lie from a build? `python tests/studies/left_out_study.py --project tyre.toml`.

A project is divided at random into ``--folds`` parts, and one after the other (of ``--looked-at`` parts) is left out of a build.

By default the sweeps are divided, and `mffit predict` says the forces of the part's readings. Printed for every channel: the
errors of the file and of the best estimate, the share of readings inside their 95 % intervals, and the usual half width over the
error; all of it again without the temperature of the readings. With ``--truth FILE.tir`` the forces of the tyre that was drawn
are compared instead, with the interval of the tyre's mean force.

With ``--plain`` the conditions are divided, and the build is compared with plain least squares: the formula, the free
coefficients and the bounds of the build, and one weight per channel, the rms of what it leaves; no priors, physical limits or
weights of outliers. It starts where the build starts: at the table's defaults, estimates and what is read off the points.
Printed: rms errors of left-out readings with the zeros of the rig, all and without the first sweep.
"""

from __future__ import annotations

import math
import tempfile
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import harness
import numpy as np
import pandas as pd

import mffit
import tir
from mffit import config as configuration
from mffit.config.lines import ExcludeTable
from mffit.fit.fitted import Fitted
from mffit.fit.known import known_before_fit
from mffit.fit.problem import FitProblem, fit_problem
from mffit.fit.start import starting_values
from mffit.least_squares import FreeNumber, solve
from mffit.pipeline.inputs import read_points
from mffit.points import Points, levels
from mffit.prediction.conditions import PATH
from mffit.quantities import column, u_column
from mffit.rig import Simulation
from mffit.rig_errors import ZEROS, error_of
from mffit.scatter import rms

STATED = ("alpha_deg", "gamma_deg", "Fz_N", "kappa", "p_kPa", "V_mps")
PASSES = 3
"""In each, the weights are those of the misfit of the one before."""
Found = dict[tuple[str, ...], tuple[np.ndarray, ...]]
"""By what is compared: arrays (n,) of errors and what goes with them."""


def divided(given: Any, points: Points) -> list[np.ndarray]:
    """Sweeps of each part."""
    forward = np.unique(
        points.sweep[points.direction > 0]
    )  # the conditions of a prediction have no direction
    groups = conditions(points) if given.plain else [np.array([k]) for k in forward]
    order = np.random.default_rng(given.seed).permutation(len(groups))
    return [np.concatenate([groups[k] for k in part]) for part in np.array_split(order, given.folds)]


def conditions(points: Points) -> list[np.ndarray]:
    """The sweeps of each condition: those whose settings that are not swept are of one level."""
    names = {"alpha": levels.SIDESLIP, "gamma": levels.CAMBER, "Fz": levels.LOAD, "p": levels.PRESSURE}
    sweeps = np.unique(points.sweep)
    usual = {n: np.array([np.median(getattr(points, n)[points.sweep == k]) for k in sweeps]) for n in names}
    labels = np.column_stack([levels.nearest_labels(usual[n], kind) for n, kind in names.items()])
    return [sweeps[rows] for rows in levels.rows_of_equal(labels)]


def without(config: configuration.Config, points: Points, rows: np.ndarray) -> configuration.Config:
    """The project without the lines of some points, and without those around them that no other point has."""
    entries = list(config.fit.exclude)
    for k in np.unique(points.file[rows]):
        own = np.flatnonzero(points.file == k)
        own = own[np.argsort(points.line[own])]
        parts = np.split(own, np.flatnonzero(np.diff(rows[own])) + 1)
        first = [points.line[own[0]], *(points.last_line[part[-1]] + 1 for part in parts[:-1])]
        last = [*(points.line[part[0]] - 1 for part in parts[1:]), points.last_line[own[-1]]]
        some = [(a, b) for part, a, b in zip(parts, first, last, strict=True) if rows[part[0]]]
        text = ", ".join(f"{a}-{b}" for a, b in some)
        entries.append(ExcludeTable(file=points.files[k], lines=text, why="left out by the study"))
    return config.model_copy(update={"fit": config.fit.model_copy(update={"exclude": tuple(entries)})})


def one(job: harness.Job) -> Found:
    """What a build without a part says of it."""
    config = configuration.load(job.given.project)
    points = read_points(config).points
    rows = np.isin(points.sweep, divided(job.given, points)[job.seed])
    part, held = without(config, points, rows), points.select(np.flatnonzero(rows))
    if job.given.plain:
        return _beside_least_squares(part, held, points.sweep[0])
    truth = tir.read(job.given.truth) if job.given.truth else None
    ways = {"": STATED}
    if np.all(np.isfinite(points.T)):
        ways = {"": (*STATED, "T_degC"), "without temperature": STATED}
    found: Found = {}
    with tempfile.TemporaryDirectory() as folder:
        prediction = mffit.build(part, folder, with_report=False).prediction
        assert prediction is not None
        for way, stated in ways.items():
            asked = pd.DataFrame({name: held.condition(name) for name in stated} | {PATH: held.phi_t})
            table = mffit.predict(folder, asked)
            for channel in prediction.channels:
                file, best = (table[name].to_numpy() for name in (column(channel), column(channel, "best")))
                true, *u = _true(held, table, channel, truth, np.abs(best - file))
                for word, said, size in zip(("file", "best"), (file, best), u, strict=True):
                    found[channel, word, way] = (true - said, size)
    return found


def _true(held: Points, table: pd.DataFrame, channel: str, truth: tir.Tyre | None, gap: np.ndarray) -> tuple:
    """Readings or true forces, and uncertainties of the file and of the best estimate."""
    if truth is None:
        run = table[f"u_{column(channel, 'run')}"].to_numpy()
        return held.channel(channel), table[u_column(channel)].to_numpy(), run
    true = Simulation.of(truth, turn_slip=bool(np.any(held.phi_t))).readings(held, [channel])[channel]
    u = table[f"u_{column(channel, 'best')}"].to_numpy()
    return true, np.hypot(u, gap), u


def _beside_least_squares(part: configuration.Config, held: Points, first: int) -> Found:
    built, found = mffit.build(part, with_report=False), {}
    fit = built.fit
    known = known_before_fit(part, built.points, built.measured, None, {})
    start = {**known.values, **starting_values(known.values, built.points, built.measured, ())}
    values, channels = fit.search.simulation.values, fit.search.problem.channels
    problem = fit_problem(part, built.points, built.measured, values, channels)
    for kind, one in {"plain file": fit.search, "at temperature": fit.full}.items():
        for way, simulation in _both(one, problem, start).items():
            for name, read in simulation.readings(held, problem.channels).items():
                found[name, kind, way] = (held.channel(name) - read, held.sweep == first)
    return found


def _both(built: Fitted, problem: FitProblem, start: Mapping[str, float]) -> dict[str, Simulation]:
    """The build, and least squares of its free numbers."""
    values = {n.name: start[n.name] for n in built.numbers if error_of(n.name) is None}
    zeros = {error.name: built.problem.value(error.name) for error in ZEROS if error.name in built.held_rig}
    problem = problem.with_values({"T_ref_degC": built.problem.value("T_ref_degC"), **zeros})
    return {"build": built.simulation, "least squares": least_squares(problem, values, built.numbers)}


def least_squares(
    problem: FitProblem, start: Mapping[str, float], numbers: Iterable[FreeNumber]
) -> Simulation:
    """Plain least squares of the numbers of a build; rig errors begin at 0, with the priors of their declaration."""
    free = [n if n.name not in start else replace(n, spread=math.inf) for n in numbers]
    here = replace(problem, envelope=None)
    here = here.with_values({n.name: start.get(n.name, n.expected) for n in free})
    for _ in range(PASSES):
        left = {name: np.where(z == 0.0, 0.0, z * here.sigma[name]) for name, z in here.misfit().items()}
        sigma = {n: np.where(np.isfinite(u), rms(left[n]), np.inf) for n, u in here.sigma.items()}
        here = replace(here, sigma=sigma)
        begin = here.starting_here(free)
        here = here.with_values(solve(here.free([n.name for n in begin]), begin).values)
    return here.simulation


def page(_: Any, parts: list[Found]) -> Iterator[str]:
    for what in parts[0]:
        error, other = (np.concatenate([part[what][k] for part in parts]) for k in (0, 1))
        if other.dtype == bool:
            yield f"{' '.join(what):40s} {rms(error):7.2f}, without the first sweep {rms(error[~other]):7.2f}"
            continue
        known = np.isfinite(error)
        share, half, size = harness.shares(error[known], other[known])
        yield f"{' '.join(what):40s} {size:7.4g}, inside 95 % {100 * share:5.1f} %, half width over error {half / size:.2f}"


if __name__ == "__main__":
    asked = {"project": harness.SAMPLES / "flat-track" / "tyre.toml", "folds": 8, "looked_at": 99, "seed": 5}
    harness.study(
        one, page, draws=None, seeds=lambda _, given: range(min(given.folds, given.looked_at)), **asked,
        truth=Path, plain=False,
    )  # fmt: skip
