"""``mffit init``: a commented ``tyre.toml`` with empty CSV files, or a copy of a sample."""

import re
import tomllib
from importlib import resources
from importlib.resources.abc import Traversable
from pathlib import Path

from mffit.errors import InputError
from mffit.output import new_files
from mffit.sweeps.channels import SWEEP_CHANNELS

OFFERED = ("alpha_deg", "gamma_deg", "Fz_N", "Fy_N", "Mz_Nm", "p_kPa", "V_mps", "T_degC")
"""Headings of the templates: the channels that a rig usually reports for a finished point."""
FILL_IN = re.compile(r"^(?:# )?(\w+) = .*# FILL IN", re.MULTILINE)
"""Line of the template with a key that only the user knows."""


def init_project(folder: str | Path) -> list[Path]:
    """Write a project to start from to a new or existing folder; returns the paths, ``tyre.toml`` first.

    Existing files are never touched. Raises InputError if one of the files is there already, or the folder cannot be written
    to.
    """
    folder = Path(folder)
    template = _template()
    names = [entry["file"] for entry in tomllib.loads(template)["sweep"]]
    contents = {"tyre.toml": template} | {name: headings() for name in names}
    return new_files(folder, contents)


def to_fill_in() -> list[str]:
    """The keys of the template that only the user knows; without them nothing is built."""
    return FILL_IN.findall(_template())


def _template() -> str:
    return resources.files("mffit.config").joinpath("template.toml").read_text(encoding="utf-8")


def copy_sample(name: str, folder: str | Path) -> list[Path]:
    """Copy a sample of the package to a folder, as :func:`init_project` does. Raises InputError also if the sample is unknown."""
    if name not in sample_names():
        raise InputError(f"there is no sample {name!r}; choose one of {', '.join(sample_names())}")
    files = [entry for entry in _samples().joinpath(name).iterdir() if entry.is_file()]
    files.sort(key=lambda file: (file.name != "tyre.toml", file.name))
    return new_files(Path(folder), {file.name: file.read_bytes() for file in files})


def sample_names() -> list[str]:
    """The samples of the package: folders that hold a ``tyre.toml``."""
    return sorted(entry.name for entry in _samples().iterdir() if entry.joinpath("tyre.toml").is_file())


def _samples() -> Traversable:
    """The folder of the samples: inside an installed package, next to the package in a source tree."""
    installed = resources.files("mffit").joinpath("samples")
    return installed if installed.is_dir() else Path(__file__).parents[1] / "samples"


def headings() -> str:
    """The line of headings of an empty sweep file."""
    offered = [channel.name for channel in SWEEP_CHANNELS if channel.required or channel.name in OFFERED]
    return ",".join(offered) + "\n"
