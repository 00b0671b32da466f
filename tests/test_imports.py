"""A command loads what it uses: modules are counted in a process of their own."""

from __future__ import annotations

import importlib
import json
import os
import shutil
import subprocess
import sys
from pathlib import Path
from types import ModuleType

import pytest

from mffit.on_demand import names_on_demand

ROOT = Path(__file__).parents[1]
MOST_OF_SPIN = 215
"""Modules of mffit and tir that the direct method needs, from the command line, with a base file and a recording."""
HEAVY = (
    "rich",
    "jinja2",
    "pint",
    "llvmlite",
    "lmfit",
    "matplotlib",
    "scipy.optimize",
    "scipy.sparse",
    "scipy.stats",
)
QUESTIONS = {
    "building": "fit.fitting",
    "comparing": "comparison.compare",
    "diagnosing": "diagnosis.engine",
    "intake": "recordings.sniffed",
    "planning": "planning.plan",
}
"""By workflow, the module that answers its question."""
ON_DEMAND = sorted(
    ".".join(path.relative_to(ROOT).parent.parts)
    for path in (ROOT / "mffit").rglob("__init__.py")
    if "on_demand(__name__)" in path.read_text(encoding="utf-8")
)


def loaded(program: str, folder: Path = ROOT) -> set[str]:
    """Names of all modules in a fresh process that has run ``program``."""
    count = "import sys; print('\\n' + '\\n'.join(sys.modules))"
    return set(in_a_process(f"{program}\n{count}", folder).split())


def in_a_process(program: str, folder: Path = ROOT) -> str:
    """What a fresh process prints that runs ``program``."""
    done = subprocess.run(
        [sys.executable, "-c", program],
        capture_output=True,
        text=True,
        check=True,
        cwd=folder,
        env={**os.environ, "PYTHONPATH": str(ROOT)},
    )
    return done.stdout


@pytest.fixture(scope="module")
def by_question() -> dict[str, set[str]]:
    """By workflow, the modules of mffit that it loads; of one process that forgets them between two workflows."""
    program = f"""
import importlib, json, sys
found = {{}}
for question in {[*QUESTIONS]}:
    importlib.import_module(f"mffit.pipeline.{{question}}")
    mine = [name for name in sys.modules if name.split(".")[0] in ("mffit", "tir")]
    found[question] = [name for name in mine if name.startswith("mffit.")]
    for name in mine:
        del sys.modules[name]
print(json.dumps(found))
"""
    done = in_a_process(program)
    return {question: set(names) for question, names in json.loads(done).items()}


def own(modules: set[str]) -> list[str]:
    return sorted(name for name in modules if name.split(".")[0] in ("mffit", "tir"))


def test_spin_loads_no_fit_and_no_other_question(tmp_path):
    shutil.copytree(ROOT / "samples" / "front-120-70", tmp_path / "front")
    modules = loaded("import mffit.cli\nmffit.cli.main(['spin', 'front/tyre.toml', '--quiet'])", tmp_path)
    assert (tmp_path / "front/out/spin.json").is_file()
    assert "mffit.measured.direct" in modules
    assert not modules & {*HEAVY, *(f"mffit.{answer}" for answer in QUESTIONS.values())}
    assert len(own(modules)) <= MOST_OF_SPIN, own(modules)


@pytest.mark.parametrize("question", QUESTIONS)
def test_no_question_imports_the_others(by_question, question):
    modules = by_question[question]
    assert f"mffit.pipeline.{question}" in modules
    others = {f"mffit.{answer}" for name, answer in QUESTIONS.items() if name != question}
    assert not others & modules


def test_tir_is_light():
    modules = loaded("import tir")
    assert not [name for name in own(modules) if name.startswith("mffit")]
    assert not modules & {*HEAVY, "scipy", "pandas", "pydantic"}


@pytest.mark.parametrize("package", ON_DEMAND)
def test_a_package_gives_out_what_it_lists(package):
    """A name that a module of the package has, too, would be that module once it is loaded."""
    module, listed = importlib.import_module(package), names_on_demand(package)
    assert listed
    assert not [name for name in listed if (Path(module.__file__).with_name(f"{name}.py")).exists()]
    for name in listed:
        assert not isinstance(getattr(module, name), ModuleType), name
    with pytest.raises(AttributeError, match="nothing_of_this_name"):
        _ = module.nothing_of_this_name
