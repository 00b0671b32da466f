"""Does scipy's ``trf`` gain anything where a search of a build ends? ``python tests/studies/solver_study.py 6``.

It builds drawn rigs, so many of each unlisted world of ``rigs_study.py`` and of each kind of ``slip_study.py`` (or the
``--projects`` named), and takes the final searches of each: the least-squares problem, its start, and its end. ``trf`` runs from
the end and from the start. Printed per search: numbers, sum of squares, fall that a step still promises, gain of ``trf`` from the
end, then sums of squares and processor time of ``trf`` and of our own search from the same start.
"""

from __future__ import annotations

import time
from argparse import Namespace
from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import Any, NamedTuple

import harness
import numpy as np
import rigs_study
import slip_study
from scipy.optimize import least_squares

from mffit.fit import polish
from mffit.least_squares import FreeNumber, LeastSquaresProblem, Linear, Solution, broken, solve
from mffit.suspicion.constants import LARGEST_FALL_LEFT

DECISIVE = 0.1
"""Fall of a sum of squares that decides something; see ``CLEARLY_BETTER_END``."""
PROJECTS = "projects"
WORLDS = (*(name for name in rigs_study.WORLDS if name.startswith("unlisted")), *slip_study.KINDS, PROJECTS)


class Search(NamedTuple):
    """A search of a build, with ``trf`` from its end and from its start."""

    numbers: int
    cost: float
    left: float
    gain: float  #: of trf from the end
    trf_cost: float  #: from the start
    seconds: float
    trf_seconds: float


def by_trf(
    problem: LeastSquaresProblem, numbers: Sequence[FreeNumber], start: np.ndarray
) -> tuple[float, float]:
    """Sum of squares where ``trf`` ends, and its processor time [s]."""
    bounds = tuple(np.array([getattr(n, end) for n in numbers]) for end in ("lower", "upper"))
    weight = np.array([0.0 if np.isinf(n.spread) else 1.0 / n.spread for n in numbers])
    expected = np.array([n.expected for n in numbers])
    last: list[tuple[np.ndarray, Linear]] = []

    def linear(x: np.ndarray) -> Linear:
        if not last or not np.array_equal(last[0][0], x):
            last[:] = [(x.copy(), problem.linear(x))]
        return last[0][1]

    few = len(problem.residual(start)[0]) == len(linear(start).data)

    def residual(x: np.ndarray) -> np.ndarray:
        data, limits = problem.residual(x) if few else (linear(x).data, linear(x).limits)
        found = np.concatenate([data, broken(limits), weight * (x - expected)])
        return np.where(np.isfinite(found), found, 1e8)

    def slope(x: np.ndarray) -> np.ndarray:
        here = linear(x)
        return np.vstack([here.slope, here.limits_slope * (here.limits > 0.0)[:, None], np.diag(weight)])

    began = time.process_time()
    found = least_squares(residual, np.clip(start, *bounds), slope, bounds, x_scale="jac", max_nfev=300)
    return 2.0 * float(found.cost), time.process_time() - began


def searches(build: Callable[[], Any]) -> list[Search]:
    """The last search of each problem over all points at the end of the polish of one build."""
    found: dict[int, tuple[Any, ...]] = {}

    def recorded(problem: LeastSquaresProblem, numbers: Sequence[FreeNumber], **keys: Any) -> Solution:
        began = time.process_time()
        end = solve(problem, numbers, **keys)
        if keys.get("max_steps", 1):
            found[len(numbers)] = (problem, numbers, end, time.process_time() - began)
        return end

    polish.solve = recorded  # type: ignore[attr-defined]
    try:
        build()
    finally:
        polish.solve = solve  # type: ignore[attr-defined]
    rows = []
    for problem, numbers, end, seconds in found.values():
        gain = end.cost - by_trf(problem, numbers, np.array(list(end.values.values())))[0]
        cost, own = by_trf(problem, numbers, np.array([n.start for n in numbers]))
        rows.append(Search(len(numbers), end.cost, end.left, gain, cost, seconds, own))
    return rows


def seeds(world: str, given: Namespace) -> Sequence[Any]:
    if given.projects:
        return given.projects if world == PROJECTS else ()
    return range(given.first, given.first + given.draws) if world != PROJECTS else ()


def one(job: harness.Job) -> list[Search]:
    if job.world == PROJECTS:
        return searches(lambda: harness.built(job.seed))
    study = rigs_study if job.world in rigs_study.WORLDS else slip_study
    given = Namespace(build=True, off=0.12, exact=True)
    return searches(lambda: study.one(harness.Job(job.seed, job.world, given)))


def page(world: str, rows: list[list[Search]]) -> Iterator[str]:
    yield from (f"{world}: " + " ".join(f"{x:10.4g}" for x in row) for found in rows for row in found)


def last(found: Mapping[str, list[list[Search]]]) -> Iterator[str]:
    every = [row for builds in found.values() for rows in builds for row in rows]
    gain, left, beyond = (np.array([f(row) for row in every]) for f in (
        lambda row: row.gain, lambda row: row.left, lambda row: row.trf_cost - row.cost
    ))  # fmt: skip
    yield (
        f"{len(every)} searches: trf gains more than {DECISIVE} from {np.sum(gain > DECISIVE)} ends, "
        f"{np.sum(left > LARGEST_FALL_LEFT)} of which count as stuck; from the start trf ends higher in "
        f"{np.sum(beyond > DECISIVE)}, lower in {np.sum(beyond < -DECISIVE)}; "
        f"{sum(r.seconds for r in every):.0f} s, trf {sum(r.trf_seconds for r in every):.0f} s"
    )


if __name__ == "__main__":
    harness.study(one, page, worlds=WORLDS, draws=6, seeds=seeds, last=last, projects=[""])
