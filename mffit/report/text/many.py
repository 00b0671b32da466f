"""Many builds, for the terminal: a line when each is finished, a table of all at the end."""

from __future__ import annotations

from collections.abc import Sequence

from mffit.quantities import CHANNELS, DIRECT
from mffit.report.rounding import ascii_only, number, stated
from mffit.report.text.layout import blocks, table
from mffit.results import Outcome


def many_line(outcome: Outcome, number_of: int, total: int) -> str:
    """What is said when one is finished."""
    said = {
        "built": f"built in {outcome.seconds:.0f} s",
        "unchanged": "unchanged since it was built, left as it is",
        "refused": "refused",
        "failed": "failed",
    }[outcome.state]
    return f"[{number_of}/{total}] {outcome.name}: {said}"


def many_summary(outcomes: Sequence[Outcome]) -> str:
    """Tyre, eps_gamma, misfit, warnings, and the file; or the sentence that says why there is none."""
    head = (
        "tyre",
        DIRECT["epsilon_gamma"].ascii,
        *(c.column(f"{n} rms") for n, c in CHANNELS.items()),
        "warnings",
    )
    whole = [o for o in outcomes if o.whole]
    rows = [
        (
            o.name,
            stated(o.epsilon_gamma),
            *(number(o.misfit.get(name), digits=3) for name in CHANNELS),
            str(o.warnings),
        )
        for o in whole
    ]
    ends = ["file", "", *(f"{o.out}/{o.file}" + " (unchanged)" * (o.state == "unchanged") for o in whole)]
    lines = [
        f"{line}  {end}".rstrip() for line, end in zip(table(head, rows).splitlines(), ends, strict=True)
    ]
    rest = [lacking(o) for o in outcomes if not o.whole]
    return blocks(["\n".join(lines) if whole else "", ascii_only("\n".join(rest))])


def lacking(outcome: Outcome) -> str:
    """Why a tyre has no output."""
    known = outcome.sentence.startswith(outcome.name)
    return outcome.sentence if known else f"{outcome.name}: {outcome.sentence}"
