"""Do the tests notice errors? Small wrong changes to the code, one at a time, and those that no test detects.

`python tests/studies/mutation_study.py 150 --seed 1` draws 150 changes, runs the tests of the changed room on each in a copy
of the tree, and prints the survivors and their share. `--rooms mffit/planning mffit/results --each` draws that many from each
of these rooms; `--modules fit/drift` keeps to modules whose path contains it, `--quick` to the tests of their room; `--out` keeps
the survivors of an interrupted run. Needs cosmic-ray, which makes the changes: swapped operators and comparisons, numbers one
larger or smaller, dropped signs and ``not``, swapped ``and``/``or``, True/False, loops that never run. Left out because they make
no difference: ``<`` for ``<=`` of measured numbers, and ``strict`` of ``zip``.
"""

from __future__ import annotations

import ast
import difflib
import os
import random
import shutil
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import count, islice
from pathlib import Path

import harness
from harness import ROOT

SWAPPED = {
    "BinaryOperator": "Add_Sub Sub_Add Mul_Div Div_Mul Pow_Mul BitAnd_BitOr BitOr_BitAnd FloorDiv_Mul Mod_Mul",
    "ComparisonOperator": "Lt_Gt Gt_Lt LtE_GtE GtE_LtE Eq_NotEq NotEq_Eq Is_IsNot IsNot_Is",
    "": "UnaryOperator_Delete_USub UnaryOperator_Delete_Not UnaryOperator_Delete_Invert TrueWithFalse FalseWithTrue "
    "AndWithOr OrWithAnd BreakWithContinue ContinueWithBreak",
}
OPERATORS = (
    *(f"core/Replace{kind}{'_' * bool(kind)}{pair}" for kind, pairs in SWAPPED.items() for pair in pairs.split()),
    "core/NumberReplacer", "core/ZeroIterationForLoop", "core/AddNot",
)  # fmt: skip
GENERAL = [f"tests/mffit/test_{name}.py" for name in ("pipeline", "command_line", "many")]
LONGEST_BASELINE = 3600.0  # s
STAMPS = count(1_000_000_000)
"""A new modification time for every written module: equal times would let Python use the compiled code of the last one."""


@dataclass(frozen=True)
class Mutant:
    """A room with one changed module, or without a change."""

    room: str
    module: str = ""
    operator: str = ""
    original: str = ""
    code: str = ""

    @property
    def change(self) -> str:
        """The lines before and after."""
        lines = difflib.unified_diff(self.original.splitlines(), self.code.splitlines(), lineterm="", n=0)
        return "\n".join(line.rstrip() for line in lines if not line.startswith(("---", "+++")))


@dataclass(frozen=True)
class Outcome:
    """Verdict of the tests on a mutant."""

    mutant: Mutant
    killed_by: str  #: first failing test, "timeout", or "" for a survivor
    seconds: float

    def line(self) -> str:
        m = self.mutant
        end = self.killed_by[:100] or ("SURVIVES\n" + m.change if m.module else "passes unchanged")
        return f"{self.seconds:5.0f} s {m.module or m.room} {m.operator} {end}"


def rooms() -> list[str]:
    """Folders of the packages, each without those inside it that are listed too."""
    inner = sorted({path.parent for path in (ROOT / "mffit").glob("*/*.py")})
    return ["tir", "mffit", *(str(folder.relative_to(ROOT)) for folder in inner)]


def modules(room: str) -> list[Path]:
    """The modules of a room, without its numbers of judgement."""
    found = (ROOT / room).glob("*.py") if room == "mffit" else (ROOT / room).rglob("*.py")
    return sorted(module for module in found if module.name != "constants.py")


def tests_of(room: str, quick: bool) -> list[str]:
    """The files of tests that should detect a change: those of the room, those that name it, and those of whole commands.

    ``quick``: those of the room only.
    """
    package, _, name = room.partition("/")
    files = sorted(path.relative_to(ROOT) for path in (ROOT / "tests").rglob("test_*.py"))
    own = [f for f in files if f.parts[1:-1] == tuple(part for part in (package, name) if part)]
    words = (f"mffit.{name}.", f"mffit.{name} import", f"from mffit import {name}\n")
    named = [
        f for f in files if name and any(word in (ROOT / f).read_text(encoding="utf-8") for word in words)
    ]
    beyond = [*map(str, named), *(GENERAL if package == "mffit" else ())]
    return list(dict.fromkeys([*map(str, own), *(() if quick and own else beyond)]))


def places(room: str, part: str) -> Iterator[tuple[str, Path, str, int]]:
    """Room, module, operator and occurrence of every possible change."""
    from cosmic_ray.ast import ast_nodes, get_ast
    from cosmic_ray.plugins import get_operator

    for module in modules(room):
        if part not in str(module):
            continue
        nodes = list(ast_nodes(get_ast(module.read_text(encoding="utf-8"))))
        for name in OPERATORS:
            operator = get_operator(name)()
            for occurrence in range(sum(len(list(operator.mutation_positions(node))) for node in nodes)):
                yield room, module, name, occurrence


