"""Print how often the diagnosis names a hidden cause: ``python tests/studies/diagnosis_study.py --help``."""

from __future__ import annotations

import argparse
import sys
import time
from collections import Counter
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1] / "mffit" / "diagnosis"))

from blind_scores import Verdict, judge, rates, suite


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seed", type=int, default=1, help="of the whole set")
    parser.add_argument("--repeats", type=int, default=1, help="how many sets")
    parser.add_argument("--only", default="", help="only cases whose name contains this")
    options = parser.parse_args()
    verdicts: list[Verdict] = []
    for plan in suite(options.seed, options.repeats):
        if options.only not in plan.name:
            continue
        began = time.perf_counter()
        verdict = judge(plan.draw())
        verdicts.append(verdict)
        if not verdict.outright:
            print(f"{verdict.line()}  {time.perf_counter() - began:.1f} s", flush=True)
    print_confusion(verdicts)
    for name, (hits, of) in rates(verdicts).items():
        print(f"{name:46s} " + (f"{hits:g} of {of:g}, {100.0 * hits / of:.1f} %" if of else f"{hits:.1f}"))


def print_confusion(verdicts: list[Verdict]) -> None:
    """Hidden effect against first named one, single hidden effects only; hits are counted, misses named."""
    print("\nhidden -> named first (number of cases)")
    single = [v for v in verdicts if len(v.causes) == 1 and not v.structure]
    for cause in dict.fromkeys(v.causes[0] for v in single):
        named = Counter(v.named[0] if v.named else "none" for v in single if v.causes[0] == cause)
        tied = sum(any(v.ties) for v in single if v.causes[0] == cause)
        text = ", ".join(f"{name if name != cause else 'right'} {n}" for name, n in named.most_common())
        print(f"  {cause:28s} {text}" + (f"   ({tied} tied)" if tied else ""))


if __name__ == "__main__":
    main()
