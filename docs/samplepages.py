"""Sphinx extension: the report, the diagnosis and the page of curves of every sample, made with the site.

``sphinx-build`` builds each sample once, in as many processes as there are cores, and not again until the program or the sample
changes; with ``-D sample_pages=NAME`` this sample only. A diagnosis is of the true tyre of the sample on its faulty rig, so that
it has something to find.
"""

from __future__ import annotations

import hashlib
import os
import shutil
import tomllib
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import mffit
from mffit.made import made
from mffit.viewer import project_page

SAMPLES = Path(__file__).parents[1] / "samples"
NAMES = tuple(sorted(path.parent.name for path in SAMPLES.glob("*/rig.toml")))

FOLDER = "shown"


def write(name: str, folder: Path) -> None:
    """The pages of a sample into a folder; nothing if they are those of this program and sample already."""
    os.chdir(SAMPLES / name)  # so that a page names its files as a user would
    true = tomllib.loads(Path("rig.toml").read_text(encoding="utf-8"))["truth"]["tyre"]
    digest = hashlib.sha256(made().source.encode())
    for path in (*sorted(path for path in Path().iterdir() if path.is_file()), Path(true)):
        digest.update(path.read_bytes())
    stamp = folder / "source.txt"
    if stamp.is_file() and stamp.read_text(encoding="utf-8") == digest.hexdigest():
        return
    folder.mkdir(parents=True, exist_ok=True)
    with TemporaryDirectory() as scratch:
        built, diagnosed = Path(scratch) / "build", Path(scratch) / "diagnosis"
        result = mffit.build("tyre.toml", built)
        mffit.diagnose("tyre.toml", true, out=diagnosed)
        shutil.copy(built / "report.html", folder)
        shutil.copy(diagnosed / "diagnosis.html", folder)
    (folder / "show.html").write_text(project_page(result).html, encoding="utf-8")
    stamp.write_text(digest.hexdigest(), encoding="utf-8")


def write_all(app: Any, exception: Exception | None) -> None:
    """The pages of all samples beside the site, once it is written."""
    if exception is not None or app.builder.format != "html":
        return
    names = app.config.sample_pages
    folders = [Path(app.outdir).resolve() / FOLDER / name for name in names]
    with ProcessPoolExecutor(min(len(names), os.cpu_count() or 1)) as pool:
        list(pool.map(write, names, folders))


def setup(app: Any) -> dict[str, Any]:
    app.add_config_value("sample_pages", list(NAMES), "")
    app.connect("build-finished", write_all)
    return {"parallel_read_safe": True}
