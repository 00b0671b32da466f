"""The page of all rig errors."""

from __future__ import annotations

import math

from mffit.rig_errors import AFTER, BEFORE, RIG_ERRORS, RigError

INTRODUCTION = """\
# Rig errors

How the readings of a rig differ from the steady forces of the tyre, in ISO-W and in the order in which the errors act. Fit,
uncertainty budget, [diagnosis](diagnosis.md), [virtual rig](simulate.md) and `mffit plan` use this list. "Declared by" names
the key of `[rig]` with the standard uncertainty and its default; such an error is a number of the fit with this prior. Only a
diagnosis searches for the others, by the named [effects](effects.md). The limits hold for fits and for `[faults]`. Numbers
marked \\* are zeros, which every [set-up](configuration.md#set-ups-of-the-rig) has anew.
"""


def page() -> str:
    """The page in Markdown: a table per place in the chain."""
    lines = [INTRODUCTION]
    ordered = (*BEFORE, *AFTER)
    for place in dict.fromkeys(error.place for error in ordered):
        assert place is not None
        lines += [f"## {place.value}", *_table([error for error in ordered if error.place is place]), ""]
    lines += [
        "## Reference of the temperature effects",
        *_table([error for error in RIG_ERRORS if error.place is None]),
    ]
    return "\n".join(lines) + "\n"


def _table(errors: list[RigError]) -> list[str]:
    head = [
        "| number | unit | meaning | usual size | limits | declared by | effects |",
        "|---|---|---|---|---|---|---|",
    ]
    return head + [_row(error) for error in errors]


def _row(error: RigError) -> str:
    scale = " × its value" if error.relative else ""
    declared = "–"
    if error.declared is not None:
        default = error.declared.default
        declared = f"`{error.declared.key}`" + (f" ({default:g})" if default is not None else "")
    effects = ", ".join(f"`{seen.id}`" for seen in (error.seen_as, error.seen_per_run) if seen) or "–"
    limits = f"{_bound(error.lower)} to {_bound(error.upper)}"
    meaning = error.meaning.replace("|Fy|", r"\|Fy\|")
    zero = r"\*" if error.of_setup else ""
    return f"| `{error.name}`{zero} | {error.unit} | {meaning} | {error.spread:g}{scale} | {limits} | {declared} | {effects} |"


def _bound(x: float) -> str:
    return ("–∞" if x < 0 else "∞") if math.isinf(x) else f"{x:g}"
