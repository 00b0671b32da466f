"""The road of a build: its numbers, and what would make them better."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from mffit.config import Config
from mffit.measured import Measured, camber_of_no_spin
from mffit.points import Points, levels, main_path
from mffit.prediction import OnRoad, road_of
from mffit.results import BuildResult


def on_road(result: BuildResult) -> OnRoad | None:
    """The tyre of a build on a straight path, by the predictor that its folder holds; None if no sideslip was tested."""
    known, use = result.predicting
    if known is None:
        return None
    tyres = result.tyres
    normal = tyres.get("normal", tyres.get("both")) if result.on_disc else None
    return road_of(known, tyres[use], normal, tuple(_better(result.config, result.points, result.measured)))


def _better(config: Config, points: Points, measured: Measured) -> Iterator[str]:
    """What would narrow the bands of the road after runs on one side of a disc."""
    if not config.rig.on_disc:
        return
    if not config.tyre.base:
        yield "a like tyre's file as base"
    camber = unspun(points, measured)
    if camber is not None and not _was_coupled(points, camber):
        yield f"a sideslip sweep at {math.degrees(camber):.1f} deg of camber (no spin there)"
    if points.one_sided:
        yield "the other side of the disc"


def unspun(points: Points, measured: Measured) -> float | None:
    """The camber [rad] at which the usual path of a disc gives no spin; None if it is not known or out of reach."""
    row = measured.nominal
    if row is None or row.epsilon_gamma is None or row.r_e is None:
        return None
    camber = camber_of_no_spin(main_path(points), row.r_e.value, row.epsilon_gamma.value)
    return camber if camber is not None and abs(camber) <= np.max(np.abs(points.gamma)) else None


def _was_coupled(points: Points, camber: float) -> bool:
    """Whether sideslip was run at a camber."""
    near = np.abs(points.gamma - camber) < levels.CAMBER.tolerance
    return bool(np.any(near & (np.abs(points.alpha) > levels.SIDESLIP.tolerance)))
