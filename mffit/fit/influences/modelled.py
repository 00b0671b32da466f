"""Records of modelled influences for report and result.json: differences between runs, and the file at one temperature."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from mffit.as_json import keys
from mffit.fit import agreement
from mffit.fit.agreement import Agreement
from mffit.fit.coefficients import Coefficient
from mffit.fit.fitted import Fitted
from mffit.fit.influences.nuisance_choice import Gaps
from mffit.fit.influences.nuisances import of_run
from mffit.fit.influences.with_nuisances import NuisanceFit
from mffit.fit.written.misfit import FileFigures
from mffit.linearised import LinearisedFit
from mffit.points import Points
from mffit.prediction import Predictor, predictor
from mffit.rig import Simulation
from mffit.rig_errors import BESIDE, OF_RUN, P_REF, T_REF, V_REF, rig_estimates
from mffit.scatter import ALARM
from tir.temperature import SCALED_BY


@dataclass(frozen=True, slots=True)
class BetweenRuns:
    """Random effects of the runs, and their standard deviations."""

    runs: tuple[str, ...]  #: names of the sweeps
    scatter: Mapping[str, tuple[float, float]]
    """Number -> (standard deviation among the runs, its uncertainty) [-]."""
    values: Mapping[str, tuple[tuple[float, float], ...]]
    """Number -> (value, standard error) of every run [-]."""
    alone: Mapping[str, Agreement]  #: by channel, agreement of the model without the random effects


keys(
    BetweenRuns,
    "names=runs scatter channels_without=alone",
    scatter=lambda found: rig_estimates(found.scatter),
)


def between_runs(found: NuisanceFit, points: Points) -> BetweenRuns | None:
    """The record of the runs' random effects; None if the fit has none."""
    full = found.full
    own = {name: value for name, value in full.rig.items() if of_run(name)}
    if not own:
        return None
    runs = tuple(dict.fromkeys(name.partition(OF_RUN)[2] for name in own))
    # The relative uncertainty of a standard deviation from n values, to first order.
    share = 1.0 / math.sqrt(2.0 * len(runs))
    return BetweenRuns(
        runs=runs,
        scatter={name: (value, share * value) for name, value in found.choice.scatter.items()},
        values={name: tuple(own[f"{name}{OF_RUN}{run}"] for run in runs) for name in found.choice.scatter},
        alone=_of_file(full, points),
    )


def without_runs(simulation: Simulation) -> Simulation:
    """The simulation with the random effects of all runs set to zero."""
    return simulation.with_numbers(dict.fromkeys(filter(of_run, simulation.of_parts), 0.0))


@dataclass(frozen=True, slots=True)
class OverSpeed:
    """Terms of grip and stiffness over the speed, of which the files hold at one."""

    V_ref: float  #: speed at which the files hold [m/s]
    V_range: tuple[float, float]  #: tested speeds [m/s]
    terms: Mapping[str, tuple[float, float]]  #: term -> (value, standard error) [s/m]
    alone: Mapping[str, Agreement]
    """By channel, agreement of the file, which has no term, with the points of all speeds."""


keys(
    OverSpeed,
    "V_ref_mps=V_ref V_min_mps=V_range.0 V_max_mps=V_range.1 terms without_terms=alone",
    terms=lambda found: rig_estimates(found.terms),
)


def over_speed(found: NuisanceFit, points: Points) -> OverSpeed | None:
    """The record of the terms of speed; None if the fit has none."""
    full = found.full
    terms = {e.name: full.rig[e.name] for e in BESIDE if e.counts_from == V_REF and e.name in full.rig}
    if not terms:
        return None
    return OverSpeed(
        V_ref=full.problem.value(V_REF),
        V_range=(float(np.min(points.V)), float(np.max(points.V))),
        terms=terms,
        alone=_of_file(full, points),
    )


def _of_file(fitted: Fitted, points: Points) -> dict[str, Agreement]:
    """By channel, agreement of the file, which has neither effects of single runs nor terms beside the formula, with points."""
    written = without_runs(without_terms(fitted, [P_REF, V_REF]))
    return agreement.with_points(written.readings(points, fitted.problem.channels), points)


