"""What the user of a fleet should know: unlike tyres, several rigs, outlying tyres, declarations that are too tight."""

import itertools
from collections.abc import Mapping, Sequence

from scipy.special import ndtri

from mffit.constants import PREDICTION_FALSE_ALARM
from mffit.fleet import Hierarchy, Row, Specimen, kinds_of
from mffit.rig_errors import words_of
from tir.errors import counted, listed


def fleet_notes(rows: Sequence[Row], rigs: Sequence[Hierarchy | None]) -> list[str]:
    """The sentences, in the order in which the page shows them."""
    far = _far_from_declared(rigs)
    limit = _surprising(sum(len(row.strain) for row in rows))
    return [
        *_counted_twice(rows),
        *_unlike(rows, rigs),
        *_several_rigs(rigs),
        *(note for row in rows for note in _outlying(row, far, limit)),
        *(
            f"All tyres together put an error of the rig, {words_of(name)}, {ratio:.0f} standard deviations from the "
            "value in [rig]: the declaration is too tight, or the tyres share an effect that the model lacks; in the second "
            "case rely on the direct method."
            for name, ratio in far.items()
        ),
    ]


def note_on_sharing(specimens: Sequence[Specimen], rig_of: Sequence[int]) -> list[str]:
    """A sentence if tyres of one rig are not declared to share a set-up."""
    on_disc = [(rig, s) for rig, s in zip(rig_of, specimens, strict=True) if s.on_disc]
    apart = [
        s.name
        for rig, s in on_disc
        if not _shared_setups(s, [o for r, o in on_disc if r == rig and o is not s])
    ]
    if not apart or len(on_disc) < 2:
        return []
    names = ", ".join(apart[:3]) + (" and others" if len(apart) > 3 else "")
    return [
        f"{names}: no set-up of the rig is declared to be that of another tyre, so the zeros of the axes and of the load cell "
        "are estimated for each build by itself. If the rig was not set up anew between the tyres, give [rig] the same name "
        "and their sweeps the same setup in every tyre.toml."
    ]


def _shared_setups(one: Specimen, others: Sequence[Specimen]) -> set[str]:
    """Names of the set-ups of a build that others of the same named rig have too."""
    return {name for other in others for name in other.setups if one.rig.get("name") and name in one.setups}


def _counted_twice(rows: Sequence[Row]) -> list[str]:
    """Pairs of builds that share recordings."""
    builds = [row.specimen for row in rows]
    return [
        f"{one.name} and {other.name} have {counted(len(same), 'recording')} in common: the joint estimate counts their "
        "readings twice, and what they have in common is no evidence that tyres are alike. Leave one of them out."
        for one, other in itertools.combinations(builds, 2)
        if (same := one.readings & other.readings)
    ]


def _far_from_declared(rigs: Sequence[Hierarchy | None]) -> dict[str, float]:
    """Rig errors far from their declaration: distance in declared standard deviations by name."""
    found = {
        (k, name): (value - rig.declared[name][0]) / rig.declared[name][1]
        for k, rig in enumerate(rigs)
        if rig is not None
        for name, (value, _) in rig.rig.items()
    }
    limit = _surprising(len(found))
    return {name: abs(z) for (_, name), z in found.items() if abs(z) > limit}


def _surprising(numbers: int) -> float:
    """Standard deviations beyond which chance hardly puts any of so many numbers."""
    return float(-ndtri(0.5 * PREDICTION_FALSE_ALARM / max(numbers, 1)))


def _several_rigs(rigs: Sequence[Hierarchy | None]) -> list[str]:
    if len(rigs) == 1:
        return []
    return [
        f"The builds declare {len(rigs)} different rigs (their tables [rig] differ): the tyres of each rig are estimated "
        "together. priors.json is not written, because it is for one rig."
    ]


def _outlying(row: Row, far: Mapping[str, float], limit: float) -> list[str]:
    """A tyre whose rig error disagrees with the other tyres."""
    # If all tyres are far from the declaration, every single tyre, which follows it, seems to disagree with the others.
    worst = max(row.strain.keys() - far, key=lambda name: abs(row.strain[name]), default="")
    if not worst or abs(row.strain[worst]) <= limit:
        return []
    return [
        f"{row.specimen.name}: its own error of the rig, {words_of(worst)}, lies {abs(row.strain[worst]):.0f} standard "
        "deviations from that of the other tyres; if the rig was adjusted in between, it is another rig: leave this tyre out."
    ]


def _unlike(rows: Sequence[Row], rigs: Sequence[Hierarchy | None]) -> list[str]:
    """Tyres of several kinds."""
    kinds = kinds_of([row.specimen for row in rows])
    if len(set(kinds)) == 1:
        return []
    named = [
        f"{listed([row.specimen.name for row, own in zip(rows, kinds, strict=True) if own == kind])} "
        f"({_conditions(rows[kinds.index(kind)].specimen)})"
        for kind in dict.fromkeys(kinds)
    ]
    return [
        f"The tyres are of {len(named)} kinds: {'; '.join(named)}. Coefficients refer to nominal load and pressure, so "
        "tyres are compared within a kind only, and unlike ones share nothing but the errors of their rig"
        + ("; priors.json, which is for one kind, is not written." if len(rigs) == 1 else ".")
    ]


def _conditions(one: Specimen) -> str:
    """Size and nominal conditions of a tyre."""
    load, pressure = one.conditions
    return ", ".join(filter(None, (one.size, f"{load:g} N", f"{pressure / 1e3:g} kPa")))
