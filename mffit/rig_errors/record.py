"""The contract of a rig error: one record holds everything that the program knows about it."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from enum import Enum
from typing import Any, NamedTuple

import numpy as np

from mffit.quantities import CHANNELS
from mffit.rig_errors import constants

RADIANS = math.pi / 180.0

Formula = Callable[[Any, Any, Any], Any]
"""(number of the error, quantity before it, state of the chain) -> quantity after it."""


class Place(Enum):
    """Place in the chain from reading to reading at which an error acts; the value is its heading in the docs."""

    CAMBER = "Camber angle"
    LOAD = "Load"
    PATH = "Path"
    SLIP = "Longitudinal slip"
    COEFFICIENTS = "Coefficients of the tyre"
    ANGLE = "Sideslip angle"
    ENVIRONMENT = "Forces of the tyre in its environment"
    FORCE = "Reading of the force"


BEFORE_THE_TYRE = (Place.CAMBER, Place.LOAD, Place.PATH, Place.SLIP, Place.COEFFICIENTS, Place.ANGLE)
"""Sideslip comes last: compliance and play need the moment of the tyre under all other conditions."""


class AtZero(NamedTuple):
    """What the direct method knows where it corrects the force at zero sideslip and camber."""

    C_alpha: Any  #: cornering stiffness [N/rad], ISO, negative
    C_gamma: Any  #: camber stiffness [N/rad], ISO, negative
    side_of_play: float  #: sign of the sideslip that backlash adds to a reading of zero
    load: float = 0.0  #: [N], with the sign of the turn slip


class Slopes(NamedTuple):
    """One number for each stiffness and force that the direct method reads."""

    C_alpha: float = 0.0
    C_gamma: float = 0.0
    F_phit: float = 0.0


class AtLoad(NamedTuple):
    """What the direct method knows of one load where it corrects its readings for an error of calibration."""

    over_load: Slopes  #: relative change per relative change of load
    by_moment: Slopes  #: relative change per angle [rad] by which one Nm turns the wheel: slopes of Mz, as sideslip acts on Fy
    load_of_camber: float  #: load over camber stiffness [rad]; 0 where this was not measured
    spin_of_camber: (
        float  #: turn-slip force times turn slip over camber stiffness [1/m]; 0 where one was not measured
    )


@dataclass(frozen=True, slots=True, kw_only=True)
class Declared:
    """How ``[rig]`` declares an error, and what a declared error does to the direct method.

    The two functions take the error in the declared unit. Both give the false part of the raw reading, which the method
    takes off.
    """

    key: str  #: key of [rig] with the standard uncertainty
    unit: str  #: of that key; "N" for an angle that is declared as the side force that it causes
    default: float | None  #: if the key is missing; None: it follows from other keys
    source: str  #: name in the uncertainty budget
    value: str = ""  #: attribute of RigTable with the declared value; empty: the undisturbed one
    force_at_zero: Callable[[Any, AtZero], Any] | None = None  #: force at zero angles [N]
    camber_stiffness: Callable[[Any, AtZero], Any] | None = None  #: slope over camber, forwards [N/rad]
    turns_with_direction: bool = False  #: the force changes sign with the direction of rolling
    calibrates: Callable[[AtLoad], Slopes] | None = None
    """Relative change of the readings per unit of the error; None if it does not multiply them."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Appearance:
    """How a diagnosis sees an error: as one number for the whole test, or as one per run."""

    id: str  #: of the effect
    name: str
    physics: str  #: one sentence
    needs: tuple[str, ...] = ()  #: what the data must vary; keys of effects.needs
    remedy: str = ""  #: at the rig; {value}, {opposite}: the number in the rig's axes, and its negative
    axes: tuple[str, ...] = ()  #: channels whose signs in the rig's axes apply to the number
    per_run: bool = False
    spread: float | None = None  #: usual size where it differs from the record's
    together_with: tuple[str, ...] = ()  #: further numbers that are free with it


@dataclass(frozen=True, slots=True, kw_only=True)
class RigError:
    """One way in which a rig, its environment or its motion makes a reading differ from the steady tyre.

    The number, in ISO-W, changes the quantities in ``acts_on`` by ``formula``.
    """

    name: str  #: with the unit, as in [faults], JSON and the property file
    unit: str
    meaning: str  #: the formula in words
    kind: str  #: "rig" | "environment" | "tyre"
    place: Place | None  #: None: it only takes part in the formulae of others
    acts_on: tuple[str, ...] = ()  #: alpha, gamma, kappa, Fz, phi_t, channels or coefficients
    formula: Formula | None = None
    reads: tuple[str, ...] = ()  #: channels of the tyre that the formula takes from ``at.true``
    undisturbed: float = 0.0  #: value without the error; NaN: as declared
    spread: float  #: usual size, 1 sigma
    scan: tuple[float, ...] = (0.0,)  #: changes to start from; an even effect needs some other than 0
    limits: tuple[float, float] = (-math.inf, math.inf)
    relative: bool = False  #: spread and scan are relative to the value
    counts_from: str = ""  #: the number that holds the condition at which it has no effect
    known_sign: int = 0  #: that the number has in all published tyres and rigs, +1 or -1; 0: either
    of_setup: bool = False  #: differs from one set-up of the rig to the next, as a zero does
    seen_as: tuple[Appearance, ...] = ()
    word: str = ""  #: what a reader calls the number; default the name of the first appearance
    shown_in: tuple[str, float] | None = (
        None  #: unit in which people read it, and its size in them; default its own
    )
    declared: Declared | None = None

    @property
    def is_gain(self) -> bool:
        """Whether it is a factor, the calibration of a channel, which no reading tells from the tyre's own coefficients."""
        return self.undisturbed == 1.0

    @property
    def has_prior(self) -> bool:
        """Whether a declaration, or the size of such zeros, limits it; nothing limits an influence that a fit finds."""
        return self.declared is not None or self.of_setup

    @property
    def lower(self) -> float:
        """The least number that a rig can have."""
        return self.limits[0]

    @property
    def upper(self) -> float:
        """The largest number that a rig can have."""
        return self.limits[1]

    def shows_in(self, channels: Iterable[str]) -> bool:
        """Whether it may change any of these channels; only what acts on other channels alone cannot."""
        return not set(self.acts_on) <= CHANNELS.keys() or not set(self.acts_on).isdisjoint(channels)

    def acts(self, number: Any) -> bool:
        """Whether a plain number, or any of an array, differs from the undisturbed value."""
        if isinstance(number, float):
            return number != self.undisturbed and not math.isnan(number)
        return bool(np.any((number != self.undisturbed) & ~np.isnan(number)))


def calibration(
    channel: str,
    name: str,
    meaning: str,
    *,
    u: float = constants.FORCE_GAIN,
    place: Place = Place.FORCE,
    slopes: Callable[[AtLoad], Slopes] = lambda at: Slopes(),
    seen_as: tuple[Appearance, ...] = (),
) -> RigError:
    """The factor between a channel and its reading, uncertain by ``u`` unless ``[rig]`` or a certificate says otherwise."""
    return RigError(
        name=name,
        unit="-",
        meaning=meaning,
        kind="rig",
        place=place,
        acts_on=(channel,),
        formula=lambda gain, quantity, at: gain * quantity,
        undisturbed=1.0,
        spread=0.02,
        limits=(0.5, 2.0),
        seen_as=seen_as,
        word=f"calibration of {channel}",
        declared=Declared(
            key=f"u_{channel}_gain",
            unit="-",
            default=u,
            source=f"calibration of {channel}",
            calibrates=slopes,
        ),
    )