def mutant(room: str, module: Path, operator: str, occurrence: int) -> Mutant | None:
    """The changed module; None if the executed code is the same, for example in an annotation."""
    from cosmic_ray.mutating import mutate_code
    from cosmic_ray.plugins import get_operator

    source = module.read_text(encoding="utf-8")
    code = mutate_code(source, get_operator(operator)(), occurrence)
    if code is None or _executed(code) in ("", _executed(source)):
        return None
    return Mutant(room, str(module.relative_to(ROOT)), operator.removeprefix("core/"), source, code)


def _executed(source: str) -> str:
    """The code without annotations, decorators of records and ``strict``; "" if it is not valid Python."""
    try:
        tree = ast.parse(source)
    except SyntaxError:
        return ""
    for node in ast.walk(tree):
        if isinstance(node, ast.AnnAssign | ast.arg):
            node.annotation = None if isinstance(node, ast.arg) else ast.Constant(None)
        if isinstance(node, ast.FunctionDef):
            node.returns = None
        if isinstance(node, ast.Call):  # strict= of zip is a check, not a result
            node.keywords = [keyword for keyword in node.keywords if keyword.arg != "strict"]
        if isinstance(node, ast.ClassDef):
            node.decorator_list = []  # mypy checks that records are frozen
    return ast.dump(tree)


def drawn(size: int, seed: int, among: list[str], part: str) -> list[Mutant]:
    """Random changes of the rooms together; the same for the same seed and code."""
    everything = [place for room in among for place in places(room, part)]
    print(f"{len(everything)} possible changes in {', '.join(among)}", flush=True)
    random.Random(seed).shuffle(everything)
    made = (mutant(*place) for place in everything)
    return list(islice((m for m in made if m is not None), size))


def copy_of_the_tree(at: Path) -> Path:
    """A copy of all files that git would commit now, in ``at``."""
    command = ["git", "ls-files", "--cached", "--others", "--exclude-standard", "-z"]
    listed = subprocess.run(command, cwd=ROOT, check=True, capture_output=True)
    for name in listed.stdout.decode().split("\0"):
        if name and (ROOT / name).is_file():
            (at / name).parent.mkdir(parents=True, exist_ok=True)
            shutil.copy2(ROOT / name, at / name)
    return at


def judged(tree: Path, one: Mutant, limit: float, tests: list[str]) -> Outcome:
    """The verdict of the tests of a room in a copy of the tree."""
    if one.module:
        _write(tree / one.module, one.code)
    began, command = time.monotonic(), [sys.executable, "-m", "pytest", "-x", "-q", "--no-header", "--tb=no"]
    environment = os.environ | {"PYTHONPATH": str(tree)}
    try:
        done = subprocess.run(
            [*command, "-p", "no:cacheprovider", *tests],
            cwd=tree, env=environment, capture_output=True, text=True, timeout=limit, check=False,
        )  # fmt: skip
        failed = [line for line in done.stdout.splitlines() if line.startswith(("FAILED", "ERROR"))]
        killed = (failed or [done.stdout[-200:].strip() or "no output"])[0] if done.returncode else ""
    except subprocess.TimeoutExpired:
        killed = "timeout"
    if one.module:
        _write(tree / one.module, one.original)
    return Outcome(one, killed, time.monotonic() - began)


def _write(module: Path, code: str) -> None:
    module.write_text(code, encoding="utf-8")
    stamp = next(STAMPS)
    os.utime(module, (stamp, stamp))


def main() -> None:
    among = rooms()
    ask = harness.arguments(
        __doc__, 150, seed=1, rooms=among, each=False, modules="", quick=False, out=Path, workers=2
    )
    given = ask.parse_args()
    os.environ |= dict.fromkeys(("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"), "1")
    try:
        import cosmic_ray  # noqa: F401
    except ImportError:
        sys.exit("cosmic-ray, which makes the changes, is not installed: pip install 'mffit[studies]'")
    groups = [[room] for room in given.rooms] if given.each else [given.rooms]
    sample = [m for group in groups for m in drawn(given.draws, given.seed, group, given.modules)]
    found: list[Outcome] = []
    with tempfile.TemporaryDirectory() as scratch:
        tree, limits = copy_of_the_tree(Path(scratch)), {}
        for one in [*map(Mutant, dict.fromkeys(m.room for m in sample)), *sample]:
            limit = limits.get(one.room, LONGEST_BASELINE)
            outcome = judged(tree, one, limit, tests_of(one.room, given.quick))
            print(outcome.line(), flush=True)
            if not one.module and outcome.killed_by:
                sys.exit(f"the tests of {one.room} fail without any change: {outcome.killed_by}")
            if not one.module:
                limits[one.room] = 120.0 + 5.0 * outcome.seconds
                continue
            found.append(outcome)
            if given.out and not outcome.killed_by:
                with given.out.open("a", encoding="utf-8") as kept:
                    kept.write(outcome.line() + "\n")
    groups = {room: [o for o in found if o.mutant.room == room] for room in limits} | {"all": found}
    alive = {room: sum(not o.killed_by for o in of) for room, of in groups.items()}
    rows = (
        (room, len(of), alive[room], f"{alive[room] / max(len(of), 1):.0%}") for room, of in groups.items()
    )
    print("\n".join(harness.table(("changed", "mutants", "survive", "share"), rows)))


if __name__ == "__main__":
    main()
