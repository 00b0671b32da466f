"""Several campaigns of one tyre in one diagnosis: each has a rig of its own, and a surface of its own."""

from __future__ import annotations

from collections.abc import Collection, Mapping

import numpy as np

from mffit.config import Config, declared_faults
from mffit.diagnosis.inexact import Inexactness
from mffit.diagnosis.notes import CampaignsTogether
from mffit.diagnosis.priors import declared_priors
from mffit.diagnosis.problem import DiagnosisProblem
from mffit.diagnosis.stated import stated_noise, with_uncertainties
from mffit.fit.constants import UNKNOWN_RATIO_OF_GRIPS
from mffit.points import Points
from mffit.rig import Simulation
from mffit.rig_errors import OF_RUN, error_of, number_of

SURFACE = "surface_grip"


def rigs_apart(rigs: Mapping[str, Config], known: Mapping[str, float]) -> dict[str, float]:
    """Numbers of the rigs of several campaigns: their declared play, and ``known`` errors of the first one."""
    out = {
        number_of(name, campaign): value
        for campaign, config in rigs.items()
        for name, value in declared_faults(config.rig).disturbed.items()
    }
    first = next(iter(rigs))
    for name, value in known.items():
        error = error_of(name)
        of_rig = OF_RUN not in name and error is not None and error.kind == "rig"
        out[number_of(name, first) if of_rig else name] = value
    return out


def grips_of_surfaces(points: Points, start: Simulation) -> dict[str, tuple[float, float]]:
    """Grip of the surface of every other campaign beyond that of the first: name -> (value, standard uncertainty)."""
    names = [number_of(SURFACE, campaign) for campaign in points.campaigns[1:]]
    return {name: (start.number(name, points), float(UNKNOWN_RATIO_OF_GRIPS)) for name in names}


def on_surfaces(
    points: Points,
    start: Simulation,
    channels: Collection[str],
    rigs: Mapping[str, Config],
    *,
    seen: bool,
) -> Simulation:
    """The simulation with the grip of every surface as the readings show it, all else as given.

    If the model was fitted to these points (``seen``), the declared errors of all rigs but the first are found as well: the
    file holds what the rig of its own campaign reads.
    """
    priors = grips_of_surfaces(points, start)
    if not priors:
        return start
    if seen:
        declared = declared_priors(rigs, points, start, channels)
        priors |= {n: x for n, x in declared.items() if campaign_of(n, points) != points.campaigns[0]}
    values, spreads = np.array(list(priors.values())).T
    problem = DiagnosisProblem(
        points, start, stated_noise(*with_uncertainties(points, start, channels), channels)
    )
    return problem.refine(problem.null, Inexactness(tuple(priors), values, np.diag(spreads)))[0].state


def campaign_of(number: str, points: Points) -> str:
    """The campaign of a number of a campaign or of one of its set-ups."""
    part = number.partition(OF_RUN)[2]
    if part in points.campaigns:
        return part
    own = points.campaign[points.setup == points.setups.index(part)]
    return points.campaigns[int(own[0])]


def looked_at_together(
    points: Points, found: Mapping[str, tuple[float, float]], start: Simulation
) -> CampaignsTogether | None:
    """Which campaigns were looked at, and the grips of their surfaces; None for a single one.

    ``found`` has the numbers that were estimated beside the effects.
    """
    if len(points.campaigns) < 2:
        return None
    counts = np.bincount(points.campaign, minlength=len(points.campaigns)).tolist()
    known = grips_of_surfaces(points, start) | {
        n: x for n, x in found.items() if n.startswith(SURFACE + OF_RUN)
    }
    return CampaignsTogether(
        tuple(zip(points.campaigns, counts, strict=True)),
        tuple((name.partition(OF_RUN)[2], 1.0 + value, u) for name, (value, u) in known.items()),
    )
