"""What is named, how surely, and is the model better afterwards? ``python tests/studies/names_study.py outside --count 5``.

``outside``: causes that the library lacks; ``library``: single causes that it has, three to ten times their detection limit;
``faint``: the same at one to three times; ``mixed``: one cause of either kind. A line per set, then a table.
All readings come from ``own_rig``.
"""

from __future__ import annotations

import argparse
import json
import sys
import tempfile
import time
from collections.abc import Iterator
from dataclasses import asdict, dataclass, replace
from pathlib import Path

import numpy as np
from own_rig import LIBRARY, OUTSIDE, U_FY, U_MZ, Run, Set, library_set, mixed_set, outside_set, write

from mffit import pipeline
from mffit.diagnosis import Diagnosis
from mffit.rig import Simulation


@dataclass(frozen=True)
class Score:
    """The diagnosis of one set against what is hidden in it."""

    name: str
    cause: str
    part: tuple[str, ...]  #: ids that count as right
    times_limit: float
    named: tuple[str, ...]
    ties: tuple[tuple[str, ...], ...]
    confidence: tuple[float, ...]
    repaired: tuple[str, ...]
    unexplained: bool
    held_out: tuple[
        float, float, float
    ]  #: chi2 per value of left-out sweeps: before, after, property file alone
    truth: tuple[
        float, float, float
    ]  #: misfit of noise-free readings in units of noise, between the settings: the same
    file_changed: bool
    file_from_tyre: (
        float  #: rms distance of the property file from the true tyre, in units of noise; given: 0
    )
    seconds: float

    @property
    def right(self) -> bool:
        """Whether the first name is right, or tied with what is right."""
        return bool(self.named) and bool({self.named[0], *self.ties[0]} & set(self.part))

    @property
    def false_names(self) -> list[float]:
        """Confidences of the names that are neither right nor tied with what is right."""
        rows = zip(self.named, self.ties, self.confidence, strict=True)
        return [c for n, t, c in rows if not {n, *t} & set(self.part)]

    @property
    def worse(self) -> bool:
        """Whether the repaired model or the file predicts worse than the given one, held out or against the truth."""
        files = (self.held_out[2], self.truth[2]) if self.file_changed else (0.0, 0.0)
        return (
            max(self.held_out[1], files[0]) > 1.001 * self.held_out[0]
            or max(self.truth[1], files[1]) > 1.001 * self.truth[0] + 1e-3
        )

    def line(self) -> str:
        named = ", ".join(
            f"{n}{list(t) if t else ''} {c:.2f}{'' if n in self.repaired else ' (not repaired)'}"
            for n, t, c in zip(self.named, self.ties, self.confidence, strict=True)
        )
        gap = " -> ".join(f"{x:.2f}" for x in self.truth)
        said = " unexplained" if self.unexplained else ""
        mark = " WORSE" if self.worse else ""
        return (
            f"{self.name:44s} x{self.times_limit:<7.3g} {named or 'none'}{said}  truth {gap}  "
            f"held out {'/'.join(f'{x:.2f}' for x in self.held_out)}  file off {self.file_from_tyre:.2f}{mark}  "
            f"{self.seconds:.1f} s"
        )


def scored(drawn: Set) -> Score:
    """The score of a diagnosis from files, as a user would make it."""
    with tempfile.TemporaryDirectory() as scratch:
        write(drawn, Path(scratch))
        began = time.process_time()
        found = pipeline.diagnose(Path(scratch) / "tyre.toml", Path(scratch) / "given.tir")
        seconds = time.process_time() - began
    check = found.validation
    return Score(
        name=drawn.name,
        cause=drawn.cause,
        part=drawn.part,
        times_limit=drawn.times_limit,
        named=tuple(one.effect.id for one in found.effects),
        ties=tuple(one.tied_with for one in found.effects),
        confidence=tuple(one.confidence for one in found.effects),
        repaired=tuple(one.effect.id for one in found.repaired),
        unexplained=found.unexplained,
        held_out=tuple(g.chi2_per_dof for g in (check.gap_before, check.gap_after, check.gap_given_file)),
        truth=_from_truth(drawn, found),
        file_changed=found.tyre is not drawn.given and dict(found.tyre.values) != dict(drawn.given.values),
        file_from_tyre=_misfit(drawn, found, found.tyre, true_tyre=True),
        seconds=seconds,
    )


