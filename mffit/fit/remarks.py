"""The sentences about sweeps and readings that do not fit: written here and nowhere else."""

from __future__ import annotations

from collections.abc import Sequence

from mffit.fit.doubts import Doubt
from mffit.fit.outliers import Outlier
from mffit.quantities import CHANNELS

SHOWN = 5
"""Outlying readings named in the sentence."""


def doubt(fact: Doubt) -> str:
    """A sweep that does not fit the others."""
    explained = f"; it looks like {fact.looks}" if fact.looks else ""
    return (
        f"{fact.sweep} does not fit the other sweeps: predicted from them, {fact.channel} is out by {fact.rms:.3g} "
        f"{CHANNELS[fact.channel].unit}, at least {100 * fact.share:.0f} % of its usual size and {fact.ratio:.1f} times what "
        f"noise and model explain{explained}; check this sweep or repeat it"
    )


def standing_out(found: Sequence[Outlier]) -> str:
    """The readings without weight, the worst by name."""
    worst = sorted(found, key=lambda o: -o.ratio)[:SHOWN]
    said = "; ".join(
        f"{o.place} {o.channel} = {o.measured:.4g} {CHANNELS[o.channel].unit} where {o.expected:.4g} is expected"
        for o in worst
    )
    more = f"; and {len(found) - len(worst)} more, all in result.json" if len(found) > len(worst) else ""
    count = (
        "1 reading stands out of its sweep and carries"
        if len(found) == 1
        else f"{len(found)} readings stand out of their sweeps and carry"
    )
    return f"{count} no weight: {said}{more}; correct or remove what is wrong"
