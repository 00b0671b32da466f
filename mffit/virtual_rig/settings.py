"""Settings of the operator, point by point, from the sweeps of the plan."""

from __future__ import annotations

import math
from dataclasses import dataclass, field, fields, replace

import numpy as np

from mffit.virtual_rig.plan import RigPlan, SweepPlan
from tir.frozen import ReadOnlyArrays


@dataclass(frozen=True, slots=True)
class Settings(ReadOnlyArrays):
    """Set-points as read at every point of a sweep, in ISO-W axes and SI units; arrays (n,)."""

    alpha: np.ndarray  #: sideslip angle as read [rad]
    gamma: np.ndarray  #: camber as read [rad]
    Fz: np.ndarray  #: load [N]
    p: np.ndarray  #: inflation pressure [Pa]
    V: np.ndarray  #: speed, positive in both directions [m/s]
    T: np.ndarray  #: tyre temperature [degC]
    t: np.ndarray  #: time of the point [s]
    direction: np.ndarray  #: +1 forward, -1 backward
    mount: np.ndarray  #: +1 normal, -1 tyre turned on its rim
    rolled_m: np.ndarray  #: distance rolled since the start of the campaign [m]
    side: float = 1.0  #: side of the disc: 1 the usual one, -1 the other
    outward: float = 0.0  #: radius of the path less that of the usual path [m]
    kappa: np.ndarray = field(default_factory=lambda: np.zeros(1))  #: longitudinal slip (n,) or (1,) [-]
    free: bool = False  #: whether the wheel is undriven

    def __len__(self) -> int:
        return len(self.alpha)

    @property
    def sense(self) -> np.ndarray:
        """Sense (n,) of the steering's motion to each point: 1 up, -1 down, 0 held; the first point takes that of the second."""
        steps = np.sign(np.diff(np.degrees(self.alpha).round(6)))
        return np.concatenate([steps[:1], steps]) if len(steps) else np.zeros(len(self.alpha))

    @property
    def Vx(self) -> np.ndarray:
        """Signed speed (n,) [m/s]: negative when the wheel rolls backwards."""
        return np.asarray(self.direction * self.V)

    def at(self, alpha: np.ndarray, gamma: np.ndarray, kappa: np.ndarray) -> Settings:
        """The conditions of the first point at other angles (m,) [rad] and slips (m,)."""
        values = {f.name: getattr(self, f.name) for f in fields(self)}
        arrays = {name: value for name, value in values.items() if isinstance(value, np.ndarray)}
        repeated = {name: np.full(len(alpha), value[0]) for name, value in arrays.items()}
        return replace(self, **repeated | {"alpha": alpha, "gamma": gamma, "kappa": kappa})


def settings_of(plan: RigPlan) -> list[Settings]:
    """The settings of every sweep, in the order of the plan; time continues from sweep to sweep."""
    pause = plan.tables.conditions.seconds_per_point or 0.0
    found: list[Settings] = []
    begins = 0
    for sweep in plan.tables.sweep:
        found.append(_settings(plan, sweep, begins, pause))
        begins += len(found[-1])
    return _rolled(found)


def _rolled(sweeps: list[Settings]) -> list[Settings]:
    """The settings with the distance rolled; the speed changes linearly between points."""
    if not sweeps:
        return []
    t, V = (np.concatenate([getattr(sweep, name) for sweep in sweeps]) for name in ("t", "V"))
    distance = np.append(0.0, np.cumsum(np.diff(t) * (V[1:] + V[:-1]) / 2.0))
    ends = np.cumsum([len(sweep) for sweep in sweeps])[:-1]
    return [replace(s, rolled_m=d) for s, d in zip(sweeps, np.split(distance, ends), strict=True)]


def _settings(plan: RigPlan, sweep: SweepPlan, begins: int, pause: float) -> Settings:
    usual, usual_radius = plan.tables.conditions, plan.declared.rig.radius
    V, p, Fz, gamma, alpha, kappa = (
        grid.ravel()
        for grid in np.meshgrid(
            sweep.V_mps or usual.V_mps,
            sweep.p_kPa or usual.p_kPa or plan.declared.tyre.nominal_pressure,
            sweep.load_N,
            sweep.gamma_deg,
            sweep.alpha_deg,
            sweep.kappa,
            indexing="ij",
        )
    )
    n = len(alpha)
    temperatures = sweep.T_degC or (usual.T_degC,)
    return Settings(
        alpha=np.radians(alpha),
        gamma=np.radians(gamma),
        Fz=Fz,
        p=1e3 * p,
        V=V,
        T=np.linspace(temperatures[0], temperatures[-1], n),
        t=pause * (begins + np.arange(n)),
        direction=np.full(n, -1 if sweep.direction == "backward" else 1),
        mount=np.full(n, 1 if sweep.mount == "normal" else -1),
        rolled_m=np.zeros(n),
        side=float(np.sign(plan.path(sweep) * plan.phi_t_sign)),
        outward=0.0 if usual_radius is None else 1.0 / abs(plan.path(sweep)) - usual_radius,
        kappa=kappa,
        free=sweep.free_rolling,
    )


def usual_speed(sweeps: list[Settings]) -> float:
    """The most frequent speed [m/s]."""
    speeds, counts = np.unique(np.round(np.concatenate([sweep.V for sweep in sweeps]), 1), return_counts=True)
    return float(speeds[counts.argmax()]) if len(speeds) else math.nan
