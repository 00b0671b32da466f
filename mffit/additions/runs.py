"""The runs that could be added to a programme, in the form of points."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import product
from typing import Any

import numpy as np

from mffit.additions import constants
from mffit.additions.kinds import ADDITIONS, Addition, LineOfPoints
from mffit.as_json import keys
from mffit.config import Config, SweepTable, setup_names
from mffit.constants import CAMBER_OF_SLOPES
from mffit.measured import was_coupled
from mffit.points import Points, levels, main_path, main_pressure
from mffit.points.points import concatenate
from mffit.quantities import CHANNELS, CONDITIONS
from mffit.rig import reference_speed
from mffit.scatter import finite_median


@dataclass(frozen=True, slots=True)
class PlannedRun:
    """One entry of a plan: points to run."""

    addition: Addition
    load: float  #: [N]
    points: Points  #: set-points in ISO-W axes, without readings
    held_deg: float = 0.0  #: camber of coupled sweeps, sideslip of sweeps of combined slip
    pressure_kPa: float | None = None  #: pressure if it differs from the programme's

    @property
    def cost(self) -> int:
        """Number of points."""
        return len(self.points)

    @property
    def name(self) -> str:
        """Stem of the run's files, unique among the candidates."""
        angle = f"-{abs(self.held_deg):.0f}deg" if self.held_deg else ""
        pressure = f"-{self.pressure_kPa:.0f}kPa" if self.pressure_kPa else ""
        return f"{self.addition.id}-{self.load:.0f}N{angle}{pressure}"

    @property
    def title(self) -> str:
        """The run in a few words."""
        more = f", {self.held_deg:g} deg" if self.held_deg else ""
        more += f", {CONDITIONS['p_kPa'].of(self.pressure_kPa)}" if self.pressure_kPa else ""
        return f"{self.addition.title}, {CONDITIONS['Fz_N'].of(self.load)}{more}"


keys(PlannedRun, "name kind=addition.id title reason=addition.reason points=cost")


def candidates(
    config: Config, points: Points, unspun: float | None = None, kinds: Sequence[Addition] = ADDITIONS
) -> tuple[PlannedRun, ...]:
    """Every run that this rig could add to these points; ``unspun`` is the camber [rad] at which the path gives no spin."""
    programme = _Programme(config, points, unspun)
    here = "disc" if config.rig.on_disc else "belt"
    return tuple(
        run
        for addition in kinds
        if addition.rig in ("any", here)
        for load in programme.loads_of(addition)
        for run in _runs_of(programme, addition, load)
    )


def _runs_of(programme: _Programme, addition: Addition, load: float) -> Iterator[PlannedRun]:
    """The runs of an addition at one load."""
    for held_deg, factor in product(programme.held_deg(addition, load), addition.pressures):
        p = factor * programme.pressure
        lines = [programme.line(line, addition, load, p, held_deg) for line in addition.lines]
        yield PlannedRun(addition, load, concatenate(lines), held_deg, None if factor == 1.0 else 1e-3 * p)


def swept(points: Points) -> Points:
    """Points with sideslip, camber or longitudinal slip; all points if there are none."""
    found = _beyond(points.alpha, levels.SIDESLIP) | _beyond(points.gamma, levels.CAMBER)
    found |= ~points.free_rolling
    return points.select(found) if np.any(found) else points


def _beyond(values: np.ndarray, kind: levels.LevelKind) -> np.ndarray:
    """Mask (n,) of the values that differ from zero by more than the tolerance of their kind."""
    return np.asarray(np.abs(values) > kind.tolerance)


def largest_slip(points: Points) -> float:
    """Largest longitudinal slip that was run; a usual value if none was run."""
    largest = float(np.max(np.abs(points.kappa), initial=0.0))
    # Step tests for a relaxation length use slips too small to count as sweeps.
    return largest if largest > 2.0 * levels.SLIP.tolerance else float(constants.LARGEST_SLIP)


