"""python .ci/contents.py DIST FILES: what the built distributions in DIST contain, against the list FILES of the tree's files.

Source distributions have every file of the tree or of tir; wheels have the packages and the samples, and nothing else.
"""

from __future__ import annotations

import sys
import tarfile
import zipfile
from pathlib import Path

ADDED = {"PKG-INFO", ".gitignore"}
"""By the build, to source distributions."""
NOT_IN_WHEELS = {"mffit/README.md", "tir/README.md", "tir/LICENSE", "tir/pyproject.toml"}


def of_wheel(path: Path) -> set[str]:
    """Names but those of the description, which must have the licence."""
    names = set(zipfile.ZipFile(path).namelist())
    about = {name for name in names if ".dist-info/" in name}
    if not any(name.endswith(".dist-info/licenses/LICENSE") for name in about):
        raise SystemExit(f"{path.name} has no licence")
    return names - about


def of_source(path: Path) -> set[str]:
    """Names below the only folder, but those of :data:`ADDED`."""
    with tarfile.open(path) as archive:
        return {name.partition("/")[2] for name in archive.getnames()} - ADDED


if __name__ == "__main__":
    dist, tree = Path(sys.argv[1]), set(Path(sys.argv[2]).read_text(encoding="utf-8").splitlines())
    tir = {name for name in tree if name.startswith("tir/")}
    packages = {name for name in tree if name.startswith(("mffit/", "tir/"))} - NOT_IN_WHEELS
    samples = {f"mffit/{name}" for name in tree if name.startswith("samples/")}
    wanted = {
        "mffit-*.tar.gz": (of_source, tree - ADDED),
        "mffit-*.whl": (of_wheel, packages | samples),
        "mffit_tir-*.tar.gz": (of_source, {name.removeprefix("tir/") for name in tir}),
        "mffit_tir-*.whl": (of_wheel, tir - NOT_IN_WHEELS),
    }
    for pattern, (names_of, names) in wanted.items():
        (path,) = dist.glob(pattern)
        found = names_of(path)
        print(f"{path.name}: {len(found)} files, {path.stat().st_size / 1e6:.1f} MB")
        if found != names:
            raise SystemExit(f"too few: {sorted(names - found)[:5]}; too many: {sorted(found - names)[:5]}")
