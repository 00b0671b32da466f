"""The declared rig errors as numbers of the fit, each with its prior."""

from __future__ import annotations

import math
from typing import Any

from mffit.config import Declaration, declared_faults, declared_rig
from mffit.constants import USUAL_CORNERING_STIFFNESS
from mffit.fit import constants
from mffit.least_squares import FreeNumber
from mffit.measured.constants import CONTRADICTED
from mffit.rig_errors import BY_NAME, Faults


def known_faults(config: Any, measured: Any) -> Faults:
    """The rig before the fit: declared play, and a misalignment that exceeds what the rig's alignment leaves."""
    faults = declared_faults(config.rig)
    if not measured.misaligned or measured.alpha_M is None:
        return faults
    return faults.replace(alpha_0_deg=math.degrees(measured.alpha_M.value))


def rig_numbers(config: Any, measured: Any) -> tuple[FreeNumber, ...]:
    """The declared rig errors with their priors; none on a flat track.

    On a straight path ply-steer and conicity are free and absorb zeros that are off.
    """
    if not config.rig.on_disc or measured.epsilon_gamma is None:
        return ()
    usual = USUAL_CORNERING_STIFFNESS * measured.F_phit_load
    declared = declared_rig(config.rig, measured.C_alpha.value if measured.C_alpha else usual)
    if measured.misaligned and measured.alpha_M is not None:
        # A zero beyond the declared uncertainty shows that the declaration was too tight.
        value, u = declared.get("alpha_0_deg", Declaration(0.0, 0.0))
        found = math.degrees(abs(measured.alpha_M.value))
        declared["alpha_0_deg"] = Declaration(value, max(u, found))
    skew, own = measured.camber_skew, declared.get("camber_skew_deg")
    if skew is not None and own is not None and abs(skew.value) > CONTRADICTED * own.u:
        declared["camber_skew_deg"] = Declaration(own.value, abs(skew.value))
    return tuple(_number(name, prior) for name, prior in declared.items())


def _number(name: str, prior: Declaration) -> FreeNumber:
    reach = constants.RIG_ERROR_REACH * prior.u
    error = BY_NAME[name]
    return FreeNumber(
        name,
        prior.value,
        max(prior.value - reach, error.lower),
        min(prior.value + reach, error.upper),
        expected=prior.value,
        spread=prior.u,
    )
