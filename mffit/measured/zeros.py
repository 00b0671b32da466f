"""Points grouped by load, path and set-up, and the forces and moments of each group at zero sideslip and camber."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from uncertainties import UFloat

from mffit.config import Config, path_curvature
from mffit.constants import FALSE_ALARM, SAME_SIDESLIP, STRAIGHT, UPRIGHT, USUAL_U_FORCE, USUAL_U_MOMENT
from mffit.measured import constants, wording
from mffit.measured.axis import slope_at
from mffit.measured.uncertain import combined, named, polynomial
from mffit.points import Points, levels, main_pressure
from tir.frozen import ReadOnlyArrays

USUAL_U = {"Fy": USUAL_U_FORCE, "Mz": USUAL_U_MOMENT}
WAYS = {1: "forward", -1: "backward"}


@dataclass(frozen=True, slots=True)
class LoadGroup(ReadOnlyArrays):
    """The freely rolling points of one load at the main pressure, normal mount."""

    load: float  #: mean load [N]
    index: np.ndarray  #: (m,) indices of the points

    def of(self, mask: np.ndarray) -> LoadGroup:
        """The group restricted to a mask (m,)."""
        return LoadGroup(self.load, self.index[mask])


def load_groups(points: Points) -> tuple[LoadGroup, ...]:
    """The steady, freely rolling points at the main pressure, grouped by rising load; points between two loads are left out."""
    used = np.flatnonzero(_usual(points) & (points.mount > 0))
    level = levels.labels(points.Fz[used], levels.LOAD)
    parts = [used[level == k] for k in range(level.max(initial=levels.NO_LEVEL) + 1)]
    return tuple(LoadGroup(float(np.mean(points.Fz[part])), part) for part in parts)


def _usual(points: Points) -> np.ndarray:
    return np.asarray(main_pressure(points) & points.free_rolling & ~points.continuous)


def flipped(points: Points, group: LoadGroup) -> LoadGroup:
    """The points at the group's load and the main pressure with the tyre turned on its rim."""
    used = np.flatnonzero(_usual(points) & (points.mount < 0))
    near = np.abs(points.Fz[used] - group.load) < levels.LOAD.tolerance * group.load
    return LoadGroup(group.load, used[near])


def zeros(points: Points, group: LoadGroup, direction: int) -> np.ndarray:
    """Indices of the group's points at zero sideslip and camber, rolling in ``direction`` (+1, -1)."""
    i = group.index
    size = np.abs(points.alpha[i])
    near = (
        (size < STRAIGHT.rad) & (np.abs(points.gamma[i]) < UPRIGHT.rad) & (points.direction[i] == direction)
    )
    return np.asarray(i[near & (size < np.min(size[near], initial=np.inf) + SAME_SIDESLIP.rad)])


@dataclass(frozen=True, slots=True)
class PathZeros:
    """The forces and the moment at zero sideslip and camber of one load, path and set-up."""

    phi_t: float  #: turn slip of the path [1/m]
    setup: str  #: name of the set-up
    group: LoadGroup  #: points of this load, path and set-up
    forward: UFloat  #: force rolling forwards, corrected for the sideslip of backlash [N]
    backward: UFloat | None  #: force rolling backwards [N]; None without backward runs
    moment: UFloat | None  #: turn-slip moment [Nm]
    side_of_play: float
    """Sign of the sideslip that backlash adds to a forward reading of zero; 0 without play."""

    @property
    def readings(self) -> tuple[UFloat, ...]:
        """The force rolling forwards and, if it was run, backwards [N]."""
        return (self.forward,) if self.backward is None else (self.forward, self.backward)

    def mean(self, *, both: bool) -> UFloat:
        """Force at zero [N]: the mean of both directions, or that of the forward runs only."""
        readings = self.readings if both else (self.forward,)
        return sum(readings) / len(readings)

    @property
    def slip(self) -> UFloat:
        """Half the difference of both directions [N]: the force of the misaligned sideslip zero."""
        return (self.forward - self.backward) / 2.0


