"""How often does the diagnosis name a hidden cause? ``python tests/studies/diagnosis_study.py --seed 3``.

The whole suite of blind cases, or rows of them: ``--hard`` (wrongly stated noise, inexact models, unknown effects),
``--doubtful`` (cases that remain ambiguous, to calibrate the confidence), ``--correlated`` (errors with a memory along each
sweep, of several lengths). Sets of ``own_rig``, each ``--repeats`` times: ``--outside`` (causes that the library lacks),
``--library`` (single causes that it has, three to ten times their detection limit), ``--faint`` (the same at one to three times),
``--mixed`` (one cause of either kind). ``--combined``: effects of Fx, combined slip and Mx at three sizes, on a belt;
``--backwards`` adds a run in the other direction. ``--only`` keeps to cases whose name contains it.
"""

from __future__ import annotations

import tempfile
import time
from collections import Counter
from collections.abc import Callable, Iterator, Mapping
from functools import partial
from pathlib import Path
from typing import Any

import harness
import numpy as np
import own_rig
from blind_hard import MEMORIES, SCATTERS, correlated, doubtful, hard, smooth, triples
from blind_scores import Verdict, judge, rates, suite
from combined_cases import HIDDEN, SIZES, backwards, diagnosed
from harness import median

SUITE = "suite"
ROWS = {
    "doubtful": ("doubtful",),
    "correlated": tuple(MEMORIES),
    "hard": (*SCATTERS, "smooth", "triples"),
    **{name: (name,) for name in ("outside", "library", "faint", "mixed", "combined")},
}
CONFIDENCES = ((0.0, 0.5), (0.5, 0.8), (0.8, 0.95), (0.95, 0.99), (0.99, 1.01))


Case = tuple[str, Callable[[], Verdict]]
"""Name, and the verdict when it is asked for."""


def cases(row: str, given: Any) -> list[Case]:
    """The cases of a row."""
    own = {"doubtful": doubtful, "smooth": smooth, "triples": triples}
    if row in ("outside", "library", "faint", "mixed"):
        return [case for k in range(given.repeats) for case in own_cases(row, given.seed + k, k)]
    if row == "combined":
        return combined(given)
    if row == SUITE:
        plans = suite(given.seed, given.repeats)
    elif row in own:
        plans = own[row](given.seed)
    else:
        plans = correlated(row, given.seed) if row in MEMORIES else hard(row, given.seed)
    return [(plan.name, partial(lambda plan: judge(plan.draw()), plan)) for plan in plans]


def own_cases(row: str, seed: int, k: int) -> list[Case]:
    """Sets of ``own_rig`` with every cause once."""
    library, outside = own_rig.LIBRARY, list(own_rig.OUTSIDE)
    single = [cause for cause, number in library.items() if not number.endswith("@")]
    sets = {
        "outside": [(own_rig.outside_set, cause) for cause in outside],
        "library": [(own_rig.library_set, cause) for cause in library if cause != "camber-misalignment"],
        "faint": [(partial(own_rig.library_set, low=1.0, high=3.0), cause) for cause in library],
        "mixed": [
            (partial(own_rig.mixed_set, cause), outside[(j + 3 * k) % len(outside)])
            for j, cause in enumerate(single)
        ],
    }

    def of(draw: Callable[..., Any], cause: str) -> Verdict:
        return own_rig.judge(*draw(cause, seed=seed))

    return [(f"{cause}-{seed}", partial(of, draw, cause)) for draw, cause in sets[row]]


def combined(given: Any) -> list[Case]:
    """Every effect of Fx, combined slip and Mx at three sizes, and none."""
    added = tuple(backwards()) if given.backwards else ()

    def of(name: str, effect: str, size: float, seed: int) -> Verdict:
        began = time.process_time()
        with tempfile.TemporaryDirectory() as scratch:
            found = diagnosed(effect, size, seed, Path(scratch), added=added)
        named = tuple(one.effect.id for one in found.effects)
        ties = tuple(tuple(one.tied_with) for one in found.effects)
        confidence = tuple(one.confidence for one in found.effects)
        hidden, seconds = (effect,) if effect in HIDDEN else (), time.process_time() - began
        return Verdict(name, hidden, "", named, ties, found.unexplained, False, np.nan, seconds, confidence)

    return [
        (name := f"{effect} {word}", partial(of, name, effect, size, 1000 * given.seed + 10 * k + j))
        for k, effect in enumerate([*HIDDEN, "none"])
        for j, (word, size) in enumerate(SIZES.items())
    ]


