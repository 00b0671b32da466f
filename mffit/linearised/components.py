"""The components of variance of a channel: what the formula misses, what differs from run to run, and noise."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.optimize import minimize

from mffit.linearised import constants
from mffit.linearised.mixed import Mixed, Variances
from mffit.linearised.smooth import Smooth


@dataclass(frozen=True, slots=True)
class Components:
    """Standard deviations, in the unit of the channel where nothing else is said."""

    missed: float  #: of what the formula misses, over the tested range
    lengths: tuple[float, ...]  #: over which it changes, along every input [unit of the input]
    offset: float  #: of a run
    scale: float  #: of a run, relative [-]
    shape: float  #: of a run, along what it sweeps
    shape_length: float  #: over the tested range [-]
    noise: float  #: over that stated [-]

    @classmethod
    def guess(cls, smooth: Smooth, misfit: float) -> Components:
        """Where the search begins: a third of the misfit of each kind."""
        third = misfit / 3.0
        lengths = tuple(2.0 * one.spacing for one in smooth.inputs)
        return cls(misfit, lengths, third, float(constants.LARGEST_RUN_SCALE) / 10.0, third, 0.3, 1.0)

    @property
    def logarithms(self) -> np.ndarray:
        """Of all numbers (d + 6,)."""
        return np.log(
            [
                self.missed,
                *self.lengths,
                self.offset,
                self.scale,
                self.shape,
                self.shape_length,
                self.noise,
            ]
        )

    @classmethod
    def of_logarithms(cls, x: np.ndarray) -> Components:
        """From the logarithms of all numbers."""
        size = np.exp(x).tolist()
        return cls(size[0], tuple(size[1:-5]), *size[-5:])

    def run_variance(self, force: np.ndarray) -> np.ndarray:
        """Variance (n,) of a new run around the mean of all, where the force is as given (n,)."""
        return np.asarray(self.offset**2 + (self.scale * force) ** 2 + self.shape**2)


def own_columns(force: np.ndarray, along: np.ndarray) -> np.ndarray:
    """What every run has of its own (n, q): constant, force, and half waves along what it sweeps, from 0 to 1."""
    order = np.arange(1, constants.FUNCTIONS_OF_A_RUN + 1)
    waves = np.sqrt(2.0) * np.cos(np.pi * order * along[:, None])
    return np.column_stack([np.ones(len(force)), force, waves])


def variances(x: np.ndarray, smooth: Smooth) -> tuple[Variances, np.ndarray, np.ndarray]:
    """The variances of all numbers, and the derivatives of the common and of the own ones by the logarithms ``x``."""
    d, q = len(smooth.inputs), int(constants.FUNCTIONS_OF_A_RUN)
    share, by_length = smooth.log_variance(np.exp(x[1 : 1 + d]))
    by_common = np.zeros((len(share), len(x)))
    by_common[:, 0] = 2.0
    by_common[:, 1 : 1 + d] = by_length
    exponent = -0.5 * (np.pi * np.arange(1, q + 1) * np.exp(x[-2])) ** 2
    total = float(np.log(np.sum(np.exp(exponent))))
    own = np.concatenate([2.0 * x[-5:-3], 2.0 * x[-3] + exponent - total])
    by_own = np.zeros((len(own), len(x)))
    by_own[0, -5] = by_own[1, -4] = 2.0
    by_own[2:, -3] = 2.0
    by_own[2:, -2] = 2.0 * (exponent - np.exp(exponent - total) @ exponent)
    return Variances(2.0 * x[0] + share, own, 2.0 * float(x[-1])), by_common, by_own


def most_probable(
    model: Mixed, smooth: Smooth, first: Components, unit: float, others: float = 1.0
) -> Components:
    """The components of the largest evidence, near their first guess; residuals are of size ``unit``.

    Shared numbers beside those of ``smooth`` have the variance ``others``.
    """
    functions = len(smooth.orders)
    begin = first.logarithms
    usual = float(np.log(constants.USUAL_RATIO))
    held = np.ones(len(begin))
    held[[0, -1]] = 0.0  # the data alone say how much the formula misses, and the noise

    def loss(x: np.ndarray) -> tuple[float, np.ndarray]:
        given, by_common, by_own = variances(x, smooth)
        found = model.evidence(given._replace(common=beside(given.common, model, others)))
        slope = found.common[:functions] @ by_common + found.own @ by_own
        slope[-1] += 2.0 * found.noise
        far = held * (x - begin) / usual
        return -found.value + 0.5 * float(far @ far), -slope + far / usual

    readings = sum(len(group) for group in model.groups)
    found = minimize(
        loss,
        begin,
        jac=True,
        method="L-BFGS-B",
        bounds=_bounds(smooth, unit),
        options={
            "maxiter": int(constants.COMPONENT_STEPS),
            "ftol": constants.COMPONENT_TOLERANCE / max(readings, 1),
        },
    )
    return Components.of_logarithms(found.x)


def beside(log_variance: np.ndarray, model: Mixed, others: float) -> np.ndarray:
    """Logarithms of the variances of all shared numbers: those given, and ``others`` of the rest."""
    return np.append(log_variance, np.full(model.common.shape[1] - len(log_variance), np.log(others)))


def _bounds(smooth: Smooth, unit: float) -> list[tuple[float, float]]:
    """Of the logarithms: a run differs by no more than the formula misses, and no length is below the settings' distance."""
    tiny = unit * 1e-4
    size = (tiny, 3.0 * unit)
    lengths = [(one.spacing, 20.0 * one.width) for one in smooth.inputs]
    of_runs = [(tiny, unit), (1e-6, float(constants.LARGEST_RUN_SCALE)), (tiny, unit), (0.05, 1.0)]
    return [tuple(np.log(pair).tolist()) for pair in [size, *lengths, *of_runs, (1e-3, 1e3)]]
