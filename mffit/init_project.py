"""``mffit init``: a commented ``tyre.toml`` and CSV files with nothing but headings."""

from __future__ import annotations

import tomllib
from importlib import resources
from pathlib import Path

from mffit.output import new_files
from mffit.sweeps.channels import CHANNELS

OFFERED = ("alpha_deg", "gamma_deg", "Fz_N", "Fy_N", "Mz_Nm", "p_kPa", "V_mps", "T_degC")
"""Headings of the templates: what a rig usually knows of a finished point."""


def init_project(folder: str | Path) -> list[Path]:
    """Write a project to start from; existing files are never touched.

    Parameters
    ----------
    folder : created if need be

    Returns
    -------
    list of Path
        The files written, ``tyre.toml`` first.

    Raises
    ------
    InputError
        One of the files is there already, or the folder cannot be written to.
    """
    folder = Path(folder)
    template = resources.files("mffit.config").joinpath("template.toml").read_text(encoding="utf-8")
    names = [entry["file"] for entry in tomllib.loads(template)["sweep"]]
    contents = {"tyre.toml": template} | {name: headings() for name in names}
    return new_files(folder, contents)


def headings() -> str:
    """The line of headings of an empty sweep file."""
    offered = [channel.name for channel in CHANNELS if channel.required or channel.name in OFFERED]
    return ",".join(offered) + "\n"
