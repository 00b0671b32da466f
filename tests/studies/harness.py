"""Command line, processes, kept rows and tables of all studies.

A study declares its worlds, ``one(job)`` that draws and judges one campaign, and ``page(world, rows)`` that says what was found;
:func:`study` does the rest. Importing this module makes the tests' own rigs importable by their names.
"""

from __future__ import annotations

import argparse
import os
import pickle
import sys
from collections import Counter
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor
from fnmatch import fnmatch
from itertools import groupby
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

ROOT = Path(__file__).parents[2]
SAMPLES = ROOT / "samples"
sys.path[:0] = [str(ROOT), *(str(ROOT / "tests/mffit" / room) for room in ("", "fit", "diagnosis"))]

from drawn_rigs import SAFE, Draw  # noqa: E402

import mffit  # noqa: E402
from mffit.errors import InputError  # noqa: E402
from mffit.scatter import rms  # noqa: E402

Page = Callable[[Any, list[Any]], Iterable[str]]


class Job(NamedTuple):
    """One draw of one world, and the arguments of the study."""

    seed: Any
    world: Any
    given: argparse.Namespace


def arguments(says: str | None, draws: int | None = None, **options: Any) -> argparse.ArgumentParser:
    """The command line: ``draws`` by default, and an option per keyword, whose value is its default.

    ``False`` makes a flag, a type an option without default, a list one with several values of the type of its first.
    """
    ask = argparse.ArgumentParser(description=says, formatter_class=argparse.RawDescriptionHelpFormatter)
    if draws is not None:
        ask.add_argument("draws", type=int, nargs="?", default=draws)
    for name, value in options.items():
        key = "--" + name.replace("_", "-")
        if value is False:
            ask.add_argument(key, action="store_true")
        elif isinstance(value, list):
            ask.add_argument(key, nargs="*", type=type(value[0]), default=value)
        else:
            kind, default = (value, None) if isinstance(value, type) else (type(value), value)
            ask.add_argument(key, type=kind, default=default)
    return ask


def study(
    one: Callable[[Job], Any],
    page: Page,
    *,
    worlds: Iterable[Any] = ("",),
    draws: int | None = 1,
    seeds: Callable[[Any, argparse.Namespace], Iterable[Any]] | None = None,
    in_turn: bool = False,
    last: Callable[[Mapping[Any, list[Any]]], Iterable[str]] = lambda found: (),
    **options: Any,
) -> None:
    """Call ``one`` for every draw of every world and print the page of each world.

    Parameters
    ----------
    one : row of a :class:`Job`, in a process of its own; a row with ``line()`` is printed at once
    page : lines of a world
    worlds : their names; ``--worlds`` chooses some, by patterns
    draws : of each world by default, the first with seed ``--first``
    seeds : the seeds of a world, where they are not consecutive numbers
    in_turn : draw the worlds in turn, one per seed; ``page(None, rows)`` then gets the rows of all, by world
    last : lines at the end, of the rows of all worlds
    options : of the command line, see :func:`arguments`

    ``--keep`` adds all rows to a file, and ``--kept`` prints the pages of such files.
    """
    found: dict[Any, list[Any]]
    names = list(worlds)
    says = sys.modules[one.__module__].__doc__
    common = {"first": 0, "jobs": 1, "worlds": names, "keep": Path, "kept": [Path("rows")]}
    ask = arguments(says, draws, **common | options)
    ask.set_defaults(kept=[], **{name: [] for name, value in options.items() if value == [""]})
    given = ask.parse_args()
    given.worlds = [name for name in names if any(fnmatch(str(name), str(asked)) for asked in given.worlds)]
    os.environ |= dict.fromkeys(("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS"), "1")
    if given.kept:
        found = _read(given.kept)
        _print(page, found, together=in_turn)
        print(*last(found), sep="\n")
        return
    jobs, found = _jobs(given, seeds, in_turn), {}
    with ProcessPoolExecutor(given.jobs) as pool:
        pairs = zip(jobs, pool.map(one, jobs), strict=True)
        for world, of_world in groupby(pairs, key=lambda pair: pair[0].world):
            for _, row in of_world:
                found.setdefault(world, []).append(row)
                _note(row, world, given.keep)
            if not in_turn:
                _print(page, {world: found[world]})
    if in_turn:
        _print(page, found, together=True)
    print(*last(found), sep="\n")


def _note(row: Any, world: Any, keep: Path | None) -> None:
    if hasattr(row, "line"):
        print(row.line(), file=sys.stderr, flush=True)
    if keep:
        with keep.open("ab") as out:
            pickle.dump((world, row), out)


def _jobs(given: argparse.Namespace, seeds: Any, in_turn: bool) -> list[Job]:
    def of(world: Any) -> Iterable[Any]:
        return seeds(world, given) if seeds else range(given.first, given.first + given.draws)

    if in_turn:
        return [Job(seed, given.worlds[seed % len(given.worlds)], given) for seed in of(None)]
    return [Job(seed, world, given) for world in given.worlds for seed in of(world)]


