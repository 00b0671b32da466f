"""The record of readings that were left out or have reduced weight, and the entries found when files become points."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from mffit.as_json import keys
from mffit.config.lines import line_text
from mffit.points.faulty import Fault
from mffit.points.stretch import Stretch
from mffit.sweeps import Sweep
from mffit.sweeps.sweep import ExcludedRows

UNUSED = "not steady: transients and incomplete means between the points"
"""Reason for sound samples that are part of no average."""


@dataclass(frozen=True, slots=True, kw_only=True)
class LeftOut:
    """Readings of one file that are left out, have reduced weight or are doubted, for one reason."""

    file: str  #: name as in ``tyre.toml``
    lines: str  #: such as "39-44, 60", counted from 1; "" if unknown
    count: int  #: number of readings, or of samples of a recording
    by: Literal["hand", "rule"]
    rule: str = ""  #: name of the rule; "" by hand
    channel: str = ""  #: "" if the whole reading is meant
    weight: float = 0.0  #: smallest weight in the fit relative to an undoubted reading
    why: str


keys(LeftOut, "* rule? channel?")


def together(entries: Sequence[LeftOut], most: int) -> list[LeftOut]:
    """The entries for a page: more than ``most`` of one rule, file, channel and weight are merged, with the first reason."""
    alike: dict[tuple[object, ...], list[LeftOut]] = {}
    for one in entries:
        alike.setdefault((one.file, one.by, one.rule, one.channel, one.weight), []).append(one)
    shown: list[LeftOut] = []
    for members in alike.values():
        if len(members) <= most:
            shown += members
            continue
        first = members[0]
        lines = ", ".join(one.lines for one in members if one.lines)
        why = f"{first.why}; and {len(members) - 1} more like it"
        shown.append(replace(first, lines=lines, count=sum(one.count for one in members), why=why))
    return shown


def by_hand(excluded: Sequence[ExcludedRows]) -> tuple[LeftOut, ...]:
    """The entries of ``[fit] exclude``."""
    return tuple(
        LeftOut(file=rows.file, lines=line_text(rows.line), count=len(rows.line), by="hand", why=rows.why)
        for rows in excluded
    )


def at_standstill(standing: Sequence[tuple[str, np.ndarray]]) -> tuple[LeftOut, ...]:
    """The entries of samples at standstill: files with lines (m,)."""
    return tuple(
        one for file, lines in standing for one in _of_lines(file, lines, "standstill", "the wheel stands")
    )


def by_rule(sweep: Sweep, which: np.ndarray, rule: str, why: str) -> tuple[LeftOut, ...]:
    """The readings of a mask (n,) as one entry; no entry if the mask is empty."""
    return _of_lines(sweep.file, sweep.line[which], rule, why)


def _of_lines(file: str, lines: np.ndarray, rule: str, why: str) -> tuple[LeftOut, ...]:
    if not len(lines):
        return ()
    return (LeftOut(file=file, lines=line_text(lines), count=len(lines), by="rule", rule=rule, why=why),)


def of_recording(
    sweep: Sweep, wrong: Sequence[Fault], tried: Sequence[Stretch], used: np.ndarray
) -> tuple[LeftOut, ...]:
    """Entries for the samples (n,) of a recording that are part of no average (mask ``used``), each under its first reason.

    ``wrong`` are faults, in the order of their rules; ``tried`` are all stretches.
    """
    rest = ~used
    out: list[LeftOut] = []
    faults = ((fault.which, fault.rule, fault.reason) for fault in wrong)
    for which, rule, why in (*faults, *_dropped(len(sweep), tried)):
        out += by_rule(sweep, which & rest, rule, why)
        rest = rest & ~which
    return (*out, *by_rule(sweep, rest, "steady-state", UNUSED))


def _dropped(n: int, tried: Sequence[Stretch]) -> Iterator[tuple[np.ndarray, str, str]]:
    """By reason, mask (n,) of the samples of dropped stretches."""
    for reason in dict.fromkeys(stretch.dropped for stretch in tried if stretch.dropped):
        which = np.zeros(n, dtype=bool)
        for stretch in tried:
            if stretch.dropped == reason:
                which[stretch.begin : stretch.end] = True
        yield which, "steady-state", reason
