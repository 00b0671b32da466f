"""What a fit leaves of the readings, as one linear model per channel."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from mffit.linearised import constants
from mffit.linearised.components import Components, most_probable, own_columns, variances
from mffit.linearised.inputs import along, inputs_of, settings_of
from mffit.linearised.mixed import Mixed, Posterior, Predicted
from mffit.linearised.smooth import Smooth
from mffit.points import Points
from mffit.rig import Simulation
from mffit.scatter import rms


@dataclass(frozen=True, eq=False)
class LinearisedChannel:
    """Residuals of one channel: what the formula misses, what differs from run to run, noise."""

    name: str
    rows: np.ndarray  #: (n,) of the points that are looked at
    unit: np.ndarray  #: (n,) their noise as stated, or usual [N], [Nm], [m]
    smooth: Smooth
    components: Components
    model: Mixed  #: of residuals, measured less model, over ``unit``
    sweeps: np.ndarray  #: number of the sweep of every group of ``model``

    @cached_property
    def posterior(self) -> Posterior:
        """Of the functions of ``smooth``."""
        return self.model.posterior(self._variances)

    @property
    def _variances(self):  # type: ignore[no-untyped-def]
        return variances(self.components.logarithms, self.smooth)[0]

    def missed(self, at: Mapping[str, np.ndarray]) -> tuple[np.ndarray, np.ndarray]:
        """What the formula misses at conditions (n,), and its standard uncertainty (n,), in the unit of the channel."""
        columns, likeness = self.smooth.columns(at), self.smooth.likeness(at, np.array(self.components.lengths))
        mean = likeness * (columns @ self.posterior.mean)
        within = likeness**2 * np.sum((columns @ self.posterior.root) ** 2, axis=1)
        return mean, np.sqrt(within + (1.0 - likeness**2) * self.components.missed**2)

    @property
    def noise(self) -> float:
        """Standard deviation of a usual reading of a run."""
        return self.components.noise * float(np.median(self.unit))

    @property
    def size(self) -> float:
        """Root mean square of what the formula misses at the readings."""
        return rms(self.unit * (self.model.common @ self.posterior.mean))

    def left_out(self, groups: Sequence[np.ndarray] | None = None) -> list[Predicted]:
        """Each sweep, or each set of groups, as all others predict it; rows count those of ``rows``."""
        which = [np.array([k]) for k in range(len(self.sweeps))] if groups is None else groups
        found = self.model.left_out(self._variances, which)
        return [
            Predicted(
                one.rows,
                one.error * self.unit[one.rows],
                one.covariance * np.outer(self.unit[one.rows], self.unit[one.rows]),
            )
            for one in found
        ]


@dataclass(frozen=True, eq=False)
class LinearisedFit:
    """The channels of a fit at its solution."""

    channels: Mapping[str, LinearisedChannel]


def linearised(
    points: Points, simulation: Simulation, sigma: Mapping[str, np.ndarray], only: Iterable[str] | None = None
) -> LinearisedFit:
    """The linear model of what a simulation leaves of the points.

    Parameters
    ----------
    points : (n,)
    simulation : the fitted tyre on its rig
    sigma : by channel, uncertainty (n,) that the fit used; inf where a reading has no weight
    only : channels to look at; all that were fitted if None
    """
    readings = simulation.readings(points, sigma)
    felt = simulation.felt(points)
    found = {}
    for name in sigma if only is None else only:
        used = np.isfinite(sigma[name]) & np.isfinite(points.channel(name))
        if np.any(used):
            found[name] = _channel(name, points, felt, readings[name], sigma[name], used)
    return LinearisedFit(found)


def _channel(
    name: str, points: Points, felt: Points, model: np.ndarray, sigma: np.ndarray, used: np.ndarray
) -> LinearisedChannel:
    every = np.flatnonzero(used)
    rows = every[:: max(1, -(-len(every) // int(constants.POINTS_EXAMINED)))]
    part, at_tyre = points.select(rows, with_table=False), felt.select(rows, with_table=False)
    residual = part.channel(name) - model[rows]
    stated = part.u(name)
    usual = float(np.median(sigma[rows]))
    unit = np.where(np.isfinite(stated) & (stated > 0.0), stated, usual)
    inputs = inputs_of(at_tyre)
    smooth = Smooth.over(inputs)
    groups = [np.flatnonzero(part.sweep == k) for k in np.unique(part.sweep)]
    own = own_columns(model[rows], along(at_tyre, inputs))
    mixed = Mixed(
        residual=residual / unit,
        common=smooth.columns(settings_of(at_tyre, inputs)) / unit[:, None],
        own=own / unit[:, None],
        groups=groups,
    )
    size = max(rms(residual), 1e-12)
    components = most_probable(mixed, smooth, Components.guess(smooth, size), size)
    return LinearisedChannel(name, rows, unit, smooth, components, mixed, np.unique(part.sweep))
