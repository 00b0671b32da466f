"""The runs and measurements that could be added to a programme, each of which a build can use."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from enum import Enum
from typing import Any, NamedTuple

import numpy as np

from mffit.config import Config
from mffit.config.models import RollingRadiusTable
from mffit.measured.radii import measured_path_radius
from mffit.points import Points, levels, main_path, main_pressure
from mffit.points.points import concatenate
from mffit.quantities import CHANNELS, CONDITIONS, DIRECT
from mffit.rig import reference_speed

ZEROS_DEG = (-1.0, -0.5, 0.0, 0.5, 1.0)
NEAR_DEG = (-20.0, -15.0, -12.5, -10.0, -7.5, -5.0, -2.5, 0.0, 2.5, 5.0, 7.5, 10.0, 12.5, 15.0, 20.0)
SHARES = (-1.0, -0.75, -0.5, -0.375, -0.25, -0.125, -0.0625, 0.0, 0.0625, 0.125, 0.25, 0.375, 0.5, 0.75, 1.0)
"""Angles of a full sweep over the largest one that was run."""
CAMBERS_DEG = (10.0, 20.0, 35.0)
LOADS = (0.7, 1.3)
"""New loads over the smallest and the largest one."""
PRESSURES = (0.8, 1.2)
"""New pressures over the programme's."""
NARROWER = 0.7
"""Second path radius over the usual one: within the disc, and far enough from it."""
BETTER = 1.0 / 3.0
"""A better measurement of the rig over the declared uncertainty."""


class Kind(Enum):
    """Kinds of runs, by the word that leaves them out."""

    ZEROS = "zeros"
    OTHER_SIDE = "other-side"
    OTHER_SIDE_CAMBER = "other-side-camber"
    SECOND_RADIUS = "second-radius"
    FLIPPED = "flipped"
    SMALL_CAMBER = "small-camber"
    CAMBER = "camber"
    SIDESLIP = "sideslip"
    COUPLED = "coupled"
    LOAD = "load"
    PRESSURE = "pressure"
    REVOLUTION = "revolution"
    CAMBER_ZERO = "camber-zero"
    LOADCELL_ZERO = "loadcell-zero"
    SIDESLIP_ZERO = "sideslip-zero"
    PATH_RADIUS = "path-radius"


class Declared(NamedTuple):
    """An uncertainty that [rig] declares."""

    key: str
    unit: str


DECLARED = {
    Kind.CAMBER_ZERO: Declared("u_camber_alignment_deg", CONDITIONS["gamma_deg"].unit),
    Kind.LOADCELL_ZERO: Declared("u_loadcell_offset_N", CHANNELS["Fy"].unit),
    Kind.SIDESLIP_ZERO: Declared("u_slip_alignment_N", f"{CHANNELS['Fy'].unit} of {CHANNELS['Fy'].word}"),
    Kind.PATH_RADIUS: Declared("u_path_radius", DIRECT["R"].unit),
}
"""Better measurements of the rig, and what of [rig] each lowers."""


@dataclass(frozen=True, slots=True)
class Run:
    """One entry of a plan: points to run, or a number of the rig to measure better."""

    kind: Kind
    load: float  #: [N]
    points: Points | None = None  #: set-points in ISO-W, without readings; None for a measurement
    camber_deg: float = 0.0  #: of coupled sweeps
    pressure_kPa: float | None = None  #: where it differs from the programme's
    rig: Mapping[str, float] = field(default_factory=dict)  #: keys of [rig] and their values from then on
    revolution: RollingRadiusTable | None = None

    @property
    def cost(self) -> int:
        """Number of points."""
        return 0 if self.points is None else len(self.points)

    @property
    def name(self) -> str:
        """A name for files, which no other candidate has."""
        camber = f"-{self.camber_deg:.0f}deg" if self.camber_deg else ""
        pressure = f"-{self.pressure_kPa:.0f}kPa" if self.pressure_kPa else ""
        return f"{self.kind.value}-{self.load:.0f}N{camber}{pressure}"

    def declared(self, config: Config) -> Config:
        """The configuration once this has been done."""
        changes: dict[str, Any] = {}
        if self.rig:
            changes["rig"] = config.rig.model_copy(update=dict(self.rig))
        if self.revolution is not None:
            changes["rolling_radius"] = (*config.rolling_radius, self.revolution)
        return config.model_copy(update=changes) if changes else config


def candidates(config: Config, points: Points, r_e: float | None = None) -> tuple[Run, ...]:
    """Runs that a rig could add to these points.

    Parameters
    ----------
    config : what is declared of the rig
    points : the programme so far
    r_e : effective radius at the nominal load [m] as the model has it, to foresee a disc revolution
    """
    return tuple(_all(_Programme(config, points), r_e))


