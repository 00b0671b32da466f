"""Checks that model and points belong together."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Sequence

import numpy as np

from mffit.config import Config
from mffit.diagnosis import constants
from mffit.diagnosis.noise import Noise
from mffit.diagnosis.notes import AnotherTyre, OffsetsOrMemory, WithoutNoise
from mffit.effects import Effect
from mffit.errors import InputError
from mffit.points import Points
from mffit.points.constants import FEWEST_POINTS
from mffit.quantities import SIDEWAYS
from mffit.rig import Simulation
from mffit.suspicion.constants import DIFFERENCE_OF_ANOTHER_TYRE
from tir import Tyre


def refuse_strangers(
    points: Points, tyre: Tyre, start: Simulation, channels: Iterable[str] = SIDEWAYS
) -> None:
    """Raise an InputError with the likely cause if model and data cannot belong together."""
    if len(points) < FEWEST_POINTS:
        raise InputError(
            f"{len(points)} points are too few for a diagnosis; measure at least {FEWEST_POINTS}"
        )
    ratio, most = float(np.median(points.Fz)) / float(tyre["FNOMIN"]), constants.LOAD_RATIO_OF_ANOTHER_TYRE
    if not 1.0 / most < ratio < most:
        raise InputError(
            f"the loads of the data (median {np.median(points.Fz):.0f} N) and FNOMIN of the model ({tyre['FNOMIN']:.0f} N) "
            "differ by an order of magnitude: the model belongs to another tyre, or one of them is not in newtons; check the "
            "model and the unit of the loads"
        )
    for channel, model in start.readings(points, channels).items():
        measured = points.channel(channel)
        known = np.isfinite(measured)
        if not np.any(known) or np.std(model[known]) == 0.0 or np.std(measured[known]) == 0.0:
            continue
        agreement = float(np.corrcoef(model[known], measured[known])[0, 1])
        if agreement < constants.OPPOSED_CORRELATION:
            raise InputError(
                f"simulated and measured {channel} have opposite signs (correlation {agreement:.2f}): data or model use other "
                "axes; check [rig] axes and the signs of PKY1 and PKY6"
            )


def another_tyre(tyre: Tyre, config: Config) -> AnotherTyre | None:
    """Differences between the model and ``tyre.toml`` in dimensions and nominal conditions; None without any."""
    given = config.tyre
    stated = {
        "UNLOADED_RADIUS": given.unloaded_radius,
        "WIDTH": given.width,
        "RIM_RADIUS": given.rim_radius,
        "FNOMIN": given.nominal_load,
        "NOMPRES": 1e3 * given.nominal_pressure,
    }
    differences = tuple(
        (name, float(tyre[name]), value)
        for name, value in stated.items()
        if value is not None
        and name in tyre.present
        and abs(float(tyre[name]) - value) > DIFFERENCE_OF_ANOTHER_TYRE * abs(value)
    )
    return AnotherTyre(differences) if differences else None


def without_noise(noise: Noise) -> WithoutNoise | None:
    """The channels whose noise is assumed, because their readings hardly scatter; None without any."""
    assumed = tuple(
        (name, noise.typical(name)) for name in noise.channels if noise.scatter[name].without_noise
    )
    return WithoutNoise(assumed) if assumed else None


def offsets_or_memory(
    noise: Noise, candidates: Sequence[Effect], named: Collection[str]
) -> list[OffsetsOrMemory]:
    """The channels whose autocorrelated errors may as well be offsets of runs, if none of these effects is ``named`` (ids)."""
    found = []
    for channel in noise.channels:
        scatter, memory = noise.scatter[channel], noise.scatter[channel].memory.correlation
        near = tuple(
            effect
            for effect in candidates
            if effect.id in noise.offsets
            and channel in noise.offsets[effect.id].channels
            and (noise.offsets[effect.id].log_odds > 0.0 or scatter.scale > constants.STATED_NOISE_FACTOR)
        )
        if memory and near and not any(effect.id in named for effect in near):
            found.append(OffsetsOrMemory(channel, memory, noise.typical(channel), near))
    return found
