"""A diagnosis, for the terminal."""

from __future__ import annotations

from collections.abc import Sequence

from mffit.diagnosis import AcceptedEffect, Diagnosis, wording
from mffit.diagnosis.notes import NotVisible
from mffit.diagnosis.where import Region
from mffit.effects import NEEDS
from mffit.quantities import CHANNELS
from mffit.report import words
from mffit.report.text.layout import blocks, paragraphs, table, wrapped
from mffit.rounding import as_good_as, number, per_cent, with_u
from tir.errors import counted

MOST_NUMBERS = 5
"""Most numbers of an effect that a terminal shows."""


def diagnosis_summary(diagnosis: Diagnosis) -> str:
    """What ``mffit diagnose`` prints: the answer, what to do, the gap effect by effect, the effects, what is unexplained.

    What to do is never cut, however many effects there are.
    """
    check, steps = diagnosis.validation, diagnosis.steps
    gaps = [("before", diagnosis.gap_before), *((f"+ {one.name}", one.gap) for one in steps[1:])]
    gaps += [("held out, before", check.gap_before), ("held out, after", check.gap_after)][
        : 1 + (len(steps) > 1)
    ]
    noise = diagnosis.noise
    rows = [(name, [*g.rmse.values(), g.chi2_per_dof]) for name, g in gaps]
    rows.append(("noise", [*(noise.typical(name) for name in noise.channels), 1.0]))
    head = ("gap, rms", *(CHANNELS[name].column(name) for name in noise.channels), "chi2 per dof")
    unseen = [note for note in diagnosis.notes if isinstance(note, NotVisible)]
    seen = [said for said in wording.notes(diagnosis) if said not in {note.sentence for note in unseen}]
    return blocks(
        [
            *(wrapped(f"NOT TO BE TRUSTED: {sentence}.") for sentence in diagnosis.reasons),
            wrapped(diagnosis.headline),
            paragraphs(wording.advice(diagnosis)),
            table(head, [(name, *(number(value, digits=3) for value in values)) for name, values in rows]),
            *(_effect(found, diagnosis) for found in diagnosis.effects),
            _regions(diagnosis.unexplained_where) if diagnosis.unexplained else "",
            "\n".join([*(wrapped(said, "- ", "  ") for said in seen), *_invisible(unseen)]),
        ]
    )


def _invisible(found: Sequence[NotVisible]) -> list[str]:
    """How many effects these data cannot show, and what they lack."""
    if not found:
        return []
    lack = dict.fromkeys(NEEDS[need] for note in found for need in note.needs)
    count = sum(len(note.effects) for note in found)
    said = f"{counted(count, 'effect')} cannot be seen without {'; '.join(lack)} (page and JSON name them)."
    return [wrapped(said, "- ", "  ")]


def models_written(diagnosis: Diagnosis) -> list[str]:
    """Names of the property files that a diagnosis writes."""
    corrected = [diagnosis.model_after] if diagnosis.delivers or diagnosis.written_anyway else []
    return [*corrected, *([diagnosis.model_with_terms] if diagnosis.model_with_terms else [])]


def _effect(found: AcceptedEffect, diagnosis: Diagnosis) -> str:
    suspected = "" if found.repaired else ", suspected and not repaired"
    lines = [f"{found.effect.name} ({found.effect.kind}), confidence {per_cent(found.confidence)}{suspected}"]
    some = list(found.parameters)[:MOST_NUMBERS]
    lines += [_number(found, name) for name in some]
    if len(found.parameters) > len(some):
        lines.append(f"  and {counted(len(found.parameters) - len(some), 'more number')} (page and JSON)")
    if found.effect.kind != "tyre" or not found.repaired:
        lines.append(wrapped(f"to do: {wording.remedy(found, diagnosis)}", "  ", "  "))
    if found.tied_with:
        rivals = ", ".join(effect.name for effect in found.tied)
        lines.append(wrapped(f"these data cannot tell it from: {rivals}", "  ", "  "))
    return "\n".join(lines)


def _number(found: AcceptedEffect, name: str) -> str:
    """One number of an effect, now and before."""
    value, u, unit = words.in_unit(name, *found.parameters[name])
    before, _, _ = words.in_unit(name, found.before[name], 0.0)
    return f"  {words.of_number(name)} = {with_u(value, u, unit)}, was {as_good_as(before, u)}"


def _regions(regions: Sequence[Region]) -> str:
    if not regions:
        return ""  # the headline states that structure remains
    lines = ["unexplained:"]
    for item in regions:
        off = f"{number(item.bias, digits=3)} {CHANNELS[item.channel].unit}"
        lines.append(
            f"  {item.channel} off by {off} at {', '.join(wording.place(item.region)) or 'all points'}"
        )
    return "\n".join(lines)
