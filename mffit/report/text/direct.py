"""The direct method and the alignment, for the terminal."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

from mffit.report.rounding import MINUS, number, with_u
from mffit.report.text.layout import blocks, paragraphs, table

STIFFNESSES = ("C_gamma_N_per_rad", "C_alpha_N_per_rad")
"""What can be read off a load without turn slip."""


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
        reason = "the warnings say why." if measured.warnings else "it was not measured."
        known = [row for row in spin["per_load"] if any(row.get(key) is not None for key in STIFFNESSES)]
        sentences = [*spin["notes"]] or [f"No camber reduction factor: {reason}"]
        return blocks([_per_load(known) if known else "", paragraphs(sentences)])
    parts = [
        spin_numbers(spin),
        budget_table(spin["budget"], spin["u_epsilon_gamma"]),
        _improve_first(spin),
        _per_load(spin["per_load"]),
        paragraphs(spin.get("notes", ())),
    ]
    return blocks(parts)


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
    return blocks([table(head, rows, left=0), sentence])


def spin_numbers(spin: Mapping[str, Any]) -> str:
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
    others = (
        ("slope", "slope"),
        ("secant", "secant"),
        ("debiased", "debiased"),
        ("written file", "model"),
        ("Mz", "moment"),
    )
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


def _signed(value: float, decimals: int) -> str:
    text = number(value, decimals)
    return text if text.startswith(MINUS) else f"+{text}"
