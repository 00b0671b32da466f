"""From points and direct measurements to the tyre that is written: one screen of calls."""

from __future__ import annotations

import dataclasses
import time
from collections.abc import Mapping
from typing import Any

import numpy as np

from mffit.fit import weights
from mffit.fit.coverage import coverage
from mffit.fit.estimates import estimates
from mffit.fit.files import Files, file_names, make_files, sentences
from mffit.fit.problem import Problem
from mffit.fit.radius import radius_coefficients
from mffit.fit.ranges import covered_ranges, envelope
from mffit.fit.result import Agreement, Coefficient, FitResult, agreement
from mffit.fit.rig_numbers import known_faults, rig_numbers
from mffit.fit.staged import Fitted, Plan, Progress, fit_staged
from mffit.fit.stages import ODD_TERMS
from mffit.fit.start import base_values, starting_values
from mffit.fit.virtual_zero import epsilon_gamma_of_model
from mffit.least_squares import touches
from mffit.measured import radius_readings
from mffit.parts import Parts
from mffit.points import Points
from mffit.rig import Simulation, reference_speed
from tir import Tyre
from tir.parameters import BY_NAME, TABLE

FROM_DATA = ("measured", "fitted", "regularised")
"""Statuses of values that these data decided."""


def fit(
    config: Any,
    points: Points,
    parts: Parts,
    measured: Any,
    base: Tyre | None = None,
    progress: Progress = lambda sentence: None,
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
    values, status = _before_the_fit(config, points, measured, base)
    cover = coverage(points, config.tyre.side or "left")
    start = starting_values(values, points, measured)
    free_pecp1 = config.spin.pecp1 == "model" and measured.epsilon_gamma is not None
    rig = rig_numbers(config, measured)
    extra = (*(("PECP1",) if free_pecp1 else ()), *(("Q_RE0",) if rig and config.rolling_radius else ()))
    plan = Plan(cover, start, rig, extra, noise_stated=bool(np.any(np.isfinite(points.u_Fy))))
    problem = _problem(config, points, values, measured)
    fitted = fit_staged(problem, start, plan, progress)
    fitted = _with_held_pecp1(fitted, points, measured, free_pecp1)
    turn_slip = {**values, **{n: start[n] for n in fitted.unmoved}, **fitted.values}
    if base is None:
        turn_slip.update(_unmeasured(turn_slip, status))
    turn_slip.update(_rolling_resistance(turn_slip, points, status))
    progress("deriving the files and judging them")
    disc = config.rig.type == "rotating-disk"
    coefficients = _coefficients(turn_slip, fitted, cover, status)
    written = make_files(
        config,
        turn_slip,
        points,
        base,
        status,
        {name: status_comment(c) for name, c in coefficients.items() if c.status in FROM_DATA},
        _by_load(measured, "C_gamma"),
    )
    names = file_names(config.tyre.name, config.spin.exact, disc)
    explanations = sentences(written, names)
    if measured.epsilon_gamma is not None:
        explanations.append(_pecp1_sentence(config, turn_slip, measured))
    use = config.spin.exact if disc else "normal"
    normal = written.by_use["normal"].tyre
    Fy, Mz = fitted.simulation.readings(points)
    return FitResult(
        tyre=written.by_use["turn-slip" if disc else "normal"].tyre,
        written=written.by_use[use].tyre,
        coefficients=_of_file(written, use, _coefficients(turn_slip, fitted, cover, status), status),
        channels={"Fy": agreement(Fy, points.Fy), "Mz": agreement(Mz, points.Mz)},
        odd=_odd_agreement(normal.values, points, parts),
        Fy_model=Fy,
        Mz_model=Mz,
        simulation=fitted.simulation,
        rig=fitted.rig,
        stages=fitted.stages,
        coverage=cover,
        explanations=tuple(explanations),
        warnings=tuple(_warnings(fitted, points)),
        seconds=time.perf_counter() - began,
        epsilon_gamma_model=_epsilon_of_model(turn_slip, points, measured),
        files=written,
    )


def _before_the_fit(config, points: Points, measured, base) -> tuple[dict[str, Any], dict[str, str]]:
    """Every value before the fit, and where it comes from."""
    values = base_values(config, base)
    origin = "base" if base is not None else "default"
    status = {row.name: origin for row in TABLE}
    if base is not None:
        status.update({row.name: "default" for row in TABLE if row.name not in base.present})
    if base is None:  # before the fit, because the vertical terms among them decide the rolling radius
        values.update(_unmeasured(values, status))
    ranges = covered_ranges(points)
    values.update(ranges)
    r_e = _by_load(measured, "r_e_measured")
    if r_e:
        radii = radius_coefficients(values, r_e, reference_speed(points))
        values.update(radii)
        status.update(dict.fromkeys(radii, "measured"))
    if measured.epsilon_gamma is not None:
        values["PECP1"], values["PECP2"] = measured.pecp1, measured.pecp2
        status["PECP1"] = status["PECP2"] = "measured"
    if config.tyre.side == "symmetric":
        values.update(dict.fromkeys(ODD_TERMS, 0.0))
    return values, status


def _problem(config, points: Points, values, measured) -> Problem:
    """Everything before the fit: points as read, weights as stated, what is known of the rig."""
    disc = config.rig.type == "rotating-disk"
    return Problem(
        points=points,
        simulation=Simulation(values, known_faults(config, measured), turn_slip=disc),
        sigma_Fy=weights.stated_or_nominal(points.u_Fy, points.Fy),
        sigma_Mz=weights.stated_or_nominal(points.u_Mz, points.Mz),
        envelope=envelope(covered_ranges(points)),
        radii=radius_readings(config) if disc else (),
        speed=reference_speed(points),
    )


def _with_held_pecp1(fitted: Fitted, points: Points, measured, free: bool) -> Fitted:
    """PECP1 is held at the measured eps_gamma: its uncertainty goes on to every coefficient and rig error, to first order."""
    if free or measured.epsilon_gamma is None:
        return fitted
    names = [*fitted.names, "PECP1"]
    slope = np.concatenate(fitted.simulation.sensitivities(points, names)[1])
    slope /= np.concatenate([fitted.sigma_Fy, fitted.sigma_Mz])[:, None]
    shift = -fitted.covariance @ (slope[:, :-1].T @ slope[:, -1]) * measured.epsilon_gamma.u
    covariance = fitted.covariance + np.outer(shift, shift)
    errors = dict(zip(fitted.names, np.sqrt(np.diag(covariance)).tolist(), strict=True))
    rig = {name: (value, errors[name]) for name, (value, _) in fitted.rig.items()}
    return dataclasses.replace(fitted, covariance=covariance, stderr=errors, rig=rig)


def _by_load(measured, key: str) -> dict[float, float]:
    return dict(measured.by_load(key))


def _unmeasured(values: Mapping[str, Any], status: dict[str, str]) -> dict[str, float]:
    found = {n: v for n, v in estimates(values).items() if status.get(n) not in ("measured",)}
    status.update(dict.fromkeys(found, "estimate"))
    return found


def _rolling_resistance(
    values: Mapping[str, Any], points: Points, status: dict[str, str]
) -> dict[str, float]:
    """QSY1 from measured My, the other terms of the rolling resistance as they are."""
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
    status["QSY1"] = "fitted"
    return {"QSY1": float(slope @ (chosen.My - at_zero) / (slope @ slope))}


def _coefficients(values, fitted: Fitted, cover, status: Mapping[str, str]) -> dict[str, Coefficient]:
    """One record per number of the file."""
    stage_of = {row.name: row.stage for row in TABLE}
    out = {}
    for row in TABLE:
        if row.kind != "number":
            continue
        free = row.name in fitted.values
        state = status.get(row.name, "default")
        if free and row.stage:
            state = "regularised" if row.name in fitted.regularised else "fitted"
        partner, correlation = fitted.correlation.get(row.name, ("", 0.0))
        out[row.name] = Coefficient(
            value=float(values[row.name]),
            stderr=fitted.stderr.get(row.name),
            stage=stage_of[row.name],
            fixed=not free,
            at_bound=row.name in fitted.at_bound,
            status=state,
            correlated_with=partner,
            correlation=correlation,
        )
    return out


def _of_file(
    files: Files, use: str, coefficients: Mapping[str, Coefficient], status: Mapping[str, str]
) -> dict[str, Coefficient]:
    """The records of the file with the plain name: its values, and the origin of each as the file states it."""
    tyre = files.by_use[use].tyre
    derived = files.changed if use == "normal" else ()
    out = {}
    for name, c in coefficients.items():
        value, origin = float(tyre[name]), tyre.status[name]
        out[name] = dataclasses.replace(c, value=value, origin=origin)
        if name in derived:
            bound = touches(value, *BY_NAME[name].bounds)
            out[name] = Coefficient(value, None, c.stage, False, bound, "fitted", origin=origin)
    return out


def status_comment(coefficient: Coefficient) -> str:
    """How the file's comment states the origin of a value."""
    text = "tied to base value" if coefficient.status == "regularised" else coefficient.status
    if coefficient.stderr is not None and not coefficient.fixed:
        text += f" +- {coefficient.stderr:.2g}"
    return text + (", at bound" if coefficient.at_bound else "")


def _odd_agreement(values, points: Points, parts: Parts) -> dict[str, Agreement]:
    """The written file against the odd part, turn slip off, without the odd shift terms that the split removes."""
    straight = points.replace(
        alpha=parts.alpha_odd, phi_t=np.zeros(len(points)), direction=np.ones_like(points.direction)
    )
    symmetric = {
        **values,
        **dict.fromkeys(
            ("PHY1", "PHY2", "PVY1", "PVY2", "PEY3", "QHZ1", "QHZ2", "QDZ6", "QDZ7", "QEZ4"), 0.0
        ),
    }
    model = Simulation(symmetric, turn_slip=False).readings(straight)
    used = (parts.paired != "unpaired") & (points.direction > 0)
    return {
        "Fy": agreement(model.Fy[used], parts.Fy_odd[used]),
        "Mz": agreement(model.Mz[used], parts.Mz_odd[used]),
    }


def _epsilon_of_model(values, points: Points, measured) -> float | None:
    if measured.epsilon_gamma is None:
        return None
    return epsilon_gamma_of_model(values, points, measured.F_phit_load, measured.r_e.value, measured.R.value)


def _pecp1_sentence(config, values, measured) -> str:
    if config.spin.pecp1 == "debiased":
        return (
            f"PECP1 = {values['PECP1']:.4f} is the measured eps_gamma {measured.epsilon_gamma.value:.4f} less what the "
            "finite spin of the disc adds to it."
        )
    if config.spin.pecp1 == "direct":
        return (
            f"PECP1 = {values['PECP1']:.4f} is the measured eps_gamma itself; the finite spin of the disc makes the "
            "model's turn-slip force differ slightly from the measured one (see epsilon_gamma_model)."
        )
    return (
        f"PECP1 = {values['PECP1']:.4f} is the joint estimate of tyre and rig, in which every point counts with its noise "
        f"and the rig's errors with what [rig] declares; the directly measured eps_gamma is {measured.epsilon_gamma.value:.4f}."
    )


NOT_TRUSTED = 2.0
"""Misfit in units of the stated noise above which a file is not to be trusted."""
CARRIES = 1.5
"""A sweep carries the misfit if its own is this many times that of all points."""


def _warnings(fitted: Fitted, points: Points) -> list[str]:
    """What a user must know of the fit, the gravest first."""
    out = []
    Fy, Mz = fitted.simulation.readings(points)
    for name, model, measured, u, scale in (
        ("Fy", Fy, points.Fy, points.u_Fy, fitted.scale[0]),
        ("Mz", Mz, points.Mz, points.u_Mz, fitted.scale[1]),
    ):
        if scale > NOT_TRUSTED and np.any(np.isfinite(u)):
            out.append(
                f"the file is not to be trusted: the model misses {name} by {scale:.1f} times the stated uncertainty"
                f"{_carriers(points, (model - measured) / u)}; look at these sweeps, or run mffit diagnose"
            )
    if fitted.attempts:
        out.append(f"the fit was started again from {', '.join(fitted.attempts)}; the best of all is kept")
    if fitted.at_bound:
        out.append(
            f"at the bound of plausible values: {', '.join(sorted(fitted.at_bound))}; check the sweeps that decide them"
        )
    return out


def _carriers(points: Points, z: np.ndarray) -> str:
    """The sweeps that carry a misfit (n,), in words."""
    known = np.isfinite(z)
    total = float(np.sqrt(np.mean(z[known] ** 2)))
    own = {
        k: float(np.sqrt(np.mean(z[known & (points.sweep == k)] ** 2)))
        for k in np.unique(points.sweep[known])
    }
    worst = [k for k in sorted(own, key=lambda k: -own[k]) if own[k] > CARRIES * total][:3]
    return f", most of it in {', '.join(points.sweep_names[k] for k in worst)}" if worst else ""
