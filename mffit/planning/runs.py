"""The runs and measurements that could be added to a programme, each of which a build can use."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from itertools import groupby, product
from typing import Any

import numpy as np

from mffit.config import Config, RollingRadiusTable, SweepTable, setup_names
from mffit.measured import measured_path_radius
from mffit.planning import constants
from mffit.planning.additions import ADDITIONS, BY_ID, Addition, LineOfPoints
from mffit.points import Points, levels, main_path, main_pressure
from mffit.points.points import concatenate
from mffit.quantities import CHANNELS
from mffit.rig import reference_speed
from mffit.scatter import finite_median


@dataclass(frozen=True, slots=True)
class PlannedRun:
    """One entry of a plan: points to run, or a number of the rig to measure better."""

    addition: Addition
    load: float  #: [N]
    points: Points | None = None  #: set-points in ISO-W, without readings; None for a measurement
    camber_deg: float = 0.0  #: of coupled sweeps
    sideslip_deg: float = 0.0  #: of sweeps of combined slip
    pressure_kPa: float | None = None  #: where it differs from the programme's
    rig: Mapping[str, float] = field(default_factory=dict)  #: keys of [rig] and their values from then on
    revolution: RollingRadiusTable | None = None

    @property
    def cost(self) -> int:
        """Number of points."""
        return 0 if self.points is None else len(self.points)

    @property
    def name(self) -> str:
        """Stem of the run's files, unique among the candidates."""
        angle = self.camber_deg or self.sideslip_deg
        camber = f"-{angle:.0f}deg" if angle else ""
        pressure = f"-{self.pressure_kPa:.0f}kPa" if self.pressure_kPa else ""
        return f"{self.addition.id}-{self.load:.0f}N{camber}{pressure}"

    def declared(self, config: Config) -> Config:
        """The configuration once this has been done."""
        changes: dict[str, Any] = {}
        if self.rig:
            changes["rig"] = config.rig.model_copy(update=dict(self.rig))
        if self.revolution is not None:
            changes["rolling_radius"] = (*config.rolling_radius, self.revolution)
        return config.model_copy(update=changes) if changes else config


def candidates(config: Config, points: Points, r_e: float | None = None) -> tuple[PlannedRun, ...]:
    """Every run that a rig could add to these points, load by load.

    ``r_e`` is the effective radius of the model at the nominal load [m], to predict a disc revolution.
    """
    programme = _Programme(config, points)
    possible = [
        addition
        for addition in ADDITIONS
        if not (addition.belt_only if config.rig.on_disc else addition.disc_only)
    ]
    found: list[PlannedRun] = []
    for loads, group in groupby(possible, key=lambda addition: addition.loads):
        additions = list(group)
        for load in programme.loads_of(loads):
            for addition in additions:
                if addition.declares:
                    found += _better_declared(config, addition, load)
                elif addition.revolution:
                    found += _revolution(config, addition, load, r_e)
                elif addition.rolling:
                    found.append(PlannedRun(addition, load, programme.rolling()))
                else:
                    found += _with_points(programme, addition, load)
    return tuple(found)


def swept(points: Points) -> Points:
    """Points at which the wheel was steered, leaned or driven; all of them if it only rolled straight."""
    steered = np.abs(points.alpha) > constants.PLAN_COUPLED_SIDESLIP.rad
    leaned = np.abs(points.gamma) > constants.PLAN_SMALLEST_CAMBER_SWEPT.rad
    found = steered | leaned | ~points.free_rolling
    return points.select(found) if np.any(found) else points


def largest_slip(points: Points) -> float:
    """Largest longitudinal slip of sweeps; a usual one where none was run."""
    largest = float(np.max(np.abs(points.kappa[~points.free_rolling]), initial=0.0))
    return largest if largest > constants.PLAN_SMALLEST_SLIP_SWEPT else float(constants.PLAN_LARGEST_SLIP)


