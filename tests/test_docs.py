"""The documentation does not lag behind: links resolve, nothing a user may write or run goes unmentioned."""

from __future__ import annotations

import re
import shlex
import shutil
import textwrap
import tomllib
from dataclasses import dataclass
from importlib.util import find_spec
from pathlib import Path

import click
import pytest

import mffit
import tir
from mffit.cli import commands
from mffit.config import Config
from mffit.config.problems import known_keys
from mffit.virtual_rig import plan
from tir import targets

ROOT = Path(__file__).parents[1]
DOCS = ROOT / "docs"
PAGES = [ROOT / "README.md", ROOT / "samples" / "README.md", *sorted(DOCS.rglob("*.md"))]
LINK = re.compile(r"\[[^\]]*\]\(([^)\s]+)\)")
KEY = r"`{0}`|\[[\w.]*\b{0}\]"
FENCE = re.compile(r"^ *```.*?^ *```", re.MULTILINE | re.DOTALL)


BLOCK = re.compile(
    r"(?:^ *<!-- (?P<word>not run|needs):(?P<marker>.*?)-->\n)?"
    r"^(?P<indent> *)```(?P<language>[\w{}-]*)\n(?P<text>.*?)^(?P=indent)```$",
    re.MULTILINE | re.DOTALL,
)
SHELLS = ("", "bash", "sh", "console")


@dataclass(frozen=True)
class Block:
    """A fenced block of a page. ``<!-- not run: why -->`` above it, or ``<!-- needs: package -->``, keeps it from being run."""

    language: str
    text: str
    line: int  #: of its first line in the page
    word: str | None = None
    marker: str | None = None

    @property
    def can_run(self) -> bool:
        return self.word is None or (self.word == "needs" and find_spec(self.marker.strip()) is not None)


def text_of(page: Path) -> str:
    return page.read_text(encoding="utf-8")


def name_of(page: Path) -> str:
    return str(page.relative_to(ROOT))


def blocks(page: Path) -> list[Block]:
    text = text_of(page)
    return [
        Block(
            language=found["language"],
            text=textwrap.dedent(found["text"]),
            line=text.count("\n", 0, found.start("text")) + 1,
            word=found["word"],
            marker=found["marker"],
        )
        for found in BLOCK.finditer(text)
    ]


