"""Input of the direct method, common to all loads."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from uncertainties import UFloat

from mffit.config import Config
from mffit.measured import camber_reduction as method
from mffit.measured.backlash import backlash_corrected, odd_alpha
from mffit.measured.radii import measured_effective_radius, measured_path_radius
from mffit.measured.result import SetupScatter
from mffit.measured.shared import SharedErrors, shared_errors
from mffit.measured.sideslip_zero import SetupAngle
from mffit.parts import Parts
from mffit.points import Points
from mffit.rig_errors import DECLARED
from tir import Tyre


@dataclass(frozen=True, slots=True)
class DirectEvidence:
    """Points and declarations from which every load is measured."""

    config: Config
    points: Points  #: with sideslip angles corrected for the play
    parts: Parts
    odd_slip: np.ndarray  #: (n,) sideslip to which the odd part of every point belongs [rad]
    rig: method.UncertainRig | None  #: None on a straight path
    scatter: SetupScatter | None  #: of repeated set-ups
    excess: Mapping[str, UFloat]  #: force by which each set-up scatters beyond what is declared [N]
    axes: Mapping[str, SetupAngle]  #: alpha_M of every set-up that was run both ways
    radii: Mapping[float, UFloat]  #: measured effective radius [m] by load [N]
    base: Tyre | None
    shared: SharedErrors  #: of the tyre, common to all loads

    @property
    def published(self) -> bool:
        """Whether C_gamma is to be the secant: then the budget is that of the published procedure, too."""
        return self.config.camber_stiffness.method == "secant"


def evidence_of(config: Config, points: Points, parts: Parts, base: Tyre | None) -> DirectEvidence:
    """The evidence in points with the angles as read."""
    R = measured_path_radius(config)
    u = {error.name: config.rig.u(error.name) for error, _ in DECLARED}
    return DirectEvidence(
        config=config,
        points=backlash_corrected(points, config),
        parts=parts,
        odd_slip=odd_alpha(points, parts, config),
        rig=None if R is None else method.uncertain_rig(u, R, points.used_setups),
        scatter=None,
        excess={},
        axes={},
        radii=measured_effective_radius(config, R),
        base=base,
        shared=shared_errors(config),
    )
