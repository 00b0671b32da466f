"""Would the tests notice? Small wrong changes to the code, one at a time, and how many of them no test sees.

`python tests/studies/mutation_study.py 150 --seed 1` draws 150 changes, runs the tests of the changed folder on each, in a copy
of the tree, and prints the share that survives and the survivors. Needs cosmic-ray, which makes the changes: swapped
operators and comparisons, numbers one larger or smaller, dropped signs and ``not``, swapped ``and``/``or``, True/False, loops
that never run. ``<`` for ``<=`` is not among them: on measured numbers it
changes nothing.
"""

from __future__ import annotations

import argparse
import ast
import difflib
import os
import random
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from dataclasses import dataclass
from importlib import import_module
from itertools import count, islice
from multiprocessing import get_context
from multiprocessing.process import BaseProcess
from pathlib import Path

ROOT = Path(__file__).parents[2]
FIT, DIAGNOSIS = "tests/mffit/fit", "tests/mffit/diagnosis"
PIPELINE, COMMANDS = "tests/mffit/test_pipeline.py", "tests/mffit/test_command_line.py"
EQUATIONS = (
    "tests/tir/test_reference_vectors.py",
    "tests/tir/test_physics.py",
    "tests/tir",
    "tests/mffit/rig",
)
TESTS: dict[str, tuple[str, ...]] = {
    "tir/equations": (*EQUATIONS, f"{FIT}/test_constraints.py", f"{FIT}/test_estimates.py"),
    "tir/evaluate.py": EQUATIONS,
    "mffit/measured": (
        "tests/mffit/measured", "tests/test_paper_tables.py", f"{FIT}/test_faulty_rig.py", f"{FIT}/test_recovery.py",
    ),
    "mffit/points": ("tests/mffit/points", "tests/mffit/suspicion/test_declarations.py"),
    "mffit/suspicion": (
        *(f"tests/mffit/suspicion/test_{name}.py" for name in ("limits", "undoing", "prediction", "distrust", "broken_units")),
        "tests/mffit/suspicion", f"{DIAGNOSIS}/test_corrected_files.py",
    ),
    "mffit/fit": (
        *(f"{FIT}/test_{name}.py" for name in (
            "constraints", "coverage", "weights", "estimates", "rig_numbers", "before_the_fit", "problem", "shapes", "roads",
            "faulty_rig",
        )),
        PIPELINE, FIT,
    ),
    "mffit/diagnosis": (
        *(f"{DIAGNOSIS}/test_{name}.py" for name in (
            "selection", "thresholds", "evidence", "places", "conditions", "wording", "steps",
        )),
        DIAGNOSIS,
    ),
    "mffit/pipeline": (PIPELINE, COMMANDS, FIT, f"{DIAGNOSIS}/test_correction.py", "tests/mffit/test_bad_input.py"),
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


PRELOADED = (
    "numpy", "scipy.optimize", "scipy.stats", "scipy.special", "scipy.linalg", "scipy.interpolate", "scipy.integrate", "pandas",
    "lmfit", "pydantic", "uncertainties", "pint", "matplotlib.figure", "matplotlib.backends.backend_agg", "jinja2", "click",
    "rich.console", "tomli_w", "pytest",
)  # fmt: skip
LONGEST = 3600.0  # s
ROOT_TEXT: dict[str, str] = {}
"""Modules as they are, by name."""
STAMPS = count(1_000_000_000)


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

    def line(self) -> str:
        """For whoever watches."""
        m = self.mutant
        what = f"{m.module} {m.operator}" if m.module else f"{m.folder} as it is"
        end = self.killed_by[:100] or ("SURVIVES\n" + m.change if m.code else "passes")
        return f"{self.seconds:5.0f} s {what} {end}"


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
    ROOT_TEXT[name] = source
    return Mutant(folder, name, operator.removeprefix("core/"), code, _change(source, code))


def _executed(source: str) -> str:
    """The code without annotations and decorators of records; "" if it is no Python any more."""
    try:
        tree = ast.parse(source)
    except SyntaxError:
        return ""
    for node in ast.walk(tree):
        if isinstance(node, ast.AnnAssign | ast.arg):
            node.annotation = None if isinstance(node, ast.arg) else ast.Constant(None)
        if isinstance(node, ast.FunctionDef):
            node.returns = None
        if isinstance(node, ast.ClassDef):
            node.decorator_list = []  # whether a record is frozen is for mypy to watch
    return ast.dump(tree)


def _change(before: str, after: str) -> str:
    lines = [
        line.rstrip()
        for line in difflib.unified_diff(before.splitlines(), after.splitlines(), lineterm="", n=0)
        if not line.startswith(("---", "+++"))
    ]
    return "\n".join(lines)


def drawn(size: int, seed: int, only: str) -> list[Mutant]:
    """A sample of all changes, each as likely as any other; the same for the same seed and code."""
    everything = [place for folder in TESTS if only in folder for place in places(folder)]
    print(f"{len(everything)} places for a change", flush=True)
    random.Random(seed).shuffle(everything)
    made = (mutant(*place) for place in everything)
    return list(islice((m for m in made if m is not None), size))


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


def started(tree: Path, tests: tuple[str, ...], output: Path) -> BaseProcess:
    """A process that runs the tests in a copy of the tree; what is imported here already, it need not import again."""
    process = get_context("fork").Process(target=_pytest, args=(tree, tests, output))
    process.start()
    return process


def _pytest(tree: Path, tests: tuple[str, ...], output: Path) -> None:
    os.setsid()
    os.chdir(tree)
    os.environ["PYTHONPATH"] = str(tree)
    sys.path[:] = [str(tree), *(place for place in sys.path if place != str(ROOT))]
    with output.open("w") as stream:
        for descriptor in (1, 2):
            os.dup2(stream.fileno(), descriptor)
    import pytest

    files = dict.fromkeys(
        str(file) for test in tests for file in _files(Path(test))
    )  # a folder would come in its own order
    code = pytest.main(["-x", "-q", "-p", "no:cacheprovider", "--no-header", "--tb=no", *files])
    sys.stdout.flush()
    os._exit(int(code))


def _files(test: Path) -> list[Path]:
    return sorted(test.rglob("test_*.py")) if test.is_dir() else [test]


def verdict(process: BaseProcess, output: Path) -> str:
    """First failing test, "timeout", or "" if all passed."""
    if process.is_alive():
        os.killpg(process.pid, signal.SIGKILL)
        process.join()
        return "timeout"
    if process.exitcode == 0:
        return ""
    text = output.read_text(errors="replace") if output.exists() else ""
    failed = [line for line in text.splitlines() if line.startswith(("FAILED", "ERROR"))]
    return failed[0] if failed else text[-200:].strip() or f"exit code {process.exitcode}"


def judged(sample: list[Mutant], workers: int) -> list[Outcome]:
    """Run the tests of every mutant, each worker in a copy of its own; first those of every folder as they are."""
    for name in PRELOADED:
        import_module(name)
    waiting = [Mutant(folder, "", "", "", "") for folder in dict.fromkeys(m.folder for m in sample)] + sample
    waiting.reverse()
    out: list[Outcome] = []
    limit: dict[str, float] = {}
    with tempfile.TemporaryDirectory() as scratch:
        trees = [copy_of_the_tree(Path(scratch) / str(k)) for k in range(workers)]
        running: dict[Path, tuple[Mutant, BaseProcess, float]] = {}
        while waiting or running:
            for tree in trees:
                if tree not in running and waiting:
                    mutant = waiting.pop()
                    _write(tree, mutant, mutant.code)
                    process = started(tree, TESTS[mutant.folder], tree.with_suffix(".txt"))
                    running[tree] = mutant, process, time.monotonic()
            time.sleep(0.05)
            for tree, (mutant, process, began) in list(running.items()):
                seconds = time.monotonic() - began
                if process.is_alive() and seconds < limit.get(mutant.folder, LONGEST):
                    continue
                found = Outcome(mutant, verdict(process, tree.with_suffix(".txt")), seconds)
                _write(tree, mutant, "")
                del running[tree]
                print(found.line(), flush=True)
                if mutant.code:
                    out.append(found)
                elif found.killed_by:
                    sys.exit(f"the tests of {mutant.folder} fail without any change: {found.killed_by}")
                else:
                    limit[mutant.folder] = 120.0 + 5.0 * seconds
    return out


def _write(tree: Path, mutant: Mutant, code: str) -> None:
    """The mutant's code into its module, or what stood there before; the time of a file tells compiled code apart."""
    if mutant.module:
        (tree / mutant.module).write_text(code or (ROOT_TEXT[mutant.module]), encoding="utf-8")
        stamp = next(STAMPS)
        os.utime(tree / mutant.module, (stamp, stamp))


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
    os.environ |= dict.fromkeys(("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"), "1")
    try:
        import cosmic_ray  # noqa: F401
    except ImportError:
        sys.exit("the changes are made by cosmic-ray: pip install 'mffit[studies]'")
    print(report(judged(drawn(given.count, given.seed, given.only), given.workers)))


if __name__ == "__main__":
    main()
