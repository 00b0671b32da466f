"""Plain-text tables for a terminal: functions of records that return str."""

from __future__ import annotations

import math
import textwrap
from collections.abc import Mapping, Sequence
from typing import Any

from mffit.report.rounding import MINUS, ascii_only, number, per_cent, times, with_u

WIDTH = 100


def table(head: Sequence[str], rows: Sequence[Sequence[str]], *, left: int = 1) -> str:
    """Columns under their headings; the first ``left`` columns flush left, the others flush right."""
    cells = [[ascii_only(cell) for cell in row] for row in (head, *rows)]
    widths = [max(len(row[i]) for row in cells) for i in range(len(head))]
    lines = [
        "  ".join(
            c.ljust(w) if i < left else c.rjust(w) for i, (c, w) in enumerate(zip(row, widths, strict=True))
        )
        for row in cells
    ]
    lines.insert(1, "  ".join("-" * w for w in widths))
    return "\n".join(line.rstrip() for line in lines)


def budget_table(budget: Sequence[Mapping[str, Any]], total: float) -> str:
    """Where u(eps_gamma) comes from, largest contribution first."""
    ordered = sorted(budget, key=lambda row: -abs(row["contribution"]))
    rows = [
        (
            str(row["source"]),
            f"{number(row['u'], digits=3)} {row.get('unit') or ''}".strip(),
            number(abs(row["contribution"]), 4),
            f"{100.0 * (row['contribution'] / total) ** 2:.0f} %" if total else "–",
        )
        for row in ordered
    ]
    rows.append(("combined (k = 1)", "", number(total, 4), ""))
    return table(("source", "u", "in eps_gamma", "of variance"), rows)


def spin_summary(measured: Any) -> str:
    """What ``mffit spin`` prints: the direct method's numbers, its budget, every load."""
    spin = measured.to_json()
    if spin["epsilon_gamma"] is None:
        return _blocks(
            [_paragraphs(["No camber reduction factor: see the warnings.", *spin.get("notes", ())])]
        )
    blocks = [
        _spin_numbers(spin),
        budget_table(spin["budget"], spin["u_epsilon_gamma"]),
        _improve_first(spin),
        _per_load(spin["per_load"]),
        _paragraphs(spin.get("notes", ())),
    ]
    return _blocks(blocks)


def alignment_table(alignment: Any) -> str:
    """What ``mffit align`` prints: every step and the correction to apply now."""
    rows = [
        (
            number(step.load, 0),
            str(step.iteration),
            number(step.F_forward, 1),
            number(step.F_backward, 1),
            number(step.F_turn_slip, 1),
            number(step.F_slip, 1),
            f"{number(step.C_alpha, 0)} ({'secant' if step.secant else 'guess'})",
            number(step.correction_deg, 3),
        )
        for step in alignment.steps
    ]
    head = (
        "load [N]",
        "step",
        "forward [N]",
        "backward [N]",
        "turn slip [N]",
        "slip [N]",
        "C_alpha [N/rad]",
        "correction [deg]",
    )
    correction = alignment.correction_deg
    sentence = (
        f"Turn the sideslip axis by {_signed(correction, 3)} deg of the rig's own scale, then measure both "
        "directions again."
    )
    return _blocks([table(head, rows, left=0), sentence])


def build_summary(result: Any) -> str:
    """What ``mffit build`` prints at its end."""
    spin, fit = result.measured.to_json(), result.fit
    blocks = []
    if spin["epsilon_gamma"] is not None:
        blocks.append(_spin_numbers(spin))
    noise = {"Fy": _rms(result.points.u_Fy), "Mz": _rms(result.points.u_Mz)}
    rows = [
        (
            name,
            str(a.n),
            f"{number(a.rmse, digits=3)} {unit}",
            times(a.rmse, noise[name]),
            f"{number(a.max_abs, digits=3)} {unit}",
            number(a.r2, 5),
        )
        for name, unit in (("Fy", "N"), ("Mz", "Nm"))
        if (a := fit.channels.get(name)) is not None and a.n
    ]
    blocks.append(table(("fit", "points", "rms", "of noise", "largest", "R2"), rows))
    blocks.append(_statuses(fit.coefficients))
    blocks.append(_paragraphs(fit.explanations))
    return _blocks(blocks)


def _blocks(blocks: Sequence[str]) -> str:
    return ascii_only("\n\n".join(block for block in blocks if block))


