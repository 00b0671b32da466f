"""What a diagnosis is asked, and what its search for effects starts from."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from mffit.config import Config
from mffit.constants import TWO_SIGMA
from mffit.diagnosis.inexact import columns_of, slopes_of, spread_of, with_rig
from mffit.diagnosis.inexact import declared as declared_inexactness
from mffit.diagnosis.noise import Noise
from mffit.diagnosis.notes import NotVisible, OneSweep
from mffit.diagnosis.problem import DiagnosisProblem
from mffit.diagnosis.smooth import Smooth, smooth_basis
from mffit.effects import CATALOG, Effect
from mffit.linearised.constants import DIVISIONS_OF_A_SWEEP
from mffit.numbers import Numbers
from mffit.points import Points
from mffit.progress import Progress, silent
from mffit.rig import Simulation
from mffit.rounding import rounded_up
from mffit.scatter import rms
from tir import Tyre


@dataclass(frozen=True, slots=True, eq=False)
class Asked:
    """The question of a diagnosis, and what is known in addition to points, model and project."""

    rig: Mapping[str, float] | None = None
    """Known rig errors, of the rig or of a set-up; None: the declared play alone."""
    effects: Sequence[Effect] = CATALOG  #: to be tried
    coefficients: Numbers | None = None
    """Prior of the model's coefficients; None: from ``model.u_coefficients``."""
    seen: bool = False  #: whether the model was fitted to these points
    left: Mapping[str, float] = field(default_factory=dict)
    """By channel, the rms [N], [Nm] by which the model misses the points of its build beyond the noise; empty if unknown."""
    missed: Mapping[str, float] = field(default_factory=dict)
    """By channel, the rms [N], [Nm] there of the model error that was taken out of the readings; it is not part of ``left``."""
    repair_all: bool = False  #: whether every named effect is repaired, see :mod:`mffit.diagnosis.repair`
    as_read: Points | None = None  #: the points (n,) before known errors were subtracted, if any were
    taken_off: Sequence[str] = ()  #: sentences on what was subtracted
    culprits: bool = True
    """Whether to search for a wrongly recorded sweep, which needs a model of this tyre."""


NOTHING_KNOWN = Asked()


@dataclass(frozen=True, eq=False)
class Search:
    """Everything that stays the same while noise, effects and coefficients are estimated."""

    tyre: Tyre  #: the given property file
    config: Config
    asked: Asked
    points: Points  #: with an uncertainty for every reading, cut at their conditions
    start: Simulation  #: the given model
    stated: Noise
    candidates: tuple[Effect, ...]
    hidden: tuple[NotVisible | OneSweep, ...]  #: why the other effects are not candidates
    inexact: Numbers
    declared: Mapping[str, tuple[float, float]]
    """Value and standard uncertainty of each declared rig error."""
    progress: Progress = silent  #: called with a sentence before each step

    @property
    def channels(self) -> tuple[str, ...]:
        return self.stated.channels

    @cached_property
    def beside(self) -> Numbers:
        """The prior of the inexact coefficients and of every declared rig error."""
        names = [n for n, (_, u) in self.declared.items() if u > 0.0 and n not in self.inexact.names]
        return with_rig(self.inexact, self.declared, names)

    @cached_property
    def coarse(self) -> np.ndarray:
        """Smooth structure (c n, k) that noise may not be taken for."""
        return smooth_basis(self.points, self.start.readings(self.points, self.channels))

    @cached_property
    def structure(self) -> np.ndarray:
        """Smooth structure (c n, k) that competes with the effects."""
        simulated = self.start.readings(self.points, self.channels)
        return smooth_basis(self.points, simulated, DIVISIONS_OF_A_SWEEP)

    def shared(self, noise: Noise, state: Simulation) -> Noise:
        """The noise together with the changes by inexact coefficients, linearised at a simulation."""
        return noise.sharing(columns_of(self.inexact, state, self.points, self.channels))

    def problem(self, state: Simulation, noise: Noise, effects: Sequence[Effect]) -> DiagnosisProblem:
        """The readings with coefficients linearised at a simulation and integrated out, in addition to smooth structure.

        The coefficients that ``effects`` have changed in the simulation are those of the given model. Where what is
        linear there misses the given model by more than they have moved, all are linearised at the given model.
        """
        changed = {name for effect in effects for name in effect.parameters}
        names = [name for name in self.inexact.names if name not in changed]
        numbers = {name: state.number(name, self.points) for name in names}
        at = self.start.with_numbers(numbers) if numbers and state is not self.start else self.start
        moved = None
        if at is not self.start:
            away = (
                np.array([at.number(name, self.points) for name in self.inexact.names])
                - self.inexact.expected
            )
            moved = slopes_of(state, self.points, self.inexact.names, self.channels) @ away
            truly = at.predict(self.points, self.channels) - self.start.predict(self.points, self.channels)
            off, size = (rms((change / noise.u)[noise.used]) for change in (moved - truly, truly))
            if off > size:  # no change at all would be nearer
                state, at, moved = self.start, self.start, None
        noise, limits = self.shared(noise, state), (self.allowed, self.excused)
        return DiagnosisProblem(self.points, at, noise, self.declared, moved, self.structure, *limits)

    @cached_property
    def allowed(self) -> dict[str, float]:
        """By channel, the amplitude up to which structure may be the model error of the build: two standard deviations of it."""
        return self._amplitudes(self.asked.left)

    @cached_property
    def by_coefficients(self) -> dict[str, float]:
        """By channel, the rms [N], [Nm] by which coefficients of declared inexactness change the readings; empty without any."""
        u = self.config.model.u_coefficients
        return {name: u * size for name, size in self._by_whole_coefficients.items() if u}

    @cached_property
    def _by_whole_coefficients(self) -> dict[str, float]:
        """The same with every coefficient as uncertain as it is large; empty if its build tells what it misses."""
        if self.asked.coefficients is not None or self.asked.left:
            return {}
        whole = spread_of(declared_inexactness(self.tyre, 1.0), self.start, self.points, self.channels)
        return {name: rms(rows) for name, rows in self.stated.by_channel(whole).items()}

    @cached_property
    def excused(self) -> dict[str, float]:
        """By channel, the amplitude of structure that a declared inexactness of the coefficients would explain.

        A formula whose coefficients are that inexact may miss the tyre by as much: such structure is found, but needs no cause.
        """
        return self._amplitudes(self.by_coefficients)

    def excusing(self, found: Smooth) -> float | None:
        """The inexactness of all coefficients that would explain a structure, with two digits; None if it needs none.

        None also where it would have to be as large as the coefficients, and for a file whose build tells what it misses.
        """
        whole = self._amplitudes(self._by_whole_coefficients)
        u = max((found.amplitude[n] / whole.get(n, math.nan) for n in found.strange), default=math.nan)
        return rounded_up(u) if found.is_strange and u < 1.0 else None

    def _amplitudes(self, sizes: Mapping[str, float]) -> dict[str, float]:
        """Two standard deviations of sizes by channel [N], [Nm], over the rms of the readings."""
        readings = {name: rms(self.points.channel(name)) for name in self.channels if name in sizes}
        return {name: TWO_SIGMA * sizes[name] / size for name, size in readings.items() if size > 0.0}
