"""Carcass stiffnesses from step tests of sideslip or longitudinal slip; relaxation length = slip stiffness / carcass stiffness.

A property file of FITTYP 62 holds sigma_y as K_ya / C_y with C_y = LATERAL_STIFFNESS (1 + PCFY1 dfz + PCFY2 dfz^2)(1 + PCFY3 dpi)
(A9), and sigma_x as K_xk / C_x likewise, with LONGITUDINAL_STIFFNESS and PCFX1-3 (A8). The force of the fitted tyre follows the
angle or the slip over this length. Offset, gain and ripple per turn of the force are free in every run, so only its delay
determines the length.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any, NamedTuple

import numpy as np

from mffit.as_json import keys, with_u
from mffit.constants import MOST
from mffit.fit import constants
from mffit.fit.beside import BesideNumbers, with_beside
from mffit.fit.coverage import StageCoverage
from mffit.fit.upright import upright
from mffit.least_squares import FreeNumber, LeastSquaresProblem, Linear, of_model, solve
from mffit.numbers import Numbers
from mffit.points import Points, levels
from mffit.points.clock import rolled_distance
from mffit.points.constants import LONGEST_STEP
from mffit.points.mean import autoregression
from mffit.points.steps import STEPPED
from mffit.rig import Simulation
from mffit.rig.lag import lag_of_move, lagged_setting
from mffit.rig.simulation import LAG
from mffit.rig_errors.record import RADIANS
from tir import Quantity, Tyre
from tir.derivatives import gradient, plain, traced
from tir.equations import stiffness
from tir.equations.forces import carcass_stiffness
from tir.parameters import BY_NAME


@dataclass(frozen=True, slots=True)
class Direction:
    """A relaxation length of the tyre, and the test that determines it."""

    setting: str  #: the stepped setting, one of ``STEPPED``
    word: str  #: its name in sentences
    sigma: str  #: tir's name of the relaxation length
    K: str  #: tir's name of the slip stiffness
    slip_stiffness: Callable[[Any, Any], Any]  #: of coefficients and inputs of the upright wheel
    names: tuple[str, str, str, str]
    """Carcass stiffness, its linear and quadratic terms over load, and its linear term over pressure."""
    zero: str  #: rig error that shifts the setting
    unit: float  #: unit of the zero, in units of the setting
    stage: str  #: word for the row of the coverage matrix
    title: str
    run: str  #: sentence for data without steps: what is missing, and the run that measures it

    @property
    def force(self) -> str:
        """The force channel that responds to the setting."""
        return STEPPED[self.setting].force


_RUN = (
    "no recording steps {what} fast enough: roll at about 1 m/s, at two or three loads, {step} within a fraction of a second, "
    "hold each {value} for 6 s, and record at 20 Hz"
)
DIRECTIONS = (
    Direction(
        setting="alpha",
        word="the sideslip angle",
        sigma="sigma_y",
        K="K_ya",
        slip_stiffness=lambda p, q: stiffness.cornering_stiffness(p, q, 0.0),
        names=("LATERAL_STIFFNESS", "PCFY1", "PCFY2", "PCFY3"),
        zero="alpha_0_deg",
        unit=RADIANS,
        stage="relaxation",
        title="Relaxation",
        run=_RUN.format(what="the sideslip angle", step="step it 0, 1, 0, -1, 0 deg", value="angle"),
    ),
    Direction(
        setting="kappa",
        word="longitudinal slip",
        sigma="sigma_x",
        K="K_xk",
        slip_stiffness=stiffness.longitudinal_slip_stiffness,
        names=("LONGITUDINAL_STIFFNESS", "PCFX1", "PCFX2", "PCFX3"),
        zero="kappa_0",
        unit=1.0,
        stage="relaxation-slip",
        title="Relaxation over slip",
        run=_RUN.format(
            what="longitudinal slip",
            step="step the speed of the wheel so that slip is 0, 0.025, 0, -0.025, 0",
            value="slip",
        ),
    ),
)
SPREAD_OF_UNIFORM = 1.0 / math.sqrt(12.0)
"""Standard deviation of the uniform distribution on [0, 1]."""
UNCLEAR = "the steps of {what} do not show the relaxation length beyond their noise: hold each of them longer, or step further"


@dataclass(frozen=True, slots=True)
class StepLength:
    """The relaxation length from one run of steps."""

    file: str
    load: float  #: [N]
    pressure: float  #: [Pa]
    length: Quantity  #: [m]
    stiffness: Quantity  #: carcass stiffness [N/m], with the slip stiffness taken as exact
    written: float = math.nan  #: relaxation length of the written file at this load and pressure [m]


@dataclass(frozen=True, slots=True)
class Relaxation:
    """The carcass coefficients that steps in one direction determine."""

    direction: Direction
    runs: tuple[StepLength, ...] = ()
    found: Mapping[str, Quantity] = field(default_factory=dict)
    beside: BesideNumbers = field(default_factory=BesideNumbers)  #: the same with their covariance
    missing: str = ""  #: why coefficients are held

    @property
    def coverage(self) -> StageCoverage:
        """The row of the coverage matrix."""
        free = tuple(self.found)
        held = tuple(name for name in self.direction.names if name not in free)
        return StageCoverage(
            stage=self.direction.stage,
            title=self.direction.title,
            supported=bool(free),
            free=free,
            held=held,
            missing=(self.missing,) if held and self.missing else (),
        )


keys(
    Relaxation,
    "runs coefficients missing?",
    runs=lambda found: [
        {
            "file": run.file,
            "load_N": run.load,
            "p_kPa": run.pressure / 1e3,
            **with_u(f"{found.direction.sigma}_m", run.length),
            f"{found.direction.sigma}_file_m": run.written,
        }
        for run in found.runs
    ],
    coefficients=lambda found: list(found.found),
)


def relaxation(
    steps: Mapping[str, Points], simulation: Simulation, posterior: Numbers, held: Collection[str] = ()
) -> tuple[Relaxation, ...]:
    """Carcass stiffnesses over load and pressure, with standard uncertainties, in the order of ``DIRECTIONS``.

    ``steps`` are samples of the runs of steps, one sweep each, by the stepped setting; ``held`` are coefficients held by hand.
    """
    return tuple(
        _of_direction(one, steps.get(one.setting), simulation, posterior, held) for one in DIRECTIONS
    )


def _of_direction(
    direction: Direction,
    steps: Points | None,
    simulation: Simulation,
    posterior: Numbers,
    held: Collection[str],
) -> Relaxation:
    if steps is None:
        return Relaxation(direction, missing=direction.run)
    runs = [_of_run(direction, steps.select(steps.sweep == k), simulation) for k in np.unique(steps.sweep)]
    clear = [run for run in runs if run.length.u < MOST * run.length.value]
    if not clear:
        return Relaxation(direction, missing=UNCLEAR.format(what=direction.word))
    values = simulation.values
    loads = levels.count(np.array([run.load for run in clear]), levels.LOAD)
    pressures = levels.count(np.array([run.pressure for run in clear]), levels.PRESSURE)
    nominal, *over_load, over_pressure = direction.names
    names = [nominal, *over_load[: loads - 1], *([over_pressure] if pressures > 1 else [])]
    lacking = [
        *([f"3 loads are needed, steps were run at {loads}"] if loads < 3 else []),
        *(["steps were run at one pressure"] if pressures < 2 else []),
    ]
    names = [name for name in names if name not in held]
    beside = _fitted(direction, names, held, values, clear, posterior)
    at = {**values, **beside.values}
    written = tuple(
        StepLength(run.file, run.load, run.pressure, run.length, run.stiffness, _length(direction, run, at))
        for run in clear
    )
    u = with_beside(posterior, beside).stderr
    found = {name: Quantity(x, u[name], BY_NAME[name].unit) for name, x in beside.values.items()}
    return Relaxation(direction, written, found, beside, "; ".join(lacking))


def _of_run(direction: Direction, samples: Points, simulation: Simulation) -> StepLength:
    """The relaxation length with which the lagged force of the fitted tyre fits the readings of one run best."""
    samples = samples.select(np.isfinite(samples.channel(direction.force)))
    load, pressure = float(np.mean(samples.Fz)), float(np.mean(samples.p))
    state = Tyre.from_values(simulation.values).state(
        load, 0.0, float(np.mean(samples.gamma)), phi_t=float(samples.phi_t[0]), p=pressure,
        turn_slip=simulation.turn_slip,
    )  # fmt: skip
    simulation = simulation.with_numbers({"hysteresis_deg": 0.0, LAG: 0.0})
    radius, turned = float(simulation.values["UNLOADED_RADIUS"]), _turned(samples, float(state.Re))
    read = samples.channel(direction.force)
    beside = np.column_stack([np.ones(len(samples)), np.cos(turned), np.sin(turned)])
    spacing = float(np.median(np.diff(rolled_distance(samples.time, samples.V))))
    within = max(1, round(radius / spacing))
    ends = _ends_of_steps(direction, samples, radius)
    free = [
        FreeNumber("sigma", radius, 1e-3 * radius),
        *(FreeNumber(f"share{row}", 0.5, 0.0, 1.0, 0.5, SPREAD_OF_UNIFORM) for row in ends),
    ]
    first = _response(direction, samples, simulation, radius, dict.fromkeys(ends, 0.5))[0]
    known, *_ = np.linalg.lstsq(np.column_stack([beside, first]), read, rcond=None)
    free += [FreeNumber(f"beside{k}", value) for k, value in enumerate(known.tolist())]

    def model(x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Model readings (n,) and their derivatives (n, k) by the free numbers."""
        count = 1 + len(ends)
        shares = dict(zip(ends, x[1:count].tolist(), strict=True))
        response, slope = _response(direction, samples, simulation, x[0], shares)
        design = np.column_stack([beside, response])
        return design @ x[count:], np.column_stack([x[-1] * slope, design])

    sigma, u, move = radius, math.inf, math.inf
    noise = _Noise.of(read - model(np.array([n.start for n in free]))[0], len(free), within)
    for _ in range(constants.REFIT_STEPS):
        end = solve(_problem(model, read, noise), free)
        x = np.array(list(end.values.values()))
        free = [replace(n, start=value) for n, value in zip(free, x.tolist(), strict=True)]
        sigma, move = float(x[0]), float(x[0]) - sigma
        u = math.sqrt(float(end.covariance[0, 0]))
        if abs(move) < constants.REFIT_TOLERANCE * sigma:
            break
        noise = _Noise.of(read - model(x)[0], len(free), within)
    u = u if abs(move) < max(u, constants.STAGE_TOLERANCE * sigma) else math.inf  # not converged
    C = abs(float(getattr(state, direction.K))) / sigma
    return StepLength(
        samples.files[int(samples.file[0])],
        load,
        pressure,
        Quantity(sigma, u, "m"),
        Quantity(C, u / sigma * C, "N/m"),
    )


