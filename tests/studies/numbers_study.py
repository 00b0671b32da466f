"""Which numbers of judgement move a figure? Each is changed by a fifth, up and down, and the figures are compared.

``python tests/studies/numbers_study.py [--projects TYRE.toml ...] [--rooms mffit.points ...] [--out FILE]`` builds each project
(two samples if none is given), diagnoses its points against the base.tir in its folder, and plans further runs, with every
number of judgement changed. ``--commands`` keeps to some of the three. Numbers are changed several at a time; a set that moves a
figure is halved until the one that moved it is alone. Prints for every number the largest change of a figure, in standard errors
of the figure where it has one, otherwise relative; and "says" where a sentence, a verdict or a choice changes. ``--out`` goes on
where it ended. A number that moves nothing is deleted, merged, or names what it is needed for.
"""

from __future__ import annotations

import ast
import io
import json
import os
import re
import subprocess
import sys
import tempfile
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import redirect_stderr, redirect_stdout
from pathlib import Path
from typing import NamedTuple

ROOT = Path(__file__).parents[2]
PROJECTS = [ROOT / "samples" / name / "tyre.toml" for name in ("front-120-70", "flat-track")]
MODEL = "base.tir"
"""In the folder of a project, the tyre that a diagnosis starts from."""
COMMANDS = ("build", "diagnose", "plan")
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


def numbers(rooms: Sequence[str]) -> Iterator[Number]:
    """All of them, in the order of their modules."""
    for path in sorted([*ROOT.glob("tir/**/constants.py"), *ROOT.glob("mffit/**/constants.py")]):
        module = ".".join(path.relative_to(ROOT).with_suffix("").parts)
        for line in (
            ast.parse(path.read_text(encoding="utf-8")).body if module.startswith(tuple(rooms)) else ()
        ):
            if isinstance(line, ast.Assign) and isinstance(line.targets[0], ast.Name):
                yield Number(module, line.targets[0].id, line.lineno, line.end_lineno or 0)


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
    from mffit.cli import main as mffit

    found: dict[str, object] = {}
    for project in projects:
        given = {"build": ["--no-report"], "diagnose": ["--model", str(project.with_name(MODEL))], "plan": []}
        for command in commands:
            said, failed, name = io.StringIO(), io.StringIO(), f"{command} {project.parent.name}"
            with tempfile.TemporaryDirectory() as out, redirect_stdout(said), redirect_stderr(failed):
                code = mffit([command, str(project), *given[command], "--json", "--out", f"{out}/out"])
            found |= flat(failed.getvalue() if code == 2 else json.loads(said.getvalue()), name)
    return {key: value for key, value in found.items() if not {"made", "seconds"} & {*key.split(".")}}


def flat(content: object, prefix: str) -> dict[str, object]:
    """Nested dictionaries and lists as one."""
    if not isinstance(content, dict | list):
        return {prefix: content}
    inner = content.items() if isinstance(content, dict) else enumerate(content)
    return {k: v for key, value in inner for k, v in flat(value, f"{prefix}.{key}").items()}


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
            says = says or (key if _worded(a) != _worded(b) else "")
        elif isinstance(a, float | int) and isinstance(b, float | int):
            largest = max(abs(a), abs(b))
            by = abs(a - b) / (unit_of(key, before) or max(largest, 1e-12))
            if abs(a - b) > UNCHANGED * max(largest, 1e-9) and by > max(size, UNCHANGED):
                size, where = by, key
    return Moved(size, where, says)


def _worded(text: object) -> object:
    """A sentence without its digits."""
    return re.sub(r"[\d.-]", "", text) if isinstance(text, str) else text


def unit_of(key: str, content: Figures) -> float | None:
    """The standard error that is stated with a value."""
    stem, _, last = key.rpartition(".")
    for name in ("stderr", f"u_{last}", f"{last}_u", "u"):
        error = content.get(f"{stem}.{name}")
        of_it = last in ("value", "expected") or name != "stderr"
        if of_it and isinstance(error, float) and error > 0.0:
            return error
    return None


def run(
    wanted: Sequence[Number], factor: float, projects: Sequence[Path], commands: Sequence[str]
) -> Figures:
    """The figures with some numbers changed, in a process of its own."""
    asked = [wanted, factor, [str(path) for path in projects], commands]
    done = subprocess.run(
        [sys.executable, __file__, "--one"],
        input=json.dumps(asked), capture_output=True, text=True, check=False,
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
    import harness  # not before numbers are changed: it imports the package

    ask = harness.arguments(
        __doc__,
        projects=PROJECTS,
        rooms=[""],
        commands=list(COMMANDS),
        together=16,
        factors=[1.2, 1 / 1.2],
        out=Path,
    )
    given = ask.parse_args()
    before = run([], 1.0, given.projects, given.commands)
    if "fails" in before:
        sys.exit(f"without a change: {before['fails']}")
    known = given.out.read_text(encoding="utf-8") if given.out and given.out.exists() else ""
    write = given.out.open("a", encoding="utf-8") if given.out else sys.stdout
    for factor in given.factors:
        every = [one for one in numbers(given.rooms) if f"x{factor:.3g}  {one!s} " not in known]
        for begin in range(0, len(every), given.together):
            again = lambda some, by=factor: run(some, by, given.projects, given.commands)  # noqa: E731
            for number, found in search(every[begin : begin + given.together], again, before):
                print(f"x{factor:.3g}  {number!s:70s} {found}", file=write, flush=True)


if __name__ == "__main__":
    if sys.argv[1:] == ["--one"]:
        wanted, factor, projects, commands = json.load(sys.stdin)
        change([Number(*one) for one in wanted], factor)
        print(json.dumps(figures([Path(p) for p in projects], commands), default=str))
    else:
        main()
