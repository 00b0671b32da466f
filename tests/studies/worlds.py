"""The loop of studies that draw rigs in several worlds: arguments, processes, and the printed lines of each world."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable, Iterable, Sequence
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path
from typing import Any

sys.path.insert(0, str(Path(__file__).parents[1] / "mffit" / "fit"))  # drawn_rigs, for all these studies


def asked(rigs: int, worlds: Iterable[Any]) -> argparse.ArgumentParser:
    """The arguments; ``rigs`` per world are drawn by default."""
    names = list(worlds)
    ask = argparse.ArgumentParser()
    ask.add_argument("rigs", type=int, nargs="?", default=rigs, help="per world")
    ask.add_argument("--first", type=int, default=0, help="seed of the first rig")
    ask.add_argument("--jobs", type=int, default=1, help="processes")
    ask.add_argument("--worlds", nargs="*", type=type(names[0]), default=names)
    return ask


def run(
    one: Callable[[Any], Any], lines: Callable[[Any, list[Any]], Sequence[str]], ask: argparse.ArgumentParser
) -> None:
    """Call ``one((seed, world, arguments))`` for every rig, and print ``lines(world, rows)`` of each world."""
    given = ask.parse_args()
    seeds = range(given.first, given.first + given.rigs)
    with ProcessPoolExecutor(given.jobs) as pool:
        found = {world: pool.map(one, [(seed, world, given) for seed in seeds]) for world in given.worlds}
        for world, rows in found.items():
            print("\n".join(lines(world, list(rows))), flush=True)