def _between(drawn: Set, found: Diagnosis):
    """The settings moved by a quarter of a degree of sideslip and a tenth of the camber, in the order of the points."""
    run = drawn.run
    lines = {name: np.flatnonzero(run.file == name) for name in set(run.file.tolist())}
    points = found.points
    order = np.concatenate(
        [lines[points.sweep_names[k].removesuffix(".csv")] for k in dict.fromkeys(points.sweep.tolist())]
    )
    moved = Run(**{name: values[order] for name, values in vars(run).items()})
    moved = replace(moved, alpha=moved.alpha + 0.25 * (np.abs(moved.alpha) < 7.5), gamma=0.93 * moved.gamma)
    return moved, points.replace(alpha=np.radians(moved.alpha), gamma=np.radians(moved.gamma))


def _misfit(drawn: Set, found: Diagnosis, tyre, *, true_tyre: bool) -> float:
    """Distance of a property file alone from noise-free readings, or from the true tyre, in units of noise."""
    run, points = _between(drawn, found)
    target = replace(drawn, numbers={}, outside=None) if true_tyre else drawn
    out = Simulation.of(tyre, turn_slip=True).readings(points)
    return _rms(target.noise_free(run), (out.Fy, out.Mz))


def _from_truth(drawn: Set, found: Diagnosis) -> tuple[float, float, float]:
    run, points = _between(drawn, found)
    after = np.split(found.state.predict(points), 2)
    return (
        _misfit(drawn, found, drawn.given, true_tyre=False),
        _rms(drawn.noise_free(run), after),
        _misfit(drawn, found, found.tyre, true_tyre=False),
    )


def _rms(truth, model) -> float:
    return float(
        np.sqrt(np.mean([((t - m) / u) ** 2 for t, m, u in zip(truth, model, (U_FY, U_MZ), strict=True)]))
    )


def sets(kind: str, count: int, seed: int) -> Iterator[Set]:
    """The drawn sets of one kind, ``count`` of every cause."""
    if kind == "outside":
        for k in range(count):
            for cause in OUTSIDE:
                yield outside_set(cause, seed + k)
    elif kind == "library":
        for k in range(count):
            for cause in LIBRARY:
                if cause != "camber-misalignment":
                    yield library_set(cause, seed + k)
    elif kind == "mixed":
        single = [cause for cause, number in LIBRARY.items() if not number.endswith("@")]
        for k in range(count):
            for j, cause in enumerate(single):
                yield mixed_set(cause, list(OUTSIDE)[(j + 3 * k) % len(OUTSIDE)], seed + k)
    else:
        for k in range(count):
            for cause in LIBRARY:
                yield library_set(cause, seed + k, 1.0, 3.0)


def print_table(scores: list[Score]) -> None:
    """A row per cause."""
    print(
        "\ncause | sets | right first or tied | false names | above 50 % | above 80 % | unexplained | worse"
    )
    for cause in dict.fromkeys(s.cause for s in scores):
        own = [s for s in scores if s.cause == cause]
        print(_row(cause, own))
    print(_row("all", scores))
    print(
        f"seconds: median {np.median([s.seconds for s in scores]):.1f}, most {max(s.seconds for s in scores):.1f}"
    )


def _row(word: str, own: list[Score]) -> str:
    false = [c for s in own for c in s.false_names]
    cells = (
        word, len(own), sum(s.right for s in own), len(false), sum(c > 0.5 for c in false), sum(c > 0.8 for c in false),
        sum(s.unexplained for s in own), sum(s.worse for s in own),
    )  # fmt: skip
    return " | ".join(map(str, cells))


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("kind", choices=("outside", "library", "faint", "mixed"))
    parser.add_argument("--count", type=int, default=5, help="sets of every cause")
    parser.add_argument("--seed", type=int, default=100)
    parser.add_argument("--only", default="", help="only sets whose name contains this")
    parser.add_argument("--keep", type=Path, help="file to which every score is appended as a line of JSON")
    options = parser.parse_args()
    scores = []
    for drawn in sets(options.kind, options.count, options.seed):
        if options.only not in drawn.name:
            continue
        scores.append(scored(drawn))
        print(scores[-1].line(), flush=True)
        if options.keep:
            with options.keep.open("a", encoding="utf-8") as out:
                out.write(json.dumps(asdict(scores[-1])) + "\n")
    print_table(scores)


if __name__ == "__main__":
    sys.exit(main())
