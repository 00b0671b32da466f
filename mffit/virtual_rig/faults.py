"""The errors of the virtual rig: given, or drawn from their declared uncertainties."""

from __future__ import annotations

import math
import zlib
from collections.abc import Mapping, Sequence

import numpy as np

from mffit.config import RigTable, declared_faults, declared_rig
from mffit.rig_errors import BY_NAME, Faults, number_of


def as_declared(rig: RigTable) -> Faults:
    """The declared rig: its play and path radius; all other errors are absent."""
    radius = rig.radius
    return declared_faults(rig).replace(path_radius_m=math.inf if radius is None else radius)


def given(rig: RigTable, values: Mapping[str, float]) -> Faults:
    """The declared rig with some errors of given size."""
    return as_declared(rig).replace(**values)


def drawn(
    rig: RigTable,
    values: Mapping[str, float],
    C_alpha: float,
    generator: np.random.Generator,
    setups: Sequence[str] = ("",),
) -> dict[str, Faults]:
    """The errors of every set-up of a rig that follow the declared uncertainties; the zeros are drawn for each set-up.

    Parameters
    ----------
    rig : the declaration; every ``u_`` is one standard deviation of a normal distribution
    values : errors that are given and therefore not drawn
    C_alpha : cornering stiffness at the nominal load [N/rad], turns ``u_slip_alignment_N`` into an angle
    generator : source of random numbers
    setups : names of the set-ups; the first has the same errors as a rig with one set-up
    """
    # Each error draws from a stream of its own name: fixing one, or declaring one more, does not change the others.
    seed = int(generator.integers(2**32))
    out = {}
    for k, setup in enumerate(setups):
        found = {}
        for name, prior in declared_rig(rig, C_alpha).items():
            stream = number_of(name, setup) if k and BY_NAME[name].of_setup else name
            own = np.random.default_rng([seed, zlib.crc32(stream.encode())])
            found[name] = max(prior.value + prior.u * own.standard_normal(), BY_NAME[name].lower)
        out[setup] = as_declared(rig).replace(**{**found, **values})
    return out
