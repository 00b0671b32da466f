"""A campaign that is being run, for the terminal."""

from __future__ import annotations

from mffit.constants import NAMED_IN_SENTENCE
from mffit.measured import Alignment
from mffit.planning import wording
from mffit.quantities import CONDITIONS, DIRECT
from mffit.report.text.layout import wrapped
from mffit.results.campaign import Arrival, Campaign
from mffit.rounding import ascii_only, number, stated, with_u
from tir.errors import some

INDENT = "  "


def campaign_text(found: Campaign) -> str:
    """The block that ``mffit watch`` prints after a change."""
    taken = [one.file for one in found.changed if one.state == "taken"]
    many = [f"{some(taken)}: taken"] if len(taken) > NAMED_IN_SENTENCE else []
    single = (one for one in found.changed if not (many and one.state == "taken"))
    lines = [*many, *map(_arrival, single), *campaign_lines(found)]
    lines += [f"warning: {sentence}" for sentence in found.warnings]
    listed = [
        line for one in found.changed if one.state == "taken" for line in one.sweep.splitlines() if line
    ]
    text = [wrapped(lines[0], "", INDENT), *(wrapped(line, INDENT, 2 * INDENT) for line in lines[1:])]
    if listed:
        text.append(f"{INDENT}not in tyre.toml; to keep it, add direction, mount and setup as they are:")
        text += [f"{INDENT}{INDENT}{line}" for line in listed]
    return ascii_only("\n".join(text))


def campaign_lines(found: Campaign) -> list[str]:
    """How far the campaign is, and what it says so far."""
    lines = [found.headline + (f"; awaited: {some(list(found.awaited))}" if found.awaited else "")]
    lines += [found.problem] if found.problem else []
    lines += [f"not to be trusted: {reason}" for reason in (found.measured.reasons if found.measured else ())]
    lines += _numbers(found)
    if found.alignment is not None:
        lines.append(_alignment(found.alignment))
    if found.next_run is not None:
        lines.append(f"next run: {wording.next_sentence(found.next_run)}")
    return lines


def _arrival(one: Arrival) -> str:
    if one.state == "gone":
        return f"{one.file} is gone"
    return f"{one.file}: {one.points} points" if one.state == "taken" else f"not taken: {one.why}"


def _numbers(found: Campaign) -> list[str]:
    """eps_gamma with its change; without it, the cornering stiffness."""
    epsilon, row = found.epsilon_gamma, found.measured.nominal if found.measured else None
    if epsilon is not None:
        was = f" (before {stated(found.before)})" if found.before not in (None, epsilon) else ""
        return [f"{DIRECT['epsilon_gamma'].ascii} {stated(epsilon)}{was}"]
    rows = [row] if row else [*(found.measured.per_load if found.measured else ())]
    known = [row for row in rows if row.C_alpha is not None]
    quantity = DIRECT["C_alpha"]
    return [
        f"{quantity.ascii} {stated(row.C_alpha, quantity.unit_behind)} at {CONDITIONS['Fz_N'].of(row.load)}"
        for row in known
    ]


def _alignment(found: Alignment) -> str:
    """Forces at the zeros both ways, and the next correction."""
    forces = "; ".join(
        f"{CONDITIONS['Fz_N'].of(step.load)} forward {number(step.F_forward, 0)}, backward {number(step.F_backward, 0)} N"
        for step in found.last
    )
    done = "; aligned" if found.aligned else ""
    return f"zeros at {forces}: next correction {with_u(found.correction_deg, found.u_deg)} deg{done}"