def _turned(samples: Points, Re: float) -> np.ndarray:
    """Angle (n,) by which the wheel has turned [rad], for the once-per-turn ripple of a tyre that is not round."""
    speed = np.where(np.isfinite(samples.omega), samples.omega, (1.0 + samples.kappa) * samples.V / Re)
    return rolled_distance(samples.time, speed)


def _ends_of_steps(direction: Direction, samples: Points, radius: float) -> list[int]:
    """Indices of the samples before the first and before the last move of every step.

    The instant of these moves between two samples is unknown, so the fit estimates it.
    """
    moved = np.diff(getattr(samples, direction.setting))
    rows = np.flatnonzero(np.abs(moved) > constants.LEAST_MOVE_OF_A_STEP * np.max(np.abs(moved), initial=0.0))
    rolled = rolled_distance(samples.time, samples.V)
    apart = np.flatnonzero(np.diff(rolled[rows]) > LONGEST_STEP * radius) + 1
    steps = [
        own for own in np.split(rows, apart) if abs(np.sum(moved[own])) >= STEPPED[direction.setting].smallest
    ]
    return sorted({int(row) for own in steps for row in (own[0], own[-1])})


def _response(
    direction: Direction, samples: Points, simulation: Simulation, sigma: float, shares: Mapping[int, float]
) -> tuple[np.ndarray, np.ndarray]:
    """Force (n,) [N] lagged by the length ``sigma`` [m], and its derivatives (n, 1 + k) by the length and the shares.

    ``shares`` holds the k abrupt moves: by index of the sample before the move, its position in the interval, 0 to 1. All other
    moves are linear between samples.
    """
    follows, by_sigma = lagged_setting(samples, sigma, direction.setting)
    by = [by_sigma]
    rolled, moved = rolled_distance(samples.time, samples.V), np.diff(getattr(samples, direction.setting))
    for row, share in shares.items():
        lag, lag_by_sigma, lag_by_share = lag_of_move(row, float(moved[row]), rolled, sigma, share)
        follows, by[0] = follows - lag, by[0] - lag_by_sigma
        by.append(-lag_by_share)
    at = samples.replace(**{direction.setting: follows})
    force, by_zero = simulation.sensitivities(at, [direction.zero], (direction.force,))
    slope = by_zero[direction.force][:, 0] / direction.unit
    return force[direction.force], slope[:, None] * np.column_stack(by)


