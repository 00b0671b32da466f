"""The direct method and the alignment, for the terminal."""

import math
from collections.abc import Collection, Sequence

from mffit.measured import Alignment, Contribution, LoadResult, Measured, wording
from mffit.measured.result import FINITE_SPIN, SetupResult
from mffit.quantities import CONDITIONS, DIRECT, KEYS
from mffit.report.text.layout import blocks, paragraphs, table, wrapped
from mffit.rounding import as_good_as, number, stated, with_u

PER_LOAD = ("epsilon_gamma", "F_phit", "C_phit", "C_gamma", "C_alpha")
"""Results of the direct method at every load, in the order of the tables."""


def budget_table(budget: Sequence[Contribution], total: float) -> str:
    """The sources of u(eps_gamma) in the terms of JCGM 100, largest contribution first."""
    rows = [
        (
            line.source,
            f"{line.type}, {line.distribution}",
            f"{number(line.u, digits=3)} {line.unit}".removesuffix(" -"),
            number(line.sensitivity, digits=3),
            "inf" if math.isinf(line.dof) else number(line.dof, 0),
            number(abs(line.contribution), 4),
            f"{100.0 * (line.contribution / total) ** 2:.0f} %" if total else "–",
        )
        for line in sorted(budget, key=lambda line: -abs(line.contribution))
    ]
    rows.append(("combined (k = 1)", "", "", "", "", number(total, 4), ""))
    head = ("source", "type", "u", "sensitivity", "dof", f"in {DIRECT['epsilon_gamma'].ascii}", "of variance")
    return table(head, rows)


def spin_summary(measured: Measured) -> str:
    """The text that ``mffit spin`` prints: results of the direct method, its budget, every load."""
    against = [wrapped(f"NOT TO BE TRUSTED: {sentence}.") for sentence in measured.reasons]
    if measured.epsilon_gamma is None:
        reason = "see the warnings." if measured.warnings else "it was not measured."
        # Stiffnesses can be measured without turn slip, too.
        known = [row for row in measured.per_load if row.C_gamma is not None or row.C_alpha is not None]
        sentences = measured.notes or [f"No camber reduction factor: {reason}"]
        return blocks([*against, _per_load(known) if known else "", paragraphs(sentences)])
    parts = [
        *against,
        "\n".join(filter(None, (spin_numbers(measured), estimates(measured)))),
        budget_table(measured.budget, measured.epsilon_gamma.u),
        wording.expanded(measured),
        _improve_first(measured.budget, measured.epsilon_gamma.u),
        _other_budgets(measured.nominal),
        _per_load(measured.per_load),
        setups_table(measured),
        paragraphs(measured.notes),
    ]
    return blocks(parts)


def alignment_table(alignment: Alignment) -> str:
    """The text that ``mffit align`` prints: every step, and the correction to apply next."""
    rows = [
        (
            number(step.load, 0),
            str(step.iteration),
            number(step.F_forward, 1),
            number(step.F_backward, 1),
            number(step.F_turn_slip, 1),
            number(step.F_slip, 1),
            f"{number(step.C_alpha, 0)} ({step.source})",
            with_u(step.correction_deg, step.u_deg),
        )
        for step in alignment.steps
    ]
    load, force = CONDITIONS["Fz_N"], DIRECT["F_phit"]
    head = (
        load.column(load.word),
        "step",
        *(force.column(name) for name in ("forward", "backward", "turn slip", "slip")),
        DIRECT["C_alpha"].column(DIRECT["C_alpha"].ascii),
        CONDITIONS["alpha_deg"].column("correction"),
    )
    return blocks([table(head, rows, left=0), *map(wrapped, wording.advice(alignment))])


def spin_numbers(measured: Measured, names: Collection[str] = KEYS) -> str:
    """The results at the load nearest to the nominal one, one per line."""
    row = measured.nominal
    if row is None:
        return ""
    found = {name: getattr(row, name) for name in names} | {"epsilon_gamma": measured.epsilon_of_file}
    explained = {
        name: f" ({DIRECT[name].how}{', of the fitted model' * (name in row.of_model)})" for name in names
    }
    carried = measured.carried
    if carried is not None:
        source = "" if carried.source == "direct" else f", {wording.SOURCES[carried.source]}"
        explained["epsilon_gamma"] = f" at {CONDITIONS['Fz_N'].of(row.load)}{source}"
    lines = [
        f"{DIRECT[name].ascii:<10} {stated(value, DIRECT[name].unit_behind)}{explained.get(name, '')}"
        for name, value in found.items()
        if value is not None
    ]
    others = wording.beside_the_file(measured) if carried is not None and carried.source != "direct" else []
    lines[1:1] = [f"{one.name:<10} {stated(one.value)}: {one.why}" for one in others]
    return "\n".join(lines)


