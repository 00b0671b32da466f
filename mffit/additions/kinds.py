"""The kinds of runs that a rig could add to a programme, one record each."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Literal, NamedTuple

from mffit.additions import constants
from mffit.constants import CAMBER_OF_SLOPES
from mffit.errors import InputError


class LineOfPoints(NamedTuple):
    """Set-points along one angle or slip; all other settings are those of most of the programme."""

    over: Literal["alpha", "gamma", "kappa"]
    shares: Sequence[float]  #: set-points over the largest angle or slip
    largest_deg: float | None = None  #: largest angle; None: the largest that was run
    direction: Literal[1, -1] = 1  #: 1 forward, -1 backward
    side: Literal[-1, 0, 1] = 0  #: sign of the addition's ``held_deg``; 0: not held


@dataclass(frozen=True, slots=True, kw_only=True)
class Addition:
    """One kind of run."""

    id: str  #: ``kind`` in plan.json, and the word for ``--without``
    title: str
    reason: str  #: what it measures and why that helps
    loads: Literal["each", "nominal", "new"] = "each"  #: "each" and "nominal" of the programme
    lines: tuple[LineOfPoints, ...]
    rig: Literal["any", "disc", "belt"] = "any"
    measures: tuple[str, ...] = ()  #: channels measured in addition to those of the programme
    mount: Literal[1, -1] = 1
    radius: float = 1.0  #: path radius over the programme's; negative: centre on the other side
    held: Literal["alpha", "gamma"] = "gamma"  #: angle that is held at ``side`` times ``held_deg``
    held_deg: Sequence[float] = (0.0,)  #: values of the held angle, one run each
    unspun: bool = False  #: the held camber is that at which the path gives no spin
    pressures: Sequence[float] = (1.0,)  #: pressures over the programme's pressure, one run each
    speed: float = 1.0  #: over the programme's
    warmer: float = 0.0  #: above the programme's temperature [K]
    later: float = math.nan  #: after the end of the test [s]; NaN: at no stated time


_NEW_SETUP = (
    "It is a new set-up of the rig, and counted so: the load cell and the axes have other zeros there, as uncertain as before. "
    "If nothing is set up anew in between, give these sweeps the setup of the others; their zeros cancel then."
)
_SHARES = constants.SWEEP_SHARES
_ZEROS = tuple(LineOfPoints("alpha", (-1.0, -0.5, 0.0, 0.5, 1.0), 1.0, way) for way in (1, -1))
"""The side force is linear up to the largest of these angles."""
_SMALL_CAMBERS = (LineOfPoints("gamma", _SHARES, CAMBER_OF_SLOPES),)
_SIDESLIP = (LineOfPoints("alpha", _SHARES),)
_CAMBER = (LineOfPoints("gamma", _SHARES),)
_DRIVE = (LineOfPoints("kappa", _SHARES),)
_DRIVE_TO_BOTH_SIDES = tuple(LineOfPoints("kappa", _SHARES, side=side) for side in (-1, 1))

_on_disc = partial(Addition, rig="disc")
_driven = partial(Addition, rig="belt", measures=("Fx",))

ADDITIONS = (
    _on_disc(
        id="zeros",
        title="zeros both ways again",
        reason="More points at zero average the noise out of the turn-slip force.",
        lines=_ZEROS,
    ),
    _on_disc(
        id="other-side",
        title="zeros both ways on the other side of the disc",
        reason=(
            "The path curves the other way and the turn-slip force changes sign; ply-steer and conicity keep theirs and cancel "
            f"in half the difference. {_NEW_SETUP}"
        ),
        lines=_ZEROS,
        radius=-1.0,
    ),
    _on_disc(
        id="other-side-camber",
        title="small cambers on the other side of the disc",
        reason=(
            "The effects of camber and path curvature add on one side of the disc and oppose each other on the other side. The "
            f"cambers include zero, so the run also measures the turn-slip force. {_NEW_SETUP}"
        ),
        lines=_SMALL_CAMBERS,
        radius=-1.0,
    ),
    _on_disc(
        id="second-radius",
        title=f"zeros both ways at {constants.SECOND_RADIUS_FACTOR:g} of the path radius",
        reason=(f"Turn slip grows with the path's curvature; conicity does not depend on it. {_NEW_SETUP}"),
        lines=_ZEROS,
        radius=constants.SECOND_RADIUS_FACTOR,
    ),
    _on_disc(
        id="small-camber",
        title="small cambers, closely spaced",
        reason="The camber stiffness is the slope at zero; cambers up to 20 deg determine it.",
        lines=_SMALL_CAMBERS,
    ),
    _on_disc(
        id="backward-camber",
        title="camber sweep rolled backwards",
        reason=(
            "Rolled backwards, the force of camber keeps its sign and the force of sideslip changes it. The run separates camber "
            "from the sideslip of a camber axis that is not square to the steering axis."
        ),
        loads="nominal",
        lines=(LineOfPoints("gamma", _SHARES, direction=-1),),
    ),
    Addition(
        id="flipped",
        title="sideslip sweep with the tyre turned on its rim",
        reason="Conicity changes sign with the tyre turned on its rim; every rig error keeps its sign.",
        loads="nominal",
        lines=(LineOfPoints("alpha", _SHARES[3:-3]),),
        mount=-1,
    ),
    Addition(
        id="sideslip",
        title="sideslip sweep",
        reason="More points over sideslip, for cornering stiffness, peak and trail.",
        lines=_SIDESLIP,
    ),
    Addition(
        id="camber",
        title="camber sweep",
        reason="More points over camber, for the camber stiffness and the shape of the camber force.",
        lines=_CAMBER,
    ),
    Addition(
        id="coupled",
        title="sideslip sweeps at camber of both signs",
        reason="How camber changes the curves over sideslip is visible only where both angles act together.",
        lines=tuple(LineOfPoints("alpha", _SHARES, side=side) for side in (-1, 1)),
        held_deg=(10.0, 20.0, 35.0),
    ),
    _on_disc(
        id="unspun",
        title="sideslip sweep at the camber without spin",
        reason=(
            "At this camber, sin(gamma) = phi_t r_e / (1 - eps_gamma), the wheel turns about the vertical as the disc does: "
            "its contact sees a straight path, as on the road."
        ),
        lines=(LineOfPoints("alpha", _SHARES, side=1),),
        unspun=True,
    ),
    Addition(
        id="pressure",
        title="sideslip and camber sweep at another pressure",
        reason=(
            "Two pressures show the effect of pressure. With two loads as well, they show whether it changes the stiffness "
            "itself or the load at which the stiffness peaks."
        ),
        lines=(*_SIDESLIP, *_CAMBER),
        pressures=constants.NEW_PRESSURE_FACTORS,
    ),
    Addition(
        id="load",
        title="sideslip and camber sweep at a new load",
        reason="The farther the loads are apart, the better the data determine what changes with load.",
        loads="new",
        lines=(*_SIDESLIP, *_CAMBER),
    ),
    _driven(
        id="drive",
        title="sweep of longitudinal slip, drive and brake",
        reason="Slip stiffness, peak and shape of the longitudinal force are seen only under slip.",
        lines=_DRIVE,
    ),
    _driven(
        id="combined",
        title="sweeps of longitudinal slip at sideslip to both sides",
        reason="How sideslip and slip take force from each other is seen only where both act together.",
        lines=_DRIVE_TO_BOTH_SIDES,
        held="alpha",
        held_deg=(2.0, 6.0),  # below and near the peak
    ),
    _driven(
        id="drive-camber",
        title="sweeps of longitudinal slip at camber of both signs",
        reason="Camber changes the peak of the longitudinal force, and the moment of slip about the two other axes.",
        lines=_DRIVE_TO_BOTH_SIDES,
        held_deg=(4.0,),
    ),
    _driven(
        id="drive-pressure",
        title="sweep of longitudinal slip at another pressure",
        reason="Slip stiffness and longitudinal friction change with pressure.",
        lines=_DRIVE,
        pressures=constants.NEW_PRESSURE_FACTORS,
    ),
)
"""Those of ``mffit plan`` in the order of trial; among equally good runs with equally many points the first is taken."""

_apart = partial(Addition, loads="nominal", lines=_SIDESLIP)

SEPARATING = (
    _apart(
        id="backward",
        title="sideslip sweep rolled backwards",
        reason="Rolled backwards, forces of the tyre change sign that errors of the rig keep.",
        lines=(LineOfPoints("alpha", _SHARES, direction=-1),),
    ),
    _apart(
        id="fast",
        title=f"sideslip sweep at {constants.FASTER:g} times the speed",
        reason="Only effects of speed change with it.",
        speed=constants.FASTER,
    ),
    _apart(
        id="warm",
        title=f"sideslip sweep with the tyre {constants.WARMER:g} K warmer",
        reason="Only effects of temperature change with it.",
        warmer=constants.WARMER,
    ),
    _apart(
        id="late",
        title="sideslip sweep at the end of the test",
        reason="Drift and wear grow with time and distance.",
        later=900.0,
    ),
    _driven(
        id="backward-drive",
        title="sweep of longitudinal slip rolled backwards",
        reason="Rolled backwards, drag of brake and bearings changes sign; a zero of the load cell keeps it.",
        loads="nominal",
        lines=(LineOfPoints("kappa", _SHARES, direction=-1),),
    ),
    _driven(
        id="flipped-drive",
        title="sweep of longitudinal slip with the tyre turned on its rim",
        reason="Turned on its rim, the tyre's asymmetry changes sign; every rig error keeps its sign.",
        loads="nominal",
        lines=_DRIVE,
        mount=-1,
    ),
)
"""Kinds that inform little about the tyre, and separate its effects from those of rig and environment."""
BY_ID: Mapping[str, Addition] = {addition.id: addition for addition in ADDITIONS}


def addition_named(word: str) -> Addition:
    """The addition with this id; raises an InputError that lists the ids if there is none."""
    if word not in BY_ID:
        raise InputError(f'"{word}" is not a kind of run; the kinds are {", ".join(BY_ID)}')
    return BY_ID[word]
