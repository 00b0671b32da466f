"""The declared rig: value and standard uncertainty of every rig error that ``[rig]`` knows, in the error's own unit."""

from __future__ import annotations

import math
from typing import NamedTuple

from mffit.config.models import RigTable
from mffit.rig_errors import DECLARED, Faults


class Declaration(NamedTuple):
    """What is declared of one rig error."""

    value: float
    u: float  #: standard uncertainty


def declared_rig(rig: RigTable, C_alpha: float) -> dict[str, Declaration]:
    """Declared rig errors by name, without those that are exactly known.

    Parameters
    ----------
    rig : the table ``[rig]``
    C_alpha : cornering stiffness [N/rad], which turns a side force into the angle that causes it
    """
    found = {}
    for error in DECLARED:
        declared = error.declared
        assert declared is not None
        value = getattr(rig, declared.value) if declared.value else error.undisturbed
        u = rig.u(error.name)
        if declared.unit == "N" and error.unit == "deg":
            u = math.degrees(u / max(abs(C_alpha), 1.0))
        if value is not None and u > 0.0:
            found[error.name] = Declaration(float(value), u)
    return found


def declared_faults(rig: RigTable) -> Faults:
    """The rig as declared: its play, nothing else wrong."""
    return Faults(backlash_deg=rig.backlash_deg)
