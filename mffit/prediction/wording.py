"""The sentence about what the formula misses of a channel."""

from __future__ import annotations

from mffit.prediction.region import MissedAtReadings, MissedRegion
from mffit.quantities import CHANNELS, CONDITIONS
from mffit.rounding import ascii_only, number
from tir.errors import listed

NAMES = {"Fx": "grip", "Fy": "grip"}
"""What the largest force of a sweep is called; otherwise by its channel."""
SIDES = {
    ("Fx", "positive"): "driving",
    ("Fx", "negative"): "braking",
    ("Fy", "positive"): "at negative sideslip",
    ("Fy", "negative"): "at positive sideslip",
}
"""Where a channel has a sign, in ISO-W; otherwise the sign is said."""
BECAUSE = {
    "Fz_N": ("Fx", "Fy", "the formula's grip is linear in the load"),
    "alpha_deg": ("Fx", "the formula weakens driving and braking alike by sideslip"),
}
"""By condition, the channels of which a structure of the formula explains such a miss, and that structure."""


def missed_sentence(found: MissedAtReadings) -> str:
    """What limits a channel: the formula, with the size of what it misses, and where most."""
    name, unit = found.channel, CHANNELS[found.channel].unit
    where = "" if found.region is None else f"; {_most(name, found.region)}"
    return (
        f"what limits {name} is the formula, not the readings: alike in all sweeps it misses {found.size:.3g} {unit} rms, "
        f"{100.0 * found.size / found.largest:.1f} % of the largest {name}{where}"
    )


def _most(name: str, region: MissedRegion) -> str:
    """The region of the largest miss, in words."""
    over = [_interval(heading, *ends) for heading, ends in region.over.items()]
    side = SIDES.get((name, region.side), f"of {region.side} sign" if region.side else "")
    what = " ".join(filter(None, (NAMES.get(name, f"largest {name}"), side)))
    ends = sorted({f"{100.0 * abs(share):.2g}" for share in (region.least, region.most)}, key=float)
    sense = "low" if region.most > 0.0 else "high"
    seen = (
        "every sweep" if region.agreeing == region.sweeps else f"{region.agreeing} of {region.sweeps} sweeps"
    )
    why = [said for heading in region.over for *of, said in [BECAUSE.get(heading, ("",))] if name in of]
    return (
        f"its {what}{' at ' if over else ''}{listed(over)} is {' to '.join(ends)} % too {sense} in {seen} there"
        f"{f', because {listed(why)}' if why else ''}"
    )


def _interval(heading: str, low: float, high: float) -> str:
    """The levels of a condition: "530 to 570 N of load"."""
    known, digits = CONDITIONS[heading], 0 if heading in ("Fz_N", "p_kPa") else 1
    ends = dict.fromkeys(number(round(end, digits) + 0.0, digits) for end in (low, high))
    return ascii_only(f"{' to '.join(ends)} {known.unit_behind} of {known.word}")
