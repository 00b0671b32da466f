"""Do the tests notice errors? Small wrong changes to the code, one at a time, and those that no test detects.

`python tests/studies/mutation_study.py 150 --seed 1` draws 150 changes, runs the tests of the changed room on each in a copy
of the tree, and prints the survivors and their share. `--rooms mffit/planning mffit/results --each` draws that many from each
of these rooms; `--json FILE` keeps the results, also of an interrupted run. Needs cosmic-ray, which makes the changes: swapped
operators and comparisons, numbers one larger or smaller, dropped signs and ``not``, swapped ``and``/``or``, True/False, loops
that never run. Left out because they make no difference: ``<`` for ``<=`` of measured numbers, and ``strict`` of ``zip``.
"""

from __future__ import annotations

import argparse
import ast
import contextlib
import difflib
import json
import os
import random
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from importlib import import_module
from itertools import count, islice
from multiprocessing import get_context
from multiprocessing.process import BaseProcess
from pathlib import Path
from typing import Any

ROOT = Path(__file__).parents[2]
SUITE = "tests/mffit"
FIT, DIAGNOSIS, POINTS, SUSPICION = (
    f"{SUITE}/{room}" for room in ("fit", "diagnosis", "points", "suspicion")
)
PIPELINE, COMMANDS, MANY = (f"{SUITE}/test_{name}.py" for name in ("pipeline", "command_line", "many"))
BAD_INPUT, CORPUS = f"{SUITE}/test_bad_input.py", f"{SUITE}/test_broken_corpus.py"
EQUATIONS = ("tests/tir/test_reference_vectors.py", "tests/tir/test_physics.py", "tests/tir", f"{SUITE}/rig")
TESTS: dict[str, tuple[str, ...]] = {
    "tir": ("tests/tir", "tests/test_constants.py", f"{SUITE}/export", f"{SUITE}/viewer"),
    "tir/equations": (*EQUATIONS, f"{FIT}/test_constraints.py", f"{FIT}/test_estimates.py"),
    "tir/evaluate.py": EQUATIONS,
    "mffit/cli": (
        f"{SUITE}/test_output.py", f"{SUITE}/test_init_project.py", f"{SUITE}/test_voice.py", f"{SUITE}/export",
        f"{SUITE}/recordings/test_unstated_units.py", COMMANDS, MANY, f"{SUITE}/comparison",
    ),
    "mffit/comparison": (f"{SUITE}/comparison", MANY),
    "mffit/config": (
        f"{SUITE}/config", f"{SUITE}/virtual_rig/test_virtual_plan.py", BAD_INPUT,
        f"{SUITE}/suspicion/test_declarations.py", f"{SUSPICION}/test_broken_units.py",
        f"{SUITE}/recordings/test_unstated_units.py", COMMANDS,
    ),
    "mffit/conversion": (f"{SUITE}/conversion",),
    "mffit/diagnosis": (
        *(f"{DIAGNOSIS}/test_{name}.py" for name in (
            "selection", "steps", "wording", "places", "thresholds", "conditions", "explain", "scatter", "evidence",
        )),
        DIAGNOSIS,
    ),
    "mffit/effects": (f"{SUITE}/effects", f"{DIAGNOSIS}/test_wording.py", DIAGNOSIS),
    "mffit/export": (f"{SUITE}/export",),
    "mffit/suspicion": (
        *(f"{SUSPICION}/test_{name}.py" for name in (
            "rules", "distrust", "undoing", "limits", "prediction", "broken_units", "broken_sweeps", "declarations",
        )),
        SUSPICION, f"{FIT}/test_trust.py", BAD_INPUT, PIPELINE, f"{DIAGNOSIS}/test_corrected_files.py",
    ),
    "mffit/fit": (
        *(f"{FIT}/test_{name}.py" for name in (
            "weights", "rig_numbers", "constraints", "coverage", "estimates", "shapes", "roads", "trust", "before_the_fit",
            "problem", "faulty_rig",
        )),
        PIPELINE, FIT,
    ),
    "mffit/fleet": (f"{SUITE}/fleet", f"{SUITE}/test_fleet_notes.py", MANY),
    "mffit/linearised": (
        f"{SUITE}/linearised", f"{SUITE}/test_left_out.py", f"{SUITE}/test_left_out_prediction.py", f"{SUITE}/prediction",
        f"{FIT}/test_posterior.py",
    ),
    "mffit/measured": (
        f"{SUITE}/measured", "tests/test_paper_tables.py", PIPELINE, f"{FIT}/test_faulty_rig.py", f"{FIT}/test_recovery.py",
    ),
    "mffit/pipeline": (
        f"{SUITE}/test_fleet_notes.py", f"{SUITE}/test_json.py", f"{SUITE}/export", f"{SUITE}/planning/test_plan_wording.py",
        f"{SUITE}/comparison", f"{SUITE}/recordings/test_unstated_units.py", f"{SUITE}/planning", MANY, COMMANDS, PIPELINE,
        f"{SUITE}/recordings/test_sniff.py", f"{FIT}/test_normal.py", f"{DIAGNOSIS}/test_corrected_files.py",
    ),
    "mffit/planning": (f"{SUITE}/planning",),
    "mffit/parts": (f"{SUITE}/parts", f"{SUITE}/measured", FIT),
    "mffit/points": (
        POINTS, BAD_INPUT, f"{SUITE}/recordings", f"{FIT}/test_trust.py", f"{FIT}/test_before_the_fit.py", SUSPICION, PIPELINE,
        CORPUS,
    ),
    "mffit/prediction": (f"{SUITE}/prediction", f"{SUITE}/test_left_out_prediction.py", PIPELINE),
    "mffit/recordings": (
        f"{SUITE}/recordings/test_unstated_units.py", f"{POINTS}/test_points_recordings.py", f"{SUITE}/recordings", CORPUS,
        COMMANDS,
    ),
    "mffit/reference": (f"{SUITE}/reference", "tests/test_docs.py", "tests/test_constants.py"),
    "mffit/report": (f"{SUITE}/report", f"{SUITE}/test_output.py", f"{SUITE}/test_voice.py", MANY),
    "mffit/results": (
        f"{SUITE}/test_json.py", f"{SUITE}/test_records.py", f"{SUITE}/planning/test_plan_wording.py", PIPELINE, MANY,
        f"{SUITE}/comparison", f"{DIAGNOSIS}/test_wording.py",
    ),
    "mffit/rig": (f"{SUITE}/rig", f"{SUITE}/virtual_rig", f"{SUITE}/effects", f"{FIT}/test_rig_numbers.py"),
    "mffit/rig_errors": (
        f"{SUITE}/rig", f"{SUITE}/virtual_rig", f"{SUITE}/effects", f"{SUITE}/reference", f"{FIT}/test_rig_numbers.py",
        f"{FIT}/test_before_the_fit.py", PIPELINE, f"{DIAGNOSIS}/test_correction.py", f"{DIAGNOSIS}/test_wording.py",
    ),
    "mffit/sweeps": (
        *(f"{SUITE}/sweeps/test_sweeps_{name}.py" for name in ("channels", "files", "frames", "formats", "fuzz")),
        BAD_INPUT, CORPUS, f"{SUITE}/test_readers_fuzz.py", f"{SUITE}/recordings", POINTS, COMMANDS,
    ),
    "mffit/viewer": (f"{SUITE}/viewer",),
    "mffit/window": (
        *(f"{SUITE}/window/test_window_{name}.py" for name in ("edits", "folder", "server")),
    ),
    "mffit/virtual_rig": (
        f"{SUITE}/virtual_rig", f"{SUITE}/rig", "tests/test_samples.py", COMMANDS,
    ),
}  # fmt: skip
"""Room, which is a folder or module -> the tests that should detect a change in it, fast ones first."""
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
    "pydantic", "uncertainties", "pint", "matplotlib.figure", "matplotlib.backends.backend_agg", "jinja2", "click",
    "rich.console", "tomli_w", "pytest",
)  # fmt: skip
LONGEST_BASELINE = 3600.0  # s
STAMPS = count(1_000_000_000)
"""A new modification time for every written module: equal times would let Python use the compiled code of the last one."""


