"""Lateral stiffness of the carcass from steps of the sideslip angle: the relaxation length is cornering stiffness over it.

A property file of FITTYP 62 holds sigma_y as K_ya / C_y with C_y = LATERAL_STIFFNESS (1 + PCFY1 dfz + PCFY2 dfz^2)(1 + PCFY3 dpi)
(A9). The side force of the fitted tyre follows the sideslip angle over sigma_y; its offset and gain are free in every run of
steps, so that only the delay counts.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, field
from types import SimpleNamespace
from typing import Any

import numpy as np

from mffit.fit import constants
from mffit.fit.beside import BesideNumbers
from mffit.fit.coverage import StageCoverage
from mffit.fit.posterior import Posterior
from mffit.fit.upright import sideways
from mffit.least_squares import FreeNumber, of_model, solve
from mffit.points import Points, levels
from mffit.rig import Simulation
from mffit.rounding import ascii_only, to_uncertainty
from tir import Quantity, Tyre
from tir.derivatives import gradient, plain, traced
from tir.equations import normalise
from tir.equations.forces import carcass_stiffness
from tir.parameters import BY_NAME

LAG = "relaxation_m"
NAMES = ("LATERAL_STIFFNESS", "PCFY1", "PCFY2", "PCFY3")
BOUNDS = {"PCFY1": (-3.0, 3.0), "PCFY2": (-3.0, 3.0), "PCFY3": (-3.0, 3.0)}
RUN = (
    "no recording steps the sideslip angle fast enough: roll at about 1 m/s, at two or three loads, step it 0, 1, 0, -1, 0 deg "
    "within a fraction of a second, hold each angle for 6 s, and record at 20 Hz"
)
"""What is missing, and the run that measures it."""
UNCLEAR = (
    "the steps do not show the relaxation length beyond their noise: hold each angle longer, or step further"
)


@dataclass(frozen=True, slots=True)
class StepLength:
    """The relaxation length that one run of steps shows."""

    file: str
    load: float  #: [N]
    pressure: float  #: [Pa]
    length: Quantity  #: [m]
    stiffness: Quantity  #: of the carcass [N/m], where the cornering stiffness is exact
    written: float = math.nan  #: relaxation length of the file there [m]


@dataclass(frozen=True, slots=True)
class Relaxation:
    """What steps of the sideslip angle determine."""

    runs: tuple[StepLength, ...] = ()
    found: Mapping[str, Quantity] = field(default_factory=dict)
    beside: BesideNumbers = field(default_factory=BesideNumbers)  #: the same with their covariance
    missing: str = RUN  #: why the others, or all, are held

    @property
    def coverage(self) -> StageCoverage:
        """The row of the coverage matrix."""
        free = tuple(self.found)
        held = tuple(name for name in NAMES if name not in free)
        return StageCoverage(
            stage="relaxation",
            title="Relaxation",
            supported=bool(free),
            free=free,
            held=held,
            missing=(self.missing,) if held and self.missing else (),
        )


def relaxation(
    steps: Points | None, simulation: Simulation, posterior: Posterior, held: Collection[str] = ()
) -> Relaxation:
    """Carcass stiffness over load and pressure, with standard uncertainties; coefficients ``held`` by hand stay.

    Parameters
    ----------
    steps : samples of the runs of steps, one sweep each; None without any
    simulation : the fitted tyre on its rig
    posterior : of the fit
    """
    if steps is None:
        return Relaxation()
    runs = [_of_run(steps.select(steps.sweep == k), simulation) for k in np.unique(steps.sweep)]
    clear = [run for run in runs if run.length.u < constants.FITTED_SHARE_OF_PRIOR * run.length.value]
    if not clear:
        return Relaxation(missing=UNCLEAR)
    values = simulation.values
    loads = levels.count(np.array([run.load for run in clear]), levels.LOAD)
    pressures = levels.count(np.array([run.pressure for run in clear]), levels.PRESSURE)
    names = ["LATERAL_STIFFNESS", *("PCFY1", "PCFY2")[: loads - 1], *(["PCFY3"] if pressures > 1 else [])]
    lacking = [
        *([f"3 loads are needed, steps were run at {loads}"] if loads < 3 else []),
        *(["steps were run at one pressure"] if pressures < 2 else []),
    ]
    names = [name for name in names if name not in held]
    beside = _fitted(names, values, clear, posterior)
    at = {**values, **beside.values}
    written = tuple(
        StepLength(run.file, run.load, run.pressure, run.length, run.stiffness, _length(run, at))
        for run in clear
    )
    u = posterior.with_numbers(beside).stderr
    found = {name: Quantity(x, u[name], BY_NAME[name].unit) for name, x in beside.values.items()}
    return Relaxation(written, found, beside, "; ".join(lacking))


def _of_run(samples: Points, simulation: Simulation) -> StepLength:
    """The relaxation length at which the fitted tyre, lagging, follows the readings best."""
    radius = float(simulation.values["UNLOADED_RADIUS"])
    used = np.isfinite(samples.Fy)
    sigma, move = radius, math.inf
    simulation = simulation.with_numbers({"hysteresis_deg": 0.0})
    for _ in range(constants.REFIT_STEPS):
        readings, slopes = simulation.with_numbers({LAG: sigma}).sensitivities(samples, [LAG], ("Fy",))
        model, slope = readings["Fy"][used], slopes["Fy"][used, 0]
        plain_fit = np.column_stack([np.ones(len(model)), model])
        offset, gain = np.linalg.lstsq(plain_fit, samples.Fy[used], rcond=None)[0]
        residual = samples.Fy[used] - offset - gain * model
        design = np.column_stack([plain_fit, gain * slope])
        move = float(np.linalg.lstsq(design, residual, rcond=None)[0][2])
        sigma = float(np.clip(sigma + move, 0.5 * sigma, 2.0 * sigma))
        if abs(move) < constants.REFIT_TOLERANCE * sigma:
            break
    variance = float(residual @ residual) / max(len(residual) - 3, 1) * _correlation(residual)
    u = math.sqrt(variance * float(np.linalg.pinv(design.T @ design)[2, 2]))
    u = u if abs(move) < max(u, constants.STAGE_TOLERANCE * sigma) else math.inf  # not converged
    load, pressure = float(np.mean(samples.Fz)), float(np.mean(samples.p))
    state = Tyre.from_values(simulation.values).state(
        load, 0.0, float(np.mean(samples.gamma)), phi_t=float(samples.phi_t[0]), p=pressure,
        turn_slip=simulation.turn_slip,
    )  # fmt: skip
    C = abs(float(state.K_ya)) / sigma
    return StepLength(
        samples.files[int(samples.file[0])],
        load,
        pressure,
        Quantity(sigma, u, "m"),
        Quantity(C, u / sigma * C, "N/m"),
    )


def _correlation(residual: np.ndarray) -> float:
    """Factor by which correlation of the residuals in time increases the variance of what they determine."""
    x = residual - residual.mean()
    power = float(x @ x) or 1.0
    total = 1.0
    for k in range(1, len(x) // 4):
        rho = float(x[k:] @ x[:-k]) / power
        if rho < 2.0 / math.sqrt(len(x)):
            break
        total += 2.0 * rho
    return total


def _stiffness(values: Mapping[str, Any], load: Any, pressure: Any) -> Any:
    p = SimpleNamespace(**values)
    q = normalise.inputs(p, load, load, 0.0, 0.0, 0.0, 0.0, pressure, False, False)
    return carcass_stiffness(p.LATERAL_STIFFNESS, p.PCFY1, p.PCFY2, p.PCFY3, q)


def _length(run: StepLength, values: Mapping[str, Any]) -> float:
    """Relaxation length [m] of the file at the conditions of a run."""
    return float(run.length.value * run.stiffness.value / _stiffness(values, run.load, run.pressure))


def _fitted(
    names: Sequence[str], values: Mapping[str, Any], runs: Sequence[StepLength], posterior: Posterior
) -> BesideNumbers:
    """The coefficients that fit the carcass stiffnesses of the runs; they follow the cornering stiffness of the fit."""
    if not names:
        return BesideNumbers()
    load, pressure = (np.array([getattr(run, name) for run in runs]) for name in ("load", "pressure"))
    measured, u = (np.array([run.stiffness[k] for run in runs]) for k in (0, 1))
    start = {**values, "LATERAL_STIFFNESS": float(np.median(measured)), **dict.fromkeys(names[1:], 0.0)}
    bounds = {**BOUNDS, "LATERAL_STIFFNESS": (0.1 * measured.min(), 10.0 * measured.max())}
    numbers = [FreeNumber(name, float(start[name]), *bounds[name]) for name in names]

    def stiffness(free: Mapping[str, Any]) -> Any:
        return _stiffness({**values, **free}, load, pressure)

    end = solve(of_model(stiffness, names, measured, u), numbers, tolerance=1e-9)
    freedom = len(runs) - len(names)
    scale = max(1.0, float(end.data @ end.data) / freedom) if freedom > 0 else 1.0
    fitted = tuple(name for name in posterior.names if name in BY_NAME)
    free = traced({name: float(values[name]) for name in fitted})
    _, K_ya = sideways({**values, **free}, load, pressure)
    relative = gradient(K_ya, list(free.values())) / np.reshape(plain(K_ya), (-1, 1)) if fitted else 0.0
    by_stiffness = end.covariance @ end.jacobian.T / u
    return BesideNumbers(
        values=dict(end.values),
        covariance=scale * end.covariance,
        leans_on=fitted,
        slope=by_stiffness @ (measured[:, None] * relative) if fitted else np.zeros((len(names), 0)),
    )


def relaxation_sentence(found: Relaxation) -> str:
    """The relaxation lengths that steps show, and the coefficients; empty without any."""
    if not found.found:
        return ""
    lengths = ", ".join(
        f"{1e3 * run.length.value:.0f} +- {1e3 * run.length.u:.0f} mm at {run.load:.0f} N"
        for run in found.runs
    )
    numbers = ", ".join(f"{name} {to_uncertainty(q.value, q.u)}" for name, q in found.found.items())
    return ascii_only(
        f"Relaxation length of the side force, from steps of the sideslip angle: {lengths}. So {numbers}."
    )