class _Programme:
    """What was run, and lines of new set-points like it."""

    def __init__(self, config: Config, points: Points) -> None:
        self.config = config
        main = main_pressure(points) & (points.direction > 0) & (points.mount > 0) & ~points.continuous
        self.points, self.main = points, points.select(main if np.any(main) else np.ones(len(points), bool))
        level = levels.labels(self.main.Fz, levels.LOAD)
        self.loads = sorted(
            float(np.mean(self.main.Fz[level == k])) for k in range(level.max(initial=-1) + 1)
        )
        self.load = min(self.loads, key=lambda load: abs(load - config.tyre.nominal_load))
        self.slip = float(np.degrees(np.max(np.abs(self.main.alpha))))
        self.lean = float(np.degrees(np.max(np.abs(self.main.gamma))))
        self.pressure = float(np.mean(self.main.p))

    def line(self, load: float, alpha: Any = 0.0, gamma: Any = 0.0, **changes: Any) -> Points:
        """Set-points (n,) at angles in degrees, otherwise as most of the programme ran."""
        alpha, gamma = np.broadcast_arrays(np.atleast_1d(alpha).astype(float), gamma)
        usual = np.flatnonzero(self.main.phi_t == main_path(self.main))[0]
        like = self.main.select(np.full(len(alpha), usual))
        given = {
            "alpha": np.radians(alpha), "gamma": np.radians(gamma), "Fz": load, "p": self.pressure,
            "V": reference_speed(self.main), "phi_t": main_path(self.main), "direction": 1, "mount": 1,
            "line": 0, "sweep": 0, "file": 0, "sweep_names": ("planned",), "files": ("",),
        }  # fmt: skip
        unknown = dict.fromkeys(("Fy", "Mz", "Mx", "My", "t", "time", "iteration"), np.nan)
        noise = {name: _typical(getattr(self.points, name)) for name in ("u_Fy", "u_Mz", "T")}
        return like.replace(**(given | unknown | noise | changes))

    def both_ways(self, load: float, alpha: Any, **changes: Any) -> Points:
        """The same angles rolled forwards and backwards."""
        ways = [self.line(load, alpha, direction=way, **changes) for way in (1, -1)]
        return concatenate(ways)

    def cambers_at(self, load: float) -> np.ndarray:
        """Cambers [deg] at which a load was swept over sideslip."""
        near = np.abs(self.main.Fz / load - 1.0) < 0.05
        used = near & (np.abs(self.main.alpha) > np.radians(0.5))
        return np.unique(np.round(np.abs(np.degrees(self.main.gamma[used]))))


def _typical(values: np.ndarray) -> float:
    known = values[np.isfinite(values)]
    return float(np.median(known)) if len(known) else math.nan


def _all(seen: _Programme, r_e: float | None) -> Iterator[Run]:
    disc = seen.config.rig.on_disc
    slip, lean = seen.slip * np.array(SHARES), seen.lean * np.array(SHARES)
    if not seen.lean > 1.0:
        lean = np.array(NEAR_DEG)
    if disc:
        yield from _on_the_disc(seen)
        yield from _of_the_rig(seen, r_e)
    yield Run(Kind.FLIPPED, seen.load, seen.line(seen.load, slip[3:-3], mount=-1))
    for load in seen.loads:
        yield Run(Kind.SIDESLIP, load, seen.line(load, slip))
        yield Run(Kind.CAMBER, load, seen.line(load, 0.0, lean))
        for camber in CAMBERS_DEG:
            if camber not in seen.cambers_at(load) and camber <= max(seen.lean, NEAR_DEG[-1]):
                sides = [seen.line(load, slip, side * camber) for side in (-1.0, 1.0)]
                yield Run(Kind.COUPLED, load, concatenate(sides), camber_deg=camber)
        for factor in PRESSURES:
            p = factor * seen.pressure
            sweeps = [seen.line(load, slip, p=p), seen.line(load, 0.0, lean, p=p)]
            yield Run(Kind.PRESSURE, load, concatenate(sweeps), pressure_kPa=1e-3 * p)
    for load in (LOADS[0] * seen.loads[0], LOADS[1] * seen.loads[-1]):
        yield Run(Kind.LOAD, load, concatenate([seen.line(load, slip), seen.line(load, 0.0, lean)]))


def _on_the_disc(seen: _Programme) -> Iterator[Run]:
    """Runs that concern turn slip."""
    usual = main_path(seen.main)
    other = -usual
    narrow = math.copysign(abs(usual) / NARROWER, usual)
    for load in seen.loads:
        yield Run(Kind.ZEROS, load, seen.both_ways(load, ZEROS_DEG))
        yield Run(Kind.OTHER_SIDE, load, seen.both_ways(load, ZEROS_DEG, phi_t=other))
        yield Run(Kind.OTHER_SIDE_CAMBER, load, seen.line(load, 0.0, NEAR_DEG, phi_t=other))
        yield Run(Kind.SECOND_RADIUS, load, seen.both_ways(load, ZEROS_DEG, phi_t=narrow))
        yield Run(Kind.SMALL_CAMBER, load, seen.line(load, 0.0, NEAR_DEG))


def _of_the_rig(seen: _Programme, r_e: float | None) -> Iterator[Run]:
    """Better measurements of the rig itself."""
    rig, R = seen.config.rig, measured_path_radius(seen.config)
    for kind, (key, _) in DECLARED.items():
        u = float(R.std_dev) if kind is Kind.PATH_RADIUS and R is not None else getattr(rig, key)
        if u:
            yield Run(kind, seen.load, rig={key: BETTER * u})
    if not seen.config.rolling_radius and r_e is not None and rig.radius is not None:
        turns, rest = divmod(rig.radius / r_e, 1.0)
        table = RollingRadiusTable(
            load_N=round(seen.load, 1),
            revolutions=turns,
            angle_start_deg=0.0,
            angle_end_deg=round(360.0 * rest, 1),
        )
        yield Run(Kind.REVOLUTION, seen.load, revolution=table)
