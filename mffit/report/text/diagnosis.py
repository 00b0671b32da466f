"""A diagnosis, for the terminal."""

from __future__ import annotations

import textwrap
from collections.abc import Mapping, Sequence

from mffit.diagnosis import Diagnosis, Found, wording
from mffit.diagnosis.where import Region
from mffit.quantities import CHANNELS
from mffit.report.rounding import number, per_cent, with_u
from mffit.report.text.layout import WIDTH, blocks, paragraphs, table


def diagnosis_summary(diagnosis: Diagnosis) -> str:
    """What ``mffit diagnose`` prints: the sentence, the gap, what was found, what remains."""
    gaps = (
        ("before", diagnosis.gap_before),
        ("after", diagnosis.gap_after),
        ("held out, before", diagnosis.validation.gap_before),
        ("held out, after", diagnosis.validation.gap_after),
    )
    rows = [(name, g.Fy_rmse_N, g.Mz_rmse_Nm, g.chi2_per_dof) for name, g in gaps]
    rows.append(("noise", diagnosis.noise.Fy, diagnosis.noise.Mz, 1.0))
    head = ("gap, rms", *(channel.column(name) for name, channel in CHANNELS.items()), "chi2 per dof")
    parts = [
        textwrap.fill(diagnosis.headline, WIDTH),
        table(head, [(name, *(number(value, digits=3) for value in values)) for name, *values in rows]),
        *(_effect(found, diagnosis.signs) for found in diagnosis.effects),
        _regions(diagnosis.unexplained_where) if diagnosis.unexplained else "",
        paragraphs(wording.notes(diagnosis)),
    ]
    return blocks(parts)


def _effect(found: Found, signs: Mapping[str, float]) -> str:
    lines = [f"{found.effect.name} ({found.effect.kind}), confidence {per_cent(found.confidence)}"]
    lines += [
        f"  {name} = {with_u(value, stderr)}, was {number(found.before[name], digits=4)}"
        for name, (value, stderr) in found.parameters.items()
    ]
    lines += textwrap.wrap(
        f"to do: {wording.remedy(found, signs)}", WIDTH - 2, initial_indent="  ", subsequent_indent="  "
    )
    if found.tied:
        lines.append(f"  not separable from: {', '.join(effect.name for effect in found.tied)}")
        lines.append(f"  to separate: {wording.separation(found.separation)}")
    return "\n".join(lines)


def _regions(regions: Sequence[Region]) -> str:
    if not regions:
        return ""  # the headline says that something remains
    lines = ["unexplained:"]
    for item in regions:
        off = f"{number(item.bias, digits=3)} {CHANNELS[item.channel].unit}"
        lines.append(
            f"  {item.channel} off by {off} at {', '.join(wording.place(item.region)) or 'all points'}"
        )
    return "\n".join(lines)
