"""Would the tests notice? Small wrong changes to the code, one at a time, and how many of them no test sees.

`python tests/studies/mutation_study.py 150 --seed 1` draws 150 changes, runs the tests of the changed folder on each, in a copy
of the tree, and prints the share that survives and the survivors. Needs cosmic-ray, which makes the changes: swapped
operators and comparisons, numbers one larger or smaller, dropped signs and ``not``, swapped ``and``/``or``, True/False, loops
that never run, and calls that hand on their first argument. ``<`` for ``<=`` is not among them: on measured numbers it
changes nothing.
"""

from __future__ import annotations

import argparse
import ast
import difflib
import os
import queue
import random
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from itertools import islice
from pathlib import Path

ROOT = Path(__file__).parents[2]
FIT, COMMANDS = "tests/mffit/fit", "tests/mffit/test_command_line.py"
TESTS: dict[str, tuple[str, ...]] = {
    "tir/equations": ("tests/tir", "tests/mffit/rig", f"{FIT}/test_constraints.py"),
    "tir/evaluate.py": ("tests/tir", "tests/mffit/rig"),
    "mffit/measured": (
        "tests/mffit/measured", "tests/test_paper_tables.py", "tests/mffit/virtual_rig/test_virtual_round_trip.py",
        f"{FIT}/test_recovery.py", "tests/mffit/diagnosis/test_correction.py", "tests/mffit/virtual_rig", COMMANDS,
    ),
    "mffit/fit": (
        f"{FIT}/test_constraints.py", f"{FIT}/test_coverage.py", f"{FIT}/test_recovery.py", FIT, COMMANDS,
    ),
    "mffit/diagnosis": (
        "tests/mffit/diagnosis/test_selection.py", "tests/mffit/diagnosis/test_conditions.py",
        "tests/mffit/diagnosis/test_steps.py", "tests/mffit/diagnosis/test_wording.py", "tests/mffit/diagnosis",
        COMMANDS,
    ),
    "mffit/pipeline.py": (COMMANDS, "tests/mffit/test_bad_input.py", FIT, "tests/mffit/diagnosis/test_correction.py"),
}  # fmt: skip
"""Folder that is changed -> the tests that ought to notice, the quick ones first."""
SWAPS = (
    *(f"BinaryOperator_{a}_{b}" for a, b in (
        ("Add", "Sub"), ("Sub", "Add"), ("Mul", "Div"), ("Div", "Mul"), ("Pow", "Mul"), ("BitAnd", "BitOr"),
        ("BitOr", "BitAnd"), ("FloorDiv", "Mul"), ("Mod", "Mul"),
    )),
    *(f"ComparisonOperator_{a}_{b}" for a, b in (
        ("Lt", "Gt"), ("Gt", "Lt"), ("LtE", "GtE"), ("GtE", "LtE"), ("Eq", "NotEq"), ("NotEq", "Eq"), ("Is", "IsNot"),
        ("IsNot", "Is"),
    )),
    "UnaryOperator_Delete_USub", "UnaryOperator_Delete_Not", "UnaryOperator_Delete_Invert", "TrueWithFalse",
    "FalseWithTrue", "AndWithOr", "OrWithAnd", "BreakWithContinue", "ContinueWithBreak",
)  # fmt: skip
OPERATORS = (
    *(f"core/Replace{name}" for name in SWAPS),
    "core/NumberReplacer",
    "core/ZeroIterationForLoop",
    "core/AddNot",
)


@dataclass(frozen=True)
class Mutant:
    """One changed module."""

    folder: str  #: key of TESTS
    module: str
    operator: str
    code: str
    change: str  #: the lines before and after


@dataclass(frozen=True)
class Outcome:
    """What the tests made of a mutant."""

    mutant: Mutant
    killed_by: str  #: first failing test, "timeout", or "" for a survivor
    seconds: float


def places(folder: str) -> Iterator[tuple[str, Path, str, int]]:
    """Folder, module, operator and occurrence of every change that could be made."""
    from cosmic_ray.ast import ast_nodes, get_ast
    from cosmic_ray.plugins import get_operator

    path = ROOT / folder
    for module in sorted(path.rglob("*.py")) if path.is_dir() else [path]:
        nodes = list(ast_nodes(get_ast(module.read_text(encoding="utf-8"))))
        for name in OPERATORS:
            operator = get_operator(name)()
            for occurrence in range(sum(len(list(operator.mutation_positions(node))) for node in nodes)):
                yield folder, module, name, occurrence


def mutant(folder: str, module: Path, operator: str, occurrence: int) -> Mutant | None:
    """The change made; None if what is executed stays the same, as in an annotation."""
    from cosmic_ray.mutating import mutate_code
    from cosmic_ray.plugins import get_operator

    source = module.read_text(encoding="utf-8")
    code = mutate_code(source, get_operator(operator)(), occurrence)
    if code is None or _executed(code) in ("", _executed(source)):
        return None
    name = str(module.relative_to(ROOT))
    return Mutant(folder, name, operator.removeprefix("core/"), code, _change(source, code))


def _executed(source: str) -> str:
    """The code without annotations and docstrings; "" if it is no Python any more."""
    try:
        tree = ast.parse(source)
    except SyntaxError:
        return ""
    for node in ast.walk(tree):
        if isinstance(node, ast.AnnAssign | ast.arg):
            node.annotation = None if isinstance(node, ast.arg) else ast.Constant(None)
        if isinstance(node, ast.FunctionDef):
            node.returns = None
    return ast.dump(tree)