class _Noise(NamedTuple):
    """Autoregressive noise of a series of readings."""

    memory: np.ndarray  #: autoregression coefficients (k,)
    size: float  #: standard deviation of the innovations

    @classmethod
    def of(cls, residual: np.ndarray, numbers: int, within: int = 1) -> _Noise:
        """The noise of residuals after a fit of some ``numbers``; enlarged if means over ``within`` samples scatter too much."""
        memory, new = autoregression(residual - residual.mean())
        white = cls(memory, math.sqrt(new) or 1.0).whitened(residual)
        blocks = white[: len(white) // within * within].reshape(-1, within).mean(axis=1)
        excess = max(1.0, within * float(np.var(blocks))) if len(blocks) > 1 else 1.0
        freedom = max(len(residual) - numbers, 1)
        return cls(memory, math.sqrt(new * excess * len(residual) / freedom) or 1.0)

    def whitened(self, x: np.ndarray) -> np.ndarray:
        """Whitened series (n - k,) or (n - k, m): prediction errors of the autoregression in units of the innovations."""
        k, n = len(self.memory), len(x)
        before = sum(share * x[k - j : n - j] for j, share in enumerate(self.memory, 1))
        return np.asarray((x[k:] - before) / self.size)


def _problem(
    model: Callable[[np.ndarray], tuple[np.ndarray, np.ndarray]], read: np.ndarray, noise: _Noise
) -> LeastSquaresProblem:
    """The least-squares problem of a model for readings (n,) with autoregressive noise."""
    none = np.zeros(0)

    def linear(x: np.ndarray) -> Linear:
        found, slope = model(x)
        return Linear(noise.whitened(found - read), noise.whitened(slope), none, np.zeros((0, len(x))))

    return LeastSquaresProblem(lambda x: (noise.whitened(model(x)[0] - read), none), linear)


def _stiffness(direction: Direction, values: Mapping[str, Any], load: Any, pressure: Any) -> Any:
    p, q = upright(values, load, pressure)
    nominal, linear, quadratic, over_pressure = (getattr(p, name) for name in direction.names)
    return carcass_stiffness(nominal, linear, quadratic, over_pressure, q)


def _length(direction: Direction, run: StepLength, values: Mapping[str, Any]) -> float:
    """Relaxation length [m] of the file at the conditions of a run."""
    C = _stiffness(direction, values, run.load, run.pressure)
    return float(run.length.value * run.stiffness.value / C)


def _fitted(
    direction: Direction,
    names: Sequence[str],
    held: Collection[str],
    values: Mapping[str, Any],
    runs: Sequence[StepLength],
    posterior: Numbers,
) -> BesideNumbers:
    """The coefficients that fit the carcass stiffnesses of the runs, with derivatives by the coefficients of the fit.

    A run measures the relaxation length, so its carcass stiffness is proportional to the fitted slip stiffness.
    """
    if not names:
        return BesideNumbers()
    load, pressure = (np.array([getattr(run, name) for run in runs]) for name in ("load", "pressure"))
    measured, u = (np.array([run.stiffness[k] for run in runs]) for k in (0, 1))
    nominal, *terms = direction.names
    numbers = {name: FreeNumber(name, 0.0) for name in terms}
    for name in terms:
        # If these runs do not determine it, its prior contributes to the uncertainty. Public files have 0.1 to 0.2 over load,
        # -0.02 to -0.05 over its square and 0.1 to 0.4 over pressure.
        if name not in names and (spread := BY_NAME[name].tyres_spread):
            numbers[name] = replace(numbers[name], start=values[name], expected=values[name], spread=spread)
    middle = float(np.median(measured))
    numbers = {nominal: FreeNumber(nominal, middle, 0.1 * middle, 10.0 * middle), **numbers}
    free = [number for name, number in numbers.items() if name not in held]

    def of(at: Mapping[str, Any]) -> Any:
        return _stiffness(direction, {**values, **at}, load, pressure)

    end = solve(of_model(of, [number.name for number in free], measured, u), free, tolerance=1e-9)
    own = [end.names.index(name) for name in names]
    freedom = len(runs) - len(names)
    scale = max(1.0, float(end.data @ end.data) / freedom) if freedom > 0 else 1.0
    fitted = tuple(name for name in posterior.names if name in BY_NAME)
    at = traced({name: float(values[name]) for name in fitted})
    K = direction.slip_stiffness(*upright({**values, **at}, load, pressure))
    relative = gradient(K, list(at.values())) / np.reshape(plain(K), (-1, 1)) if fitted else 0.0
    by_stiffness = (end.covariance @ end.jacobian.T / u)[own]
    return BesideNumbers(
        values={name: end.values[name] for name in names},
        covariance=scale * end.covariance[np.ix_(own, own)],
        leans_on=fitted,
        slope=by_stiffness @ (measured[:, None] * relative) if fitted else np.zeros((len(names), 0)),
    )
