"""From points and direct measurements to the tyre that is written: one screen of calls."""

from __future__ import annotations

import dataclasses
import math
import time
from collections.abc import Mapping
from typing import Any

import numpy as np

from mffit.config import axis_signs
from mffit.config.declared import as_declared
from mffit.fit import weights
from mffit.fit.coverage import coverage
from mffit.fit.estimates import estimates
from mffit.fit.files import Files, decisions, file_names, make_files
from mffit.fit.known import Known
from mffit.fit.posterior import COVERING
from mffit.fit.priors import Prior, of_fleet, scatters
from mffit.fit.problem import Problem
from mffit.fit.radius import radius_coefficients
from mffit.fit.ranges import covered_ranges, envelope
from mffit.fit.result import Agreement, Coefficient, FitResult, agreement
from mffit.fit.rig_numbers import known_faults, rig_numbers
from mffit.fit.staged import Fitted, Plan, fit_staged
from mffit.fit.stages import ODD_TERMS, STAGES
from mffit.fit.start import base_values, starting_values
from mffit.fit.virtual_zero import epsilon_gamma_of_model
from mffit.fit.wording import (
    file_comments,
    pecp1_sentence,
    sentences,
    warnings,
)
from mffit.least_squares import touches
from mffit.measured import radius_readings
from mffit.parts import Parts
from mffit.points import Points
from mffit.progress import Progress, silent
from mffit.quantities import CHANNELS
from mffit.rig import Simulation, reference_speed
from mffit.suspicion import (
    Campaign,
    Doubt,
    FittedModel,
    Misfit,
    When,
    about,
    after_the_fit,
    distrust,
    outliers,
)
from tir import Tyre
from tir.parameters import BY_NAME, TABLE


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
    base : coefficients that are not fitted come from here
    progress : called with a sentence before each step

    Raises
    ------
    InputError
        If there are fewer points than coefficients.
    """
    began = time.perf_counter()
    learnt = of_fleet(config)
    known = _before_the_fit(config, points, measured, base, learnt)
    start = starting_values(known.values, points, measured)
    plan = _plan(config, points, measured, known, start, learnt)
    problem = _problem(config, points, known.values, measured)
    stated = problem.sigma_Fy, problem.sigma_Mz

    campaign = Campaign(
        points=points,
        stated=stated,
        signs=axis_signs(config),
        refit=lambda rows: _solved(fit_staged(problem.select(rows), start, plan, silent, restarts=False)),
    )

    def judged(of: Fitted, when: When) -> tuple[Doubt, ...]:
        progress("judging every sweep by all others")
        with as_declared(config):
            return after_the_fit(campaign, _solved(of), when)

    fitted = fit_staged(problem, start, plan, progress, first=lambda of: judged(of, When.FIRST))
    doubts = judged(fitted, When.AFTER)
    known = _after_the_fit(known, fitted, base)
    progress("deriving the files and judging them")
    known = known.deciding(decisions(config))
    rolling = _rolling_resistance(known.values, points)
    known = known.having({name: value for name, (value, _) in rolling.items()}, "fitted")
    coefficients = _coefficients(known, fitted, {name: u for name, (_, u) in rolling.items()})
    written = make_files(config, known, points, base, dict(measured.by_load("C_gamma")))
    written = written.annotated(file_comments(written, known.origin, coefficients))
    disc = config.rig.on_disc
    explanations = sentences(written, file_names(config.tyre.name, config.spin.exact, disc))
    if measured.epsilon_gamma is not None:
        explanations.append(pecp1_sentence(config, known.values, measured))
    use = config.spin.exact if disc else "normal"
    readings = fitted.simulation.readings(points)
    channels = {name: agreement(getattr(readings, name), getattr(points, name)) for name in CHANNELS}
    untrusted = distrust(
        Misfit(
            points=points,
            model=readings,
            scale=fitted.scale,
            r2={name: found.r2 for name, found in channels.items()},
        )
    )
    singled = outliers(points, stated, (fitted.problem.sigma_Fy, fitted.problem.sigma_Mz), readings)
    return FitResult(
        tyre=written.by_use["turn-slip" if disc else "normal"].tyre,
        written=written.by_use[use].tyre,
        coefficients=_of_file(written, use, coefficients),
        channels=channels,
        odd=_odd_agreement(written.by_use["normal"].tyre.values, points, parts),
        Fy_model=readings.Fy,
        Mz_model=readings.Mz,
        simulation=fitted.simulation,
        rig=fitted.rig,
        posterior=fitted.posterior,
        search=fitted,
        stages=fitted.stages,
        coverage=plan.cover,
        explanations=tuple(explanations),
        distrusted=untrusted,
        warnings=(
            *untrusted,
            *warnings(fitted),
            *(about(doubt) for doubt in doubts),
            *([about(singled)] if singled else []),
        ),
        doubts=doubts,
        outliers=singled,
        seconds=time.perf_counter() - began,
        epsilon_gamma_model=_epsilon_of_model(known.values, points, measured),
        files=written,
    )


def _solved(fitted: Fitted) -> FittedModel:
    """The fit as the suspicions see it."""
    return FittedModel(
        points=fitted.problem.points,
        simulation=fitted.simulation,
        weights=(fitted.problem.sigma_Fy, fitted.problem.sigma_Mz),
        numbers=fitted.numbers,
        names=fitted.posterior.names,
        covariance=fitted.posterior.covariance,
        scale=fitted.scale,
    )


def _plan(
    config,
    points: Points,
    measured,
    known: Known,
    start: Mapping[str, float],
    learnt: Mapping[str, Prior],
) -> Plan:
    """What these points can decide, and what is known of it beforehand."""
    rig = rig_numbers(config, measured)
    extra = ["Q_RE0"] if rig and config.rolling_radius else []
    cover = coverage(points, config.tyre.side or "left")
    scatter = scatters(
        {name: start[name] for stage in STAGES for name in stage.parameters},
        known.origin,
        curved=bool(np.any(points.phi_t)),
    )
    scatter |= {name: prior.spread for name, prior in learnt.items()}
    none = ODD_TERMS if config.tyre.side == "symmetric" else frozenset()
    held = {name: scatter[name] for row in cover for name in row.held if name not in none}
    if measured.epsilon_gamma is not None:
        if config.spin.pecp1 == "model":
            extra.append("PECP1")
        else:
            debiased = measured.epsilon_gamma_debiased if config.spin.pecp1 == "debiased" else None
            held["PECP1"] = (debiased or measured.epsilon_gamma).u
    return Plan(
        cover,
        {**start, **{name: prior.expected for name, prior in learnt.items()}},
        scatter,
        rig,
        tuple(extra),
        held,
        noise_stated=bool(np.any(np.isfinite(points.u_Fy))),
    )


def _before_the_fit(
    config, points: Points, measured, base: Tyre | None, learnt: Mapping[str, Prior]
) -> Known:
    """Every value before the fit, and where it comes from."""
    values = base_values(config, base)
    present = base.present if base is not None else frozenset()
    known = Known(values, {row.name: "base" if row.name in present else "default" for row in TABLE})
    if base is None:  # before the fit, because the vertical terms among them decide the rolling radius
        known = known.having(estimates(values), "estimate")
    known = known.having({name: prior.expected for name, prior in learnt.items()}, "fleet")
    known = known.having(covered_ranges(points), "range")
    r_e = dict(measured.by_load("r_e_measured"))
    if r_e:
        known = known.having(radius_coefficients(known.values, r_e, reference_speed(points)), "measured")
    if measured.epsilon_gamma is not None:
        known = known.having({"PECP1": measured.pecp1, "PECP2": measured.pecp2}, "measured")
    if config.tyre.side == "symmetric":
        known = known.having(dict.fromkeys(ODD_TERMS, 0.0), "given")
    return known


def _after_the_fit(known: Known, fitted: Fitted, base: Tyre | None) -> Known:
    """The fitted values, and those that follow from them."""
    tied = fitted.regularised
    known = known.having({n: v for n, v in fitted.values.items() if n in tied}, "regularised")
    freed = {n: v for n, v in fitted.values.items() if n not in tied}
    known = known.having({n: v for n, v in freed.items() if not BY_NAME[n].stage})
    known = known.having({n: v for n, v in freed.items() if BY_NAME[n].stage}, "fitted")
    if base is None:  # anew, as friction and stiffness among them come from the fitted ones
        measured = [n for n, origin in known.origin.items() if origin == "measured"]
        found = {n: v for n, v in estimates(known.values).items() if n not in measured}
        known = known.having(found, "estimate")
    return known


def _problem(config, points: Points, values, measured) -> Problem:
    """Everything before the fit: points as read, weights as stated, what is known of the rig."""
    disc = config.rig.on_disc
    return Problem(
        points=points,
        simulation=Simulation(
            values, known_faults(config, measured), turn_slip=disc, radius_m=config.rig.radius or math.nan
        ),
        sigma_Fy=weights.stated_or_nominal(points.u_Fy, points.Fy),
        sigma_Mz=weights.stated_or_nominal(points.u_Mz, points.Mz),
        envelope=envelope(covered_ranges(points)),
        radii=radius_readings(config) if disc else (),
        speed=reference_speed(points),
    )


def _rolling_resistance(values: Mapping[str, Any], points: Points) -> dict[str, tuple[float, float]]:
    """QSY1 from measured My with its standard error, the other terms of the rolling resistance as they are."""
    used = np.isfinite(points.My) & (points.direction > 0)
    if not np.any(used):
        return {}
    chosen = points.select(np.flatnonzero(used))

    def moment(QSY1: float) -> np.ndarray:
        trial = Tyre.from_values(values).replace(QSY1=QSY1)
        return trial(
            chosen.Fz, chosen.alpha, chosen.gamma, phi_t=chosen.phi_t, Vx=chosen.V, p=chosen.p, turn_slip=True
        ).My

    at_zero = moment(0.0)
    slope = moment(1.0) - at_zero
    QSY1 = float(slope @ (chosen.My - at_zero) / (slope @ slope))
    scatter = float(np.sum((chosen.My - at_zero - QSY1 * slope) ** 2)) / max(len(slope) - 1, 1)
    return {"QSY1": (QSY1, math.sqrt(scatter / float(slope @ slope)))}


def _coefficients(known: Known, fitted: Fitted, rolling: Mapping[str, float]) -> dict[str, Coefficient]:
    """One record per number of the file; ``rolling`` has the errors of what was fitted after the others."""
    free = {n: fitted.posterior.stderr[n] for n in fitted.values} | dict(rolling)
    out = {}
    for row in TABLE:
        if row.kind != "number":
            continue
        partner, correlation = fitted.correlation.get(row.name, ("", 0.0))
        out[row.name] = Coefficient(
            value=float(known.values[row.name]),
            stderr=free.get(row.name),
            stage=row.stage,
            fixed=row.name not in free,
            at_bound=row.name in fitted.at_bound,
            status=known.origin[row.name],
            correlated_with=partner,
            correlation=correlation,
            interval=_interval(
                float(known.values[row.name]), free.get(row.name), fitted.intervals.get(row.name)
            ),
        )
    return out


def _interval(
    value: float, stderr: float | None, followed: tuple[float, float] | None
) -> tuple[float, float] | None:
    """95 %: as the valley shows where one was followed, else from the curvature."""
    if stderr is None:
        return None
    return followed or (value - COVERING * stderr, value + COVERING * stderr)


def _of_file(files: Files, use: str, coefficients: Mapping[str, Coefficient]) -> dict[str, Coefficient]:
    """The records of the file with the plain name: its values, and the origin of each as the file states it."""
    tyre = files.by_use[use].tyre
    derived = files.changed.get(use, ())
    out = {}
    for name, c in coefficients.items():
        value, origin = float(tyre[name]), tyre.status[name]
        out[name] = dataclasses.replace(c, value=value, origin=origin)
        if name in derived:
            bound = touches(value, *BY_NAME[name].bounds)
            out[name] = Coefficient(value, None, c.stage, False, bound, "fitted", origin=origin)
    return out


def _odd_agreement(values, points: Points, parts: Parts) -> dict[str, Agreement]:
    """The written file against the odd part, turn slip off, without the odd shift terms that the split removes."""
    straight = points.replace(
        alpha=parts.alpha_odd, phi_t=np.zeros(len(points)), direction=np.ones_like(points.direction)
    )
    model = Simulation({**values, **dict.fromkeys(ODD_TERMS, 0.0)}, turn_slip=False).readings(straight)
    used = (parts.paired != "unpaired") & (points.direction > 0)
    return {
        "Fy": agreement(model.Fy[used], parts.Fy_odd[used]),
        "Mz": agreement(model.Mz[used], parts.Mz_odd[used]),
    }


def _epsilon_of_model(values, points: Points, measured) -> float | None:
    if measured.epsilon_gamma is None:
        return None
    return epsilon_gamma_of_model(values, points, measured.F_phit_load, measured.r_e.value, measured.R.value)
