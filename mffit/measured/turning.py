"""Turn-slip force and stiffness at one load, from the zeros of every path and of both mounts."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from uncertainties import UFloat

from mffit.config import Config, path_curvature
from mffit.constants import FALSE_ALARM
from mffit.errors import InputError
from mffit.measured import camber_reduction as method
from mffit.measured import constants, wording
from mffit.measured.axis import SlipStiffness, slip_stiffness
from mffit.measured.evidence import DirectEvidence, rest_of_play
from mffit.measured.stiffnesses import LoadSlopes
from mffit.measured.uncertain import Combined, agreed, combined, quantity
from mffit.measured.zeros import LoadGroup, PathZeros, flipped, unlike_zeros, zeros_by_path
from mffit.rig_errors import AtZero


class PathForce(NamedTuple):
    """The turn-slip force of one path in one set-up."""

    zeros: PathZeros
    R: UFloat  #: path radius [m]
    force: UFloat  #: corrected (23) [N]

    @property
    def stiffness(self) -> UFloat:
        """C_phit = F/phi_t (21) by this path alone [Nm]."""
        return math.copysign(1.0, self.zeros.phi_t) * self.force * self.R


@dataclass(frozen=True, slots=True)
class Turning:
    """Turn-slip force and stiffness of one load."""

    paths: tuple[PathForce, ...]  #: every path and set-up, the usual path first
    C_phit: UFloat  #: turn-slip stiffness [Nm]
    force: UFloat  #: on the usual path [N]
    conicity: UFloat | None  #: from both mounts [N]
    alpha_M: UFloat | None  #: misalignment plus ply-steer, of the first set-up with a known sum [rad]

    def calibrated(self, factor: UFloat) -> Turning:
        """The record with all turn-slip forces multiplied by a factor."""
        paths = tuple(path._replace(force=path.force * factor) for path in self.paths)
        return replace(self, paths=paths, C_phit=self.C_phit * factor, force=self.force * factor)

    @property
    def zeros(self) -> PathZeros:
        """The readings on the usual path."""
        return self.paths[0].zeros

    @property
    def phi_t(self) -> tuple[float, ...]:
        """Turn slip of every path [1/m]."""
        return tuple(dict.fromkeys(path.zeros.phi_t for path in self.paths))


def turning(
    evidence: DirectEvidence, group: LoadGroup, slopes: LoadSlopes
) -> tuple[Turning | None, list[str]]:
    """Turn-slip force and stiffness, and warnings; None without zeros.

    Raises InputError if the force points towards the centre of the disc.
    """
    config, points, rig = evidence.config, evidence.points, evidence.rig
    assert rig is not None
    found = zeros_by_path(points, group, slopes.C_alpha, config)
    if not found:
        return None, []
    troubles = [x for path in found for x in unlike_zeros(points, path.group, slopes.C_alpha, config)]
    stiffness = slip_stiffness(slopes.C_alpha, slopes.bend, group.load)
    angles = {name: axis.at(group.load) for name, axis in evidence.axes.items()}
    measured, expected = _conicity(evidence, group, slopes.C_alpha, found)
    # Conicity has the same sign on every path.
    floating = abs(stiffness.C_alpha.nominal_value) * rest_of_play(config)
    usual = config.rig.radius
    assert usual is not None
    paths = tuple(
        PathForce(
            zero,
            # Distances between paths are known, so all paths share one error of R.
            R=rig.R + (1.0 / abs(zero.phi_t) - usual),
            force=_force(zero, stiffness, slopes.C_gamma, evidence, angles.get(zero.setup))
            - expected
            + floating,
        )
        for zero in found
    )
    alone = [path.stiffness for path in paths]
    radii = [-1.0 / path.phi_t for path in found]
    both = turn_slip_stiffness(alone, radii)
    (C_phit,) = both.numbers
    if both.chance < FALSE_ALARM:
        troubles.append(wording.paths_contradict(group.load, radii, [quantity(C, "Nm") for C in alone]))
    force = math.copysign(1.0, found[0].phi_t) * C_phit / rig.R
    alpha_M = next((angles[path.setup] for path in found if path.setup in angles), None)
    if C_phit.nominal_value <= 0.0:
        raise _inward(force.nominal_value, group.load, alpha_M, config)
    return Turning(paths, C_phit, force, measured, alpha_M), troubles


def _force(
    zero: PathZeros,
    stiffness: SlipStiffness,
    C_gamma: UFloat | None,
    evidence: DirectEvidence,
    alpha_M: UFloat | None,
) -> UFloat:
    """The turn-slip force (23) of one path in one set-up [N].

    With both directions it is their mean, in which alpha_M cancels. A forward reading alone is corrected for the force of alpha_M
    if another load of the set-up was run both ways. The angles are already corrected for the play.
    """
    assert evidence.rig is not None
    load = math.copysign(zero.group.load, zero.phi_t)
    at = AtZero(stiffness.C_alpha, 0.0 if C_gamma is None else C_gamma, zero.side_of_play, load)
    both = zero.backward is not None
    force = zero.mean(both=both)
    if alpha_M is not None and not both:
        force = force - stiffness.force(
            alpha_M, math.copysign(1.0, zero.phi_t * path_curvature(evidence.config.rig))
        )
    errors = evidence.rig.at(zero.setup)
    force = method.turn_slip_force(force, errors, at, both_directions=both or alpha_M is not None)
    return force - evidence.excess.get(zero.setup, 0.0)


def turn_slip_stiffness(of_paths: Sequence[UFloat], radii: Sequence[float]) -> Combined:
    """C_phit from paths at these radii [m], by generalised least squares.

    Zeros are common to the paths of one set-up, so a zero force cancels between the two sides of the disc, or between two radii.
    Zeros of different set-ups are independent.
    """
    spin = np.array([1.0 / R**2 for R in radii])
    of_spin = constants.SPIN_LOSS * np.mean([C.nominal_value for C in of_paths]) * (spin - spin[0])
    return combined(of_paths, beside=np.outer(of_spin, of_spin))


def _conicity(
    evidence: DirectEvidence, group: LoadGroup, C_alpha: UFloat | None, normal: Sequence[PathZeros]
) -> tuple[UFloat | None, UFloat]:
    """The measured conicity force [N], None with one mount only; and the conicity force used for the correction.

    Turning the tyre on its rim reverses conicity; everything else keeps its sign.
    """
    declared = evidence.conicity * (0.0 if evidence.published else group.load)
    turned = flipped(evidence.points, group)
    usual: Mapping[tuple[float, str], PathZeros] = {(path.phi_t, path.setup): path for path in normal}
    halves = []
    for other in zeros_by_path(evidence.points, turned, C_alpha, evidence.config):
        own = usual.get((other.phi_t, other.setup))
        if own is not None:
            both = own.backward is not None and other.backward is not None
            halves.append((own.mean(both=both) - other.mean(both=both)) / 2.0)
    return (combined(halves).numbers[0], agreed(declared, halves)) if halves else (None, declared)


def _inward(force: float, load: float, alpha_M: UFloat | None, config: Config) -> InputError:
    """The error about a turn-slip force that points towards the centre of the disc."""
    if alpha_M is None:
        cause = "sideslip misaligned by a degree or more (run mffit align with forward and backward zeros), or path_centre wrong"
    else:
        cause = "path_centre or axes are wrong, as forward and backward runs agree on it"
    return InputError(
        f"the turn-slip force at {load:.0f} N is {force:.0f} N in ISO-W, towards the disc's centre, but turn slip "
        f"pushes outwards: {cause}",
        file=config.path,
        key="rig.path_centre",
    )
