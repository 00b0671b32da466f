"""Signs that recordings were made on a disc; without them its curved path would be taken for a straight one."""

import math
from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np

from mffit.constants import UPRIGHT
from mffit.points import Points
from mffit.recordings import constants
from mffit.recordings.recording import rolls_backward, speed_is_negative
from mffit.recordings.sniffed import Sniffed, points_from
from mffit.suspicion.constants import SIDESLIP_OF_SLOPES
from mffit.sweeps import formats


class DiscPath(NamedTuple):
    """The path of a disc."""

    radius: float  #: [m]
    centre: str  #: side of the disc's centre, "left" or "right", seen rolling forwards


def disc_signs(sniffed: Sniffed) -> list[str]:
    """Each sign of a disc, as a phrase; empty for recordings of a belt."""
    found = []
    backward = [r for r in sniffed.recordings if r.backward]
    if backward:
        of_speed = "has negative speeds" if speed_is_negative(backward[0].guesses) else "rolls backwards"
        why = "is named as rolling backwards" if rolls_backward(backward[0].path) else of_speed
        found.append(f"{backward[0].path.name} {why}")
    of_files = [points_from(sniffed.points, {str(r.path.absolute())}) for r in sniffed.recordings]
    if any(len(np.unique(points.direction)) > 1 for points in of_files):
        found.append("the wheel rolls both ways")
    zero = zero_of_upright(sniffed.points)
    if abs(zero) > constants.ZERO_OF_A_DISC:
        found.append(f"the side force of the upright wheel vanishes at {zero:.1f} deg of sideslip")
    return found


def zero_of_upright(points: Points) -> float:
    """Sideslip [deg] at zero side force of the upright wheel rolling forwards; NaN if the points do not determine it."""
    alpha = np.degrees(points.alpha)
    near = (
        (np.abs(np.degrees(points.gamma)) < UPRIGHT)
        & (np.abs(alpha) < SIDESLIP_OF_SLOPES)
        & (points.direction > 0)
        & np.isfinite(points.Fy)
        & (points.Fz > 0.0)
    )
    if near.sum() < 3 or np.ptp(alpha[near]) < 1.0:
        return math.nan
    slope, offset = np.polyfit(alpha[near], points.Fy[near] / points.Fz[near], 1)
    return float(-offset / slope) if slope < 0.0 else math.nan


def files_of_folder(folder: Path) -> Sequence[Path]:
    """The recordings in a folder, sorted by name, without those that programs put next to an open file (. or ~$)."""
    inside = (p for p in folder.iterdir() if not p.name.startswith((".", "~$")) and p.is_file())
    return sorted(path for path in inside if path.name.lower().endswith(formats.ENDINGS))
