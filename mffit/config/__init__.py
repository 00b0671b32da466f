"""``tyre.toml`` as frozen records; errors name file, line and key."""

from mffit.config.loading import load as load
from mffit.config.models import Config as Config
from mffit.config.models import RigTable as RigTable
from mffit.config.models import RollingRadiusTable as RollingRadiusTable
from mffit.config.models import SweepTable as SweepTable
from mffit.config.radii import effective_radius as effective_radius
from mffit.config.radii import path_radius as path_radius
from mffit.config.radii import wheel_turn as wheel_turn
from mffit.config.resolved import resolved as resolved
from mffit.config.rig_declaration import Declaration as Declaration
from mffit.config.rig_declaration import axis_signs as axis_signs
from mffit.config.rig_declaration import declared_faults as declared_faults
from mffit.config.rig_declaration import declared_rig as declared_rig
from mffit.config.rig_declaration import path_curvature as path_curvature
from mffit.config.rig_declaration import setup_names as setup_names
