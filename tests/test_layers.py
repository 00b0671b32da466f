"""Imports point where docs/architecture.md says they may."""

from __future__ import annotations

import ast
import re
import subprocess
import sys
from collections import Counter
from collections.abc import Iterator
from graphlib import TopologicalSorter
from pathlib import Path

import pytest

from tir.parameters import TABLE

ROOT = Path(__file__).parents[1]
ARCHITECTURE = "docs/architecture.md"


def modules(package: str) -> list[Path]:
    return sorted(path for path in (ROOT / package).rglob("*.py") if "build" not in path.parts)


def imports(path: Path) -> Iterator[tuple[int, str]]:
    """Line and dotted name of everything a module imports, inside functions too."""
    package = ".".join(path.relative_to(ROOT).parts[:-1])
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            for alias in node.names:
                yield node.lineno, alias.name
        elif isinstance(node, ast.ImportFrom):
            above = package.split(".")[: len(package.split(".")) - node.level + 1] if node.level else []
            origin = ".".join([*above, *([node.module] if node.module else [])])
            for alias in node.names:
                yield node.lineno, f"{origin}.{alias.name}"


def layers() -> list[str]:
    """Folders and modules of mffit from the top of the list in docs/architecture.md downwards."""
    text = (ROOT / ARCHITECTURE).read_text(encoding="utf-8")
    block = re.search(r"^mffit/\n((?: .*\n)+)", text, re.MULTILINE)
    assert block, f"{ARCHITECTURE} has no list of the folders of mffit/ any more; put it back"
    return [re.split(r"[/.\s]", line.strip())[0] for line in block[1].splitlines()]


def listed() -> dict[str, list[str]]:
    """By package, the entries of the list in docs/architecture.md as they stand there."""
    text = (ROOT / ARCHITECTURE).read_text(encoding="utf-8")
    blocks = re.findall(r"^(\w+)/\n((?: .*\n)+)", text, re.MULTILINE)
    return {package: [line.split()[0] for line in block.splitlines()] for package, block in blocks}


@pytest.mark.parametrize("package", ["tir", "mffit"])
def test_the_list_is_the_tree(package):
    """Folders with a slash, modules with .py, each once and no other."""
    there = {
        path.name + "/" * path.is_dir()
        for path in (ROOT / package).iterdir()
        if path.suffix in (".py", ".csv") or (path / "__init__.py").is_file()
    } - {"__init__.py"}
    entries = listed()[package]
    assert sorted(entries) == sorted(there), f"{ARCHITECTURE} lists {package}/ otherwise than it is"


def layer_of(dotted: str) -> str | None:
    """The folder or module of mffit that a dotted name lies in; None outside mffit and for mffit itself."""
    parts = dotted.split(".")
    if parts[0] != "mffit" or len(parts) == 1:
        return None
    inside = ROOT / "mffit" / parts[1]
    return parts[1] if inside.is_dir() or inside.with_suffix(".py").is_file() else None


def place(path: Path, line: int) -> str:
    return f"{path.relative_to(ROOT)}:{line}"


def test_every_part_of_mffit_stands_in_the_list():
    order = layers()
    parts = {path.relative_to(ROOT / "mffit").parts[0].removesuffix(".py") for path in modules("mffit")}
    missing = sorted(parts - set(order) - {"__init__"})
    assert not missing, (
        f"{ARCHITECTURE} does not say where {', '.join(missing)} belongs; add a line to its list"
    )


def test_mffit_imports_only_from_above():
    order = layers()
    wrong = []
    for path in modules("mffit"):
        own = path.relative_to(ROOT / "mffit").parts[0].removesuffix(".py")
        if own not in order:
            continue  # mffit/__init__.py gives out the public names and may import any of them
        for line, name in imports(path):
            other = layer_of(name)
            if other in order and order.index(other) > order.index(own):
                wrong.append(
                    f"{place(path, line)}: {own} imports {name}, but {ARCHITECTURE} has {own} above {other}; "
                    f"move the code, or the folder's place in the list"
                )
    assert not wrong, "\n".join(wrong)


@pytest.mark.parametrize(
    "folder", sorted(path.name for path in (ROOT / "mffit").iterdir() if (path / "__init__.py").is_file())
)
def test_modules_of_a_folder_import_in_one_direction(folder):
    """A folder inside counts as one module."""
    inside = f"mffit.{folder}."
    after: dict[str, set[str]] = {}
    for path in (ROOT / "mffit" / folder).rglob("*.py"):
        own = path.relative_to(ROOT / "mffit" / folder).parts[0].removesuffix(".py")
        if path.name != "__init__.py":
            used = {
                name.removeprefix(inside).split(".")[0]
                for _, name in imports(path)
                if name.startswith(inside)
            }
            after.setdefault(own, set()).update(used - {own})
    while after:
        free = {name for name, used in after.items() if not used & after.keys()}
        assert free, (
            f"{', '.join(sorted(after))} of mffit/{folder} import each other; move what both need to a third module"
        )
        after = {name: used for name, used in after.items() if name not in free}