@dataclass(frozen=True)
class Mutant:
    """One changed module."""

    room: str  #: key of TESTS
    module: str  #: "" for the unchanged room
    operator: str
    original: str
    code: str
    change: str  #: the lines before and after


def unchanged(room: str) -> Mutant:
    """The room without a change, whose tests must pass."""
    return Mutant(room, module="", operator="", original="", code="", change="")


@dataclass(frozen=True)
class Outcome:
    """Verdict of the tests on a mutant."""

    mutant: Mutant
    killed_by: str  #: first failing test, "timeout", or "" for a survivor
    seconds: float

    def line(self) -> str:
        """The verdict in one line, and the change if no test detected it."""
        m = self.mutant
        what = f"{m.module} {m.operator}" if m.module else f"{m.room} unchanged"
        end = self.killed_by[:100] or ("SURVIVES\n" + m.change if m.code else "passes")
        return f"{self.seconds:5.0f} s {what} {end}"


def modules(room: str) -> list[Path]:
    """The modules of a room, without those of a room inside it and without its numbers of judgement."""
    path = ROOT / room
    found = sorted(path.rglob("*.py")) if path.is_dir() else [path]
    inner = [ROOT / other for other in TESTS if other.startswith(f"{room}/")]
    found = [module for module in found if module.name != "constants.py"]
    return [module for module in found if not any(module.is_relative_to(other) for other in inner)]


