"""``fit``: from points and direct measurements to the property files."""

from __future__ import annotations

import time
from collections.abc import Mapping
from typing import Any

import numpy as np

from mffit.config import axis_signs
from mffit.config.declared import as_declared
from mffit.fit import agreement
from mffit.fit.by_hand import hand_of
from mffit.fit.coefficients import coefficient_records, of_file
from mffit.fit.comments import file_comments
from mffit.fit.files import make_files
from mffit.fit.fitted import Fitted
from mffit.fit.known import known_after_fit, known_before_fit
from mffit.fit.plan import FitPlan, fit_plan
from mffit.fit.priors import of_fleet
from mffit.fit.problem import FitProblem, fit_problem
from mffit.fit.result import FitResult
from mffit.fit.rolling import rolling_resistance
from mffit.fit.staged import fit_staged
from mffit.fit.start import starting_values
from mffit.fit.virtual_zero import epsilon_gamma_of_model
from mffit.fit.wording import explanations, warnings
from mffit.parts import Parts
from mffit.points import Points
from mffit.progress import Progress, silent
from mffit.suspicion import Doubt, FittedModel, JudgedSweeps, When, after_the_fit, outliers
from tir import Tyre


def fit(
    config: Any,
    points: Points,
    parts: Parts,
    measured: Any,
    base: Tyre | None = None,
    progress: Progress = silent,
) -> FitResult:
    """Fit MF 6.2 to raw points with turn slip on, holding what was measured directly.

    Parameters
    ----------
    config : the validated ``tyre.toml``
    points : raw points, angles as read
    parts : their odd and even parts
    measured : the direct method's result; ``epsilon_gamma`` None on a flat track
    base : property file with the values that are not fitted, if there is one
    progress : called with a sentence before each step

    Raises
    ------
    InputError
        If there are fewer points than coefficients, or a sweep contradicts all others beyond plausibility.
    """
    began = time.perf_counter()
    fleet = of_fleet(config)
    hand = hand_of(config, base)
    known = known_before_fit(config, points, measured, base, fleet, hand)
    start = starting_values(known.values, points, measured, hand.held)
    plan = fit_plan(config, points, measured, known, start, fleet)
    start = hand.starting(start)
    problem = fit_problem(config, points, measured, known.values)
    fitted, doubts = _fitted_and_judged(config, problem, start, plan, progress)
    readings = fitted.simulation.readings(points)
    outlying = outliers(points, _sigma(problem), _sigma(fitted.problem), readings)

    progress("deriving the property files")
    known = known_after_fit(known, fitted.values, fitted.regularised, base)
    rolling = {} if "QSY1" in hand.held else rolling_resistance(known.values, points)
    known = known.having({name: QSY1.value for name, QSY1 in rolling.items()}, "fitted")
    coefficients = coefficient_records(known, fitted, rolling)
    files = make_files(config, known, points, base, dict(measured.by_load("C_gamma")))
    files = files.annotated(file_comments(files, known.origin, coefficients))
    use = config.spin.exact if config.rig.on_disc else "normal"

    return FitResult(
        tyre=files.by_use["turn-slip" if config.rig.on_disc else "normal"].tyre,
        written=files.by_use[use].tyre,
        coefficients=of_file(files, use, coefficients),
        channels=agreement.with_points(readings, points),
        odd=agreement.with_odd_part(files.by_use["normal"].tyre.values, points, parts),
        simulation=fitted.simulation,
        rig=fitted.rig,
        Fy_model=readings.Fy,
        Mz_model=readings.Mz,
        posterior=fitted.posterior,
        stages=fitted.stages,
        coverage=plan.cover,
        explanations=tuple(explanations(config, files, known.values, measured, hand)),
        warnings=warnings(fitted, doubts, outlying, files.untested, plan.cover),
        seconds=time.perf_counter() - began,
        epsilon_gamma_model=_epsilon_gamma(known.values, points, measured),
        doubts=doubts,
        outliers=outlying,
        search=fitted,
        files=files,
    )


def _fitted_and_judged(
    config: Any, problem: FitProblem, start: Mapping[str, float], plan: FitPlan, progress: Progress
) -> tuple[Fitted, tuple[Doubt, ...]]:
    """The fit to all points, and the sweeps that contradict the others; one beyond plausibility ends the build."""

    campaign = JudgedSweeps(
        points=problem.points,
        stated=_sigma(problem),
        signs=axis_signs(config),
        refit=lambda rows: _as_model(fit_staged(problem.select(rows), start, plan, silent, restarts=False)),
    )

    def judged(fitted: Fitted, when: When) -> tuple[Doubt, ...]:
        progress("predicting each sweep from the others")
        with as_declared(config):
            return after_the_fit(campaign, _as_model(fitted), when)

    fitted = fit_staged(
        problem, start, plan, progress, before_restarts=lambda first: judged(first, When.FIRST)
    )
    return fitted, judged(fitted, When.AFTER)


def _as_model(fitted: Fitted) -> FittedModel:
    """The fit as the rules of suspicion use it."""
    return FittedModel(
        points=fitted.problem.points,
        simulation=fitted.simulation,
        weights=fitted.problem.sigma,
        numbers=fitted.numbers,
        names=fitted.posterior.names,
        covariance=fitted.posterior.covariance,
        scale=fitted.scale,
    )


def _sigma(problem: FitProblem) -> tuple[np.ndarray, np.ndarray]:
    """Uncertainty of Fy and Mz (n,) that the problem uses as weight."""
    return problem.sigma["Fy"], problem.sigma["Mz"]


def _epsilon_gamma(values: Mapping[str, Any], points: Points, measured: Any) -> float | None:
    """eps_gamma of the fitted model; None on a flat track."""
    if measured.epsilon_gamma is None:
        return None
    return epsilon_gamma_of_model(values, points, measured.F_phit_load, measured.r_e.value)
