"""Readings at zero sideslip and camber of one load, and the turn-slip force and moment in them."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from uncertainties import UFloat

from mffit.config import Config, path_curvature
from mffit.constants import USUAL_CORNERING_STIFFNESS, USUAL_U_FORCE, USUAL_U_MOMENT, ZERO_CAMBER
from mffit.errors import InputError
from mffit.measured import camber_reduction as method
from mffit.measured import constants, notes
from mffit.measured.groups import LoadGroup, zeros
from mffit.measured.paths import PathForce, by_path
from mffit.measured.slip_stiffness import SlipStiffness
from mffit.measured.sources import named
from mffit.points import Points
from mffit.rig_errors import AtZero


class ZeroReadings(NamedTuple):
    """Forces and moment at zero sideslip and camber of one load, path and set-up."""

    forward: float  #: [N], corrected for the sideslip of backlash
    backward: float  #: NaN without backward runs
    u_forward: float
    u_backward: float
    moment: UFloat | None  #: turn-slip moment [Nm]
    side_of_play: (
        float  #: sign of the sideslip that backlash adds to a forward reading of zero; 0 without play
    )


class PathInSetup(NamedTuple):
    """A path in one set-up."""

    phi_t: float  #: turn slip of the path [1/m]
    setup: str  #: name of the set-up


class PathZeros(NamedTuple):
    """The readings at zero of one path in one set-up, and the points that they are from."""

    phi_t: float  #: turn slip of the path [1/m]
    setup: str  #: name of the set-up
    readings: ZeroReadings
    group: LoadGroup

    @property
    def place(self) -> PathInSetup:
        """Its path and set-up."""
        return PathInSetup(self.phi_t, self.setup)


def zeros_by_path(
    points: Points, group: LoadGroup, C_alpha: UFloat | None, config: Config
) -> list[PathZeros]:
    """The zeros of every path and set-up with forward zeros at this load, the usual path first."""
    found = (
        PathZeros(path.phi_t, path.setup, _zeros(points, path.group, C_alpha, config), path.group)
        for path in by_path(points, group, path_curvature(config.rig))
    )
    return [path for path in found if np.isfinite(path.readings.forward)]


def _zeros(points: Points, group: LoadGroup, C_alpha: UFloat | None, config: Config) -> ZeroReadings:
    """Forces and moments at zero sideslip in both directions, corrected for the play."""
    slope = _slope(C_alpha, group)
    u_Fy = np.where(np.isfinite(points.u_Fy), points.u_Fy, USUAL_U_FORCE)
    u_Mz = np.where(np.isfinite(points.u_Mz), points.u_Mz, USUAL_U_MOMENT)
    forward = _at_zero(points, group, 1, points.Fy, u_Fy, slope)
    backward = _at_zero(points, group, -1, points.Fy, u_Fy, -slope)
    moments = [_at_zero(points, group, direction, points.Mz, u_Mz, None) for direction in (1, -1)]
    known = [
        named(value, u, "noise of the zero moment", "Nm", kind="A")
        for value, u in moments
        if math.isfinite(value)
    ]
    moment = (known[0] - known[1]) / 2.0 if len(known) == 2 else known[0] if known else None
    i = zeros(points, group, 1)
    side = float(np.sign(np.mean(points.alpha[i]))) if len(i) and config.rig.backlash_deg else 0.0
    return ZeroReadings(forward[0], backward[0], forward[1], backward[1], moment, side)


def _slope(C_alpha: UFloat | None, group: LoadGroup) -> float:
    """Cornering stiffness [N/rad]; the usual one where none was measured."""
    return -USUAL_CORNERING_STIFFNESS * group.load if C_alpha is None else float(C_alpha.nominal_value)


def _at_zero(
    points: Points, group: LoadGroup, direction: int, y: np.ndarray, u: np.ndarray, slope: float | None
) -> tuple[float, float]:
    """Value at zero sideslip and its u: a local parabola through five angles or more, else the mean of the zeros.

    With ``slope``, zeros shifted by backlash are moved back. NaN if the direction was not run.
    """
    i = zeros(points, group, direction)
    i = i[np.isfinite(y[i])]
    if not len(i):
        return math.nan, math.nan
    reach = constants.PARABOLA_SIDESLIP.rad
    near = group.index[
        (np.abs(points.alpha[group.index]) < reach)
        & (np.abs(points.gamma[group.index]) < ZERO_CAMBER.rad)
        & (points.direction[group.index] == direction)
        & np.isfinite(y[group.index])
    ]
    x = points.alpha[near]
    angles = len(np.unique(np.round(x, 3)))
    if angles >= constants.POINTS_FOR_PARABOLA and x.min() < -reach / 2 and x.max() > reach / 2:
        A = np.vander(x, 3) / u[near, None]
        cov = np.linalg.inv(A.T @ A)
        return float((cov @ A.T @ (y[near] / u[near]))[2]), float(np.sqrt(cov[2, 2]))
    values = y[i] - (slope * points.alpha[i] if slope is not None else 0.0)
    return float(np.mean(values)), float(np.sqrt(np.sum(u[i] ** 2)) / len(i))


def unlike_zeros(points: Points, group: LoadGroup, C_alpha: UFloat | None, config: Config) -> list[str]:
    """Warnings about sweeps of one load, path, set-up and direction whose zeros differ by more than noise explains."""
    slope = _slope(C_alpha, group)
    u_difference = math.sqrt(2.0) * math.hypot(config.rig.u("alpha_0_deg"), USUAL_U_FORCE)
    out = []
    for direction in (1, -1):
        i = zeros(points, group, direction)
        i = i[np.isfinite(points.Fy[i])]
        force = points.Fy[i] - direction * slope * points.alpha[i]
        found = sorted(
            (float(np.mean(force[points.sweep[i] == k])), int(k)) for k in np.unique(points.sweep[i])
        )
        if found and found[-1][0] - found[0][0] > constants.UNLIKE_ZEROS * u_difference:
            (least, a), (most, b) = found[0], found[-1]
            names = (points.sweep_names[a], points.sweep_names[b])
            way = "forward" if direction > 0 else "backward"
            out.append(notes.zeros_disagree(group.load, way, names, (least, most)))
    return out


def angle_at_zero(found: PathZeros, stiffness: SlipStiffness) -> UFloat | None:
    """alpha_M [rad] of one path in one set-up: the angle of half the difference of both directions; None without both."""
    if not math.isfinite(found.readings.backward):
        return None
    forward, backward = _noisy(found.readings)
    slip = (forward - backward) / 2.0
    # The difference is odd in the angle, so the slope at true zero counts, not that at the reading of zero.
    return slip / stiffness.at(slip / stiffness.C_alpha)


def turn_slip_of_path(
    found: PathZeros,
    stiffness: SlipStiffness,
    C_gamma: UFloat | None,
    rig: method.UncertainRig,
    config: Config,
    scatter: UFloat | None = None,
    alpha_M: UFloat | None = None,
) -> PathForce:
    """The corrected turn-slip force of one path in one set-up.

    Parameters
    ----------
    found : the readings
    stiffness : over sideslip
    C_gamma : camber stiffness [N/rad]
    rig : the uncertain rig errors; the angles are already corrected for the play
    config : declares the usual path
    scatter : force of this set-up that repeated set-ups show beyond what is declared [N]
    alpha_M : of the set-up at this load [rad]; None if no load of it was run both ways

    Notes
    -----
    Of both directions the mean counts, in which alpha_M drops out; a forward reading alone is corrected for its force.
    """
    zero, phi_t, errors = found.readings, found.phi_t, rig.at(found.setup)
    at = AtZero(stiffness.C_alpha, 0.0 if C_gamma is None else C_gamma, zero.side_of_play)
    readings = _noisy(zero)
    both = len(readings) > 1
    force = sum(readings) / len(readings)
    if alpha_M is not None and not both:
        force = force - stiffness.force(alpha_M, math.copysign(1.0, phi_t * path_curvature(config.rig)))
    force = method.turn_slip_force(force, errors, at, both_directions=both or alpha_M is not None)
    # The wheel is moved from path to path by known distances, so one error of R is common to all.
    usual = config.rig.radius
    assert usual is not None
    return PathForce(
        sign=float(np.sign(phi_t)),
        R=rig.R + (1.0 / abs(phi_t) - usual),
        at=_plain(at),
        readings=readings,
        force=force if scatter is None else force - scatter,
        setup=found.setup,
        scatter=scatter,
    )


def _noisy(zero: ZeroReadings) -> tuple[UFloat, ...]:
    """The forces forwards, and backwards if that was run, with the noise of their readings [N]."""
    forward = named(zero.forward, zero.u_forward, "noise of the forward zeros", "N", kind="A")
    if not math.isfinite(zero.backward):
        return (forward,)
    return forward, named(zero.backward, zero.u_backward, "noise of the backward zeros", "N", kind="A")


def _plain(at: AtZero) -> AtZero:
    """The same without uncertainties."""
    return AtZero(*(float(getattr(x, "nominal_value", x)) for x in at))


def refuse_inward(force: float, load: float, alpha_M: UFloat | None, config: Config) -> None:
    """Refuse a turn-slip force that points towards the centre of the disc.

    Raises
    ------
    InputError
    """
    if alpha_M is None:
        cause = "sideslip misaligned by a degree or more (run mffit align with forward and backward zeros), or path_centre wrong"
    else:
        cause = "path_centre or axes are wrong, as forward and backward runs agree on it"
    raise InputError(
        f"the turn-slip force at {load:.0f} N is {force:.0f} N in ISO-W, towards the disc's centre, but turn slip "
        f"pushes outwards: {cause}",
        file=config.path,
        key="rig.path_centre",
    )
