"""A campaign that is being run, for the terminal."""

from pathlib import Path

from mffit.constants import NAMED_IN_SENTENCE
from mffit.measured import Alignment
from mffit.planning import wording
from mffit.quantities import CONDITIONS, DIRECT
from mffit.report.text.layout import wrapped
from mffit.results.campaign import Arrival, WatchedCampaign
from mffit.rounding import ascii_only, number, stated, with_u
from tir.errors import counted, some

INDENT = "  "


def campaign_text(found: WatchedCampaign) -> str:
    """The block that ``mffit watch`` prints after a change."""
    taken = [one.file for one in found.changed if one.state == "taken"]
    many = [f"{some(taken)}: taken"] if len(taken) > NAMED_IN_SENTENCE else []
    single = (one for one in found.changed if not (many and one.state == "taken"))
    lines = [*many, *map(arrival_line, single), *campaign_lines(found)]
    lines += [f"warning: {sentence}" for sentence in found.warnings]
    listed = [
        line for one in found.changed if one.state == "taken" for line in one.sweep.splitlines() if line
    ]
    text = [wrapped(lines[0], "", INDENT), *(wrapped(line, INDENT, 2 * INDENT) for line in lines[1:])]
    if listed:
        text.append(f"{INDENT}not in tyre.toml; to keep it, add direction, mount and setup as they are:")
        text += [f"{INDENT}{INDENT}{line}" for line in listed]
    return ascii_only("\n".join(text))


def campaign_lines(found: WatchedCampaign) -> list[str]:
    """Progress of the campaign, and its results so far."""
    more = len(found.awaited) - NAMED_IN_SENTENCE
    awaited = ", ".join(found.awaited[:NAMED_IN_SENTENCE]) + (f" and {more} more" if more > 0 else "")
    lines = [found.headline + (f"; awaited: {awaited}" if awaited else "")]
    lines += [found.problem] if found.problem else []
    lines += [f"not to be trusted: {reason}" for reason in (found.measured.reasons if found.measured else ())]
    lines += _numbers(found)
    if found.alignment is not None:
        lines.append(_alignment(found.alignment))
    if found.next_run is not None:
        lines.append(f"next run: {wording.next_sentence(found.next_run)}")
    return lines


def arrival_line(one: Arrival) -> str:
    """What became of a file."""
    if one.state == "gone":
        return f"{one.file} is gone"
    if one.state == "taken":
        return f"{one.file}: {counted(one.points, 'point')}"
    name = "" if Path(one.file).name in one.why else f"{one.file}: "
    return f"not taken: {name}{one.why}"


def _numbers(found: WatchedCampaign) -> list[str]:
    """eps_gamma with its change; without it, the cornering stiffness."""
    epsilon, row = found.epsilon_gamma, found.measured.nominal if found.measured else None
    if epsilon is not None:
        now, was = stated(epsilon), stated(found.before) if found.before else ""
        return [f"{DIRECT['epsilon_gamma'].ascii} {now}{f' (before {was})' if was not in ('', now) else ''}"]
    known = [one for one in (found.measured.per_load if found.measured else ()) if one.C_alpha is not None]
    quantity, load = DIRECT["C_alpha"], CONDITIONS["Fz_N"]
    at = [row] if row in known else known
    each = (f"{stated(one.C_alpha, quantity.unit_behind)} at {load.of(one.load)}" for one in at)
    return [f"{quantity.ascii} {', '.join(each)}"] if at else []


def _alignment(found: Alignment) -> str:
    """Forces at zeros forwards less those backwards, and the next correction."""
    load = CONDITIONS["Fz_N"]
    gaps = (f"{number(step.F_forward - step.F_backward, 0)} N at {load.of(step.load)}" for step in found.last)
    done = "; aligned" if found.aligned else ""
    correction = with_u(found.correction_deg, found.u_deg)
    return f"zeros forward less backward {', '.join(gaps)}; next correction {correction} deg{done}"
