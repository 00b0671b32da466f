"""``tyre.toml``: its tables as frozen records, read with errors that name file, line and key."""

from mffit.config.loading import load
from mffit.config.models import Config, RigTable, RollingRadiusTable, SweepTable, TyreTable
from mffit.config.radii import effective_radius, path_radius, wheel_turn
from mffit.config.resolved import resolved

__all__ = [
    "Config",
    "RigTable",
    "RollingRadiusTable",
    "SweepTable",
    "TyreTable",
    "effective_radius",
    "load",
    "path_radius",
    "resolved",
    "wheel_turn",
]