class _Programme:
    """What has been run, and new set-points like it."""

    def __init__(self, config: Config, points: Points) -> None:
        main = main_pressure(points) & (points.direction > 0) & (points.mount > 0) & ~points.continuous
        self.config = config
        self.points, self.main = points, points.select(main if np.any(main) else np.ones(len(points), bool))
        Fz = swept(self.main).Fz
        level = levels.labels(Fz, levels.LOAD)
        self.loads = sorted(float(np.mean(Fz[level == k])) for k in range(level.max(initial=-1) + 1))
        self.load = min(self.loads, key=lambda load: abs(load - config.tyre.nominal_load))
        self.largest = {
            name: float(np.degrees(np.max(np.abs(getattr(self.main, name))))) for name in ("alpha", "gamma")
        }
        self.largest["kappa"] = largest_slip(points)
        self.pressure = float(np.mean(self.main.p))
        self.phi_t = main_path(self.main)

    def loads_of(self, which: str) -> list[float]:
        """Loads [N] at which additions are run."""
        low, high = constants.PLAN_NEW_LOAD_FACTORS
        new = [low * self.loads[0], high * self.loads[-1]]
        return {"each": self.loads, "nominal": [self.load], "new": new}[which]

    def angles(self, line: LineOfPoints) -> np.ndarray:
        """Angles [deg] or slips (n,) of a line."""
        if line.angles.unit == "deg" or line.absolute:
            return np.array(line.angles)
        if line.over == "gamma" and not self.largest["gamma"] > constants.PLAN_SMALLEST_CAMBER_SWEPT:
            return np.array(constants.PLAN_SMALL_CAMBERS)
        return self.largest[line.over] * np.array(line.angles)

    def cambers(self, addition: Addition, load: float) -> list[float]:
        """Cambers [deg] of an addition's coupled sweeps that the programme lacks at a load; [0] for other additions."""
        if addition.cambers is None:
            return [0.0]
        near = np.abs(self.main.Fz / load - 1.0) < constants.PLAN_COUPLED_LOAD_TOLERANCE
        swept = near & (np.abs(self.main.alpha) > constants.PLAN_COUPLED_SIDESLIP.rad)
        run_already = np.round(np.abs(np.degrees(self.main.gamma[swept])))
        if addition.belt_only:
            return list(addition.cambers)
        most = max(self.largest["gamma"], constants.PLAN_SMALL_CAMBERS[-1])
        return [camber for camber in addition.cambers if camber not in run_already and camber <= most]

    def rolling(self) -> Points:
        """Set-points (n,) of an upright wheel that rolls freely straight on, at all loads and several pressures."""
        straight = LineOfPoints("alpha", constants.PLAN_ZERO_ANGLES)
        one = self.line(straight, BY_ID["rolling"], load=self.load, camber_deg=0.0, p=self.pressure)
        low, high = self.loads_of("new")
        loads = [low, *self.loads, high]
        grid = [
            (load, factor * self.pressure) for load in loads for factor in constants.PLAN_ROLLING_PRESSURES
        ]
        Fz, p = np.array(grid).T
        return one.select(np.zeros(len(grid), dtype=int)).replace(alpha=0.0, Fz=Fz, p=p)

    def sideslips(self, addition: Addition) -> list[float]:
        """Sideslips [deg] of an addition's sweeps of combined slip; [0] for other additions."""
        return [0.0] if addition.sideslips is None else list(addition.sideslips)

    def line(
        self,
        line: LineOfPoints,
        addition: Addition,
        *,
        load: float,
        camber_deg: float,
        p: float,
        sideslip_deg: float = 0.0,
    ) -> Points:
        """Set-points (n,) of one line of an addition."""
        angles = self.angles(line) if line.over == "kappa" else np.radians(self.angles(line))
        usual = np.flatnonzero(self.main.phi_t == self.phi_t)[0]
        like = self.main.select(np.full(len(angles), usual))
        phi_t = self.phi_t / addition.radius
        given = {
            "alpha": np.radians(line.steer_side * sideslip_deg),
            "gamma": np.radians(line.camber_side * camber_deg), "Fz": load, "p": p,
            "V": constants.PLAN_STEP_SPEED if addition.steps else reference_speed(self.main),
            "phi_t": phi_t, "direction": line.direction,
            "mount": addition.mount, "line": 0, "sweep": 0, "file": 0, "sweep_names": ("planned",), "files": ("",),
            "setup": 0, "setups": (setup_on(self.config, self.points, phi_t),),
        }  # fmt: skip
        unknown = dict.fromkeys((*CHANNELS, "t", "time", "iteration"), np.nan) | {"kappa": 0.0}
        uncertain = (*(f"u_{name}" for name in CHANNELS), "T")
        typical = {name: finite_median(getattr(self.points, name)) for name in uncertain}
        return like.replace(**(given | unknown | typical | {line.over: angles}))


def setup_on(config: Config, points: Points, phi_t: float) -> str:
    """Name of the set-up in which a run on a path would be: that of the points there, else a new one, as a build calls it."""
    there = np.flatnonzero(np.isclose(points.phi_t, phi_t))
    if len(there):
        return points.setups[points.setup[there[-1]]]
    centre: Any = "left" if phi_t < 0.0 else "right"
    usual, other = (
        SweepTable(file="a"),
        SweepTable(file="b", path_centre=centre, path_radius=1.0 / abs(phi_t)),
    )
    return setup_names(config.rig, (usual, other))[1]


def new_setups(config: Config, points: Points) -> tuple[str, ...]:
    """Names of the set-ups that a plan may add: one for every path that was not run."""
    paths = {main_path(points) / addition.radius for addition in ADDITIONS}
    names = {setup_on(config, points, phi_t) for phi_t in paths if phi_t}
    return tuple(sorted(names - set(points.used_setups)))


def _with_points(programme: _Programme, addition: Addition, load: float) -> Iterator[PlannedRun]:
    """The runs of an addition at one load: one per camber and pressure."""
    kinds = product(
        programme.cambers(addition, load), programme.sideslips(addition), addition.pressures or (1.0,)
    )
    for camber, sideslip, factor in kinds:
        p = factor * programme.pressure
        lines = [
            programme.line(line, addition, load=load, camber_deg=camber, p=p, sideslip_deg=sideslip)
            for line in addition.lines
        ]
        yield PlannedRun(
            addition,
            load,
            concatenate(lines),
            camber_deg=camber,
            sideslip_deg=sideslip,
            pressure_kPa=None if addition.pressures is None else 1e-3 * p,
        )


def _better_declared(config: Config, addition: Addition, load: float) -> Iterator[PlannedRun]:
    """A better measurement of a number of the rig whose uncertainty is declared."""
    R = measured_path_radius(config) if addition.declares == "u_path_radius" else None
    u = getattr(config.rig, addition.declares) if R is None else float(R.std_dev)
    if u:
        yield PlannedRun(addition, load, rig={addition.declares: constants.PLAN_RIG_IMPROVEMENT * u})


def _revolution(config: Config, addition: Addition, load: float, r_e: float | None) -> Iterator[PlannedRun]:
    """The disc revolution that would measure r_e, where none was made."""
    if config.rolling_radius or r_e is None or config.rig.radius is None:
        return
    turns, rest = divmod(config.rig.radius / r_e, 1.0)
    table = RollingRadiusTable(
        load_N=round(load, 1), revolutions=turns, angle_start_deg=0.0, angle_end_deg=round(360.0 * rest, 1)
    )
    yield PlannedRun(addition, load, revolution=table)