def zeros_by_path(
    points: Points, group: LoadGroup, C_alpha: UFloat | None, config: Config
) -> list[PathZeros]:
    """The zeros of every path and set-up with forward zeros at this load, the usual path first."""
    slope, usual = slope_at(C_alpha, group.load), path_curvature(config.rig)
    phi_t, setup = points.phi_t[group.index], points.setup[group.index]
    paths = sorted({*zip(phi_t.tolist(), setup.tolist(), strict=True)}, key=lambda x: (abs(x[0] - usual), x))
    found = []
    for path, k in paths:
        part = group.of((phi_t == path) & (setup == k))
        forward, backward = (force_at_zero(points, part, way, slope) for way in WAYS)
        if forward is None:
            continue
        moments = [
            way * moment
            for way in WAYS
            if (moment := _at_zero(points, part, way, "Mz", "noise of the zero moment")) is not None
        ]
        moment = sum(moments) / len(moments) if moments else None
        play = float(np.sign(np.mean(points.alpha[zeros(points, part, 1)])))
        side = play if config.rig.backlash_deg else 0.0
        found.append(PathZeros(path, points.setups[k], part, forward, backward, moment, side))
    return found


def force_at_zero(points: Points, group: LoadGroup, way: int, slope: float) -> UFloat | None:
    """Side force [N] at zero sideslip and camber in one direction of rolling; None if it was not run.

    ``slope`` is the cornering stiffness [N/rad].
    """
    return _at_zero(points, group, way, "Fy", f"noise of the {WAYS[way]} zeros", way * slope)


def u_of(points: Points, channel: str) -> np.ndarray:
    """Standard uncertainty (n,) of Fy or Mz: as stated, else the usual one."""
    u = points.u(channel)
    return np.where(np.isfinite(u), u, USUAL_U[channel])


def _at_zero(
    points: Points, group: LoadGroup, direction: int, channel: str, source: str, slope: float = 0.0
) -> UFloat | None:
    """Value at zero sideslip: from a local parabola if there are enough angles, else the mean of the zeros.

    ``slope`` corrects zeros that backlash has shifted. None if the direction was not run.
    """
    y, u, unit = points.channel(channel), u_of(points, channel), "N" if channel == "Fy" else "Nm"
    i = zeros(points, group, direction)
    i = i[np.isfinite(y[i])]
    if not len(i):
        return None
    reach = constants.PARABOLA_SIDESLIP.rad
    near = group.index
    near = near[
        (np.abs(points.alpha[near]) < reach)
        & (np.abs(points.gamma[near]) < UPRIGHT.rad)
        & (points.direction[near] == direction)
        & np.isfinite(y[near])
    ]
    x = points.alpha[near]
    angles = len(np.unique(np.round(x, 3)))
    if angles >= constants.POINTS_FOR_PARABOLA and x.min() < -reach / 2 and x.max() > reach / 2:
        found, errors = polynomial(x, y[near], u[near], (0, 1, 2))
        return named(found[0], errors[0], source, unit, kind="A")
    mean = float(np.mean(y[i] - slope * points.alpha[i]))
    return named(mean, float(np.linalg.norm(u[i])) / len(i), source, unit, kind="A")


def unlike_zeros(points: Points, group: LoadGroup, C_alpha: UFloat | None, config: Config) -> list[str]:
    """Warnings about sweeps of one load, path, set-up and direction with significantly different zeros."""
    u, slope = math.hypot(config.rig.u("alpha_0_deg"), USUAL_U_FORCE), slope_at(C_alpha, group.load)
    out = []
    for direction, word in WAYS.items():
        rows = zeros(points, group, direction)
        rows = rows[np.isfinite(points.Fy[rows])]
        force, sweep = points.Fy[rows] - direction * slope * points.alpha[rows], points.sweep[rows]
        found = {int(k): float(np.mean(force[sweep == k])) for k in np.unique(sweep)}
        readings = [named(force, u, "zero of a sweep", "N") for force in found.values()]
        if readings and combined(readings).chance < FALSE_ALARM:
            least, most = (f(found, key=lambda k: found[k]) for f in (min, max))
            forces = {"low": found[least], "high": found[most]}
            names = {"least": points.sweep_names[least], "most": points.sweep_names[most]}
            out.append(wording.ZEROS_DISAGREE.format(load=group.load, way=word, **names, **forces))
    return out
