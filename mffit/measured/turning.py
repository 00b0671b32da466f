"""Turn-slip force and stiffness of one load, from the zeros of every path and of both mounts."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from uncertainties import UFloat

from mffit.measured import notes
from mffit.measured.agreed import agreed
from mffit.measured.at_zero import (
    PathInSetup,
    PathZeros,
    ZeroReadings,
    refuse_inward,
    turn_slip_of_path,
    unlike_zeros,
    zeros_by_path,
)
from mffit.measured.backlash import rest_of_play
from mffit.measured.camber_reduction import known_quantity
from mffit.measured.evidence import DirectEvidence
from mffit.measured.groups import LoadGroup, flipped
from mffit.measured.load_slopes import LoadSlopes
from mffit.measured.paths import PathForce, TurnSlipStiffness, least_uncertain_mean, turn_slip_stiffness
from mffit.measured.slip_stiffness import SlipStiffness, slip_stiffness


@dataclass(frozen=True, slots=True)
class Turning:
    """Turn-slip force and stiffness of one load."""

    found: tuple[PathZeros, ...]  #: of every path and set-up, the usual path first
    paths: tuple[PathForce, ...]
    stiffness: TurnSlipStiffness
    force: UFloat  #: on the usual path [N]
    conicity: UFloat | None  #: from both mounts [N]
    alpha_M: UFloat | None  #: sum of misalignment and ply-steer of the first set-up whose one is known [rad]

    @property
    def zeros(self) -> ZeroReadings:
        """The readings on the usual path."""
        return self.found[0].readings

    @property
    def phi_t(self) -> tuple[float, ...]:
        """Turn slip of every path [1/m]."""
        return tuple(dict.fromkeys(path.phi_t for path in self.found))

    @property
    def sign(self) -> float:
        """Sign of the usual path's turn slip."""
        return self.paths[0].sign


def turning(
    evidence: DirectEvidence, group: LoadGroup, slopes: LoadSlopes
) -> tuple[Turning | None, list[str]]:
    """Turn-slip force and stiffness, and warnings; None without zeros."""
    config, points, rig = evidence.config, evidence.points, evidence.rig
    assert rig is not None
    found = zeros_by_path(points, group, slopes.C_alpha, config)
    if not found:
        return None, []
    troubles: list[str] = []
    for path in found:
        troubles += unlike_zeros(points, path.group, slopes.C_alpha, config)
    stiffness = slip_stiffness(slopes.C_alpha, slopes.bend, group.load)
    angles = {name: axis.at(group.load) for name, axis in evidence.axes.items()}
    raw = {
        path.place: turn_slip_of_path(
            path,
            stiffness,
            slopes.C_gamma,
            rig,
            config,
            evidence.excess.get(path.setup),
            angles.get(path.setup),
        )
        for path in found
    }
    measured, expected = _conicity(evidence, group, slopes, stiffness, raw)
    # Conicity has the same sign on every path.
    floating = abs(stiffness.C_alpha.nominal_value) * rest_of_play(config)
    paths = tuple(path._replace(force=path.force - expected + floating) for path in raw.values())
    combined = turn_slip_stiffness(paths)
    if combined.contradictory:
        alone = [known_quantity(C, "Nm") for C in combined.of_paths]
        troubles.append(notes.paths_contradict(group.load, [-1.0 / path.phi_t for path in found], alone))
    force = paths[0].force if len(paths) == 1 else paths[0].sign * combined.C_phit / rig.R
    alpha_M = next((angles[path.setup] for path in found if path.setup in angles), None)
    made = Turning(tuple(found), paths, combined, force, measured, alpha_M)
    if combined.C_phit.nominal_value <= 0.0:
        refuse_inward(force.nominal_value, group.load, made.alpha_M, config)
    return made, troubles


def _conicity(
    evidence: DirectEvidence,
    group: LoadGroup,
    slopes: LoadSlopes,
    stiffness: SlipStiffness,
    normal: Mapping[PathInSetup, PathForce],
) -> tuple[UFloat | None, UFloat]:
    """The conicity force [N] from both mounts, None with one mount only; and the one to correct with.

    The tyre turned on its rim has the opposite conicity; everything else keeps its sign.
    """
    declared = evidence.shared.conicity * (0.0 if evidence.published else group.load)
    turned = flipped(evidence.points, group)
    if not len(turned.index):
        return None, declared
    halves = []
    for path in zeros_by_path(evidence.points, turned, slopes.C_alpha, evidence.config):
        usual = normal.get(path.place)
        if usual is None:
            continue
        assert evidence.rig is not None
        other = turn_slip_of_path(path, stiffness, slopes.C_gamma, evidence.rig, evidence.config)
        count = min(len(usual.readings), len(other.readings))
        halves.append((_mean(usual, count) - _mean(other, count)) / 2.0)
    if not halves:
        return None, declared
    return least_uncertain_mean(halves), agreed(declared, halves)


def _mean(path: PathForce, count: int) -> UFloat:
    """Mean of the first readings, forwards and backwards [N]."""
    return sum(path.readings[:count]) / count
