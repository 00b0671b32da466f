"""Prior knowledge of the numbers of an effect: scale, prior, starting values, and the declaration of the rig."""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping, Sequence

import numpy as np

from mffit.config import Config, declared_rig
from mffit.diagnosis import constants
from mffit.effects import Effect, Free
from mffit.least_squares import FreeNumber
from mffit.points import Points
from mffit.quantities import SIDEWAYS
from mffit.rig import Simulation
from mffit.rig_errors import BY_NAME, ZEROS, number_of
from tir.parameters import BY_NAME as COEFFICIENTS

SWITCH = "turn_slip"


def moving(effects: Sequence[Effect]) -> list[Free]:
    """The numbers that effects free, each once with the prior of the first effect that frees it; without switches."""
    found: dict[str, Free] = {}
    for effect in effects:
        for free in effect.free:
            if free.name != SWITCH:
                found.setdefault(free.name, free)
    return list(found.values())


def switched(effects: Sequence[Effect]) -> dict[str, float]:
    """The switches that effects turn on."""
    return {SWITCH: 1.0} if any(effect.switches for effect in effects) else {}


def anchor(free: Free, start: Simulation, points: Points) -> tuple[float, float]:
    """Current value of a number, and the unit of its spread and scan."""
    current = start.number(free.name, points)
    if not free.relative:
        return current, 1.0
    # A coefficient that is zero in the model has no scale of its own; the width of its usual range supplies one.
    return current, abs(current) or constants.ZERO_COEFFICIENT_SCALE * COEFFICIENTS[free.name].width


def number(free: Free, at: Mapping[str, float], start: Simulation, points: Points) -> FreeNumber:
    """A free number with its prior around the current value, starting at its value in ``at`` if present."""
    current, unit = anchor(free, start, points)
    return FreeNumber(
        name=free.name,
        start=at.get(free.name, current),
        lower=free.lower,
        upper=free.upper,
        expected=current,
        spread=free.spread * unit,
    )


def starts(
    effect: Effect, at: Mapping[str, float], start: Simulation, points: Points
) -> list[dict[str, float]]:
    """Starting values of a fit, one set per step of the effect's scan; values in ``at`` are kept."""
    trials = []
    for k in range(max(len(free.scan) for free in effect.free)):
        trial = dict(at)
        for free in moving((effect,)):
            if free.name not in at:
                current, unit = anchor(free, start, points)
                change = free.scan[min(k, len(free.scan) - 1)]
                trial[free.name] = float(np.clip(current + change * unit, free.lower, free.upper))
        trials.append(trial)
    return trials


def usual_start(free: Free, start: Simulation, points: Points) -> float:
    """The value before if the readings change with the number there, else the step of the scan nearest its usual size."""
    current, unit = anchor(free, start, points)
    change = 0.0 if 0.0 in free.scan else min(free.scan, key=lambda step: abs(step - free.spread))
    return float(np.clip(current + change * unit, free.lower, free.upper))


def beyond_declaration(known: FreeNumber, value: float, declared: Mapping[str, tuple[float, float]]) -> float:
    """Change of a rig error's log prior by its declaration; never positive, so a declaration never favours an effect."""
    if known.name not in declared:
        return 0.0
    expected, u = declared[known.name]
    near = -0.5 * ((value - expected) / u) ** 2 + 0.5 * ((value - known.expected) / known.spread) ** 2
    narrower = math.log(known.spread / u) if u < known.spread else 0.0
    worse = constants.RIGS_WORSE_THAN_DECLARED
    return min(math.log((1.0 - worse) * math.exp(min(near + narrower, 30.0)) + worse), 0.0)


def declared_priors(
    config: Config, points: Points, start: Simulation, channels: Collection[str] = SIDEWAYS
) -> dict[str, tuple[float, float]]:
    """Declared rig errors that act on these channels: name -> (value in the simulation, standard uncertainty)."""
    declared = declared_rig(config.rig, _cornering_stiffness(points, start))
    if not np.any(points.phi_t):
        declared.pop("path_radius_m", None)
    setups = points.used_setups
    several = len(setups) > 1
    spreads = {error.name: error.spread for error in ZEROS if several and error.declared is None}
    spreads |= {name: u for name, (_, u) in declared.items()}
    spreads = {name: u for name, u in spreads.items() if BY_NAME[name].shows_in(channels)}
    out = {}
    for name, u in spreads.items():
        for part in setups if several and BY_NAME[name].of_setup else ("",):
            number = number_of(name, part)
            out[number] = (start.number(number, points), u)
    return out


def zeros_of_setups(points: Points, channels: Collection[str] = SIDEWAYS) -> list[str]:
    """Names of the zeros of every set-up, if there are several; they always differ, within their declared uncertainty."""
    setups = points.used_setups
    zeros = [error.name for error in ZEROS if error.shows_in(channels)]
    return [number_of(name, setup) for name in zeros for setup in setups] if len(setups) > 1 else []


def _cornering_stiffness(points: Points, start: Simulation) -> float:
    """Cornering stiffness [N/rad] of the model at the median load and zero angles."""
    middle = points.select(np.array([np.argmin(np.abs(points.Fz - np.median(points.Fz)))]))
    _, slope = start.sensitivities(middle.replace(alpha=0.0, gamma=0.0), ["alpha_0_deg"])
    return float(np.degrees(slope.Fy[0, 0]))


def log_prior(effect: Effect, start: Simulation) -> float:
    """Log prior of an effect, which ranks effects that the data hardly separate.

    A coefficient that is exactly zero in the given model was never identified, so it is more likely to be missing than others.
    """
    if effect.kind != "tyre" or not all(name in COEFFICIENTS for name in effect.parameters):
        return effect.prior
    unidentified = all(float(start.values[name]) == 0.0 for name in effect.parameters)
    return effect.prior + (1.0 if unidentified else -1.0) * constants.UNIDENTIFIED_LOG_ODDS


def price(candidates: int) -> float:
    """Log evidence that an effect must add to be accepted and kept: a penalty for the number of candidates, and a margin."""
    return math.log(max(candidates, 1)) + constants.EVIDENCE_MARGIN
