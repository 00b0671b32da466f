"""Signs between the rig's axes and ISO-W, and the curvature of the rig's path."""

from __future__ import annotations

from mffit.config.models import Config, RigTable, SweepTable
from tir.conventions import sign

CHANNELS = ("alpha", "gamma", "Fz", "Fx", "Fy", "Mx", "My", "Mz")


def axis_signs(config: Config) -> dict[str, float]:
    """Sign of each channel, +1 or -1, that converts ISO-W to the rig's axes and back."""
    return {channel: sign(config.rig.axes, channel) for channel in CHANNELS}


def path_curvature(rig: RigTable, sweep: SweepTable | None = None) -> float:
    """Turn slip phi_t of the path [1/m]: -1/R with the centre to the left, 1/R to the right, 0 on a straight path.

    Parameters
    ----------
    rig : the rig with its usual path
    sweep : a sweep, which may have a path of its own; None for the usual path
    """
    radius, centre = rig.radius, rig.path_centre
    if radius is None:
        return 0.0
    if sweep is not None:
        radius, centre = sweep.path_radius or radius, sweep.path_centre or centre
    return (-1.0 if centre == "left" else 1.0) / radius