def estimates(measured: Measured) -> str:
    """eps_gamma by other methods, and what the file carries."""
    row = measured.nominal
    found = _other_estimates(measured, row) if row is not None else []
    lines = [f"{'from':<10} {', '.join(found)}"] if found else []
    if measured.published is not None:
        paper = stated(measured.published.epsilon_gamma)
        lines.append(f"{'published':<10} {paper} (the paper's procedure: (5) or (6), secant (20), u by (24))")
    if measured.pecp1 is not None:
        lines.append(f"{'file':<10} PECP1 {number(measured.pecp1, 4)}, PECP2 {number(measured.pecp2, 4)}")
    return "\n".join(lines)


def _other_estimates(measured: Measured, row: LoadResult) -> list[str]:
    """eps_gamma by other methods; without an uncertainty of its own it has the digits of the measured one."""
    u = row.epsilon_gamma.u if row.epsilon_gamma is not None else None
    plain = {
        "slope": row.epsilon_slope,
        "secant": row.epsilon_secant,
        "force of the file": measured.epsilon_gamma_model,
        "Mz (informational)": row.epsilon_moment,
    }
    found = [f"{name} {as_good_as(value, u)}" for name, value in plain.items() if value is not None]
    debiased = measured.epsilon_gamma_debiased
    return found + ([f"debiased {stated(debiased)}"] if debiased is not None else [])


def setups_table(measured: Measured) -> str:
    """What the zeros of every set-up give by themselves at the nominal load; empty if there is one on one path."""
    rows = measured.nominal.setups if measured.nominal else ()
    own = [(row.name or "-", row.path) for row in rows]
    return _zeros(("set-up", "path centre"), own, rows, ("epsilon_gamma", "F_phit")) if rows else ""


def _improve_first(budget: Sequence[Contribution], total: float) -> str:
    """The largest source of uncertainty, and what halving it would bring."""
    # The spin of a disc is as it is.
    lines = [line for line in budget if line.source != FINITE_SPIN]
    largest = max(lines, key=lambda line: abs(line.contribution), default=None)
    if largest is None or not total:
        return ""
    rest = total**2 - 0.75 * largest.contribution**2
    if rest <= 0.0:
        return ""
    before, after = number(total, 3), number(math.sqrt(rest), 3)
    epsilon = DIRECT["epsilon_gamma"].ascii
    return f"Improve first: {largest.source}; half of it would bring u({epsilon}) from {before} to {after}."


def _other_budgets(row: LoadResult | None) -> str:
    """What makes the other results uncertain, in shares of their variance, the largest three of each."""
    rows = [
        (
            DIRECT[name].ascii,
            f"{number(own.u, digits=2)} {own.unit}",
            ", ".join(
                f"{line.source} {100.0 * (line.contribution / own.u) ** 2:.0f} %" for line in lines[:3]
            ),
        )
        for name, lines in (row.budgets.items() if row else ())
        if (own := getattr(row, name)) and own.u
    ]
    return table(("of", "u", "mostly from"), rows, left=3) if rows else ""


def _per_load(rows: Sequence[LoadResult]) -> str:
    load = CONDITIONS["Fz_N"]
    return _zeros((load.column(load.word),), [(number(row.load, 0),) for row in rows], rows, PER_LOAD, left=0)


def _zeros(
    first: Sequence[str],
    own: Sequence[tuple[str, ...]],
    rows: Sequence[LoadResult | SetupResult],
    names: Sequence[str],
    left: int = 2,
) -> str:
    """A table of results by name and of alpha_M, behind columns of each row's own."""
    head = (
        *first,
        *(DIRECT[name].column(DIRECT[name].ascii) for name in names),
        CONDITIONS["alpha_deg"].column(DIRECT["alpha_M"].ascii),
    )
    cells = [
        (
            *cells,
            *(stated(getattr(row, name)) for name in names),
            stated(row.alpha_M, scale=math.degrees(1.0)),
        )
        for cells, row in zip(own, rows, strict=True)
    ]
    return table(head, cells, left=left)
