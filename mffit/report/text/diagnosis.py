"""A diagnosis, for the terminal."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from mffit.diagnosis import AcceptedEffect, Diagnosis, Gap, wording
from mffit.diagnosis.notes import NotVisible
from mffit.diagnosis.where import Region
from mffit.effects import NEEDS
from mffit.quantities import CHANNELS
from mffit.report import words
from mffit.report.text.layout import blocks, cut, lines_left, table, wrapped
from mffit.rounding import as_good_as, number, per_cent, with_u
from tir.errors import counted


def diagnosis_summary(diagnosis: Diagnosis) -> str:
    """What ``mffit diagnose`` prints on one screen: the main sentence, the gap, the effects, what is unexplained."""
    gaps: tuple[tuple[str, Gap], ...] = (
        ("before", diagnosis.gap_before),
        ("after", diagnosis.gap_after),
        ("held out, before", diagnosis.validation.gap_before),
        ("held out, after", diagnosis.validation.gap_after),
    )
    if not diagnosis.is_corrected:
        gaps = (("all points", diagnosis.gap_before), ("held out", diagnosis.validation.gap_before))
    if diagnosis.terms:
        gaps = (*gaps, ("held out, corrected file alone", diagnosis.validation.gap_file))
    noise = diagnosis.noise
    rows = [(name, [*g.rmse.values(), g.chi2_per_dof]) for name, g in gaps]
    rows.append(("noise", [*(noise.typical(name) for name in noise.channels), 1.0]))
    head = ("gap, rms", *(CHANNELS[name].column(name) for name in noise.channels), "chi2 per dof")
    parts = [
        *(wrapped(f"NOT TO BE TRUSTED: {sentence}.") for sentence in diagnosis.reasons),
        wrapped(diagnosis.headline),
        table(head, [(name, *(number(value, digits=3) for value in values)) for name, values in rows]),
    ]
    regions = _regions(diagnosis.unexplained_where) if diagnosis.unexplained else ""
    unseen = [note for note in diagnosis.notes if isinstance(note, NotVisible)]
    seen = [said for said in wording.notes(diagnosis) if said not in {note.sentence for note in unseen}]
    notes = "\n".join([*(f"- {cut(said, 2, '  ')}" for said in seen), *_invisible(unseen)])
    effects = [_effect(found, diagnosis.signs) for found in diagnosis.effects]
    return blocks([*parts, *_within(lines_left(*parts, regions, notes), effects), regions, notes])


def _within(lines: int, effects: Sequence[str]) -> list[str]:
    """Effects as far as there is room for all that is said of them; of the others their first lines."""
    heads = [effect.partition("\n")[0] for effect in effects]
    full = 0
    while full < len(effects):
        lines -= effects[full].count("\n") + 2
        if full and lines < len(effects) - full - 1:
            break
        full += 1
    return [*effects[:full], "\n".join(heads[full:])]


def _invisible(found: Sequence[NotVisible]) -> list[str]:
    """How many effects these data cannot show, and what they lack."""
    if not found:
        return []
    lack = dict.fromkeys(NEEDS[need] for note in found for need in note.needs)
    count = sum(len(note.effects) for note in found)
    said = f"{counted(count, 'effect')} cannot be seen without {'; '.join(lack)} (page and JSON name them)."
    return [wrapped(said, "- ", "  ")]


def models_written(diagnosis: Diagnosis) -> str:
    """Names of the property files of a diagnosis, with what they are."""
    if diagnosis.with_terms is not None:
        return f"{diagnosis.model_after} (the model as given), {diagnosis.model_with_terms}"
    if not diagnosis.is_corrected:
        return f"{diagnosis.model_after} (the model as given)"
    return diagnosis.model_after


def _effect(found: AcceptedEffect, signs: Mapping[str, float]) -> str:
    suspected = "" if found.repaired else ", suspected and not repaired"
    lines = [f"{found.effect.name} ({found.effect.kind}), confidence {per_cent(found.confidence)}{suspected}"]
    lines += [_number(found, name) for name in found.parameters]
    lines.append(wrapped(f"to do: {wording.remedy(found, signs)}", "  ", "  "))
    if found.tied_with:
        rivals = ", ".join(effect.name for effect in found.tied)
        lines.append(wrapped(f"these data cannot tell it from: {rivals}", "  ", "  "))
        lines.append(wrapped(f"to separate them: {wording.separation(found.separation)}", "  ", "  "))
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
