"""The documentation does not lag behind: links resolve, nothing a user may write or run goes unmentioned."""

from __future__ import annotations

import re
import tomllib
from pathlib import Path

import pytest

import mffit
import tir
from mffit.cli import commands
from mffit.config.problems import known_keys
from mffit.virtual_rig import plan

ROOT = Path(__file__).parents[1]
DOCS = ROOT / "docs"
PAGES = [ROOT / "README.md", ROOT / "samples" / "README.md", *sorted(DOCS.rglob("*.md"))]
LINK = re.compile(r"\[[^\]]*\]\(([^)\s]+)\)")
KEY = r"`{0}`|\[[\w.]*\b{0}\]"
FENCE = re.compile(r"^```.*?^```", re.MULTILINE | re.DOTALL)


def text_of(page: Path) -> str:
    return page.read_text(encoding="utf-8")


def anchors(page: Path) -> set[str]:
    """The anchors of a page's headings, as the usual renderers make them."""
    headings = re.findall(r"^#+\s+(.*?)\s*$", FENCE.sub("", text_of(page)), re.MULTILINE)
    return {re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-") for heading in headings}


@pytest.mark.parametrize("page", PAGES, ids=lambda page: str(page.relative_to(ROOT)))
def test_links_resolve(page):
    broken = []
    for target in LINK.findall(FENCE.sub("", text_of(page))):
        if re.match(r"[a-z]+:", target):
            continue
        file, _, anchor = target.partition("#")
        found = (page.parent / file).resolve() if file else page
        if not found.exists() or (anchor and anchor not in anchors(found)):
            broken.append(target)
    assert not broken, f"{page.relative_to(ROOT)} links to {', '.join(broken)}, which is not there"


def test_every_page_is_reached_from_the_index():
    index = DOCS / "index.md"
    linked = {(DOCS / target.partition("#")[0]).resolve() for target in LINK.findall(text_of(index))}
    missing = [page.name for page in DOCS.glob("*.md") if page != index and page.resolve() not in linked]
    assert not missing, f"docs/index.md does not link to {', '.join(missing)}"


def test_every_dependency_has_a_reason():
    project = tomllib.loads(text_of(ROOT / "pyproject.toml"))["project"]
    extras = [line for lines in project["optional-dependencies"].values() for line in lines]
    names = {re.split(r"[\s<>=!\[;]", line)[0] for line in [*project["dependencies"], *extras]} - {"mffit"}
    rows = re.findall(r"^\| `([\w-]+)`", text_of(DOCS / "dependencies.md"), re.MULTILINE)
    explained = set(rows)
    assert len(rows) == len(explained), "docs/dependencies.md explains a package twice"
    assert names <= explained, (
        f"docs/dependencies.md has no reason for {', '.join(sorted(names - explained))}"
    )
    assert explained <= names, (
        f"docs/dependencies.md explains {', '.join(sorted(explained - names))}, not used"
    )


@pytest.mark.parametrize("command", sorted(commands.commands))
def test_every_command_is_described(command):
    assert any(f"mffit {command}" in text_of(page) for page in DOCS.glob("*.md")), (
        f"no page of docs/ mentions `mffit {command}`"
    )


def test_the_readme_names_no_command_that_is_not_there():
    named = set(re.findall(r"`mffit (\w+)", text_of(ROOT / "README.md")))
    assert named <= set(commands.commands), f"README.md names {', '.join(named - set(commands.commands))}"


@pytest.mark.parametrize("package", [tir, mffit], ids=lambda package: package.__name__)
def test_every_public_name_is_in_the_reference(package):
    page = text_of(DOCS / "api.md")
    missing = [name for name in package.__all__ if not re.search(rf":: [\w.]+\.{name}\b", page)]
    assert not missing, f"docs/api.md does not list {', '.join(missing)}"


def test_every_key_of_tyre_toml_is_described():
    page = text_of(DOCS / "configuration.md")
    keys = {key for keys in known_keys().values() for key in keys}
    missing = sorted(key for key in keys if not re.search(KEY.format(key), page))
    assert not missing, f"docs/configuration.md does not describe {', '.join(missing)}"


def test_every_key_of_rig_toml_is_described():
    page = text_of(DOCS / "simulate.md")
    keys = {key for table in (plan.RigTables, *plan.TABLES) for key in table.model_fields}
    missing = sorted(key for key in keys if not re.search(KEY.format(key), page))
    assert not missing, f"docs/simulate.md does not describe {', '.join(missing)}"


@pytest.mark.parametrize(
    "example", re.findall(r"^```python\n(.*?)```", text_of(ROOT / "README.md"), re.DOTALL | re.MULTILINE)
)
def test_the_examples_of_the_readme_run(example, tmp_path, monkeypatch):
    (tmp_path / "samples").symlink_to(ROOT / "samples")
    monkeypatch.chdir(tmp_path)
    exec(compile(example, "README.md", "exec"), {})


def test_the_readme_says_how_to_run_and_how_to_test():
    blocks = re.findall(
        r"<!-- ci:(\w+) -->\n```(?:bash|sh|console)\n(.*?)```", text_of(ROOT / "README.md"), re.DOTALL
    )
    assert [name for name, _ in blocks] == ["main", "tests"]


def test_every_dependency_is_used():
    project = tomllib.loads(text_of(ROOT / "pyproject.toml"))["project"]
    names = {re.split(r"[\s<>=!\[;]", line)[0].replace("-", "_") for line in project["dependencies"]}
    modules = {name: {"pillow": "PIL"}.get(name, name) for name in names}
    code = "\n".join(text_of(path) for package in ("tir", "mffit") for path in (ROOT / package).rglob("*.py"))
    unused = sorted(
        name
        for name, module in modules.items()
        if not re.search(rf"^\s*(import|from) {module}\b", code, re.MULTILINE)
    )
    assert not unused, f"pyproject.toml requires {', '.join(unused)}, which no module imports; remove it"
