"""Does scipy's ``trf`` gain anything where a search of a build ends? ``python tests/studies/solver_study.py 6 [TYRE.toml ...]``.

It builds drawn rigs, so many of each world of ``unlisted_study.py``, as many drawn tyres on a drive/brake programme per three
worlds, and the projects named, and takes the final searches of each: the least-squares problem, its start, and its end. ``trf``
runs from the end and from the start. Printed per search: numbers, sum of squares, fall that a step still promises, gain of
``trf`` from the end, then sums of squares and processor time of ``trf`` and of our own search from the same start.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Callable, Iterator, Sequence
from functools import partial
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import unlisted_study
from scipy.optimize import least_squares

sys.path.insert(0, str(Path(__file__).parents[2]))
import driven_study

import mffit
from mffit.config import load
from mffit.errors import InputError
from mffit.fit import polish
from mffit.least_squares import FreeNumber, LeastSquaresProblem, Linear, Solution, broken, solve
from mffit.suspicion.constants import LARGEST_FALL_LEFT
from tests.mffit.fit import combined_programme as belt

DECISIVE = 0.1
"""Fall of a sum of squares that decides something; see ``CLEARLY_BETTER_END``."""


class Search(NamedTuple):
    """A search of a build."""

    problem: LeastSquaresProblem
    numbers: Sequence[FreeNumber]
    end: Solution
    seconds: float


class Row(NamedTuple):
    """A search and ``trf`` beside it."""

    name: str
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
    lower, upper = (np.array([getattr(n, end) for n in numbers]) for end in ("lower", "upper"))
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
    found = least_squares(
        residual, np.clip(start, lower, upper), slope, (lower, upper), x_scale="jac", max_nfev=300
    )
    return 2.0 * float(found.cost), time.process_time() - began


def searches(build: Callable[[], Any]) -> list[Search]:
    """The searches over all points at the end of the polish of one build."""
    found: list[Search] = []

    def recorded(problem: LeastSquaresProblem, numbers: Sequence[FreeNumber], **keys: Any) -> Solution:
        began = time.process_time()
        end = solve(problem, numbers, **keys)
        if keys.get("max_steps", 1):
            found.append(Search(problem, numbers, end, time.process_time() - began))
        return end

    polish.solve = recorded  # type: ignore[attr-defined]
    try:
        build()
    except InputError:
        pass
    finally:
        polish.solve = solve  # type: ignore[attr-defined]
    return found


def rows(name: str, found: Sequence[Search]) -> Iterator[Row]:
    """The last search of each problem beside ``trf``."""
    for problem, numbers, end, seconds in {len(one.numbers): one for one in found}.values():
        here = np.array(list(end.values.values()))
        gain = end.cost - by_trf(problem, numbers, here)[0]
        start = np.array([n.start for n in numbers])
        cost, own = by_trf(problem, numbers, start)
        yield Row(name, len(numbers), end.cost, end.left, gain, cost, seconds, own)


def builds(count: int, paths: Sequence[str]) -> Iterator[tuple[str, Callable[[], Any]]]:
    """Names and builds: projects as ``TYRE.toml`` or ``TYRE.toml,PPX2=0,...``, then drawn rigs."""
    for path in paths:
        file, *held = path.split(",")
        yield path, partial(lambda file, held: mffit.build(load(file, coefficients=held)), file, held)
    for world in unlisted_study.WORLDS:
        for seed in range(count):
            yield f"{world} {seed}", partial(unlisted_study.one, (seed, world, None))
    base = belt.truth()
    for seed in range(count * len(unlisted_study.WORLDS) // 3):
        yield f"driven {seed}", partial(_driven, base, seed)


def _driven(base: Any, seed: int) -> Any:
    return belt.fitted(belt.programme(tyre=driven_study.drawn(base, seed), seed=seed))


def main(count: int, paths: Sequence[str]) -> None:
    """Print a line per search, and what they say together."""
    every: list[Row] = []
    built = 0
    for name, build in builds(count, paths):
        found = searches(build)
        built += bool(found)
        for row in rows(name, found):
            every.append(row)
            print(
                f"{row.name[-60:]:60s} {row.numbers:4d} {row.cost:10.2f} {row.left:9.1e} {row.gain:9.1e}  "
                f"{row.trf_cost:10.2f} {row.seconds:6.2f} s {row.trf_seconds:6.2f} s",
                flush=True,
            )
    gain, left = (np.array([getattr(row, name) for row in every]) for name in ("gain", "left"))
    beside = np.array([row.trf_cost - row.cost for row in every])
    print(
        f"{built} builds, {len(every)} searches: trf gains more than {DECISIVE} from {np.sum(gain > DECISIVE)} ends, "
        f"{np.sum(left > LARGEST_FALL_LEFT)} of which count as stuck; from the start trf ends higher in "
        f"{np.sum(beside > DECISIVE)}, lower in {np.sum(beside < -DECISIVE)}; "
        f"{sum(r.seconds for r in every):.0f} s, trf {sum(r.trf_seconds for r in every):.0f} s"
    )


if __name__ == "__main__":
    main(int(sys.argv[1]), sys.argv[2:])
