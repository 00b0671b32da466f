"""The forward model: readings of a tyre on a rig, and their derivatives by any number of tyre or rig."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from mffit.brief import Brief
from mffit.points import Points
from mffit.quantities import CHANNELS, SIDEWAYS
from mffit.rig.chain import Chain
from mffit.rig.histories import History, RowsOfTest, blocks, of_part, successive, usual_radius
from mffit.rig.readings import Readings
from mffit.rig_errors import BY_NAME, NO_FAULTS, OF_RUN, RIG_ERRORS, Faults
from tir import Tyre, constants
from tir.derivatives import Traced, gradient, plain, traced
from tir.equations.forces import Forces, State

SWITCH = "turn_slip"
LAG = "relaxation_m"
"""The rig error that makes a point depend on all previous points of its sweep."""
PLAY, SIDESLIP_ZERO, MOMENT_ZERO = "backlash_deg", "alpha_0_deg", "M0_Nm"
SIMULATED = tuple(name for name in CHANNELS if name in (*Forces._fields, *State._fields))
"""Channels that tir computes, under the same names."""


@dataclass(frozen=True, slots=True, repr=False)
class Simulation(Brief):
    """A tyre on a rig. Points keep the angles as read; ``faults`` has all differences between reading and tyre."""

    values: Mapping[str, Any]  #: every value of the property file
    faults: Faults = NO_FAULTS
    turn_slip: bool = True  #: whether the simulation accounts for path curvature and spin
    star: bool = False  #: whether tan(alpha) and sin(gamma) replace the angles as inputs
    radius_m: float = math.nan  #: declared radius of the rig's usual path [m]; NaN: that of most points
    of_parts: Mapping[str, float] = field(default_factory=dict)
    """Additional rig error of single files, set-ups or sweeps, by names such as ``F0_N@zeros.csv`` or ``F0_N@A``, in its unit."""

    @classmethod
    def of(
        cls, tyre: Tyre, faults: Faults = NO_FAULTS, *, turn_slip: bool = True, star: bool = False
    ) -> Simulation:
        """The simulation of a tyre."""
        return cls(dict(tyre.values), faults, turn_slip, star)

    def number(self, name: str, points: Points) -> float:
        """Current value of a coefficient, a rig error or a switch."""
        if name == SWITCH:
            return float(self.turn_slip)
        if OF_RUN in name:
            return self.of_parts.get(name, 0.0)
        if name == "path_radius_m" and math.isnan(self.faults[name]):
            return self.declared(points)
        return float(self.faults[name] if name in BY_NAME else self.values[name])

    def declared(self, points: Points) -> float:
        """Declared radius of the usual path [m], which the error ``path_radius_m`` replaces."""
        return usual_radius(points) if math.isnan(self.radius_m) else self.radius_m

    def with_numbers(self, numbers: Mapping[str, float]) -> Simulation:
        """The simulation with some coefficients, rig errors or switches replaced."""
        faults = {name: value for name, value in numbers.items() if name in BY_NAME}
        of_parts = {name: value for name, value in numbers.items() if OF_RUN in name}
        values = {n: v for n, v in numbers.items() if n not in {*faults, *of_parts, SWITCH}}
        return replace(
            self,
            values={**self.values, **values} if values else self.values,
            faults=self.faults.replace(**faults) if faults else self.faults,
            turn_slip=bool(numbers.get(SWITCH, self.turn_slip)),
            of_parts={**self.of_parts, **of_parts} if of_parts else self.of_parts,
        )

    @property
    def faultless(self) -> Simulation:
        """The same tyre, its relaxation included, on a perfect rig at reference conditions."""
        own = {error.name: self.faults[error.name] for error in RIG_ERRORS if error.kind == "tyre"}
        return replace(self, faults=Faults(**own), of_parts={})

    def readings(self, points: Points, channels: Iterable[str] = SIDEWAYS) -> Readings:
        """The readings of some channels at every point (n,), in ISO-W axes, contact frame, rig-fixed also when rolling
        backwards.
        """
        return self.sensitivities(points, (), channels)[0]

    def felt(self, points: Points) -> Points:
        """The points with the tyre's true conditions, and with readings corrected for rig and environment.

        The correction is that of this simulation, so the residuals of the tyre alone at the returned points equal those of the
        simulation at ``points``.
        """
        channels = _in_order((*SIDEWAYS, *(name for name in points.measured if name in SIMULATED)))
        felt = points.replace(**self._chain(points, {}).at_the_tyre())
        rig = self.readings(points, channels)
        tyre = replace(self, faults=NO_FAULTS, of_parts={}).readings(felt, channels)
        return felt.replace(**{name: points.channel(name) - (rig[name] - tyre[name]) for name in channels})

    def floats(self, points: Points) -> np.ndarray:
        """Mask (n,) of the points at which the moment changes sign within the play of the steering axis.

        There, the friction of the axis decides where between its stops the wheel rests, which no reading shows.
        """
        play = float(self.faults[PLAY])
        if not play > 0.0:
            return np.zeros(len(points), dtype=bool)
        of_parts = {n: x for n, x in self.of_parts.items() if n.partition(OF_RUN)[0] != MOMENT_ZERO}
        tight = replace(self, of_parts=of_parts).with_numbers({PLAY: 0.0, MOMENT_ZERO: 0.0})
        low, high = (
            tight.with_numbers({SIDESLIP_ZERO: self.faults[SIDESLIP_ZERO] + end * play}).readings(
                points, ("Mz",)
            )["Mz"]
            for end in (-0.5, 0.5)
        )
        return np.asarray(low * high < 0.0)

    def predict(self, points: Points, channels: Iterable[str] = SIDEWAYS) -> np.ndarray:
        """The simulated readings (c n,), channel by channel."""
        return self.readings(points, channels).stacked

    def sensitivities(
        self, points: Points, names: Sequence[str], channels: Iterable[str] = SIDEWAYS
    ) -> tuple[Readings, Readings]:
        """The readings (n,) by channel, and their exact derivatives (n, k) by the named numbers.

        For a wheel with play the derivatives are at a fixed stop, or at zero moment if the wheel floats.
        """
        return self.at_rows(points, names, channels)(np.arange(len(points)))

    def in_blocks(
        self, points: Points, names: Sequence[str], channels: Iterable[str] = SIDEWAYS
    ) -> Iterator[tuple[np.ndarray, Readings, Readings]]:
        """:meth:`sensitivities` block by block: row indices (m,), readings (m,), derivatives (m, k).

        Blocks limit the memory for derivatives; with lag, no sweep is divided.
        """
        at_rows = self.at_rows(points, names, channels)
        for rows in blocks(points, by_sweep=self._lags(names)):
            yield rows, *at_rows(rows)

    def at_rows(
        self, points: Points, names: Sequence[str], channels: Iterable[str] = SIDEWAYS
    ) -> Callable[[np.ndarray], tuple[Readings, Readings]]:
        """:meth:`sensitivities` as a function of row indices (m,) of a test; with lag, these must cover whole sweeps."""
        channels = _in_order(channels)
        history = History(points)
        numbers = {name: self.number(name, points) for name in (n.partition(OF_RUN)[0] for n in names)}
        here, lags = replace(self, radius_m=self.declared(points)), self._lags(names)

        def found(rows: np.ndarray) -> tuple[Readings, Readings]:
            n = len(rows)
            if lags or n <= constants.CONDITIONS_PER_BLOCK:
                which = successive(rows)
                every = isinstance(which, slice) and n == len(points)
                part = points if every else points.select(which, with_table=False)
                return here._linearised(part, names, numbers, channels, RowsOfTest(history, which))
            whole: dict[str, np.ndarray] = {name: np.empty(n) for name in channels}
            by_number: dict[str, np.ndarray] = {name: np.empty((len(names), n)).T for name in channels}
            for i in np.array_split(np.arange(n), -(-n // constants.CONDITIONS_PER_BLOCK)):
                out, slopes = found(rows[i])
                for name in channels:
                    to = slice(i[0], i[-1] + 1)
                    whole[name][to], by_number[name][to] = out[name], slopes[name]
            return Readings(**whole), Readings(**by_number)

        return found

    def _lags(self, names: Sequence[str]) -> bool:
        """Whether readings depend on previous points of their sweep."""
        return bool(self.faults[LAG]) or any(n.partition(OF_RUN)[0] == LAG for n in (*names, *self.of_parts))

    def _linearised(
        self,
        points: Points,
        names: Sequence[str],
        numbers: Mapping[str, float],
        channels: tuple[str, ...],
        which: RowsOfTest,
    ) -> tuple[Readings, Readings]:
        """Readings and derivatives by the named numbers at some rows of a test."""
        at, n = traced(numbers), len(points)
        chain = self._chain(points, at, which)
        out = dict(zip(channels, chain.readings(channels), strict=True))
        columns = list(at.values())
        place = [list(at).index(name.partition(OF_RUN)[0]) for name in names]
        slopes = {}
        for name, x in out.items():
            slope = np.broadcast_to(gradient(x, columns), (n, len(columns)))
            as_it_is = place == list(range(len(columns))) and not any(OF_RUN in name for name in names)
            slopes[name] = slope if as_it_is else slope.T[place].T
        # A number of a part is added to that of the whole test, so its derivative is equal at the points of the part.
        for k, name in enumerate(names):
            if OF_RUN in name:
                own = of_part(points, name.partition(OF_RUN)[2])
                for slope in slopes.values():
                    slope[:, k] *= own
        return Readings(**{name: np.broadcast_to(plain(x), n) for name, x in out.items()}), Readings(**slopes)

    def _chain(self, points: Points, numbers: Mapping[str, Traced], place: RowsOfTest | None = None) -> Chain:
        """The chain for the points with some numbers traced."""
        faults: dict[str, Any] = {**self.faults, **{n: x for n, x in numbers.items() if n in BY_NAME}}
        for key, added in self.of_parts.items():
            name, _, part = key.partition(OF_RUN)
            faults[name] = faults[name] + added * of_part(points, part)
        return Chain(
            points,
            {**self.values, **{n: x for n, x in numbers.items() if n in self.values}},
            faults,
            usual_radius=self.declared(points),
            modes={"turn_slip": self.turn_slip, "star": self.star},
            place=place,
        )


def _in_order(channels: Iterable[str]) -> tuple[str, ...]:
    wanted = frozenset(channels)
    return tuple(name for name in CHANNELS if name in wanted)
