"""Friction and cornering stiffness of every run as the fit found them, for the report and for result.json."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

from mffit.fit import agreement
from mffit.fit.agreement import Agreement
from mffit.fit.influences.nuisances import of_run
from mffit.fit.influences.with_nuisances import NuisanceFit
from mffit.points import Points
from mffit.rig import Simulation
from mffit.rig_errors import OF_RUN


@dataclass(frozen=True, slots=True)
class BetweenRuns:
    """The numbers that every run has, and their scatter."""

    runs: tuple[str, ...]  #: names of the sweeps
    scatter: Mapping[
        str, tuple[float, float]
    ]  #: number -> (standard deviation among the runs, its uncertainty) [-]
    values: Mapping[
        str, tuple[tuple[float, float], ...]
    ]  #: number -> (value, standard error) of every run [-]
    alone: Mapping[str, Agreement]  #: by channel, agreement of the model without the numbers of the runs


def between_runs(found: NuisanceFit, points: Points) -> BetweenRuns | None:
    """The record of a fit that models them; None for others."""
    full = found.full
    own = {name: value for name, value in full.rig.items() if of_run(name)}
    if not own:
        return None
    runs = tuple(dict.fromkeys(name.partition(OF_RUN)[2] for name in own))
    # The relative uncertainty of a standard deviation from n values, to first order.
    share = 1.0 / math.sqrt(2.0 * len(runs))
    rest = without_runs(full.simulation).readings(points)
    return BetweenRuns(
        runs=runs,
        scatter={name: (value, share * value) for name, value in found.choice.scatter.items()},
        values={name: tuple(own[f"{name}{OF_RUN}{run}"] for run in runs) for name in found.choice.scatter},
        alone=agreement.with_points(rest, points),
    )


def without_runs(simulation: Simulation) -> Simulation:
    """The simulation at the mean of the runs."""
    return simulation.with_numbers(dict.fromkeys(filter(of_run, simulation.of_parts), 0.0))
