"""Signs between the rig's axes and ours, and the curvature of the rig's path."""

from __future__ import annotations

from mffit.config.models import Config, RigTable, SweepTable
from tir.conventions import sign

CHANNELS = ("alpha", "gamma", "Fz", "Fx", "Fy", "Mx", "My", "Mz")


def axis_signs(config: Config) -> dict[str, float]:
    """+1 or -1 per channel: what turns ISO-W into the rig's axes, and back."""
    return {channel: sign(config.rig.axes, channel) for channel in CHANNELS}


def path_curvature(rig: RigTable, sweep: SweepTable | None = None) -> float:
    """Turn slip phi_t of the path [1/m]: -1/R with the centre to the left, 1/R to the right, else 0.

    Of the rig's usual path, or of the one that a sweep was run on.
    """
    radius, centre = rig.radius, rig.path_centre
    if radius is None:
        return 0.0
    if sweep is not None:
        radius, centre = sweep.path_radius or radius, sweep.path_centre or centre
    return (-1.0 if centre == "left" else 1.0) / radius
