"""``fit``: property files from points and direct measurements."""

import time
from collections.abc import Mapping
from dataclasses import replace
from types import MappingProxyType
from typing import Any

import numpy as np

from mffit.config import Config, axis_signs
from mffit.config.loading import as_declared
from mffit.fit import agreement, constants
from mffit.fit.bands import Bands, bands
from mffit.fit.beginning import Begun, begin
from mffit.fit.coefficients import of_file
from mffit.fit.delivery import Beside, Delivered, deliver
from mffit.fit.fitted import Fitted, left_by, with_errors_of
from mffit.fit.influences.confounding import confounding_sentence, confoundings
from mffit.fit.influences.modelled import at_temperature, between_runs, over_speed, without_terms
from mffit.fit.influences.nuisance_choice import at_reference
from mffit.fit.influences.with_nuisances import NuisanceFit, fit_with_nuisances
from mffit.fit.plan import FitPlan
from mffit.fit.polish import refitted
from mffit.fit.problem import FitProblem
from mffit.fit.result import FitResult
from mffit.fit.rig.rig_numbers import scatter_of_setups
from mffit.fit.rig.zeros import epsilon_gamma_of_model
from mffit.fit.wheel.vertical import vertical_sentence
from mffit.fit.wording import (
    alignment_sentence,
    explanations,
    nominal_pressure_sentences,
    nuisance_sentences,
    remarks,
    warnings,
    zeros_of_rig,
    zeros_sentence,
)
from mffit.fit.written.files import plain_use
from mffit.linearised import LinearisedFit
from mffit.measured import Measured
from mffit.parts import Parts
from mffit.points import Points
from mffit.prediction import Predictor, predictor
from mffit.progress import DERIVING, PREDICTING, Progress, silent
from mffit.rig import Simulation
from mffit.rig_errors import P_REF
from mffit.suspicion import Doubt, FittedModel, JudgedSweeps, after_the_fit
from mffit.suspicion.mounts import undeclared_mount
from mffit.suspicion.outliers import outliers
from mffit.suspicion.reversals import turning_sentences
from tir import Tyre
from tir.errors import begun


def fit(
    config: Config,
    points: Points,
    parts: Parts,
    measured: Measured,
    base: Tyre | None = None,
    progress: Progress = silent,
    steps: Mapping[str, Points] = MappingProxyType({}),
) -> FitResult:
    """The fit of MF 6.2 to raw points, angles as read, with turn slip on; directly measured values are held.

    ``parts`` are the points' odd and even parts; ``epsilon_gamma`` of ``measured`` is None on a flat track; ``base`` supplies
    the values that are not fitted; ``steps`` are samples of step tests, by the stepped setting: sideslip angle or longitudinal
    slip.

    Raises InputError if there are fewer points than coefficients, or a sweep contradicts all others beyond plausibility.
    """
    began = time.perf_counter()
    beginning = begin(config, points, measured, base)
    problem = beginning.problem
    found, left_by_formula, doubts = _fitted_and_judged(
        config, problem, beginning.start, beginning.plan, progress
    )
    found, left_by_file = _with_errors(found, left_by_formula)
    fitted, full = found.plain, found.full
    # Pressure is an input of a property file, which has no coefficient for these effects of it, so they are switched off.
    delivered = without_terms(fitted, [P_REF])
    readings, best = (one.readings(points, problem.channels) for one in (delivered, full.simulation))

    progress(DERIVING)
    use, on_disc = plain_use(config), config.rig.on_disc
    beside = Beside(beginning.radii, steps)
    made = deliver(config, beginning.known, points, base, fitted, beside)
    files = made.files
    temperature, setups = None, scatter_of_setups(config, measured)
    if found.at_temperature:
        special = deliver(config, beginning.known, points, base, full, beside, only=use)
        own = of_file(special.files, use, special.coefficients)
        temperature = at_temperature(found, points, special.files.by_use[use], own, left_by_formula, setups)

    tyre = files.by_use["turn-slip" if on_disc else "normal"].tyre
    prediction, wide = _predicted(
        fitted, left_by_file, points, Simulation(tyre.values, turn_slip=on_disc), setups
    )
    turned = undeclared_mount.find(points, FittedModel(full.simulation, left_by_formula))
    result = FitResult(
        tyre=tyre,
        written=files.by_use[use].tyre,
        coefficients=of_file(files, use, made.coefficients),
        channels=agreement.with_points(readings, points),
        odd=agreement.with_odd_part(files.by_use["normal"].tyre.values, points, parts),
        simulation=delivered,
        rig={**fitted.rig_stated, **made.zeros},
        model=readings,
        posterior=made.posterior,
        coverage=(*found.plan.cover, *(direction.coverage for direction in made.relaxation)),
        explanations=(),
        warnings=(),
        seconds=0.0,
        epsilon_gamma_model=_epsilon_gamma(made.known.values, points, measured),
        doubts=doubts,
        mounts=tuple(map(undeclared_mount.said, turned)),
        outliers=outliers(points, problem.sigma, found.stated.sigma, best),
        at_turns=full.problem.turning(),
        search=fitted,
        full=full,
        left_by_formula=left_by_formula,
        left_by_file=left_by_file,
        files=files,
        temperature=temperature,
        speed=over_speed(found, points),
        choice=found.choice,
        runs=between_runs(found, points),
        confounded=confoundings(replace(full, problem=at_reference(config, full.problem))),
        radii=beginning.radii,
        bands=wide,
        prediction=prediction,
        relaxation=made.relaxation,
    )
    explained, warned = _sentences(config, beginning, measured, found, made, result)
    turning = turning_sentences(points, best, result.at_turns)
    return replace(
        result, explanations=explained, warnings=(*warned, *turning), seconds=time.perf_counter() - began
    )


