"""The sentences about the model error of a channel and about the road."""

from __future__ import annotations

import math

from mffit.prediction.region import MissedAtReadings, MissedRegion
from mffit.prediction.road import OnRoad
from mffit.quantities import CHANNELS, CONDITIONS
from mffit.rounding import ascii_only, number
from tir.errors import listed

SIDES = {
    ("Fx", "positive"): "driving",
    ("Fx", "negative"): "braking",
    ("Fy", "positive"): "at negative sideslip",
    ("Fy", "negative"): "at positive sideslip",
}
"""Words for a sign of a channel in ISO-W axes; without an entry, the sentence names the sign."""
BECAUSE = {
    "Fz_N": ("Fx", "Fy", "the formula's grip is linear in the load"),
    "apart": ("Fx", "the formula's grip is the same driving and braking"),
}
"""By condition or side, the channels whose error of grip a property of the formula explains, and that property."""


def missed_sentence(found: MissedAtReadings, rival: str = "") -> str:
    """A sentence on a channel that model error limits: size of the error and region of the largest one.

    ``rival`` is a clause on an error of rig or environment that may cause part of it.
    """
    name, unit = found.channel, CHANNELS[found.channel].unit
    where = "" if found.region is None else f"; {_most(found, found.region)}"
    limits = "the formula, not the readings" if not rival else f"the formula, or the readings ({rival})"
    return (
        f"what limits {name} is {limits}: alike in all sweeps it misses {found.size:.3g} {unit} rms, "
        f"{100.0 * found.size / found.largest:.1f} % of the largest {name}{where}{_slopes(found)}"
    )


def _slopes(found: MissedAtReadings) -> str:
    """The slopes at zero slip that the file misses, in words; empty if it misses none."""
    off = [
        f"{number(100.0 * abs(one.share), digits=2)} % too {'low' if one.share > 0.0 else 'high'} at "
        f"{CONDITIONS['Fz_N'].of(one.load)}"
        for one in found.slopes
    ]
    return f"; its slope at zero slip is {listed(off)}" if off else ""


def road_sentences(road: OnRoad, normal: str = "") -> list[str]:
    """How far the file for turn slip off, called ``normal``, is from the road, and what would make the road better known."""
    sentences = []
    if road.missed:
        posture, missed = [*road.missed.items()][-1]
        of = [" of the peak", *[""] * len(missed)]
        off = [
            f"{number(one.rms, digits=2)} {CHANNELS[name].unit} ({number(100.0 * one.share, digits=2)} %{peak})"
            for (name, one), peak in zip(missed.items(), of, strict=False)
        ]
        lean = (
            f" by {number(math.degrees(road.curves[posture].camber), 0)} deg" if posture == "leaned" else ""
        )
        sentences.append(f"{normal} misses the road by {listed(off)} rms when {posture}{lean}.")
    if road.better:
        sentences.append(f"It is better known with {', or '.join(road.better)}.")
    return [ascii_only(sentence) for sentence in sentences]


def _most(found: MissedAtReadings, region: MissedRegion) -> str:
    """The region of the largest error, in words."""
    over = [_interval(heading, *ends) for heading, ends in region.over.items()]
    name, what = found.channel, "grip" if found.is_grip else f"largest {found.channel}"
    where = f" at {listed(over)}" if over else ""
    ends = sorted({f"{100.0 * abs(share):.2g}" for share in (region.lower, region.upper)}, key=float)
    size, more = f"{' to '.join(ends)} %", region.upper > 0.0
    seen = f"in all {region.sweeps} sweeps there"
    keys = (region.side,) if region.side == "apart" else region.over
    why = [said for key in keys for *of, said in [BECAUSE.get(key, ("",))] if name in of]
    because = f", because {listed(why)}" if why and found.is_grip else ""
    if region.side == "apart":
        one, other = (
            _side(name, side) for side in (("positive", "negative") if more else ("negative", "positive"))
        )
        return f"its {what}{one} exceeds that{other}{where} by {size} more than in the file {seen}{because}"
    return f"its {what}{_side(name, region.side)}{where} is {size} too {'low' if more else 'high'} {seen}{because}"


def _side(name: str, side: str) -> str:
    """A sign of the force in words; empty for both signs."""
    return f" {SIDES.get((name, side), f'of {side} sign')}" if side else ""


def _interval(heading: str, low: float, high: float) -> str:
    """The levels of a condition: "530 to 570 N of load"."""
    known, digits = CONDITIONS[heading], 0 if heading in ("Fz_N", "p_kPa") else 1
    ends = dict.fromkeys(number(round(end, digits) + 0.0, digits) for end in (low, high))
    return ascii_only(f"{' to '.join(ends)} {known.unit_behind} of {known.word}")
