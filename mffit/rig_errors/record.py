"""The record of a rig error: everything that the program needs to know about it."""

import math
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from enum import Enum
from typing import Any, NamedTuple

import numpy as np

from mffit.quantities import CHANNELS

RADIANS = math.pi / 180.0

Formula = Callable[[Any, Any, Any], Any]
"""(number of the error, quantity before it, state of the chain) -> quantity after it."""


class Place(Enum):
    """Place at which an error acts in the chain from set-points to readings; the value is the heading in the docs."""

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
    """Inputs for the correction of the force at zero sideslip and camber in the direct method."""

    C_alpha: Any  #: cornering stiffness [N/rad], ISO, negative
    C_gamma: Any  #: camber stiffness [N/rad], ISO, negative
    side_of_play: float  #: sign of the sideslip that backlash adds to a zero reading
    load: float = 0.0  #: load with the sign of the turn slip [N]


class Slopes(NamedTuple):
    """One number for each stiffness and force of the direct method."""

    C_alpha: float = 0.0
    C_gamma: float = 0.0
    F_phit: float = 0.0


class AtLoad(NamedTuple):
    """Inputs for the correction of calibration errors in the direct method, at one load."""

    over_load: Slopes  #: relative change per relative change of load
    by_moment: Slopes  #: relative change per unit of steering compliance [rad/Nm]
    load_of_camber: float  #: load over camber stiffness [rad]; 0 if this was not measured
    spin_of_camber: float
    """Turn-slip force times turn slip over camber stiffness [1/m]; 0 if one was not measured."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Declared:
    """Declaration of an error in ``[rig]``, and its effect on the direct method.

    ``force_at_zero`` and ``camber_stiffness`` take the error in the declared unit and return its contribution to the raw reading,
    which the method subtracts.
    """

    key: str  #: key of [rig] with the standard uncertainty
    unit: str  #: unit of the key; "N" for an angle that is declared as the side force that it causes
    default: float | None  #: value if the key is missing; None: it follows from other keys
    source: str  #: name in the uncertainty budget
    value: str = ""  #: attribute of RigTable with the declared value; empty: the undisturbed value
    force_at_zero: Callable[[Any, AtZero], Any] | None = None  #: contribution to the force at zero angles [N]
    camber_stiffness: Callable[[Any, AtZero], Any] | None = None
    """To the slope over camber, forwards [N/rad]."""
    turns_with_direction: bool = False  #: whether the force changes sign with the direction of rolling
    calibrates: Callable[[AtLoad], Slopes] | None = None
    """Relative change of the readings per unit of the error; None if it is not multiplicative."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Appearance:
    """An effect by which a diagnosis detects an error."""

    id: str  #: id of the effect
    name: str
    physics: str  #: one sentence
    needs: tuple[str, ...] = ()  #: conditions that the data must vary; keys of effects.needs
    remedy: str = ""  #: at the rig; {value}, {opposite}: the number in the rig's axes, and its negative
    axes: tuple[str, ...] = ()  #: channels whose signs in the rig's axes apply to the number
    spread: float | None = None  #: usual size if it differs from the record's
    together_with: tuple[str, ...] = ()  #: further numbers that are freed with it


@dataclass(frozen=True, slots=True, kw_only=True)
class RigError:
    """One error by which a rig, its environment or its motion makes a reading differ from the steady tyre.

    The number, in ISO-W axes, changes the quantities in ``acts_on`` by ``formula``.
    """

    name: str  #: name with the unit, as in [faults], JSON and the property file
    unit: str
    meaning: str  #: the formula in words
    kind: str  #: "rig" | "environment" | "tyre"
    place: Place | None = None  #: None: a reference value that enters the formulae of other errors
    acts_on: tuple[str, ...] = ()  #: alpha, gamma, kappa, Fz, phi_t, channels or coefficients
    formula: Formula | None = None
    reads: tuple[str, ...] = ()  #: channels of the tyre that the formula takes from ``at.true``
    undisturbed: float = 0.0  #: value without the error; NaN: as declared
    spread: float  #: usual size, 1 sigma
    scan: tuple[float, ...] = (0.0,)  #: starting changes; an even effect needs some other than 0
    limits: tuple[float, float] = (-math.inf, math.inf)
    relative: bool = False  #: whether spread and scan are relative to the value
    counts_from: str = ""  #: name of the reference condition at which the error has no effect
    known_sign: int = 0  #: sign of the number in all published tyres and rigs, +1 or -1; 0: either
    of_setup: bool = False  #: whether it differs from set-up to set-up, as a zero does
    seen_as: Appearance | None = None  #: with one number for the whole test
    seen_per_run: Appearance | None = None  #: with one number for every run
    word: str = ""  #: words for the number in sentences, if not the name of the effect
    shown_in: tuple[str, float] | None = None
    """Unit for display, and the factor to it; default: its own unit."""
    declared: Declared | None = None

    @property
    def words(self) -> str:
        """Words for the number in sentences; empty without any."""
        return self.word or (self.seen_as.name if self.seen_as else "")

    @property
    def is_gain(self) -> bool:
        """Whether it is the calibration factor of a channel, which readings cannot separate from the tyre's coefficients."""
        return self.undisturbed == 1.0

    @property
    def has_prior(self) -> bool:
        """Whether it has a prior, from a declaration or from the usual size of zeros."""
        return self.declared is not None or self.of_setup

    @property
    def lower(self) -> float:
        """The smallest possible number."""
        return self.limits[0]

    @property
    def upper(self) -> float:
        """The largest possible number."""
        return self.limits[1]

    def shows_in(self, channels: Iterable[str]) -> bool:
        """Whether it may change any of these channels: always, unless it acts on other channels only."""
        return not set(self.acts_on) <= CHANNELS.keys() or not set(self.acts_on).isdisjoint(channels)

    def acts(self, number: Any) -> bool:
        """Whether a plain number, or any of an array, differs from the undisturbed value."""
        if isinstance(number, float):
            return number != self.undisturbed and not math.isnan(number)
        return bool(np.any((number != self.undisturbed) & ~np.isnan(number)))
