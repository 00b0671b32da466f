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


def imported(folder: Path) -> str:
    """What Python says on importing mffit from a folder like that of installed packages."""
    command = [
        sys.executable,
        "-I",
        "-S",
        "-c",
        f"import sys; sys.path[:] = [{str(folder)!r}, *sys.path]; import mffit",
    ]
    return subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False).stderr


@pytest.fixture
def site(tmp_path) -> Path:
    for name in ("mffit", "tir"):
        (tmp_path / name).mkdir()
        (tmp_path / name / "__init__.py").write_bytes(
            (ROOT / name / "__init__.py").read_bytes() * (name == "mffit")
        )
    return tmp_path


def test_mffit_alone_says_nothing(site):
    (site / "mffit-0.2.0.dist-info").mkdir()
    assert imported(site) == ""


def test_both_distributions_are_pointed_out(site):
    (site / "mffit_tir-0.2.0.dist-info").mkdir()
    assert (
        "removing one breaks the other: pip uninstall mffit-tir, then pip install --force-reinstall"
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