def anchors(page: Path) -> set[str]:
    """The anchors of a page's headings, as the usual renderers make them."""
    headings = re.findall(r"^#+\s+(.*?)\s*$", FENCE.sub("", text_of(page)), re.MULTILINE)
    return {re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-") for heading in headings}


@pytest.mark.parametrize("page", PAGES, ids=name_of)
def test_links_resolve(page):
    broken = []
    for target in LINK.findall(FENCE.sub("", text_of(page))):
        if re.match(r"[a-z]+:", target):
            continue
        file, _, anchor = target.partition("#")
        found = (page.parent / file).resolve() if file else page
        if not found.exists() or (anchor and anchor not in anchors(found)):
            broken.append(target)
    assert not broken, f"{name_of(page)} links to {', '.join(broken)}, which is not there"


def test_every_page_is_reached_from_the_index():
    index = DOCS / "index.md"
    linked = {(DOCS / target.partition("#")[0]).resolve() for target in LINK.findall(text_of(index))}
    missing = [page.name for page in DOCS.glob("*.md") if page != index and page.resolve() not in linked]
    assert not missing, f"docs/index.md does not link to {', '.join(missing)}"


def test_the_gallery_links_to_the_pages_of_every_sample():
    linked = set(re.findall(r'href="shown/([\w./-]+)"', text_of(DOCS / "gallery.md")))
    samples = [path.parent.name for path in (ROOT / "samples").glob("*/rig.toml")]
    assert linked == {f"{name}/{kind}.html" for name in samples for kind in ("report", "diagnosis", "show")}


def test_the_pages_together_stay_short():
    """The changelog is looked up, not read."""
    pages = [page for page in PAGES if page.name != "changelog.md"]
    words = sum(len(text_of(page).split()) for page in pages)
    assert words <= 52_000, (
        f"the pages have {words} words; say each fact once, and what a study showed in a few lines"
    )


DISTRIBUTIONS = [ROOT / "pyproject.toml", ROOT / "tir" / "pyproject.toml"]


def test_both_distributions_the_changelog_and_the_citation_have_one_version():
    projects = [tomllib.loads(text_of(file))["project"] for file in DISTRIBUTIONS]
    newest = re.search(r"^## (\d\S+)", text_of(DOCS / "changelog.md"), re.MULTILINE)
    cited = re.search(r"^version: (\S+)", text_of(DOCS / "CITATION.cff"), re.MULTILINE)
    assert newest
    assert cited
    assert {project["version"] for project in projects} | {newest[1], cited[1]} == {projects[0]["version"]}


def test_tir_by_itself_declares_what_mffit_declares():
    both = [tomllib.loads(text_of(file))["project"] for file in DISTRIBUTIONS]
    whole, alone = (
        {
            *project["dependencies"],
            *(line for extra in project["optional-dependencies"].values() for line in extra),
        }
        for project in both
    )
    assert alone <= whole
    assert text_of(ROOT / "LICENSE") == text_of(ROOT / "tir" / "LICENSE")


@pytest.mark.parametrize("file", DISTRIBUTIONS, ids=["mffit", "tir"])
def test_the_description_on_a_package_index_needs_no_other_file(file):
    """A link or a picture that is relative to the repository is broken there."""
    readme = file.parent / tomllib.loads(text_of(file))["project"]["readme"]
    relative = [target for target in LINK.findall(text_of(readme)) if not target.startswith("#")]
    assert not relative, f"{readme.relative_to(ROOT)} links to {', '.join(relative)}"


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


def test_the_table_of_parameters_is_explained():
    """Every column, every stage, and every word for what the data must vary."""
    page = text_of(DOCS / "parameters.md")
    columns = (ROOT / "tir" / "parameters.csv").read_text(encoding="ascii").splitlines()[0].split(",")
    needs = {need.word for row in tir.parameters.TABLE for need in row.needs}
    stages = {row.stage for row in tir.parameters.TABLE if row.stage}
    for word in (*columns, *needs, *stages):
        assert f"`{word}`" in page or f"`{word}:" in page, f"docs/parameters.md does not explain {word}"


def names_of(group: click.Group) -> list[str]:
    """The commands of a group and of the groups below it, such as ``export c``."""
    return [
        f"{name} {below}".strip()
        for name, command in sorted(group.commands.items())
        for below in (names_of(command) if isinstance(command, click.Group) else ("",))
    ]


@pytest.mark.parametrize("command", names_of(commands))
def test_every_command_is_described(command):
    """Not by the changelog or the page for developers, which may speak of others."""
    pages = [page for page in DOCS.glob("*.md") if page.name not in ("changelog.md", "contributing.md")]
    described = any(re.search(rf"mffit {command}\b", text_of(page)) for page in pages)
    assert described, f"no page of docs/ describes `mffit {command}`; see docs/contributing.md, A command"
    named = re.search(rf"`mffit {command}\b", text_of(ROOT / "README.md"))
    assert named, f"README's table of commands lacks `mffit {command}`"


def test_every_program_that_a_file_can_be_written_for_is_described():
    from tir.targets import TARGETS

    page = text_of(DOCS / "property-files.md")
    missing = [name for name in TARGETS if f"`{name}`" not in page]
    assert not missing, f"docs/property-files.md does not describe {', '.join(missing)}"


def test_what_programs_compute_otherwise_is_computed():
    """The numbers of the page are those of the sample, whatever becomes of either."""
    front = tir.read(ROOT / "samples" / "front-120-70" / "true.tir")
    text = " ".join(text_of(ROOT / "docs" / "property-files.md").split())
    for words in (targets.chrono_in_words(front), targets.mbsim_in_words(front)):
        assert words in text


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
    keys = {key for keys in known_keys(Config).values() for key in keys}
    missing = sorted(key for key in keys if not re.search(KEY.format(key), page))
    assert not missing, f"docs/configuration.md does not describe {', '.join(missing)}"


def test_every_key_of_rig_toml_is_described():
    page = text_of(DOCS / "simulate.md") + text_of(DOCS / "rig-errors.md")
    tables = [
        x
        for x in vars(plan).values()
        if getattr(x, "__module__", "") == plan.__name__ and hasattr(x, "model_fields")
    ]
    keys = {key for table in tables for key in table.model_fields}
    missing = sorted(key for key in keys if not re.search(KEY.format(key), page))
    assert not missing, f"docs/simulate.md does not describe {', '.join(missing)}"


@pytest.fixture
def reader(tmp_path, monkeypatch):
    """A reader's folder: the samples, and the files that pages call front.tir and rear.tir."""
    shutil.copytree(ROOT / "samples", tmp_path / "samples")
    for name, sample in (("front.tir", "front-120-70"), ("rear.tir", "rear-190-55")):
        shutil.copy(ROOT / "samples" / sample / "true.tir", tmp_path / name)
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("MPLBACKEND", "agg")
    return tmp_path


WITH_PYTHON = [page for page in PAGES if any(block.language == "python" for block in blocks(page))]


@pytest.mark.parametrize("page", WITH_PYTHON, ids=name_of)
def test_the_python_of_a_page_runs(page, reader):
    """All blocks of a page in one namespace, in their order, as somebody would who reads it from the top."""
    names: dict[str, object] = {"__name__": "page"}
    for block in blocks(page):
        if block.language == "python" and block.can_run:
            source = "\n" * (block.line - 1) + block.text  # a traceback then names the line of the page
            exec(compile(source, str(page), "exec", dont_inherit=True), names)


def test_every_block_that_is_not_run_says_why():
    unexplained = [
        f"{name_of(page)}:{block.line}"
        for page in PAGES
        for block in blocks(page)
        if block.marker is not None and not block.marker.strip()
    ]
    assert not unexplained, f"<!-- not run: --> without a reason at {', '.join(unexplained)}"


def named_by(words: list[str]) -> tuple[click.Command, list[str]]:
    """The command that the words after ``mffit`` name, and the words that follow it."""
    command: click.Command = commands
    while isinstance(command, click.Group) and words and not words[0].startswith("-"):
        if words[0] not in command.commands:
            raise click.UsageError(f"there is no command {words[0]}")
        command, words = command.commands[words[0]], words[1:]
    return command, words


def wrong_in_command(line: str) -> str | None:
    """What the command line's own parser says against ``mffit ...``, as a sentence; None if it takes it.

    Placeholders such as FILE and N stay what they are; only choices are looked at.
    """
    try:
        command, words = named_by(shlex.split(line, comments=True)[1:])
        context = click.Context(command)
        given, _, _ = command.make_parser(context).parse_args(words)
        for option in command.params:
            if isinstance(option.type, click.Choice) and option.name in given:
                option.type_cast_value(context, given[option.name])
    except click.ClickException as error:
        return f"{line}: {error.format_message()}"
    return None


def commands_on(page: Path) -> list[str]:
    """Every ``mffit ...`` of a page's shell blocks and of its running text."""
    lines = [line for block in blocks(page) if block.language in SHELLS for line in block.text.splitlines()]
    parts = [part.strip() for line in lines for part in line.split("&&")]
    inline = re.findall(r"`(mffit [^`]*)`", FENCE.sub("", text_of(page)))
    calls = [part for part in parts if re.match(r"(\S*/)?mffit ", part)]
    return [call.replace("\\|", "|") for call in (*calls, *inline)]


@pytest.mark.parametrize("page", [page for page in PAGES if page.name != "changelog.md"], ids=name_of)
def test_the_commands_on_a_page_exist_with_their_options(page):
    wrong = [sentence for call in commands_on(page) if (sentence := wrong_in_command(call))]
    assert not wrong, f"{name_of(page)}: {'; '.join(wrong)}"


@pytest.mark.parametrize("page", PAGES, ids=name_of)
def test_the_scripts_that_a_page_runs_are_in_the_repository(page):
    shell = "\n".join(block.text for block in blocks(page) if block.language in SHELLS)
    named = re.findall(r"\bpython3? ((?:docs|tests)/\S+\.py)", shell + "\n" + text_of(page))
    missing = sorted({script for script in named if not (ROOT / script).exists()})
    modules = set(re.findall(r"\bpython3? -m ((?:mffit|tir)[\w.]*)", shell + "\n" + text_of(page)))
    missing += sorted(module for module in modules if find_spec(module) is None)
    assert not missing, f"{name_of(page)} runs {', '.join(missing)}, which is not there"


SAID = re.compile(r"(?:`|<code>)(mffit [a-z][^`<]*)(?:`|</code>)")


def test_the_commands_that_the_program_names_exist_with_their_options():
    """In its messages, pages and docstrings; what is filled in is a placeholder."""
    wrong = []
    for file in sorted(
        path for ending in ("py", "j2", "toml") for path in (ROOT / "mffit").rglob(f"*.{ending}")
    ):
        for said in SAID.findall(
            re.sub(r'"\s*\n\s*f?"', "", text_of(file))
        ):  # a text may go on in the next line
            call = " ".join(re.sub(r"\{+[^{}]*\}+", "X", said).split())
            if sentence := wrong_in_command(call):
                wrong.append(f"{file.relative_to(ROOT)}: {sentence}")
    assert not wrong, "; ".join(wrong)


LOOSE_OPTION = re.compile(r"`(--[\w-]+)[^`]*`")


@pytest.mark.parametrize("page", [page for page in PAGES if page.name != "changelog.md"], ids=name_of)
def test_an_option_by_itself_is_one_of_a_command_that_its_paragraph_names(page):
    """Paragraphs about a script of the tests have its options."""
    wrong = []
    for paragraph in re.split(r"\n\s*\n|\n\| ", FENCE.sub("", text_of(page))):
        calls = [
            shlex.split(call, comments=True)[1:] for call in re.findall(r"`(mffit\s+[a-z][^`]*)`", paragraph)
        ]
        known = set().union({"--help"}, *(options_of(named_by(call)[0]) for call in calls))
        if calls and ".py" not in paragraph:
            wrong += [option for option in LOOSE_OPTION.findall(paragraph) if option not in known]
    assert not wrong, f"{name_of(page)}: no command named there has {', '.join(wrong)}"


def options_of(command: click.Command) -> set[str]:
    """The long options of a command and of those below it."""
    if isinstance(command, click.Group):
        return set().union(*(options_of(below) for below in command.commands.values()))
    return {
        name
        for option in command.params
        for name in (*option.opts, *option.secondary_opts)
        if name[:2] == "--"
    }


def test_every_option_is_described():
    pages = "\n".join(text_of(page) for page in PAGES)
    missing = sorted(option for option in options_of(commands) if not re.search(rf"{option}\b", pages))
    assert not missing, f"no page mentions {', '.join(missing)}"


@pytest.mark.parametrize("page", PAGES, ids=name_of)
def test_toml_on_a_page_has_known_tables_and_keys(page):
    known = known_keys(Config, plan.RigTables)
    unknown = []
    for block in blocks(page):
        if block.language == "toml" and block.can_run:
            for name, table in tomllib.loads(block.text).items():
                if name not in known[""]:
                    unknown.append(f"[{name}]")
                for row in table if isinstance(table, list) else [table]:
                    unknown += [f"{name}.{key}" for key in row if name in known and key not in known[name]]
    assert not unknown, f"{name_of(page)} shows {', '.join(unknown)}, which tyre.toml does not know"


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
