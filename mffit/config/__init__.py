"""``tyre.toml`` as frozen records; errors name file, line and key."""

from mffit.config.loading import load
from mffit.config.models import Config, RigTable, RollingRadiusTable, SweepTable
from mffit.config.radii import effective_radius, path_radius, wheel_turn
from mffit.config.resolved import resolved
from mffit.config.rig_declaration import (
    Declaration,
    axis_signs,
    declared_faults,
    declared_rig,
    path_curvature,
    setup_names,
)

__all__ = [
    "Config",
    "Declaration",
    "RigTable",
    "RollingRadiusTable",
    "SweepTable",
    "axis_signs",
    "declared_faults",
    "declared_rig",
    "effective_radius",
    "load",
    "path_curvature",
    "path_radius",
    "resolved",
    "setup_names",
    "wheel_turn",
]
