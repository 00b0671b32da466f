"""How often a hidden effect of Fx, combined slip or Mx is named first: ``python tests/studies/combined_study.py --help``."""

from __future__ import annotations

import argparse
import sys
import tempfile
import time
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1] / "mffit" / "diagnosis"))

from combined_cases import HIDDEN, SIZES, backwards, diagnosed


def main() -> None:
    ask = argparse.ArgumentParser(description=__doc__)
    ask.add_argument("--seed", type=int, default=1)
    ask.add_argument("--only", nargs="*", default=[*HIDDEN, "none"])
    ask.add_argument("--sizes", nargs="*", default=list(SIZES))
    ask.add_argument("--backwards", action="store_true", help="with a run in the other direction")
    given = ask.parse_args()
    added = tuple(backwards()) if given.backwards else ()
    for k, effect in enumerate([*HIDDEN, "none"]):
        for j, size in enumerate(SIZES):
            if effect not in given.only or size not in given.sizes:
                continue
            with tempfile.TemporaryDirectory() as scratch:
                began = time.process_time()
                found = diagnosed(
                    effect, SIZES[size], 1000 * given.seed + 10 * k + j, Path(scratch), added=added
                )
                seconds = time.process_time() - began
            named = [(one.effect.id, *one.tied_with) for one in found.effects]
            first = named[0] if named else ("none",)
            verdict = "right" if first[0] == effect else "tied" if effect in first else "WRONG"
            said = "; ".join(
                f"{one.effect.id}{list(one.tied_with) or ''} {one.confidence:.2f}" for one in found.effects
            )
            rest = " unexplained" if found.unexplained else ""
            print(f"{effect:24s} {size:7s} {verdict:6s} {said or 'none'}{rest}  {seconds:.1f} s", flush=True)


if __name__ == "__main__":
    main()
