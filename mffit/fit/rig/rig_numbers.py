"""The declared rig errors as free or held numbers of the fit, each with its prior."""

import math
from collections.abc import Collection, Mapping, Sequence

import numpy as np

from mffit.config import Config, Declaration, declared_faults, declared_rig
from mffit.constants import COVERAGE_FACTOR_95, USUAL_CORNERING_STIFFNESS
from mffit.fit import constants
from mffit.least_squares import FreeNumber
from mffit.measured import Measured
from mffit.points import Points
from mffit.quantities import SIDEWAYS
from mffit.rig_errors import BY_NAME, ZEROS, Faults, number_of

SIDESLIP_ZERO = "alpha_0_deg"
CAMBER_ZERO = "gamma_0_deg"
COMPLIANCE = "compliance_deg_per_Nm"


def unseen_zeros(points: Points) -> frozenset[str]:
    """The zeros of the axes that one set-up on a flat track does not separate from the tyre, in which they stay.

    That of sideslip looks like ply-steer in every run of one set-up: where the fit could separate the two, only what the formula
    misses would. That of camber, unless the tyre was also run turned on its rim.
    """
    turned = len(np.unique(points.mount)) > 1
    return frozenset([SIDESLIP_ZERO] if turned else [SIDESLIP_ZERO, CAMBER_ZERO])


def known_faults(config: Config, measured: Measured, setups: Sequence[str] = ()) -> Faults:
    """The rig before the fit: declared play, and the measured misalignment if it exceeds the rig's alignment uncertainty.

    With several set-ups each has its own misalignment; see :func:`known_zeros`.
    """
    faults = declared_faults(config.rig)
    if not measured.misaligned or measured.alpha_M is None or len(setups) > 1:
        return faults
    return faults.replace(alpha_0_deg=math.degrees(measured.alpha_M.value))


def known_zeros(measured: Measured, setups: Sequence[str]) -> dict[str, float]:
    """By rig number, misalignments [deg] of set-ups that exceed the rig's alignment uncertainty; empty for one set-up."""
    if len(setups) < 2:
        return {}
    found = {name: _misaligned(measured, name) for name in setups}
    return {number_of(SIDESLIP_ZERO, name): angle for name, angle in found.items() if angle}


def _misaligned(measured: Measured, setup: str) -> float:
    """Sideslip misalignment of a set-up [deg]; 0 within the alignment uncertainty."""
    return math.degrees(measured.misaligned_setups.get(setup, 0.0))


def rig_numbers(
    config: Config,
    measured: Measured,
    setups: Sequence[str] = (),
    channels: Collection[str] = SIDEWAYS,
    *,
    unseen: Collection[str] = (SIDESLIP_ZERO, CAMBER_ZERO),
) -> tuple[FreeNumber, ...]:
    """The declared rig errors that the fit frees, with their priors, if they act on the ``channels`` of the fit.

    Calibrations are held, see :func:`held_rig`. On a disc without turn-slip zeros, errors of Fy, Mz and the angles are left out,
    except the compliance of the steering. On a flat track the priors apportion an asymmetry between zeros of forces on the
    one hand and conicity and residual torque on the other; the ``unseen`` zeros are held, see :func:`unseen_zeros`. With several
    ``setups`` each has its own zeros; if repeated set-ups scatter more than declared, the scatter widens the prior of F0_N.
    """
    others = [
        _number(name, prior, setup)
        for name, prior in declared_rig(config.rig, USUAL_CORNERING_STIFFNESS).items()
        if _of_other_channels(name) and BY_NAME[name].shows_in(channels) and not BY_NAME[name].is_gain
        for setup in (setups if len(setups) > 1 else ("",))
    ]
    return (*_sideways(config, measured, setups, unseen), *others)


def held_rig(
    config: Config,
    measured: Measured,
    setups: Sequence[str] = (),
    channels: Collection[str] = SIDEWAYS,
    *,
    unseen: Collection[str] = (SIDESLIP_ZERO, CAMBER_ZERO),
) -> dict[str, float]:
    """Standard uncertainty of declared errors that the ``channels`` cannot separate from coefficients.

    The fit takes these errors as absent and propagates their uncertainty to the coefficients. Examples: a calibration error of Fy
    looks like grip and stiffness. On a flat track a skew of the camber axis looks like camber stiffness. So does most of a
    camber zero: only terms quadratic in camber distinguish it, which the formula does not model well enough, so that misfit
    would appear as a zero of degrees. Several ``setups`` separate the zeros that are ``unseen`` with one, and on a disc turn slip
    separates all; then the fit frees them. The measured cornering stiffness turns declared forces into angles.
    """

    def is_held(name: str) -> bool:
        if BY_NAME[name].is_gain:
            return BY_NAME[name].shows_in(channels)
        if config.rig.on_disc or _of_other_channels(name) or name == COMPLIANCE:
            return False
        return not BY_NAME[name].of_setup or (name in unseen and len(setups) < 2)

    declared = _declared(config, measured, config.tyre.nominal_load)
    held = {name: prior.u for name, prior in declared.items() if is_held(name)}
    if SIDESLIP_ZERO in held:
        held[SIDESLIP_ZERO] = _with_lag(held[SIDESLIP_ZERO], measured)
    return held


