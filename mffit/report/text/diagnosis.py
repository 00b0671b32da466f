"""A diagnosis, for the terminal."""

from __future__ import annotations

import textwrap
from collections.abc import Mapping, Sequence
from typing import Any

from mffit.report.rounding import number, per_cent, with_u
from mffit.report.text.layout import WIDTH, blocks, paragraphs, table


def diagnosis_summary(diagnosis: Any) -> str:
    """What ``mffit diagnose`` prints: the sentence, the gap, what was found, what remains."""
    d = diagnosis.to_json()
    rows = [
        (
            name,
            number(g["Fy_rmse_N"], digits=3),
            number(g["Mz_rmse_Nm"], digits=3),
            number(g["chi2_per_dof"], digits=3),
        )
        for name, g in (
            ("before", d["gap_before"]),
            ("after", d["gap_after"]),
            ("held out, before", d["validation"]["gap_before"]),
            ("held out, after", d["validation"]["gap_after"]),
        )
    ]
    rows.append(
        (
            "noise",
            number(d["noise_floor"]["Fy_N"], digits=3),
            number(d["noise_floor"]["Mz_Nm"], digits=3),
            "1",
        )
    )
    parts = [
        textwrap.fill(d["headline"], WIDTH),
        table(("gap, rms", "Fy [N]", "Mz [Nm]", "chi2 per dof"), rows),
        *(_effect(effect) for effect in d["effects"]),
        _regions("unexplained", d["unexplained_where"]) if d["unexplained"] else "",
        paragraphs(d["notes"]),
    ]
    return blocks(parts)


def _effect(effect: Mapping[str, Any]) -> str:
    lines = [f"{effect['id']} ({effect['kind']}), confidence {per_cent(effect['confidence'])}"]
    lines += [f"  {name} = {with_u(p['value'], p['stderr'])}" for name, p in effect["parameters"].items()]
    if effect["tied_with"]:
        lines.append(f"  not told from: {', '.join(effect['tied_with'])}")
        lines.append(f"  to separate: {effect['separate_by']}")
    return "\n".join(lines)


def _regions(title: str, regions: Sequence[Mapping[str, Any]]) -> str:
    lines = [f"{title}:"]
    for item in regions:
        place = ", ".join(_range(key, low, high) for key, (low, high) in item["region"].items())
        unit = "N" if item["channel"] == "Fy" else "Nm"
        lines.append(
            f"  {item['channel']} off by {number(item['bias'], digits=3)} {unit} at {place or 'all points'}"
        )
    return "\n".join(lines)


def _range(key: str, low: float, high: float) -> str:
    if key == "direction":
        return "backward" if high < 0 else "forward" if low > 0 else "both directions"
    return f"{key} {number(low)}" if low == high else f"{key} {number(low)} to {number(high)}"