def seeds(row: str, given: Any) -> list[int]:
    """Places of the wanted cases of a row."""
    wanted = [one for name, rows in ROWS.items() if getattr(given, name) for one in rows] or [SUITE]
    return [k for k, (name, _) in enumerate(cases(row, given)) if given.only in name] if row in wanted else []


def one(job: harness.Job) -> Verdict:
    return cases(job.world, job.given)[job.seed][1]()


def page(row: str, verdicts: list[Verdict]) -> Iterator[str]:
    if row == SUITE:
        yield from confusion(verdicts)
        for name, (hits, of) in rates(verdicts).items():
            yield f"{name:46s} " + (f"{hits:g} of {of:g}, {100.0 * hits / of:.1f} %" if of else f"{hits:.1f}")
        return
    caused = [v for v in verdicts if v.causes]
    first = sum(v.named[:1] == v.causes[:1] for v in caused)
    if row == "triples":
        first = sum(v.named != () and v.named[0] in v.causes for v in caused)
    ties = sum(bool(v.named) and bool({v.named[0], *v.ties[0]} & set(v.causes)) for v in caused)
    counts = {
        "first": f"{first} of {len(caused)}",
        "first or tied": ties,
        "all causes": sum(all(v.found(c) for c in v.causes) for v in caused),
        "extra": sum(v.extra for v in verdicts),
        "unexplained": f"{sum(v.unexplained for v in verdicts)} of {len(verdicts)}",
        "named on empty": f"{sum(bool(v.named) for v in verdicts if not v.causes)} of {len(verdicts) - len(caused)}",
        "worse": sum(bool(v.named) and v.shrink < 0.98 for v in verdicts),
        "shrink": f"{median([v.shrink for v in caused or verdicts]):.1f}",
        "seconds": f"{median([v.seconds for v in verdicts]):.1f}, at most {max(v.seconds for v in verdicts):.1f}",
    }
    yield f"{row}: " + ", ".join(f"{word} {count}" for word, count in counts.items())


def confusion(verdicts: list[Verdict]) -> Iterator[str]:
    """The first named effect by hidden effect, for single hidden effects."""
    yield "\nhidden -> named first (number of cases)"
    single = [v for v in verdicts if len(v.causes) == 1 and not v.structure]
    for cause in dict.fromkeys(v.causes[0] for v in single):
        named = Counter(v.named[0] if v.named else "none" for v in single if v.causes[0] == cause)
        tied = sum(any(v.ties) for v in single if v.causes[0] == cause)
        text = ", ".join(f"{name if name != cause else 'right'} {n}" for name, n in named.most_common())
        yield f"  {cause:28s} {text}" + (f"   ({tied} tied)" if tied else "")


def calibration(found: Mapping[str, list[Verdict]]) -> Iterator[str]:
    """How often named effects are right, by their confidence."""
    named = [
        (c, n in v.causes, bool({n, *t} & set(v.causes)))
        for verdicts in found.values()
        for v in verdicts
        for n, t, c in zip(v.named, v.ties, v.confidence, strict=True)
    ]
    rows = []
    for low, high in CONFIDENCES:
        inside = np.array([row for row in named if low <= row[0] < high]).reshape(-1, 3)
        mean = f"{100.0 * np.mean(inside[:, 0]):.0f} %" if len(inside) else "-"
        right = (int(count) for count in inside[:, 1:].sum(axis=0))
        rows.append((f"{low:.2f} to {min(high, 1.0):.2f}", len(inside), mean, *right))
    return harness.table(("confidence", "named", "mean confidence", "right", "right or tied with it"), rows)


if __name__ == "__main__":
    harness.study(
        one, page, worlds=(SUITE, *(row for rows in ROWS.values() for row in rows)), draws=None, seeds=seeds,
        last=calibration, seed=1, repeats=1, only="", backwards=False, **dict.fromkeys(ROWS, False),
    )  # fmt: skip