def places(room: str) -> Iterator[tuple[str, Path, str, int]]:
    """Room, module, operator and occurrence of every possible change."""
    from cosmic_ray.ast import ast_nodes, get_ast
    from cosmic_ray.plugins import get_operator

    for module in modules(room):
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
    return Mutant(
        room=room,
        module=str(module.relative_to(ROOT)),
        operator=operator.removeprefix("core/"),
        original=source,
        code=code,
        change=_change(source, code),
    )


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


def _change(before: str, after: str) -> str:
    lines = [
        line.rstrip()
        for line in difflib.unified_diff(before.splitlines(), after.splitlines(), lineterm="", n=0)
        if not line.startswith(("---", "+++"))
    ]
    return "\n".join(lines)


def drawn(size: int, seed: int, rooms: Sequence[str], *, each: bool) -> list[Mutant]:
    """Random changes of the rooms together, or ``size`` of each; the same for the same seed and code."""
    if each:
        return [mutant for room in rooms for mutant in drawn(size, seed, [room], each=False)]
    everything = [place for room in rooms for place in places(room)]
    print(f"{len(everything)} possible changes in {', '.join(rooms)}", flush=True)
    random.Random(seed).shuffle(everything)
    made = (mutant(*place) for place in everything)
    return list(islice((m for m in made if m is not None), size))


def copy_of_the_tree(at: Path) -> Path:
    """A copy of all files that git would commit now, in ``at``."""
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
    """A process that runs the tests in a copy of the tree; forked, so that the preloaded packages need no import."""
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

    # Files instead of folders, because pytest would collect a folder in its own order.
    files = dict.fromkeys(str(file) for test in tests for file in _files(Path(test)))
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


def judged(sample: list[Mutant], workers: int) -> Iterator[Outcome]:
    """Outcomes of the mutants, each worker in its own copy of the tree; the unchanged rooms are tested first."""
    for name in PRELOADED:
        with contextlib.suppress(ImportError):
            import_module(name)
    waiting = [unchanged(room) for room in dict.fromkeys(m.room for m in sample)] + sample
    waiting.reverse()
    limit: dict[str, float] = {}
    with tempfile.TemporaryDirectory() as scratch:
        trees = [copy_of_the_tree(Path(scratch) / str(k)) for k in range(workers)]
        running: dict[Path, tuple[Mutant, BaseProcess, float]] = {}
        while waiting or running:
            for tree in trees:
                if tree not in running and waiting:
                    mutant = waiting.pop()
                    _write(tree, mutant.module, mutant.code)
                    process = started(tree, TESTS[mutant.room], tree.with_suffix(".txt"))
                    running[tree] = mutant, process, time.monotonic()
            time.sleep(0.05)
            for tree, (mutant, process, began) in list(running.items()):
                seconds = time.monotonic() - began
                if process.is_alive() and seconds < limit.get(mutant.room, LONGEST_BASELINE):
                    continue
                found = Outcome(mutant, verdict(process, tree.with_suffix(".txt")), seconds)
                _write(tree, mutant.module, mutant.original)
                del running[tree]
                print(found.line(), flush=True)
                if mutant.module:
                    yield found
                elif found.killed_by:
                    sys.exit(f"the tests of {mutant.room} fail without any change: {found.killed_by}")
                else:
                    limit[mutant.room] = 120.0 + 5.0 * seconds


