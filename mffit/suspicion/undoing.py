"""The known mistake that explains the errors of a sweep: undone, it leaves less than a third of them."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from typing import NamedTuple

from mffit.constants import EXPLAINED_SHARE
from mffit.points import Points
from mffit.suspicion.mistakes import Mistake


class Away(NamedTuple):
    """How far one channel of a sweep is from what is expected."""

    error: float  #: in any unit that is the same before and after
    share: float  #: of the channel's usual size
    matched: bool = True  #: False if the error is not small beside what was measured and expected


class Explained(NamedTuple):
    """A mistake that explains a sweep."""

    mistake: Mistake
    left: float  #: largest share of the usual size by which a channel is still away


def explaining(
    candidates: Iterable[tuple[Mistake, Points]],
    gross: Mapping[str, float],
    away: Callable[[Points], Mapping[str, Away]],
    tolerated: Mapping[str, float],
) -> Explained | None:
    """The mistake that leaves least when it is undone; None if no mistake explains the errors.

    Parameters
    ----------
    candidates : mistakes, with the points of the sweep as they are without the mistake
    gross : errors to be explained, by channel
    away : how far points of the sweep are from what is expected, by channel
    tolerated : largest share by which each channel may be away in the end, so that no new error is made elsewhere
    """
    best = None
    for mistake, points in candidates:
        after = away(points)
        little = all(
            after[name].error <= EXPLAINED_SHARE * error and after[name].matched
            for name, error in gross.items()
        )
        if not little or any(one.share > tolerated[name] for name, one in after.items()):
            continue
        left = max(one.share for one in after.values())
        if best is None or left < best.left:
            best = Explained(mistake=mistake, left=left)
    return best