def _change(before: str, after: str) -> str:
    lines = [
        line.rstrip()
        for line in difflib.unified_diff(before.splitlines(), after.splitlines(), lineterm="", n=0)
        if not line.startswith(("---", "+++"))
    ]
    return "\n".join(lines)


def drawn(count: int, seed: int, only: str) -> list[Mutant]:
    """A sample of all changes, each as likely as any other; the same for the same seed and code."""
    everything = [place for folder in TESTS if only in folder for place in places(folder)]
    print(f"{len(everything)} places for a change", flush=True)
    random.Random(seed).shuffle(everything)
    made = (mutant(*place) for place in everything)
    return list(islice((m for m in made if m is not None), count))


def copy_of_the_tree(at: Path) -> Path:
    """What git would commit, as it is now."""
    listed = subprocess.run(
        ["git", "ls-files", "--cached", "--others", "--exclude-standard", "-z"],
        cwd=ROOT,
        check=True,
        capture_output=True,
    )
    for name in listed.stdout.decode().split("\0"):
        if name and (ROOT / name).is_file():
            (at / name).parent.mkdir(parents=True, exist_ok=True)
            shutil.copy2(ROOT / name, at / name)
    subprocess.run([sys.executable, "-m", "compileall", "-q", "tir", "mffit"], cwd=at, check=True)
    return at


def run_tests(tree: Path, tests: tuple[str, ...], timeout: float) -> str:
    """First failing test, "timeout", or "" if all pass."""
    alone = {name: "1" for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS")}
    env = os.environ | alone | {"PYTHONDONTWRITEBYTECODE": "1", "PYTHONPATH": str(tree)}
    command = [
        sys.executable,
        "-m",
        "pytest",
        "-x",
        "-q",
        "-p",
        "no:cacheprovider",
        "--no-header",
        "--tb=no",
        *tests,
    ]
    process = subprocess.Popen(
        command,
        cwd=tree,
        env=env,
        text=True,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        start_new_session=True,
    )
    try:
        output, _ = process.communicate(timeout=timeout)
    except subprocess.TimeoutExpired:
        os.killpg(process.pid, signal.SIGKILL)
        process.communicate()
        return "timeout"
    if process.returncode == 0:
        return ""
    failed = [line for line in output.splitlines() if line.startswith(("FAILED", "ERROR"))]
    return failed[0] if failed else output[-200:]


def judged(sample: list[Mutant], workers: int) -> list[Outcome]:
    """Run the tests of every mutant, each worker in a copy of its own."""
    with tempfile.TemporaryDirectory() as scratch:
        free: queue.Queue[Path] = queue.Queue()
        for k in range(workers):
            free.put(copy_of_the_tree(Path(scratch) / str(k)))
        limit = {}
        for folder in {m.folder for m in sample}:
            began = time.perf_counter()
            wrong = run_tests(Path(scratch) / "0", TESTS[folder], 1800.0)
            if wrong:
                sys.exit(f"the tests of {folder} fail without any change: {wrong}")
            limit[folder] = 60.0 + 4.0 * (time.perf_counter() - began)
            print(f"{folder}: tests take {time.perf_counter() - began:.0f} s", flush=True)

        def judge(mutant: Mutant) -> Outcome:
            tree, began = free.get(), time.perf_counter()
            path = tree / mutant.module
            source, times = path.read_text(encoding="utf-8"), path.stat()
            try:
                path.write_text(mutant.code, encoding="utf-8")
                killer = run_tests(tree, TESTS[mutant.folder], limit[mutant.folder])
            finally:
                path.write_text(source, encoding="utf-8")
                os.utime(path, ns=(times.st_atime_ns, times.st_mtime_ns))
                free.put(tree)
            out = Outcome(mutant, killer, time.perf_counter() - began)
            print(
                f"{out.seconds:5.0f} s {mutant.module} {mutant.operator} {'SURVIVES' if not killer else killer[:100]}"
                + ("" if killer else "\n" + mutant.change),
                flush=True,
            )
            return out

        with ThreadPoolExecutor(workers) as pool:
            return list(pool.map(judge, sample))


def report(outcomes: list[Outcome]) -> str:
    """Survivors, and their share by folder."""
    lines = ["", "Survivors"]
    for out in outcomes:
        if not out.killed_by:
            lines += [f"\n{out.mutant.module} ({out.mutant.operator})", out.mutant.change]
    lines += ["", "| changed | mutants | survive | share |", "|---|---|---|---|"]
    for folder in [*TESTS, ""]:
        of = [o for o in outcomes if o.mutant.folder == folder or not folder]
        alive = sum(not o.killed_by for o in of)
        if of:
            lines.append(
                f"| {f'`{folder}`' if folder else 'all'} | {len(of)} | {alive} | {alive / len(of):.0%} |"
            )
    return "\n".join(lines)


def main() -> None:
    arguments = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    arguments.add_argument("count", type=int, nargs="?", default=150, help="how many changes to draw")
    arguments.add_argument("--seed", type=int, default=1)
    arguments.add_argument("--only", default="", help="part of a folder's name, to look at that one alone")
    arguments.add_argument("--workers", type=int, default=2)
    given = arguments.parse_args()
    try:
        import cosmic_ray  # noqa: F401
    except ImportError:
        sys.exit("the changes are made by cosmic-ray: pip install cosmic-ray")
    print(report(judged(drawn(given.count, given.seed, given.only), given.workers)))


if __name__ == "__main__":
    main()
