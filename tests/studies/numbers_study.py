"""Which numbers of judgement move a figure? Each is changed by a fifth, up and down, and the figures are compared.

``python tests/studies/numbers_study.py [PROJECT ...] [--rooms mffit.points ...] [--out FILE]`` builds each project
(its tyre.toml; two samples if none is given), diagnoses its points against the base.tir in its folder, and plans further runs,
with every number of judgement changed. ``--commands`` keeps to some of the three. Numbers are changed several at a time; a set
that moves a figure is halved until the one that moved it is alone. Prints for every number the largest change of a figure, in
standard errors of the figure where it has one, otherwise relative; and "says" where a sentence, a verdict or a choice changes.
A number that moves nothing is deleted, merged, or names what it is needed for.
"""

from __future__ import annotations

import argparse
import ast
import json
import os
import subprocess
import sys
from collections.abc import Callable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import NamedTuple

ROOT = Path(__file__).parents[2]
SAMPLES = [ROOT / "samples" / name / "tyre.toml" for name in ("front-120-70", "flat-track")]
MODEL = "base.tir"
"""In the folder of a project, the tyre that a diagnosis starts from."""
COMMANDS = ("build", "diagnose", "plan")
FACTORS = (1.2, 1 / 1.2)
UNCHANGED = 1e-6  # relative: what the order of sums changes
Figures = Mapping[str, object]


class Number(NamedTuple):
    """A number of judgement, and the lines of its definition."""

    module: str
    name: str
    first: int
    last: int

    def __str__(self) -> str:
        return f"{self.module}.{self.name}"


def numbers(rooms: Sequence[str]) -> list[Number]:
    """All of them, in the order of their modules."""
    found = []
    for path in sorted([*ROOT.glob("tir/**/constants.py"), *ROOT.glob("mffit/**/constants.py")]):
        module = ".".join(path.relative_to(ROOT).with_suffix("").parts)
        if rooms and not any(module.startswith(room) for room in rooms):
            continue
        for statement in ast.parse(path.read_text(encoding="utf-8")).body:
            if isinstance(statement, ast.Assign) and isinstance(statement.targets[0], ast.Name):
                found.append(
                    Number(module, statement.targets[0].id, statement.lineno, statement.end_lineno or 0)
                )
    return found


def change(wanted: Sequence[Number], factor: float) -> None:
    """Change numbers where they are made; before anything else of the package is imported."""
    from tir import constant

    def changed(made: Callable[..., object]) -> Callable[..., object]:
        def new(kind: type, value: object, *rest: object, **named: object) -> object:
            frame = sys._getframe(1)
            module, line = frame.f_globals["__name__"], frame.f_lineno
            if any(one.module == module and one.first <= line <= one.last for one in wanted):
                value = other(value, factor)
            return made(kind, value, *rest, **named)

        return new

    for kind in (constant.Real, constant.Count, constant.Series):
        kind.__new__ = changed(kind.__new__)  # type: ignore[method-assign, assignment]


def other(value: object, factor: float) -> object:
    """A value, a whole one by at least 1 and at least 1; a probability stays one."""
    if isinstance(value, int):
        step = max(1, round(abs(value) * abs(factor - 1.0)))
        return max(1, value + (step if factor > 1.0 else -step))
    if isinstance(value, float):
        beyond = value * factor
        return 1.0 - (1.0 - value) / factor if 0.5 < value < 1.0 <= beyond else beyond
    return tuple(other(each, factor) for each in value)  # type: ignore[attr-defined]


def figures(projects: Sequence[Path], commands: Sequence[str]) -> dict[str, object]:
    """What the commands say of the projects, by command and key; the sentence of a failure in its place."""
    import mffit
    from mffit.as_json import plain
    from mffit.pipeline.planning import plan_of

    found: dict[str, object] = {}
    for project in projects:
        name = project.parent.name
        try:
            if "build" in commands or "plan" in commands:
                built = mffit.build(project, with_report=False)
                found |= flat(plain(built), f"build {name}")
            if "diagnose" in commands:
                model = project.with_name(MODEL)
                found |= flat(plain(mffit.diagnose(project, model)), f"diagnose {name}")
            if "plan" in commands:
                found |= flat(plain(plan_of(built)), f"plan {name}")
        except Exception as error:  # any failure is a figure that moved
            found[f"{name} fails"] = f"{type(error).__name__}: {error}"
    return {key: value for key, value in found.items() if not {"made", "seconds"} & {*key.split(".")}}


def flat(content: object, prefix: str) -> dict[str, object]:
    """Nested dictionaries and lists as one."""
    if isinstance(content, dict):
        return {k: v for key, value in content.items() for k, v in flat(value, f"{prefix}.{key}").items()}
    if isinstance(content, list):
        return {k: v for i, value in enumerate(content) for k, v in flat(value, f"{prefix}.{i}").items()}
    return {prefix: content}


