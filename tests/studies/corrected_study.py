"""Does the delivered file contain the tyre? ``python tests/studies/corrected_study.py 200 --nothing 100 --jobs 2``.

Each set hides one or two effects of the tyre among none to four errors of the rig. The model given lacks all of them; it is
exact, or as inexact as it declares; the noise is white, or correlated along each sweep (``--noise`` of the sets in turn).
``--nothing`` adds sets with nothing hidden. Judged is the file that ``model_after`` names, against the hidden tyre, on a straight
path and on the disc. All readings come from ``blind_rig``.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import harness
import numpy as np
from blind_corrected import NOISE, PLAIN_CHI2, USUAL, Score, plans, scored
from blind_set import CAUSES
from drawn_rigs import SAFE

from mffit.scatter import rms


def planned(given: Any) -> list[Any]:
    return list(plans(given.seed, given.draws, given.nothing, given.inexactness, given.noise))


def seeds(_: Any, given: Any) -> list[int]:
    return [k for k, plan in enumerate(planned(given)) if given.only in plan.name]


def one(job: harness.Job) -> Score:
    return scored(planned(job.given)[job.seed])


def page(_: Any, scores: list[Score]) -> Iterator[str]:
    hidden, empty = [s for s in scores if s.causes], [s for s in scores if not s.causes]
    groups = {
        "all": hidden,
        "exact": [s for s in hidden if s.exact],
        "inexact": [s for s in hidden if not s.exact],
        **{noise: [s for s in hidden if s.noise == noise] for noise in NOISE},
    }
    for kind, rows in groups.items():
        if not rows:
            continue
        plain = [
            name not in s.missed
            for s in rows
            for name, size in zip((c for c in s.causes if CAUSES[c].tyre), s.chi2, strict=True)
            if size > PLAIN_CHI2
        ]
        yield from _shares(
            {
                f"{kind}: delivered misses at most 0.4 of the given": [s.ratio <= 0.4 for s in rows],
                f"{kind}: never worse": [s.ratio <= 1.001 for s in rows],
                f"{kind}: plain tyre effects named": plain,
                f"{kind}: sets with a false name": [bool(s.false) for s in rows],
                f"{kind}: everything named, nothing else": [
                    not s.false and set(s.causes) <= s.known for s in rows
                ],
                f"{kind}: unexplained": [s.unexplained for s in rows],
                f"{kind}: distrusted": [not s.trusted for s in rows],
            }
        )
        pulls = np.array([x for s in rows for x in s.pulls.values()])
        inside = harness.percent(np.abs(pulls) < SAFE)
        yield f"{kind}: pulls rms {rms(pulls):.2f}, inside 95 % {inside} of {len(pulls)}"
    nothing = [not s.named and not s.unexplained and not s.new_file for s in empty]
    yield from _shares(
        {
            "nothing hidden: nothing named": [not s.named for s in empty],
            "nothing hidden: nothing missing": nothing,
        }
    )
    seconds = [s.seconds for s in scores]
    yield f"median seconds {harness.median(seconds):.1f}, most {max(seconds):.1f}"


def _shares(rows: dict[str, list[bool]]) -> Iterator[str]:
    for what, hits in rows.items():
        if hits:
            yield f"{what:58s} {sum(hits)} of {len(hits)}, {100.0 * sum(hits) / len(hits):.1f} %"


if __name__ == "__main__":
    harness.study(
        one, page, draws=200, seeds=seeds, seed=1, nothing=0, inexactness=0.004, noise=list(USUAL), only=""
    )
