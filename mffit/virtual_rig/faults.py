"""The errors of the virtual rig: given, or drawn from their declared uncertainties."""

from __future__ import annotations

import math
import zlib
from collections.abc import Mapping

import numpy as np

from mffit.config import RigTable, declared_faults, declared_rig
from mffit.rig_errors import BY_NAME, Faults


def as_declared(rig: RigTable) -> Faults:
    """The declared rig: its play and path radius; all other errors are absent."""
    radius = rig.radius
    return declared_faults(rig).replace(path_radius_m=math.inf if radius is None else radius)


def given(rig: RigTable, values: Mapping[str, float]) -> Faults:
    """The declared rig with some errors of given size."""
    return as_declared(rig).replace(**values)


def drawn(
    rig: RigTable, values: Mapping[str, float], C_alpha: float, generator: np.random.Generator
) -> Faults:
    """A rig whose errors follow the declared uncertainties.

    Parameters
    ----------
    rig : the declaration; every ``u_`` is one standard deviation of a normal distribution
    values : errors that are given and therefore not drawn
    C_alpha : cornering stiffness at the nominal load [N/rad], turns ``u_slip_alignment_N`` into an angle
    generator : source of random numbers
    """
    # Each error draws from a stream of its own name: fixing one, or declaring one more, does not change the others.
    seed = int(generator.integers(2**32))
    found = {}
    for name, prior in declared_rig(rig, C_alpha).items():
        own = np.random.default_rng([seed, zlib.crc32(name.encode())])
        found[name] = max(prior.value + prior.u * own.standard_normal(), BY_NAME[name].lower)
    return as_declared(rig).replace(**{**found, **values})
