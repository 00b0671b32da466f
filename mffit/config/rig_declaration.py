"""The rig as ``[rig]`` declares it: signs of its axes, curvature of its path, and its errors with standard uncertainties."""

import math
from collections.abc import Sequence
from typing import NamedTuple

from mffit.config.models import Config, RigTable, SetupTable
from mffit.rig_errors import DECLARED, Faults
from tir.conventions import sign

CHANNELS_WITH_SIGN = ("alpha", "gamma", "Fz", "Fx", "Fy", "Mx", "My", "Mz")


def axis_signs(config: Config) -> dict[str, float]:
    """Sign of each channel, +1 or -1, that converts ISO-W to the rig's axes and back."""
    return {channel: sign(config.rig.axes, channel) for channel in CHANNELS_WITH_SIGN}


def path_curvature(rig: RigTable, sweep: SetupTable | None = None) -> float:
    """Turn slip phi_t of the usual path, or of that of a sweep [1/m]: -1/R with the centre to the left, 1/R to the right, 0
    straight.
    """
    radius, centre = rig.radius, rig.path_centre
    if radius is None:
        return 0.0
    if sweep is not None:
        radius, centre = sweep.path_radius or radius, sweep.path_centre or centre
    return (-1.0 if centre == "left" else 1.0) / radius


def setup_names(rig: RigTable, sweeps: Sequence[SetupTable]) -> tuple[str, ...]:
    """Name of the set-up of every sweep, in their order; a sweep that names none belongs to the set-up of its path.

    Empty names if none is declared and all sweeps ran on one path: one set-up.
    """
    paths = [path_curvature(rig, sweep) for sweep in sweeps]
    if len(set(paths)) < 2 and all(sweep.setup is None for sweep in sweeps):
        return ("",) * len(paths)
    return tuple(
        sweep.setup if sweep.setup is not None else _of_path(path, paths)
        for sweep, path in zip(sweeps, paths, strict=True)
    )


def _of_path(path: float, paths: Sequence[float]) -> str:
    """Name of the set-up of a path with curvature [1/m]: the side of its centre, with the radius where sides have several."""
    if not path:
        return "straight"
    side = "left" if path < 0.0 else "right"
    several = len({other for other in paths if (other < 0.0) == (path < 0.0)}) > 1
    return f"{side}-{abs(1.0 / path):.4g}m" if several else side


class Declaration(NamedTuple):
    """What is declared of one rig error."""

    value: float
    u: float  #: standard uncertainty


def declared_rig(rig: RigTable, C_alpha: float) -> dict[str, Declaration]:
    """Declared rig errors by name, without those that are exactly known.

    ``C_alpha`` is the cornering stiffness [N/rad], which turns a side force into the angle that causes it.
    """
    found = {}
    for error, declared in DECLARED:
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
