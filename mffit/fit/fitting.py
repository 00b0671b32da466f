"""``fit``: from points and direct measurements to the property files."""

from __future__ import annotations

import time
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np

from mffit.config import Declaration, axis_signs, declared_rig
from mffit.config.declared import as_declared
from mffit.constants import USUAL_CORNERING_STIFFNESS
from mffit.fit import agreement
from mffit.fit.between_runs import between_runs
from mffit.fit.by_hand import hand_of
from mffit.fit.campaign import FittedCampaign, Joined, campaign_sentence, join
from mffit.fit.coefficients import Coefficient, coefficient_records, of_file
from mffit.fit.comments import file_comments
from mffit.fit.confounding import confounding_sentence, confoundings
from mffit.fit.files import Files, make_files, plain_use
from mffit.fit.fitted import Fitted
from mffit.fit.known import Known, known_after_fit, known_before_fit
from mffit.fit.nuisance_choice import at_reference
from mffit.fit.nuisance_wording import nuisance_sentences
from mffit.fit.overturning import overturning_terms
from mffit.fit.plan import FitPlan, fit_plan
from mffit.fit.posterior import Posterior
from mffit.fit.priors import of_fleet
from mffit.fit.problem import FitProblem, fit_problem
from mffit.fit.relaxation import Relaxation, relaxation, relaxation_sentence
from mffit.fit.remarks import with_remarks
from mffit.fit.result import FitResult
from mffit.fit.rolling import MY_ZERO, rolling_resistance
from mffit.fit.sister import Lent, Sister, lend, sister_of, sister_sentence
from mffit.fit.start import starting_values
from mffit.fit.temperature import at_temperature
from mffit.fit.vertical import Vertical, vertical_coefficients, vertical_sentence
from mffit.fit.virtual_zero import epsilon_gamma_of_model
from mffit.fit.with_nuisances import NuisanceFit, fit_with_nuisances
from mffit.fit.wording import explanations, warnings
from mffit.fit.zeros import turning_zeros
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
    steps: Points | None = None,
    campaigns: Sequence[FittedCampaign] = (),
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
    steps : samples of steps of the sideslip angle, if there are any
    campaigns : others of the same tyre, whose coefficients are taken where these points determine none

    Raises
    ------
    InputError
        If there are fewer points than coefficients, or a sweep contradicts all others beyond plausibility.
    """
    began = time.perf_counter()
    fleet = of_fleet(config)
    hand = hand_of(config, base)
    sister = sister_of(config, base, points)
    elsewhere = {name: x for other in campaigns for name, x in other.vertical().items()}
    known = known_before_fit(config, points, measured, base, fleet, hand, elsewhere)
    settled = {*hand.held, *(name for name, origin in known.origin.items() if origin == "measured")}
    radii = vertical_coefficients(known.values, points, settled)
    known = known.having({name: q.value for name, q in radii.found.items()}, "fitted")
    rolling = points.select(points.free_rolling) if np.any(points.free_rolling) else points
    turning = None if "PECP1" in hand.held else turning_zeros(known.values, rolling, measured)
    overturning = overturning_terms(points, known.values, config.tyre.side or "left", hand)
    start = {
        **starting_values(known.values, points, measured, hand.held),
        **overturning.start,
        **(turning.start if turning else {}),
    }
    plan = fit_plan(config, points, measured, known, start, fleet, turning, overturning.predicting)
    start = hand.starting(start)
    problem = fit_problem(config, points, measured, known.values, plan.channels)
    found, doubts = _fitted_and_judged(config, problem, start, plan, progress)
    fitted, full = found.plain, found.full
    readings, best = (fit.simulation.readings(points, problem.channels) for fit in (fitted, full))
    outlying = outliers(points, problem.sigma, full.problem.sigma, best)

    progress("deriving the property files")
    use = plain_use(config)
    after, coefficients, files, lent, lag, joined, posterior, zeros = _delivered(
        config, known, points, steps, measured, base, fitted, radii, sister, campaigns
    )
    temperature = None
    if found.at_temperature:
        special = _delivered(
            config, known, points, steps, measured, base, full, radii, sister, campaigns, only=use
        )
        own = of_file(special.files, use, special.coefficients)
        temperature = at_temperature(found, points, special.files.by_use[use], own)

    runs = between_runs(found, points)
    confounded = confoundings(replace(full, problem=at_reference(config, full.problem)))
    channels = agreement.with_points(readings, points)
    result = FitResult(
        tyre=files.by_use["turn-slip" if config.rig.on_disc else "normal"].tyre,
        written=files.by_use[use].tyre,
        coefficients=of_file(files, use, coefficients),
        channels=channels,
        odd=agreement.with_odd_part(files.by_use["normal"].tyre.values, points, parts),
        simulation=fitted.simulation,
        rig={**fitted.rig, **zeros},
        model=readings,
        posterior=posterior,
        stages=fitted.stages,
        coverage=(*plan.cover, lag.coverage),
        explanations=(
            *nuisance_sentences(config.tyre.name, found, temperature, runs, channels),
            *explanations(config, files, after.values, measured, hand),
            *filter(None, [vertical_sentence(radii)]),
            *filter(None, [relaxation_sentence(lag)]),
            *map(campaign_sentence, joined),
            *([] if lent is None else [sister_sentence(lent)]),
        ),
        warnings=(
            *warnings(full, doubts, outlying, files.untested, plan.cover),
            *(confounding_sentence(row, modelled=found.at_temperature) for row in confounded),
        ),
        seconds=time.perf_counter() - began,
        epsilon_gamma_model=_epsilon_gamma(after.values, points, measured),
        doubts=doubts,
        outliers=outlying,
        search=fitted,
        full=full,
        files=files,
        temperature=temperature,
        choice=found.choice,
        runs=runs,
        confounded=confounded,
        radii=radii,
        lent=lent,
        joined=joined,
        relaxation=lag,
    )
    return with_remarks(result, config, points, turning, from_base=base is not None)


class _Delivered(NamedTuple):
    """What a fit writes."""

    known: Known  #: every value of the property file, with its origin
    coefficients: dict[str, Coefficient]
    files: Files
    lent: Lent | None  #: what a sister tyre gave
    relaxation: Relaxation
    joined: tuple[Joined, ...]  #: what other campaigns gave
    posterior: Posterior  #: of all of them
    zeros: Mapping[str, tuple[float, float]]  #: of My, with standard errors


def _delivered(
    config: Any,
    known: Known,
    points: Points,
    steps: Points | None,
    measured: Any,
    base: Tyre | None,
    fitted: Fitted,
    radii: Vertical,
    sister: Sister | None,
    campaigns: Sequence[FittedCampaign],
    only: str | None = None,
) -> _Delivered:
    """The files of a fit, for one use ``only`` or for all, and the records of their coefficients."""
    known = known_after_fit(known, fitted.values, fitted.regularised, base)
    side = config.tyre.side or "left"
    zero = declared_rig(config.rig, USUAL_CORNERING_STIFFNESS).get(MY_ZERO, Declaration(0.0, 0.0))
    rolling = rolling_resistance(known.values, points, zero, known.hand.held, side)
    for name, q in rolling.found.items():
        known = known.having({name: q.value}, "regularised" if name in rolling.regularised else "fitted")
    lag = relaxation(steps, fitted.simulation, fitted.posterior, known.hand.held)
    known = known.having({name: q.value for name, q in lag.found.items()}, "fitted")
    lent = None if sister is None else lend(sister, known, fitted.posterior)
    borrowed = {} if lent is None else dict(lent.found)
    known = known.having({name: q.value for name, q in borrowed.items()}, "sister")
    posterior = fitted.posterior if lent is None else lent.posterior
    joined = []
    for campaign in campaigns:
        joined.append(join(campaign, known, posterior))
        known = known.having(joined[-1].values, "campaign")
        borrowed |= {name: q for name, q in joined[-1].found.items() if q.u > 0.0}
        posterior = joined[-1].posterior
    coefficients = coefficient_records(known, fitted, {**rolling.found, **radii.found, **lag.found, **borrowed})
    files = make_files(config, known, points, base, dict(measured.by_load("C_gamma")), only=only)
    annotated = files.annotated(file_comments(files, known.origin, coefficients))
    return _Delivered(known, coefficients, annotated, lent, lag, tuple(joined), posterior, rolling.zeros)


def _fitted_and_judged(
    config: Any, problem: FitProblem, start: Mapping[str, float], plan: FitPlan, progress: Progress
) -> tuple[NuisanceFit, tuple[Doubt, ...]]:
    """The fits to all points, and the sweeps that contradict the others; one beyond plausibility ends the build."""

    def judged(found: NuisanceFit, when: When) -> tuple[Doubt, ...]:
        progress("predicting each sweep from the others")
        campaign = JudgedSweeps(
            points=problem.points,
            stated=problem.sigma,
            signs=axis_signs(config),
            refit=lambda rows: _as_model(found.refit(rows)),
        )
        with as_declared(config):
            return after_the_fit(campaign, _as_model(found.full), when)

    found = fit_with_nuisances(
        config, problem, start, plan, progress, before_restarts=lambda first: judged(first, When.FIRST)
    )
    return found, judged(found, When.AFTER)


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


def _epsilon_gamma(values: Mapping[str, Any], points: Points, measured: Any) -> float | None:
    """eps_gamma of the fitted model; None on a flat track."""
    if measured.epsilon_gamma is None:
        return None
    return epsilon_gamma_of_model(values, points, measured.F_phit_load, measured.r_e.value)
