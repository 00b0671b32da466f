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
from mffit.fit.bands import bands
from mffit.fit.beginning import begin
from mffit.fit.coefficients import of_file
from mffit.fit.delivery import Beside, deliver
from mffit.fit.fitted import left_by, with_errors_of
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
from mffit.prediction import predictor
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
    hand, known, radii, turning, start, plan, problem = begin(config, points, measured, base)
    found, left_by_formula, doubts = _fitted_and_judged(config, problem, start, plan, progress)
    fitted, full = found.plain, found.full
    full = with_errors_of(full, left_by_formula)
    if found.at_temperature:
        left_by_file = left_by(fitted, near=left_by_formula)
        fitted = with_errors_of(fitted, left_by_file)
    else:
        left_by_file, fitted = left_by_formula, full
    found = replace(found, plain=fitted, full=full)
    # Pressure is an input of a property file, which has no coefficient for these effects of it, so they are switched off.
    delivered = without_terms(fitted, [P_REF])
    readings, best = (one.readings(points, problem.channels) for one in (delivered, full.simulation))
    outlying = outliers(points, problem.sigma, found.stated.sigma, best)
    at_turns = full.problem.turning()

    progress(DERIVING)
    use = plain_use(config)
    beside = Beside(radii, steps)
    made = deliver(config, known, points, base, fitted, beside)
    files = made.files
    temperature, setups = None, scatter_of_setups(config, measured)
    if found.at_temperature:
        special = deliver(config, known, points, base, full, beside, only=use)
        own = of_file(special.files, use, special.coefficients)
        file = special.files.by_use[use]
        temperature = at_temperature(found, points, file, own, left_by_formula, setups)

    runs, speed = between_runs(found, points), over_speed(found, points)
    confounded = confoundings(replace(full, problem=at_reference(config, full.problem)))
    channels = agreement.with_points(readings, points)
    tyre = files.by_use["turn-slip" if config.rig.on_disc else "normal"].tyre
    simulation = Simulation(tyre.values, turn_slip=config.rig.on_disc)
    found_rig = {name: value for name, (value, _) in fitted.rig_stated.items()}
    known_forces, with_zeros = (
        predictor(points, left_by_file, found_rig, exact, setups=setups).stating(fitted.posterior)
        for exact in ((), zeros_of_rig(fitted.zeros))
    )
    wide = bands(known_forces, fitted.held, simulation, points, with_zeros)
    turned = undeclared_mount.find(points, FittedModel(full.simulation, left_by_formula))
    mounts = tuple(map(undeclared_mount.said, turned))
    modelled, others = nuisance_sentences(config.tyre.name, found, temperature, runs, channels)
    moved, contradicted = (
        ("", False) if turning is None else zeros_sentence(turning, fitted, from_base=base is not None)
    )
    return FitResult(
        tyre=tyre,
        written=files.by_use[use].tyre,
        coefficients=of_file(files, use, made.coefficients),
        channels=channels,
        odd=agreement.with_odd_part(files.by_use["normal"].tyre.values, points, parts),
        simulation=delivered,
        rig={**fitted.rig_stated, **made.zeros},
        model=readings,
        posterior=made.posterior,
        coverage=(*found.plan.cover, *(direction.coverage for direction in made.relaxation)),
        explanations=(
            *modelled,
            *explanations(config, files, made.known.values, measured, hand),
            *filter(None, [vertical_sentence(radii), alignment_sentence(config, measured)]),
            *others,
            *remarks(config, points, fitted, tyre.values, wide),
            *([f"{begun(moved)}."] if moved and not contradicted else []),
        ),
        warnings=(
            *([moved] if contradicted else []),
            *warnings(full, doubts, outlying, files.untested),
            *mounts,
            *nominal_pressure_sentences(files),
            *turning_sentences(points, best, at_turns),
            *(confounding_sentence(row, modelled=found.at_temperature) for row in confounded),
        ),
        seconds=time.perf_counter() - began,
        epsilon_gamma_model=_epsilon_gamma(made.known.values, points, measured),
        doubts=doubts,
        mounts=mounts,
        outliers=outlying,
        at_turns=at_turns,
        search=fitted,
        full=full,
        left_by_formula=left_by_formula,
        left_by_file=left_by_file,
        files=files,
        temperature=temperature,
        speed=speed,
        choice=found.choice,
        runs=runs,
        confounded=confounded,
        radii=radii,
        bands=wide,
        prediction=known_forces,
        relaxation=made.relaxation,
    )


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