def _write(tree: Path, module: str, code: str) -> None:
    """Replace a module of a copy, with a modification time of its own."""
    if module:
        (tree / module).write_text(code, encoding="utf-8")
        stamp = next(STAMPS)
        os.utime(tree / module, (stamp, stamp))


def report(outcomes: list[Outcome]) -> str:
    """The survivors, and their share by room."""
    lines = ["", "Survivors"]
    for out in outcomes:
        if not out.killed_by:
            lines += [f"\n{out.mutant.module} ({out.mutant.operator})", out.mutant.change]
    lines += ["", "| changed | mutants | survive | share |", "|---|---|---|---|"]
    for room in [*TESTS, ""]:
        of = [o for o in outcomes if o.mutant.room == room or not room]
        alive = sum(not o.killed_by for o in of)
        if of:
            lines.append(
                f"| {f'`{room}`' if room else 'all'} | {len(of)} | {alive} | {alive / len(of):.0%} |"
            )
    return "\n".join(lines)


def content(outcomes: list[Outcome], seed: int) -> dict[str, Any]:
    """The content of the results file: per room how many changes were drawn and survived, then every change."""
    rooms = dict.fromkeys(o.mutant.room for o in outcomes)
    alive = [o.mutant.room for o in outcomes if not o.killed_by]
    drawn = [o.mutant.room for o in outcomes]
    return {
        "seed": seed,
        "rooms": {room: {"drawn": drawn.count(room), "survived": alive.count(room)} for room in rooms},
        "survivors": [_row(o) for o in outcomes if not o.killed_by],
        "killed": [_row(o) | {"by": o.killed_by, "seconds": o.seconds} for o in outcomes if o.killed_by],
    }


def _row(found: Outcome) -> dict[str, Any]:
    m = found.mutant
    return {"room": m.room, "module": m.module, "operator": m.operator, "change": m.change}


def main() -> None:
    arguments = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    arguments.add_argument("count", type=int, nargs="?", default=150, help="number of changes to draw")
    arguments.add_argument("--seed", type=int, default=1)
    arguments.add_argument(
        "--rooms",
        nargs="+",
        choices=list(TESTS),
        default=list(TESTS),
        metavar="ROOM",
        help="rooms to draw from",
    )
    arguments.add_argument("--each", action="store_true", help="draw COUNT changes from each room")
    arguments.add_argument("--json", type=Path, help="results file, written after every change")
    arguments.add_argument("--workers", type=int, default=2, help="tests that run at the same time")
    given = arguments.parse_args()
    os.environ |= dict.fromkeys(("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"), "1")
    try:
        import cosmic_ray  # noqa: F401
    except ImportError:
        sys.exit("cosmic-ray, which makes the changes, is not installed: pip install 'mffit[studies]'")
    missing = [name for room in given.rooms for name in (room, *TESTS[room]) if not (ROOT / name).exists()]
    if missing:
        sys.exit(f"{', '.join(dict.fromkeys(missing))}: no such file or folder; correct TESTS in {__file__}")
    outcomes: list[Outcome] = []
    for outcome in judged(drawn(given.count, given.seed, given.rooms, each=given.each), given.workers):
        outcomes.append(outcome)
        if given.json is not None:
            given.json.write_text(json.dumps(content(outcomes, given.seed), indent=1), encoding="utf-8")
    print(report(outcomes))


if __name__ == "__main__":
    main()
