"""The road of a build: its numbers, and what would make them better."""

import math
from collections.abc import Iterator

from mffit.config import Config
from mffit.measured import Measured, unspun, was_coupled
from mffit.points import Points
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
    if points.one_sided and config.tyre.side != "symmetric":
        # One side of a disc does not tell ply-steer, conicity and a torque of the tyre's own from turn slip.
        yield 'side = "symmetric" if the tyre is'
    if not config.tyre.base:
        yield "a like tyre's file as base"
    camber = unspun(points, measured)
    if camber is not None and not was_coupled(points, camber):
        yield f"a sideslip sweep at {math.degrees(camber):.1f} deg of camber (no spin there)"
    if points.one_sided:
        yield "the other side of the disc"
