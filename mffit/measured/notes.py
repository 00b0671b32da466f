"""What the direct method has to remark beside its numbers: facts, put into sentences by :mod:`mffit.measured.wording`."""

from __future__ import annotations

from dataclasses import dataclass

from tir import Quantity


@dataclass(frozen=True, slots=True)
class SlopeNotPossible:
    """The camber sweep is too short for its slope at zero; the secant stands in."""

    load: float  #: [N]
    angle_deg: float  #: of the secant


@dataclass(frozen=True, slots=True)
class SecantNotPossible:
    """The camber sweep does not reach the secant's angle; the slope at zero stands in."""

    load: float  #: [N]
    angle_deg: float


@dataclass(frozen=True, slots=True)
class NothingMeasured:
    """A disc, and no load has everything that eps_gamma needs."""


@dataclass(frozen=True, slots=True)
class StraightPath:
    """A flat track."""


@dataclass(frozen=True, slots=True)
class NotSeparable:
    """Without backward runs misalignment and ply-steer look like turn slip."""

    force: float  #: at (0, 0) [N]
    angle_deg: float | None  #: that would make this force; None without a cornering stiffness
    u_alignment: float  #: assumed for the alignment [N]


@dataclass(frozen=True, slots=True)
class SeveralPaths:
    """Zeros of more than one path were combined."""

    radii: tuple[float, ...]  #: [m], positive with the disc's centre to the left


@dataclass(frozen=True, slots=True)
class CamberSkew:
    """Forward and backward camber sweeps measure the squareness of camber and steering axis."""

    skew: Quantity  #: [deg]


@dataclass(frozen=True, slots=True)
class Aligned:
    """Forward and backward runs show a sideslip misalignment within what the alignment leaves."""

    alpha_M: Quantity  #: [rad]
    slip: float  #: the force of it [N]
    shift: float  #: of eps_gamma, were it not corrected


@dataclass(frozen=True, slots=True)
class Misaligned:
    """They show one beyond that."""

    alpha_M: Quantity  #: [rad]
    slip: float  #: [N]
    shift: float


@dataclass(frozen=True, slots=True)
class LoadSlope:
    """PECP2 is written."""

    pecp2: float
    u: float


@dataclass(frozen=True, slots=True)
class OneLoad:
    """PECP2 is 0: there is nothing to take a slope over."""


@dataclass(frozen=True, slots=True)
class SlopeInNoise:
    """PECP2 is 0: the slope does not stand out."""

    slope: float  #: of eps_gamma per unit of dfz
    u: float


@dataclass(frozen=True, slots=True)
class EpsilonInNoise:
    """PECP2 is 0: it is relative to an eps_gamma that does not stand out from zero."""


@dataclass(frozen=True, slots=True)
class SlopeTooSteep:
    """PECP2 is 0: with it eps_gamma would come too near 1."""

    largest: float  #: eps_gamma within the loads


@dataclass(frozen=True, slots=True)
class StandardUncertainties:
    """All uncertainties have k = 1."""


@dataclass(frozen=True, slots=True)
class Conicity:
    """It cannot be removed."""

    share: float  #: a plausible one, of the load
    force: float  #: [N]
    shift: float  #: of eps_gamma by it


@dataclass(frozen=True, slots=True)
class ContactWanders:
    """With camber the path radius changes."""


@dataclass(frozen=True, slots=True)
class AxisOff:
    """Forward and backward zeros of a load differ by more than an aligned axis allows."""

    load: float  #: [N]
    difference: float  #: [N]
    limit: float  #: [N]
    correction_deg: float


@dataclass(frozen=True, slots=True)
class PathsContradict:
    """The zeros of the paths say different turn-slip stiffnesses, beyond all that is known to be uncertain."""

    load: float  #: [N]
    radii: tuple[float, ...]  #: [m], positive with the disc's centre to the left
    C_phit: tuple[Quantity, ...]  #: [Nm]


@dataclass(frozen=True, slots=True)
class ZerosDisagree:
    """Sweeps that are declared alike read zeros that are not."""

    load: float  #: [N]
    backward: bool
    sweeps: tuple[str, str]
    forces: tuple[float, float]  #: [N]


Note = (
    StraightPath
    | NotSeparable
    | SeveralPaths
    | CamberSkew
    | Aligned
    | LoadSlope
    | OneLoad
    | SlopeInNoise
    | EpsilonInNoise
    | SlopeTooSteep
    | StandardUncertainties
    | Conicity
    | ContactWanders
)
"""To be known beside the numbers."""
Trouble = (
    SlopeNotPossible
    | SecantNotPossible
    | NothingMeasured
    | Misaligned
    | AxisOff
    | PathsContradict
    | ZerosDisagree
)
"""To be acted on."""
