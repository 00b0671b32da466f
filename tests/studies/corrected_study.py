"""Does the delivered file contain the tyre? ``python tests/studies/corrected_study.py --sets 200 --nothing 100 --jobs 2``.

Each set hides one or two effects of the tyre among none to four errors of the rig. The model given lacks all of them; it is
exact, or as inexact as it declares; the noise is white, or correlated along each sweep. ``--nothing`` adds sets with nothing
hidden. Judged is the file that ``model_after`` names, against the hidden tyre, on a straight path and on the disc. All readings
come from ``blind_rig``. A line of JSON per set goes to ``--keep``; ``--table`` prints the table of kept lines.
"""

from __future__ import annotations

import argparse
import json
import math
import sys
from concurrent.futures import ProcessPoolExecutor
from dataclasses import asdict
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1] / "mffit" / "diagnosis"))

import numpy as np
from blind_corrected import NOISE, PLAIN_CHI2, USUAL, Score, plans, scored
from blind_set import CAUSES


def table(scores: list[Score]) -> None:
    """Print the rates."""
    hidden, empty = [s for s in scores if s.causes], [s for s in scores if not s.causes]

    def share(what: str, rows: list[bool]) -> None:
        if rows:
            print(f"{what:58s} {sum(rows)} of {len(rows)}, {100.0 * sum(rows) / len(rows):.1f} %")

    for kind, rows in (
        ("all", hidden),
        ("exact", [s for s in hidden if s.exact]),
        ("inexact", [s for s in hidden if not s.exact]),
        *((noise, [s for s in hidden if s.noise == noise]) for noise in NOISE),
    ):
        share(f"{kind}: delivered misses at most 0.4 of the given", [s.ratio <= 0.4 for s in rows])
        share(f"{kind}: never worse", [s.ratio <= 1.001 for s in rows])
        plain = [
            name not in s.missed
            for s in rows
            for name, size in zip((c for c in s.causes if CAUSES[c].tyre), s.chi2, strict=True)
            if size > PLAIN_CHI2
        ]
        share(f"{kind}: plain tyre effects named", plain)
        share(f"{kind}: sets with a false name", [bool(s.false) for s in rows])
        share(
            f"{kind}: everything named, nothing else",
            [not s.false and set(s.causes) <= s.known for s in rows],
        )
        share(f"{kind}: unexplained", [s.unexplained for s in rows])
        share(f"{kind}: distrusted", [not s.trusted for s in rows])
        pulls = np.array([x for s in rows for x in s.pulls.values()])
        if len(pulls):
            inside = 100.0 * np.mean(np.abs(pulls) < 1.96)
            size = math.sqrt(np.mean(pulls**2))
            print(f"{kind}: pulls rms {size:.2f}, inside 95 % {inside:.0f} % of {len(pulls)}")
    share("nothing hidden: nothing named", [not s.named for s in empty])
    share(
        "nothing hidden: nothing missing",
        [not s.named and not s.unexplained and not s.new_file for s in empty],
    )
    print(
        f"median seconds {np.median([s.seconds for s in scores]):.1f}, most {max(s.seconds for s in scores):.1f}"
    )


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--sets", type=int, default=200)
    parser.add_argument("--nothing", type=int, default=0)
    parser.add_argument(
        "--inexactness", type=float, default=0.004, help="of the coefficients of inexact models"
    )
    parser.add_argument("--noise", default=",".join(USUAL), help=f"of the sets in turn: {', '.join(NOISE)}")
    parser.add_argument("--only", default="", help="names of sets, with commas")
    parser.add_argument("--jobs", type=int, default=1)
    parser.add_argument("--keep", type=Path)
    parser.add_argument("--table", type=Path, help="print only the table of these kept lines")
    options = parser.parse_args()
    if options.table:
        rows = [json.loads(line) for line in options.table.read_text().splitlines()]
        scores = [
            Score(
                **{
                    k: tuple(map(tuple, v)) if k == "ties" else tuple(v) if isinstance(v, list) else v
                    for k, v in row.items()
                }
            )
            for row in rows
        ]
        for score in scores:
            if score.ratio > 0.4 or score.false or score.missed or score.unexplained:
                print(score.line())
        table(scores)
        return
    wanted = [
        p
        for p in plans(
            options.seed, options.sets, options.nothing, options.inexactness, options.noise.split(",")
        )
        if not options.only or p.name in options.only.split(",")
    ]
    scores = []
    with ProcessPoolExecutor(options.jobs) as pool:
        for score in pool.map(scored, wanted):
            scores.append(score)
            print(score.line(), flush=True)
            if options.keep:
                with options.keep.open("a") as out:
                    out.write(json.dumps(asdict(score)) + "\n")
    table(scores)


if __name__ == "__main__":
    main()