def _with_errors(found: NuisanceFit, left_by_formula: LinearisedFit) -> tuple[NuisanceFit, LinearisedFit]:
    """The fits with standard errors that hold the model error; and the linear model of the plain file's residuals."""
    full = with_errors_of(found.full, left_by_formula)
    if not found.at_temperature:
        return replace(found, plain=full, full=full), left_by_formula
    left_by_file = left_by(found.plain, near=left_by_formula)
    return replace(found, plain=with_errors_of(found.plain, left_by_file), full=full), left_by_file


def _predicted(
    fitted: Fitted, left: LinearisedFit, points: Points, simulation: Simulation, setups: Mapping[str, float]
) -> tuple[Predictor, Bands]:
    """The predictor of the plain file's fit, and the bands of the written tyre, whose ``simulation`` has no errors of the rig."""
    rig = {name: value for name, (value, _) in fitted.rig_stated.items()}
    known, with_zeros = (
        predictor(points, left, rig, exact, setups=setups).stating(fitted.posterior)
        for exact in ((), zeros_of_rig(fitted.zeros))
    )
    return known, bands(known, fitted.held, simulation, points, with_zeros)


def _sentences(
    config: Config,
    beginning: Begun,
    measured: Measured,
    found: NuisanceFit,
    made: Delivered,
    result: FitResult,
) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """The explanations and the warnings of a fit, the most important of each first."""
    fitted, wide, files, points = found.plain, result.bands, made.files, found.stated.points
    assert wide is not None
    moved, contradicted = "", False
    if beginning.turning is not None:
        moved, contradicted = zeros_sentence(beginning.turning, fitted, from_base=beginning.base is not None)
    modelled, others = nuisance_sentences(
        config.tyre.name, found, result.temperature, result.runs, result.channels
    )
    explained = (
        *modelled,
        *explanations(config, files, made.known.values, measured, beginning.hand),
        *filter(None, [vertical_sentence(beginning.radii), alignment_sentence(config, measured)]),
        *others,
        *remarks(config, points, fitted, result.tyre.values, wide),
        *([f"{begun(moved)}."] if moved and not contradicted else []),
    )
    warned = (
        *([moved] if contradicted else []),
        *warnings(found.full, result.doubts, result.outliers, files.untested),
        *result.mounts,
        *nominal_pressure_sentences(files),
        *(confounding_sentence(row, modelled=found.at_temperature) for row in result.confounded),
    )
    return explained, warned


def _fitted_and_judged(
    config: Config, problem: FitProblem, start: Mapping[str, float], plan: FitPlan, progress: Progress
) -> tuple[NuisanceFit, LinearisedFit, tuple[Doubt, ...]]:
    """The fits to all points, the linear model of the full fit's residuals, and the sweeps that contradict the others.

    An InputError ends the build if a sweep contradicts the others beyond plausibility.
    """

    found = fit_with_nuisances(config, problem, start, plan, progress)
    progress(PREDICTING)

    def mostly_rejected(name: str, rows: np.ndarray) -> bool:
        read = np.isfinite(problem.points.channel(name)[rows]) & np.isfinite(problem.sigma[name][rows])
        return bool(2 * np.sum(read & np.isfinite(found.stated.sigma[name][rows])) < np.sum(read))

    def refit(without: np.ndarray) -> FittedModel:
        others = np.setdiff1d(np.arange(len(problem.points)), without)
        here = replace(found.stated, simulation=found.full.simulation).select(others)
        fitted = refitted(found.full, here, tolerance=constants.REFIT_TOLERANCE)
        sigma = {name: weights.copy() for name, weights in found.full.problem.sigma.items()}
        for name, weights in sigma.items():
            # Outliers are single readings; where most of a sweep are, the sweep itself is judged.
            stated = problem if mostly_rejected(name, without) else found.stated
            weights[without] = stated.sigma[name][without]
        return FittedModel(
            fitted.simulation, left_by(fitted, replace(found.full.problem, sigma=sigma), without, near=left)
        )

    left = left_by(found.full, near=found.left)
    fitted = FittedModel(found.full.simulation, left)
    with as_declared(config):
        doubts = after_the_fit(
            JudgedSweeps(problem.points, axis_signs(config), fitted, refit, mostly_rejected)
        )
    return found, left, doubts


def _epsilon_gamma(values: Mapping[str, Any], points: Points, measured: Measured) -> float | None:
    """eps_gamma of the fitted model; None on a flat track."""
    row = measured.nominal
    if row is None or row.epsilon_gamma is None or row.r_e is None:
        return None
    return epsilon_gamma_of_model(values, points, row.load, row.r_e.value)