def test_a_name_is_imported_from_where_it_is_defined():
    """From the module that defines it, or from the folder whose __init__.py gives it out."""
    trees = {
        path.relative_to(ROOT).with_suffix("").as_posix().replace("/", "."): ast.parse(
            path.read_text(encoding="utf-8")
        )
        for path in modules("mffit")
    }
    passed_on = {
        f"{name}.{alias.asname or alias.name}"
        for name, tree in trees.items()
        for node in ast.walk(tree)
        if isinstance(node, ast.ImportFrom)
        for alias in node.names
    }
    wrong = {
        f"{place(path, line)}: {name} is only imported there; import it from where it is defined"
        for path in modules("mffit")
        for line, name in imports(path)
        if name in passed_on
    }
    assert not wrong, "\n".join(sorted(wrong))


def test_tir_does_not_know_mffit():
    wrong = [
        f"{place(path, line)}: tir imports {name}; a simulation must be able to use tir alone"
        for path in modules("tir")
        for line, name in imports(path)
        if name.split(".")[0] == "mffit"
    ]
    assert not wrong, "\n".join(wrong)


WHEN_ASKED = {("tir.tyre", "tir.drawing"), ("tir.tyre", "tir.checking")}
"""The imports that point upwards: methods of the user's class for what works on that class."""


def test_no_modules_of_tir_import_each_other_in_a_circle():
    """Imports for types, inside functions and of names from packages count too."""
    names = {".".join(path.relative_to(ROOT).with_suffix("").parts): path for path in modules("tir")}
    needed: dict[str, set[str]] = {}
    for own, path in names.items():
        found = {
            other for _, name in imports(path) for other in (name, name.rpartition(".")[0]) if other in names
        }
        needed[own] = {other for other in found if (own, other) not in WHEN_ASKED}
    assert len(list(TopologicalSorter(needed).static_order())) == len(names)


def test_tir_needs_nothing_but_numpy():
    allowed = {"tir", "numpy"} | set(sys.stdlib_module_names)
    compiler, drawing = {"llvmlite", "casadi"}, {"matplotlib"}
    wrong = [
        f"{place(path, line)}: tir imports {name}; it may use numpy and the standard library, in codegen llvmlite and casadi, "
        f"in tir/drawing.py matplotlib"
        for path in modules("tir")
        for line, name in imports(path)
        if name.split(".")[0]
        not in allowed
        | (compiler if "codegen" in path.parts else set())
        | (drawing if path.name == "drawing.py" else set())
    ]
    assert not wrong, "\n".join(wrong)


def test_mffit_writes_no_equation_again():
    """A formula of the Magic Formula outside tir/equations would use its coefficients by name."""
    coefficients = {row.name for row in TABLE if row.section.endswith("COEFFICIENTS") and not row.scaling}
    wrong = [
        f"{place(path, node.lineno)}: uses {node.attr}; call the function of tir/equations instead"
        for path in modules("mffit")
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8")))
        if isinstance(node, ast.Attribute) and node.attr in coefficients
    ]
    assert not wrong, "\n".join(wrong)


def test_tir_imports_what_is_optional_only_when_asked():
    wrong = subprocess.run(
        [
            sys.executable,
            "-c",
            "import sys, tir; print(*{'matplotlib', 'llvmlite', 'casadi'} & set(sys.modules))",
        ],
        capture_output=True,
        text=True,
        check=True,
        cwd=ROOT,
    ).stdout.split()
    assert not wrong, f"import tir imports {', '.join(wrong)}"


def test_only_the_report_draws():
    wrong = [
        f"{place(path, line)}: {name} is imported outside mffit/report; hand the numbers to a figure there"
        for path in modules("mffit")
        for line, name in imports(path)
        if name.split(".")[0] == "matplotlib" and "report" not in path.parts
    ]
    assert not wrong, "\n".join(wrong)


def test_a_class_name_means_one_thing():
    found = Counter(
        node.name
        for package in ("tir", "mffit")
        for path in modules(package)
        for node in ast.parse(path.read_text(encoding="utf-8")).body
        if isinstance(node, ast.ClassDef)
    )
    twice = sorted(name for name, times in found.items() if times > 1)
    assert not twice, f"{', '.join(twice)}: several classes of one name; say in the name which is which"
