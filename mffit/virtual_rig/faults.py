"""What is wrong with the virtual rig, given or drawn from the uncertainties that its user declares."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from mffit.config import RigTable


@dataclass(frozen=True, slots=True)
class Faults:
    """Faults of the rig and influence of its surroundings, in ISO-W; the default is a perfect rig.

    The names are those of the effects that :command:`mffit diagnose` corrects.
    """

    alpha_0_deg: float = 0.0  #: true sideslip angle minus reading
    gamma_0_deg: float = 0.0  #: true camber minus reading
    gain: float = 1.0  #: reported Fy per newton
    F0_N: float = 0.0  #: reported Fy of an unloaded cell
    crosstalk: float = 0.0  #: reported Fy per newton of load
    M0_Nm: float = 0.0  #: reported Mz of an unloaded cell
    backlash_deg: float = 0.0  #: full play of the sideslip axis
    path_radius_m: float = math.inf  #: true radius of the path; infinite on a flat track
    k_T_per_K: float = 0.0  #: relative change of Fy and Mz per kelvin above 25 degC
    k_V_per_mps: float = 0.0  #: relative change of Fy and Mz per m/s above the usual speed
    k_t_per_s: float = 0.0  #: relative change of Fy and Mz per second of testing


def declared(rig: RigTable) -> Faults:
    """The rig as its user describes it: play and path radius as declared, nothing else wrong."""
    radius = rig.radius
    return Faults(backlash_deg=rig.backlash_deg, path_radius_m=math.inf if radius is None else radius)


def given(rig: RigTable, values: Mapping[str, float]) -> Faults:
    """The declared rig with the faults that stand in ``values``."""
    return replace(declared(rig), **values)


def drawn(
    rig: RigTable, values: Mapping[str, float], C_alpha: float, generator: np.random.Generator
) -> Faults:
    """A rig of which the declared uncertainties tell the truth.

    Parameters
    ----------
    rig : the declaration; every ``u_`` is one standard deviation of a normal distribution
    values : faults that are fixed and hence not drawn
    C_alpha : cornering stiffness at the nominal load [N/rad], turns ``u_slip_alignment_N`` into an angle
    generator : the source of chance; always asked for the same numbers, whatever ``values`` fixes
    """
    sure = declared(rig)
    chance = generator.standard_normal(5)
    u_alpha = math.degrees(rig.u_slip_alignment_N / abs(C_alpha))
    found = {
        "alpha_0_deg": u_alpha * chance[0],
        "gamma_0_deg": rig.u_camber_alignment_deg * chance[1],
        "F0_N": rig.u_loadcell_offset_N * chance[2],
        "backlash_deg": max(sure.backlash_deg + rig.u_backlash_deg * chance[3], 0.0),
        "path_radius_m": sure.path_radius_m + u_radius(rig) * chance[4],
    }
    return replace(sure, **{name: float(value) for name, value in found.items()} | dict(values))


def u_radius(rig: RigTable) -> float:
    """Standard uncertainty of the path radius [m]: declared, or that of the four tape measures in (19)."""
    if rig.radius is None:
        return 0.0
    if rig.u_path_radius is not None:
        return rig.u_path_radius
    return rig.u_length * math.sqrt(0.25 + 1.0 + 0.25 + 0.25)
