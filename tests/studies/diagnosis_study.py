"""How often the diagnosis names a hidden cause: ``python tests/studies/diagnosis_study.py --help``."""

from __future__ import annotations

import argparse
import json
import sys
import time
from collections import Counter
from collections.abc import Iterable
from dataclasses import asdict
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1] / "mffit" / "diagnosis"))

import numpy as np
from blind_hard import MEMORIES, SCATTERS, correlated, doubtful, hard, smooth, triples
from blind_scores import Plan, Verdict, judge, rates, suite


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seed", type=int, default=1, help="of the whole set")
    parser.add_argument("--repeats", type=int, default=1, help="how many sets")
    parser.add_argument("--only", default="", help="only cases whose name contains this")
    parser.add_argument(
        "--hard", action="store_true", help="wrongly stated noise, inexact models, unknown effects"
    )
    parser.add_argument(
        "--doubtful",
        action="store_true",
        help="cases that remain ambiguous under these conditions, to calibrate the confidence",
    )
    parser.add_argument(
        "--correlated", action="store_true", help="errors with a memory along each sweep, of several lengths"
    )
    parser.add_argument("--keep", type=Path, help="file to which every verdict is appended as a line of JSON")
    parser.add_argument(
        "--reliability", type=Path, nargs="+", help="print only the table of these kept verdicts"
    )
    options = parser.parse_args()
    if options.reliability:
        print_calibration(kept(options.reliability))
        return
    if options.hard or options.doubtful or options.correlated:
        print_hard(options)
        return
    verdicts: list[Verdict] = []
    for plan in suite(options.seed, options.repeats):
        if options.only not in plan.name:
            continue
        began = time.perf_counter()
        verdict = keep(judge(plan.draw()), options.keep)
        verdicts.append(verdict)
        if not verdict.outright:
            print(f"{verdict.line()}  {time.perf_counter() - began:.1f} s", flush=True)
    print_confusion(verdicts)
    for name, (hits, of) in rates(verdicts).items():
        print(f"{name:46s} " + (f"{hits:g} of {of:g}, {100.0 * hits / of:.1f} %" if of else f"{hits:.1f}"))


def print_hard(options: argparse.Namespace) -> None:
    """Print a line per condition, each with 12 single causes and 6 correct models."""
    print(f"{'row':12s} right first/ties  extras  unexplained  named on empty  worse  shrink  seconds")
    every: list[Verdict] = []
    if options.doubtful:
        every += judged("doubtful", list(doubtful(options.seed)), options)
    for row in MEMORIES if options.correlated else ():
        every += judged(row, list(correlated(row, options.seed)), options)
    for row in SCATTERS if options.hard else ():
        every += judged(row, list(hard(row, options.seed)), options)
    if options.hard:
        every += judged("smooth", list(smooth(options.seed)), options)
        every += judged("triples", list(triples(options.seed)), options)
    print_calibration(every)


def keep(verdict: Verdict, file: Path | None) -> Verdict:
    """The verdict, after appending it to the file if one is given."""
    if file is not None:
        with file.open("a", encoding="utf-8") as out:
            out.write(json.dumps(asdict(verdict)) + "\n")
    return verdict


def kept(files: Iterable[Path]) -> list[Verdict]:
    """Verdicts of earlier runs."""
    rows = [json.loads(line) for file in files for line in file.read_text(encoding="utf-8").splitlines()]
    return [Verdict(**{n: _tuples(value) for n, value in row.items()}) for row in rows]


def _tuples(value: object) -> object:
    return tuple(map(_tuples, value)) if isinstance(value, list) else value


def judged(row: str, plans: list[Plan], options: argparse.Namespace) -> list[Verdict]:
    """The verdicts of the cases of a row; prints the row."""
    if options.only not in row:
        return []
    verdicts = []
    for plan in plans:
        verdicts.append(keep(judge(plan.draw()), options.keep))
        if not verdicts[-1].outright:
            print("    " + verdicts[-1].line(), flush=True)
    caused = [v for v in verdicts if v.causes]
    first = sum(v.named[:1] == v.causes[:1] for v in caused)
    if row == "triples":
        first = sum(v.named != () and v.named[0] in v.causes for v in caused)
    ties = sum(bool(v.named) and bool({v.named[0], *v.ties[0]} & set(v.causes)) for v in caused)
    all_found = sum(all(v.found(c) for c in v.causes) for v in caused)
    print(
        f"{row:12s} {first}/{ties} of {len(caused)} (all {all_found})  {sum(v.extra for v in verdicts)} extra  "
        f"{sum(v.unexplained for v in verdicts)} of {len(verdicts)} unexplained  "
        f"{sum(bool(v.named) for v in verdicts if not v.causes)} of {len(verdicts) - len(caused)} named on empty  "
        f"{sum(bool(v.named) and v.shrink < 0.98 for v in verdicts)} worse  "
        f"shrink {float(np.median([v.shrink for v in caused or verdicts])):.1f}  "
        f"{float(np.median([v.seconds for v in verdicts])):.1f} s, at most {max(v.seconds for v in verdicts):.1f}",
        flush=True,
    )
    return verdicts


def print_calibration(verdicts: list[Verdict]) -> None:
    """Print how often named effects are right, by their confidence."""
    named = [
        (c, n in v.causes, bool({n, *t} & set(v.causes)))
        for v in verdicts
        for n, t, c in zip(v.named, v.ties, v.confidence, strict=True)
    ]
    print("confidence: named, mean confidence, right, right or tied with it")
    for low, high in ((0.0, 0.5), (0.5, 0.8), (0.8, 0.95), (0.95, 0.99), (0.99, 1.01)):
        inside = [row for row in named if low <= row[0] < high]
        mean = f"{100.0 * np.mean([c for c, _, _ in inside]):.0f} %" if inside else "-"
        right, tied = (sum(row[k] for row in inside) for k in (1, 2))
        print(f"  {low:.2f} to {min(high, 1.0):.2f}: {len(inside)}, {mean}, {right}, {tied}")


def print_confusion(verdicts: list[Verdict]) -> None:
    """Print the first named effect by hidden effect, for single hidden effects."""
    print("\nhidden -> named first (number of cases)")
    single = [v for v in verdicts if len(v.causes) == 1 and not v.structure]
    for cause in dict.fromkeys(v.causes[0] for v in single):
        named = Counter(v.named[0] if v.named else "none" for v in single if v.causes[0] == cause)
        tied = sum(any(v.ties) for v in single if v.causes[0] == cause)
        text = ", ".join(f"{name if name != cause else 'right'} {n}" for name, n in named.most_common())
        print(f"  {cause:28s} {text}" + (f"   ({tied} tied)" if tied else ""))


if __name__ == "__main__":
    main()