def _read(files: Iterable[Path]) -> dict[Any, list[Any]]:
    found: dict[Any, list[Any]] = {}
    for file in files:
        with file.open("rb") as kept:
            while kept.peek(1):
                world, row = pickle.load(kept)
                found.setdefault(world, []).append(row)
    return found


def _print(page: Page, found: Mapping[Any, list[Any]], *, together: bool = False) -> None:
    for world, rows in {None: found}.items() if together else found.items():
        print("\n".join(page(world, rows)), flush=True)


def built(path: Path, **how: Any) -> Any:
    """The build of a project, or the sentence of its refusal."""
    try:
        return mffit.build(path, with_report=False, **how)
    except InputError as error:
        return str(error)


def table(head: Sequence[str], rows: Iterable[Sequence[object]], title: str = "") -> Iterator[str]:
    """Lines of a table, none without rows."""
    rows = list(rows)
    if not rows:
        return
    yield f"\n## {title}\n" if title else ""
    yield f"| {' | '.join(head)} |"
    yield "|---" * len(head) + "|"
    yield from (f"| {' | '.join(map(str, row))} |" for row in rows)


def percent(hits: Collection[Any]) -> str:
    """Share of what is true, in percent."""
    return f"{np.mean([bool(hit) for hit in hits]):.0%}" if len(hits) else "-"


def counted(words: Iterable[str], most: int = 5) -> Iterator[str]:
    """The most frequent sentences, each with how often it occurs."""
    return (f"  {times}x {text}" for text, times in Counter(words).most_common(most))


def median(values: Collection[float]) -> float:
    """Median, NaN of nothing."""
    return float(np.median(list(values))) if len(values) else float("nan")


def shares(error: Any, u: Any) -> tuple[float, float, float]:
    """Share of errors (n,) inside 95 %, rms half width, rms error."""
    error, u = np.asarray(error), np.asarray(u)
    return float(np.mean(np.abs(error) < SAFE * u)), SAFE * rms(u), rms(error)


def sound(draws: Iterable[Draw]) -> tuple[list[Draw], list[str]]:
    """The draws that were built, and the refusals of the others as lines."""
    draws = list(draws)
    return [d for d in draws if not d.refused], [f"* refused: {d.refused}" for d in draws if d.refused]


def by_group(
    groups: Mapping[Any, Sequence[Any]],
    columns: Mapping[str, Callable[[Any], object]],
    title: str = "",
    first: str = "campaign",
) -> Iterator[str]:
    """Table with a row per group of draws, and a column per function of such a group."""
    rows = ((name, len(of), *(cell(of) for cell in columns.values())) for name, of in groups.items() if of)
    return table((first, "builds", *columns), rows, title)


def spread(values: Iterable[float]) -> str:
    """Median and range."""
    x = np.array(list(values))
    return f"{np.median(x):.2f} ({x.min():.2f}-{x.max():.2f})"


def largest(values: Iterable[float]) -> str:
    """Rms and largest size."""
    x = np.array(list(values))
    return f"{rms(x):.3g} ({np.max(np.abs(x)):.3g})"


def misfits(groups: Mapping[str, Sequence[Draw]]) -> Iterator[str]:
    """Table of misfits over stated noise, by group of draws."""
    channels = next(iter(groups.values()))[0].misfit
    columns: dict[str, Callable[[Any], object]] = {
        f"{c} median (range)": lambda of, c=c: spread(d.misfit[c] for d in of) for c in channels
    }
    for limit in (1.05, 1.3):
        columns[f"above {limit}"] = lambda of, limit=limit: sum(max(d.misfit.values()) > limit for d in of)
    columns["fit [s]"] = lambda of: f"{median([d.seconds for d in of]):.2f}"
    return by_group(groups, columns, "Misfit over stated noise")


def coverage(draws: Sequence[Draw], least: float = 0.0, title: str = "") -> Iterator[str]:
    """Table of all numbers noted in the draws; those of a smaller share of draws than ``least`` are left out.

    Coefficients come first, then those that the priors decide, then the numbers of the rig.
    """
    names = dict.fromkeys(name for d in draws for name in d.pulls)
    groups = {
        name: [(d.pulls[name], d.stderr[name], d.inside[name]) for d in draws if name in d.pulls]
        for name in sorted(names, key=lambda name: (name.startswith("rig."), "(" in name))
    }
    groups = {name: of for name, of in groups.items() if len(of) >= least * len(draws)}
    arrays = {name: tuple(np.array(x) for x in zip(*of, strict=True)) for name, of in groups.items()}
    rows = [
        (
            name, len(u), percent(inside), f"{rms(pull * u):.3g}", f"{np.mean(u):.3g}", f"{rms(u) / rms(pull * u):.2f}",
            f"{np.mean(pull):+.2f}", f"{np.std(pull):.2f}",
        )
        for name, (pull, u, inside) in arrays.items()
    ]  # fmt: skip
    head = ("quantity", "builds", "inside 95 %", "rms error", "mean u", "rms u over rms error", "mean pull")
    return table((*head, "sd of pull"), rows, title)