def scatter_of_setups(config: Config, measured: Measured) -> dict[str, float]:
    """By zero of the rig, its standard deviation from set-up to set-up; a misalignment that was found is not part of it."""
    declared = _declared(config, measured, config.tyre.nominal_load)
    return {name: prior.u for name, prior in of_a_setup(declared, measured).items() if prior.u > 0.0}


def _declared(config: Config, measured: Measured, load: float) -> dict[str, Declaration]:
    """The declared rig errors; the measured cornering stiffness, or the usual one at ``load`` [N], turns forces into angles."""
    usual = USUAL_CORNERING_STIFFNESS * load
    return declared_rig(config.rig, measured.C_alpha.value if measured.C_alpha else usual)


def default_alignment(config: Config, measured: Measured) -> Declaration | None:
    """The sideslip zero [deg] that the default of its key asserts; None if [rig] states the key."""
    declared = BY_NAME[SIDESLIP_ZERO].declared
    if declared is None or declared.key in config.rig.model_fields_set:
        return None
    return _declared(config, measured, config.tyre.nominal_load)[SIDESLIP_ZERO]


def _with_lag(u: float, measured: Measured) -> float:
    """Standard uncertainty [deg] of the sideslip zero: a lag that no sweep the other way shows moves the readings as it does."""
    return math.hypot(u, math.degrees(measured.lag.angle) if measured.lag else 0.0)


def _of_other_channels(name: str) -> bool:
    """Whether a rig error acts on channels other than Fy and Mz alone."""
    return not BY_NAME[name].shows_in(SIDEWAYS)


def _sideways(
    config: Config, measured: Measured, setups: Sequence[str], unseen: Collection[str]
) -> tuple[FreeNumber, ...]:
    """The free numbers of the rig errors that act on Fy and Mz."""
    several = len(setups) > 1
    spin = config.rig.on_disc and any(row.F_phit is not None for row in measured.per_load)
    load = measured.nominal.load if spin and measured.nominal else config.tyre.nominal_load
    declared = {
        name: prior
        for name, prior in _declared(config, measured, load).items()
        if not _of_other_channels(name) and not BY_NAME[name].is_gain
    }
    if not spin:
        zeros = several or not config.rig.on_disc
        seen = {name for name in declared if (zeros and BY_NAME[name].of_setup) or name == COMPLIANCE}
        declared = {name: prior for name, prior in declared.items() if name in seen}
    if not several and not config.rig.on_disc:
        declared = {name: prior for name, prior in declared.items() if name not in unseen}
        return _of_setups(declared, measured, ("",))
    if several:
        return _of_setups(declared, measured, setups)
    if measured.misaligned and measured.alpha_M is not None:
        # A misalignment beyond the declared uncertainty shows that the declaration was too narrow.
        value, u = declared.get("alpha_0_deg", Declaration(0.0, 0.0))
        found = math.degrees(abs(measured.alpha_M.value))
        declared["alpha_0_deg"] = Declaration(value, max(u, found))
    skew, own = measured.camber_skew, declared.get("camber_skew_deg")
    if skew is not None and own is not None and abs(skew.value) > COVERAGE_FACTOR_95 * own.u:
        declared["camber_skew_deg"] = Declaration(own.value, abs(skew.value))
    return tuple(_number(name, prior) for name, prior in declared.items())


def of_a_setup(declared: Mapping[str, Declaration], measured: Measured) -> dict[str, Declaration]:
    """The zeros of any set-up of a rig as ``declared``; repeated set-ups that scatter more widen that of Fy.

    No key of [rig] declares some, such as that of Mz; on a disc with one set-up the residual torque absorbs it.
    """
    zeros = {error.name: error for error in ZEROS}
    found = {name: prior for name, prior in declared.items() if name in zeros}
    found |= {n: Declaration(e.undisturbed, e.spread) for n, e in zeros.items() if not e.declared}
    if measured.setup_scatter is not None and "F0_N" in found:
        value, u = found["F0_N"]
        found["F0_N"] = Declaration(value, math.hypot(u, measured.setup_scatter.excess))
    return found


def _of_setups(
    declared: Mapping[str, Declaration], measured: Measured, setups: Sequence[str]
) -> tuple[FreeNumber, ...]:
    """The free numbers of a rig with named set-ups, or with one set-up named ""."""
    zeros = {error.name for error in ZEROS}
    found = [_number(name, prior) for name, prior in declared.items() if name not in zeros]
    for name, (value, u) in of_a_setup(declared, measured).items():
        own = _with_lag(u, measured) if name == SIDESLIP_ZERO else u
        for setup in setups:
            off = abs(_misaligned(measured, setup)) if name == SIDESLIP_ZERO else 0.0
            reach = constants.RIG_ERROR_REACH if setup else constants.FLAT_TRACK_ZERO_REACH
            found.append(_number(name, Declaration(value, max(own, off)), setup, reach))
    return tuple(found)


def _number(
    name: str, prior: Declaration, setup: str = "", most: float = constants.RIG_ERROR_REACH
) -> FreeNumber:
    """The free number of a rig error, bounded ``most`` standard uncertainties either side of its declared value."""
    reach = most * prior.u
    error = BY_NAME[name]
    return FreeNumber(
        number_of(name, setup),
        prior.value,
        max(prior.value - reach, error.lower),
        min(prior.value + reach, error.upper),
        expected=prior.value,
        spread=prior.u,
    )