def _spin_numbers(spin: Mapping[str, Any]) -> str:
    names = (
        ("eps_gamma", "epsilon_gamma", ""),
        ("C_phit", "C_phit_Nm", "Nm"),
        ("F_phit", "F_phit_N", "N"),
        ("C_gamma", "C_gamma_N_per_rad", "N/rad"),
        ("C_alpha", "C_alpha_N_per_rad", "N/rad"),
        ("r_e", "r_e_m", "m"),
        ("R", "R_m", "m"),
    )
    lines = [
        f"{name:<10} {with_u(spin[key], spin.get('u_' + key), unit)}"
        for name, key, unit in names
        if spin.get(key) is not None
    ]
    others = (("slope", "slope"), ("secant", "secant"), ("written file", "model"), ("Mz", "moment"))
    given = [
        f"{name} {number(spin[f'epsilon_gamma_{key}'], 4)}"
        for name, key in others
        if spin.get(f"epsilon_gamma_{key}") is not None
    ]
    if given:
        lines.append(f"{'from':<10} {', '.join(given)}")
    if spin.get("pecp1") is not None:
        lines.append(f"{'file':<10} PECP1 {number(spin['pecp1'], 4)}, PECP2 {number(spin['pecp2'], 4)}")
    return "\n".join(lines)


def _improve_first(spin: Mapping[str, Any]) -> str:
    """Which source to work on, and what halving it would bring."""
    largest = max(spin["budget"], key=lambda row: abs(row["contribution"]), default=None)
    if largest is None or not spin["u_epsilon_gamma"]:
        return ""
    rest = spin["u_epsilon_gamma"] ** 2 - 0.75 * largest["contribution"] ** 2
    if rest <= 0.0:
        return ""
    before, after = number(spin["u_epsilon_gamma"], 3), number(math.sqrt(rest), 3)
    return (
        f"Improve first: {largest['source']}; half of it would bring u(eps_gamma) from {before} to {after}."
    )


def _per_load(rows: Sequence[Mapping[str, Any]]) -> str:
    return table(
        (
            "load [N]",
            "eps_gamma",
            "F_phit [N]",
            "C_phit [Nm]",
            "C_gamma [N/rad]",
            "C_alpha [N/rad]",
            "alpha_M [deg]",
        ),
        [
            (
                number(row["load_N"], 0),
                *(
                    with_u(row.get(key), row.get("u_" + key))
                    for key in (
                        "epsilon_gamma",
                        "F_phit_N",
                        "C_phit_Nm",
                        "C_gamma_N_per_rad",
                        "C_alpha_N_per_rad",
                        "alpha_M_deg",
                    )
                ),
            )
            for row in rows
        ],
        left=0,
    )


def _statuses(coefficients: Mapping[str, Any]) -> str:
    counts: dict[str, int] = {}
    for c in coefficients.values():
        counts[c.status] = counts.get(c.status, 0) + 1
    text = "coefficients: " + ", ".join(f"{n} {status}" for status, n in counts.items())
    bound = [name for name, c in coefficients.items() if c.at_bound]
    return text + (f"; at a bound: {' '.join(bound)}" if bound else "")


def _rms(u: Any) -> float:
    known = [x for x in u if math.isfinite(x)]
    return math.sqrt(sum(x * x for x in known) / len(known)) if known else math.nan


def _signed(value: float, decimals: int) -> str:
    text = number(value, decimals)
    return text if text.startswith(MINUS) else f"+{text}"


def _paragraphs(sentences: Sequence[str]) -> str:
    return "\n".join(textwrap.fill(s, WIDTH, initial_indent="- ", subsequent_indent="  ") for s in sentences)


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
    blocks = [
        textwrap.fill(d["headline"], WIDTH),
        table(("gap, rms", "Fy [N]", "Mz [Nm]", "chi2 per dof"), rows),
        *(_effect(effect) for effect in d["effects"]),
        _regions("unexplained", d["unexplained_where"]) if d["unexplained"] else "",
        _paragraphs(d["notes"]),
    ]
    return _blocks(blocks)


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
        place = ", ".join(
            f"{key} {number(low)} to {number(high)}" for key, (low, high) in item["region"].items()
        )
        unit = "N" if item["channel"] == "Fy" else "Nm"
        lines.append(
            f"  {item['channel']} off by {number(item['bias'], digits=3)} {unit} at {place or 'all points'}"
        )
    return "\n".join(lines)