class _Programme:
    """The present programme, and new set-points like its own."""

    def __init__(self, config: Config, points: Points, unspun: float | None) -> None:
        main = main_pressure(points) & (points.direction > 0) & (points.mount > 0) & ~points.continuous
        self.config, self.unspun = config, unspun
        self.points, self.main = points, points.select(main if np.any(main) else np.ones(len(points), bool))
        Fz = swept(self.main).Fz
        level = levels.labels(Fz, levels.LOAD)
        self.loads = sorted(float(np.mean(Fz[level == k])) for k in range(level.max(initial=-1) + 1))
        self.pressure = float(np.mean(self.main.p))
        self.largest = {
            "alpha": float(np.max(np.abs(self.main.alpha))),
            "gamma": float(np.max(np.abs(self.main.gamma))),
            "kappa": largest_slip(points),
        }
        if not self.largest["gamma"] > levels.CAMBER.tolerance:
            self.largest["gamma"] = CAMBER_OF_SLOPES.rad

    def loads_of(self, addition: Addition) -> list[float]:
        """Loads [N] at which an addition is run."""
        if addition.loads == "each":
            return self.loads
        if addition.loads == "nominal":
            return [min(self.loads, key=lambda load: abs(load - self.config.tyre.nominal_load))]
        low, high = constants.NEW_LOAD_FACTORS
        return [low * self.loads[0], high * self.loads[-1]]

    def held_deg(self, addition: Addition, load: float) -> list[float]:
        """Held angles [deg] of an addition's runs; for coupled sweeps only those that the programme lacks at this load."""
        if addition.unspun:
            at = self.points.select(np.abs(np.log(self.points.Fz / load)) < levels.LOAD.tolerance)
            lacking = [] if self.unspun is None or was_coupled(at, self.unspun) else [self.unspun]
            return [round(math.degrees(camber), 1) for camber in lacking]
        if addition.held == "alpha" or addition.rig == "belt" or not any(addition.held_deg):
            return list(addition.held_deg)
        near = np.abs(np.log(self.main.Fz / load)) < levels.LOAD.tolerance
        there = near & _beyond(self.main.alpha, levels.SIDESLIP)
        run_already = np.round(np.abs(np.degrees(self.main.gamma[there])))
        most = max(np.degrees(self.largest["gamma"]), float(CAMBER_OF_SLOPES))
        return [angle for angle in addition.held_deg if angle not in run_already and angle <= most]

    def line(self, line: LineOfPoints, addition: Addition, load: float, p: float, held_deg: float) -> Points:
        """Set-points (n,) of one line of an addition."""
        largest = self.largest[line.over] if line.largest_deg is None else np.radians(line.largest_deg)
        angles = largest * np.array(line.shares)
        phi_t = main_path(self.main) / addition.radius
        usual = np.flatnonzero(self.main.phi_t == main_path(self.main))[0]
        given: dict[str, Any] = {
            "alpha": 0.0, "gamma": 0.0, "kappa": 0.0, "Fz": load, "p": p, "V": addition.speed * reference_speed(self.main),
            "phi_t": phi_t, "direction": line.direction, "mount": addition.mount,
            "line": 0, "sweep": 0, "file": 0, "sweep_names": ("planned",), "files": ("",),
            "setup": 0, "setups": (setup_on(self.config, self.points, phi_t),),
        }  # fmt: skip
        given |= {addition.held: np.radians(line.side * held_deg), line.over: angles}
        unknown = dict.fromkeys((*CHANNELS, "t", "time", "iteration"), np.nan)
        uncertain = (*(f"u_{name}" for name in CHANNELS), "T")
        typical = {name: finite_median(getattr(self.points, name)) for name in uncertain}
        typical["T"] += addition.warmer
        typical["t"] = np.max(np.nan_to_num(self.points.t)) + addition.later
        return self.main.select(np.full(len(angles), usual)).replace(**(given | unknown | typical))


def setup_on(config: Config, points: Points, phi_t: float) -> str:
    """Name of the set-up of a run on a path: that of the points on this path, else a new one, named as in a build."""
    there = np.flatnonzero(np.isclose(points.phi_t, phi_t))
    if len(there):
        return str(points.setups[points.setup[there[-1]]])
    usual, other = (
        SweepTable(file="a"),
        SweepTable(file="b", path_centre="left" if phi_t < 0.0 else "right", path_radius=1.0 / abs(phi_t)),
    )
    return setup_names(config.rig, (usual, other))[1]


def new_setups(config: Config, points: Points) -> tuple[str, ...]:
    """Names of the set-ups that a plan may add: one for every new path."""
    paths = {main_path(points) / addition.radius for addition in ADDITIONS}
    names = {setup_on(config, points, phi_t) for phi_t in paths if phi_t}
    return tuple(sorted(names - set(points.used_setups)))
