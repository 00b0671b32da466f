"""Is a build as good as plain least squares? ``python tests/studies/plain_study.py tyre.toml --folds 6 --looked-at 3``.

The conditions are divided at random, and one part after the other is left out. Plain least squares has the formula, the free
coefficients and the bounds of the build, and one weight per channel, the rms of what it leaves; no priors, physical limits or
weights of outliers. It starts where the build starts: at the table's defaults, estimates and what is read off the points.
Printed: rms errors of left-out readings with the zeros of the rig, all and without the first sweep.
"""

from __future__ import annotations

import argparse
import math
import sys
from collections.abc import Iterable, Mapping
from dataclasses import replace
from pathlib import Path

import numpy as np

import mffit
from mffit import config as configuration
from mffit.fit.fitted import Fitted
from mffit.fit.known import known_before_fit
from mffit.fit.problem import FitProblem, fit_problem
from mffit.fit.start import starting_values
from mffit.least_squares import FreeNumber, solve
from mffit.pipeline.inputs import read_points
from mffit.points import Points, levels
from mffit.rig import Simulation
from mffit.rig_errors import ZEROS, error_of
from mffit.scatter import rms

sys.path.insert(0, str(Path(__file__).parents[2]))
from tests.studies.prediction_study import without

PASSES = 3
"""In each, the weights are those of the misfit of the one before."""


def least_squares(
    problem: FitProblem, start: Mapping[str, float], numbers: Iterable[FreeNumber]
) -> Simulation:
    """Plain least squares of the numbers of a build; rig errors begin at 0, with the priors of their declaration."""
    free = [n if n.name not in start else replace(n, spread=math.inf) for n in numbers]
    here = replace(problem, envelope=None, nominal={})
    here = here.with_values({n.name: start.get(n.name, n.expected) for n in free})
    for _ in range(PASSES):
        left = {name: np.where(z == 0.0, 0.0, z * here.sigma[name]) for name, z in here.misfit().items()}
        sigma = {n: np.where(np.isfinite(u), rms(left[n]), np.inf) for n, u in here.sigma.items()}
        here = replace(here, sigma=sigma)
        begin = here.starting_here(free)
        here = here.with_values(solve(here.free([n.name for n in begin]), begin).values)
    return here.simulation


def of(built: Fitted, problem: FitProblem, start: Mapping[str, float]) -> dict[str, Simulation]:
    """The build, and least squares of its free numbers."""
    values = {n.name: start[n.name] for n in built.numbers if error_of(n.name) is None}
    zeros = {error.name: built.problem.value(error.name) for error in ZEROS if error.name in built.held_rig}
    problem = problem.with_values({"T_ref_degC": built.problem.value("T_ref_degC"), **zeros})
    return {"build": built.simulation, "least squares": least_squares(problem, values, built.numbers)}


def conditions(points: Points) -> list[np.ndarray]:
    """The sweeps of each condition: those whose settings that are not swept are of one level."""
    names = {"alpha": levels.SIDESLIP, "gamma": levels.CAMBER, "Fz": levels.LOAD, "p": levels.PRESSURE}
    sweeps = np.unique(points.sweep)
    usual = {n: np.array([np.median(getattr(points, n)[points.sweep == k]) for k in sweeps]) for n in names}
    labels = np.column_stack([levels.nearest_labels(usual[n], kind) for n, kind in names.items()])
    return [sweeps[rows] for rows in levels.rows_of_equal(labels)]


def main() -> None:
    ask = argparse.ArgumentParser()
    ask.add_argument("project", type=Path)
    ask.add_argument("--folds", type=int, default=6)
    ask.add_argument("--looked-at", type=int, default=3, help="parts that are left out, one after the other")
    given = ask.parse_args()
    config = configuration.load(given.project)
    points = read_points(config).points
    first, every = points.sweep[0], conditions(points)
    parts = np.array_split(np.random.default_rng(5).permutation(len(every)), given.folds)
    found: dict[tuple[str, str], list[tuple[np.ndarray, np.ndarray]]] = {}
    for k, left_out in enumerate(parts[: given.looked_at]):
        rows = np.isin(points.sweep, np.concatenate([every[i] for i in left_out]))
        part = without(config, points, rows)
        built = mffit.build(part, with_report=False)
        fit, held = built.fit, points.select(np.flatnonzero(rows))
        known = known_before_fit(part, built.points, built.measured, None, {})
        start = {**known.values, **starting_values(known.values, built.points, built.measured, ())}
        values, channels = fit.search.simulation.values, fit.search.problem.channels
        problem = fit_problem(part, built.points, built.measured, values, channels)
        for kind, one in {"plain file": fit.search, "at temperature": fit.full}.items():
            for way, simulation in of(one, problem, start).items():
                for name, read in simulation.readings(held, problem.channels).items():
                    pair = (held.channel(name) - read, held.sweep == first)
                    found.setdefault((f"{kind}, {way}", name), []).append(pair)
        print(f"part {k + 1}: {built.seconds:.0f} s", flush=True)
    for (what, name), pairs in found.items():
        error, of_first = (np.concatenate(own) for own in zip(*pairs, strict=True))
        print(f"{what:30s} {name}: {rms(error):7.2f} / {rms(error[~of_first]):7.2f}")


if __name__ == "__main__":
    main()
