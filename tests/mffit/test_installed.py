"""What `import mffit` says where two distributions own the package tir."""

from __future__ import annotations

import hashlib
import shutil
import subprocess
import sys
import zipfile
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]


def started(folder: Path, *arguments: str) -> subprocess.CompletedProcess[str]:
    """What Python says in a folder like that of installed packages, which nothing but the standard library is beside."""
    command = [
        sys.executable,
        "-I",
        "-S",
        "-c",
        f"import sys; sys.path.insert(0, {str(folder)!r}); {arguments[0]}",
    ]
    return subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)


def imported(folder: Path) -> str:
    """What Python says on importing mffit."""
    return started(folder, "import mffit").stderr


@pytest.fixture
def site(tmp_path) -> Path:
    for name in ("mffit", "tir"):
        (tmp_path / name).mkdir()
        shutil.copy(ROOT / name / "__init__.py", tmp_path / name)
    return tmp_path


def test_mffit_alone_says_nothing(site):
    (site / "mffit-0.2.0.dist-info").mkdir()
    assert imported(site) == ""


@pytest.mark.parametrize("other", ["mffit-tir", "tir"])
def test_both_distributions_are_pointed_out(site, other):
    (site / f"{other.replace('-', '_')}-0.2.0.dist-info").mkdir()
    assert (
        f"removing one breaks the other: pip uninstall {other}, then pip install --force-reinstall"
        in imported(site)
    )


@pytest.mark.parametrize("folder_stays", [True, False])
def test_a_removed_tir_is_one_sentence_with_the_remedy(site, folder_stays):
    (site / "tir" / "__init__.py").unlink()
    if not folder_stays:
        (site / "tir").rmdir()
    last = imported(site).splitlines()[-1]
    assert last.startswith("ImportError: the package tir is missing")
    assert last.endswith("pip install --force-reinstall --no-deps mffit")


@pytest.mark.parametrize("where", ["in our place", "elsewhere"])
def test_a_tir_of_another_project_is_one_sentence_and_never_run(site, tmp_path_factory, where):
    """In Python, and on the command line, in both ways to start it, without a traceback and with exit code 2."""
    replaced = where == "in our place"
    folder = site if replaced else tmp_path_factory.mktemp("work")
    other = folder / "tir" / "__init__.py" if replaced else folder / "tir.py"
    other.write_text("raise SystemExit('run')", encoding="utf-8")
    path = f"sys.path.insert(0, {str(folder)!r}); "
    remedy = "pip uninstall tir, then pip install" if replaced else "rename it, or start in another folder"
    assert (
        f"ImportError: {other} is not the tir that mffit needs, but has its name: {remedy}"
        in started(site, f"{path}import mffit").stderr
    )
    for argument in ("-m", "/somewhere/bin/mffit", "mffit.exe"):
        done = started(site, f"{path}sys.argv = [{argument!r}]; import mffit")
        assert (done.returncode, done.stderr.count("\n")) == (2, 1)
        assert done.stderr.startswith(f"mffit: {other} is not the tir")


SAID = "from mffit.made import source; print(source())"


def digest_of(place: Path) -> str:
    """The digest that the program states of its files in a folder or an archive."""
    command = [sys.executable, "-c", f"import sys; sys.path.insert(0, {str(place)!r}); {SAID}"]
    return subprocess.run(command, cwd="/", capture_output=True, text=True, check=True).stdout.strip()


def test_the_digest_of_the_source_is_that_of_its_files_wherever_they_are(tmp_path):
    """Of all files but those that a wheel lacks; in a folder with other things, and in a ZIP archive."""
    beside = {"mffit/README.md", "tir/README.md", "tir/LICENSE", "tir/pyproject.toml"}
    files = [path for name in ("mffit", "tir") for path in (ROOT / name).rglob("*") if path.is_file()]
    names = sorted({path.relative_to(ROOT).as_posix() for path in files if path.suffix != ".pyc"} - beside)
    stated = hashlib.sha256()
    with zipfile.ZipFile(tmp_path / "packed.zip", "w") as archive:
        for name in names:
            content = (ROOT / name).read_bytes()
            if not name.endswith("py.typed"):
                stated.update(f"{name} {hashlib.sha256(content).hexdigest()}\n".encode())
            (tmp_path / "wheel" / name).parent.mkdir(parents=True, exist_ok=True)
            (tmp_path / "wheel" / name).write_bytes(content)
            archive.writestr(name, content)
    shutil.copytree(ROOT / "samples", tmp_path / "wheel" / "mffit" / "samples")
    (tmp_path / "wheel" / "tir" / "notes.txt").write_text("of a user")
    places = [ROOT, tmp_path / "packed.zip", tmp_path / "wheel"]
    assert [digest_of(place) for place in places] == 3 * [stated.hexdigest()]
    with (tmp_path / "wheel" / "tir" / "parameters.csv").open("a") as table:
        table.write("\n")
    assert digest_of(tmp_path / "wheel") != stated.hexdigest()