def without_terms(fitted: Fitted, references: Sequence[str]) -> Simulation:
    """The simulation of a fit without its terms beside the formula that count from these reference conditions."""
    return fitted.simulation.with_numbers(
        {e.name: e.undisturbed for e in BESIDE if e.counts_from in references and e.name in fitted.rig}
    )


@dataclass(frozen=True, slots=True)
class AtTemperature:
    """The model with temperature terms, and its file."""

    file: FileFigures
    T_ref: float  #: temperature at which the file holds [degC]
    T_range: tuple[float, float]  #: temperatures of the points [degC]
    terms: Mapping[str, tuple[float, float]]  #: temperature term -> (value, standard error) [1/K]
    rig: Mapping[str, tuple[float, float]]  #: rig number -> (value, standard error), with these terms
    coefficients: Mapping[str, Coefficient]
    channels: Mapping[str, Agreement]  #: agreement with the temperature terms
    alone: Mapping[str, Agreement]  #: agreement without the temperature terms
    left_out: Gaps  #: by channel, rms error of left-out sweeps with the terms
    left_out_plain: Gaps  #: by channel, rms error of left-out sweeps of the plain file
    moved: Mapping[str, tuple[float, float, float]]
    """Coefficient -> (value in the plain file, value here, standard error here) if they clearly differ, largest change first."""
    prediction: Predictor = field(repr=False)  #: of forces at any conditions and tested temperatures


keys(
    AtTemperature,
    "T_ref_degC T_min_degC=T_range.0 T_max_degC=T_range.1 terms channels without_terms=alone left_out_rmse coefficients moved",
    terms=lambda found: rig_estimates(found.terms),
    left_out_rmse=lambda found: {"temperature": found.left_out, "plain": found.left_out_plain},
    moved=lambda found: {
        name: {"plain": there, "value": here, "stderr": u} for name, (there, here, u) in found.moved.items()
    },
)


def at_temperature(
    found: NuisanceFit,
    points: Points,
    file: FileFigures,
    coefficients: Mapping[str, Coefficient],
    left: LinearisedFit,
    setups: Mapping[str, float],
) -> AtTemperature:
    """The record of a fit that models the temperature; ``left`` is the linear model of its residuals, ``setups`` the standard
    deviations of zeros from set-up to set-up.
    """
    full = found.full
    terms = {name: full.rig[name] for name in SCALED_BY if name in full.rig}
    rig, T_ref = {name: value for name, (value, _) in full.rig_stated.items()}, full.simulation.faults[T_REF]
    simulation = without_runs(full.simulation)
    alone = simulation.with_numbers(dict.fromkeys(terms, 0.0))
    verdict = next(v for v in found.choice.verdicts if v.modelled and set(v.nuisance.numbers) & set(terms))
    return AtTemperature(
        file=file,
        T_ref=T_ref,
        T_range=(float(np.nanmin(points.T)), float(np.nanmax(points.T))),
        terms=terms,
        rig=full.rig_stated,
        coefficients=coefficients,
        channels=agreement.with_points(simulation.readings(points, full.problem.channels), points),
        alone=agreement.with_points(alone.readings(points, full.problem.channels), points),
        left_out=verdict.beside,
        left_out_plain=verdict.without,
        moved=_moved(found),
        prediction=predictor(
            points, left, {**rig, T_REF: T_ref}, terms=(*terms, T_REF), setups=setups
        ).stating(full.posterior),
    )


def _moved(found: NuisanceFit) -> dict[str, tuple[float, float, float]]:
    """Coefficients that the temperature terms changed by clearly more than their standard errors."""
    plain, full = found.plain, found.full
    errors = full.stderr
    moved = {
        name: (plain.values[name], value, errors[name])
        for name, value in full.values.items()
        if name in plain.values and name not in full.regularised
    }
    sizes: dict[str, float] = {
        name: abs(here - there) / u if u else 0.0 for name, (there, here, u) in moved.items()
    }
    named = sorted(sizes, key=lambda name: -sizes[name])
    return {name: moved[name] for name in named if sizes[name] > ALARM}