class Moved(NamedTuple):
    """By how much figures differ."""

    size: float  #: the largest change of a number
    where: str  #: its key
    says: str  #: a key whose text or choice differs, or that is there only once

    def __str__(self) -> str:
        if not self.size and not self.says:
            return "nothing"
        return f"{self.size:8.2g}  {self.where}" + (f"; says {self.says}" if self.says else "")


def moved(before: Figures, after: Figures) -> Moved:
    """The largest difference between two sets of figures."""
    size, where = 0.0, ""
    says = next(iter(sorted(set(before) ^ set(after))), "")
    for key in before.keys() & after.keys():
        a, b = before[key], after[key]
        if isinstance(a, bool | str | None) or isinstance(b, bool | str | None):
            if a != b and not similar(a, b):
                says = says or key
        elif isinstance(a, float | int) and isinstance(b, float | int):
            scale = unit_of(key, before) or max(abs(a), abs(b), 1e-12)
            if abs(a - b) > UNCHANGED * max(abs(a), abs(b), 1e-9) and abs(a - b) / scale > max(
                size, UNCHANGED
            ):
                size, where = abs(a - b) / scale, key
    return Moved(size, where, says)


def similar(a: object, b: object) -> bool:
    """Sentences that differ in their digits only."""
    if not (isinstance(a, str) and isinstance(b, str)):
        return False
    plain_a, plain_b = ("".join(c for c in text if not c.isdigit() and c not in ".-") for text in (a, b))
    return plain_a == plain_b


def unit_of(key: str, content: Figures) -> float | None:
    """The standard error that stands with a value."""
    stem, _, last = key.rpartition(".")
    for name in ("stderr", f"u_{last}", f"{last}_u", "u"):
        error = content.get(f"{stem}.{name}")
        of_it = last in ("value", "expected") or name != "stderr"
        if of_it and isinstance(error, float) and error > 0.0:
            return error
    return None


def run(
    wanted: Sequence[Number], factor: float, projects: Sequence[str], commands: Sequence[str]
) -> dict[str, object]:
    """The figures with some numbers changed, in a process of its own."""
    given = json.dumps({"numbers": wanted, "factor": factor, "projects": projects, "commands": commands})
    done = subprocess.run(
        [sys.executable, __file__, "--one"],
        input=given, capture_output=True, text=True, check=False,
        env={**os.environ, "PYTHONPATH": str(ROOT), "OPENBLAS_NUM_THREADS": "1"},
    )  # fmt: skip
    if done.returncode:
        return {"fails": done.stderr.strip().splitlines()[-1] if done.stderr.strip() else "without a word"}
    return dict(json.loads(done.stdout.splitlines()[-1]))


def search(
    group: Sequence[Number], again: Callable[[Sequence[Number]], Figures], before: Figures
) -> Iterator[tuple[Number, Moved]]:
    """What each number of a group moves; a group that moves nothing is asked once."""
    found = moved(before, again(group))
    if len(group) == 1 or (not found.size and not found.says):
        yield from ((number, found) for number in group)
        return
    middle = len(group) // 2
    yield from search(group[:middle], again, before)
    yield from search(group[middle:], again, before)


def main() -> None:
    """Print what every number moves."""
    ask = argparse.ArgumentParser()
    ask.add_argument("projects", nargs="*", default=[str(path) for path in SAMPLES])
    ask.add_argument("--rooms", nargs="*", default=[], help="modules whose numbers are changed")
    ask.add_argument("--commands", nargs="*", default=COMMANDS, choices=COMMANDS)
    ask.add_argument("--together", type=int, default=16, help="numbers changed at a time")
    ask.add_argument("--factors", type=float, nargs="*", default=FACTORS)
    ask.add_argument(
        "--out", type=Path, help="file to which the lines go as they are found; goes on where it ended"
    )
    ask.add_argument("--one", action="store_true", help=argparse.SUPPRESS)
    given = ask.parse_args()
    if given.one:
        asked = json.loads(sys.stdin.read())
        change([Number(*one) for one in asked["numbers"]], asked["factor"])
        print(json.dumps(figures([Path(p) for p in asked["projects"]], asked["commands"]), default=str))
        return
    before = run([], 1.0, given.projects, given.commands)
    if "fails" in before:
        sys.exit(f"without a change: {before['fails']}")
    known = given.out.read_text(encoding="utf-8") if given.out and given.out.exists() else ""
    write = given.out.open("a", encoding="utf-8") if given.out else sys.stdout
    for factor in given.factors:
        every = [one for one in numbers(given.rooms) if f"x{factor:.3g}  {one!s} " not in known]
        for begin in range(0, len(every), given.together):
            group = every[begin : begin + given.together]
            for number, found in search(
                group, lambda some, by=factor: run(some, by, given.projects, given.commands), before
            ):
                print(f"x{factor:.3g}  {number!s:70s} {found}", file=write, flush=True)


if __name__ == "__main__":
    main()
