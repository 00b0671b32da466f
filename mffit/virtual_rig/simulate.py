"""``mffit simulate``: writes a folder of sweeps, which ``mffit build`` reads, from rig.toml."""

import gzip
import json
import shutil
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import tir
from mffit.config.toml_file import toml_text
from mffit.csv_tables import csv_text
from mffit.output import output_folder
from mffit.virtual_rig.campaign import run
from mffit.virtual_rig.loading import load_plan
from mffit.virtual_rig.plan import RigPlan
from mffit.virtual_rig.truth import Truth


def simulate(
    plan: RigPlan | Mapping[str, Any] | str | Path, out: str | Path, seed: int | None = None
) -> Truth:
    """Write the files of a virtual test campaign and return the truth behind them.

    Parameters
    ----------
    plan : path of a ``rig.toml``, its content, or a loaded plan
    out : folder for the sweeps, ``tyre.toml`` and ``truth.json``
    seed : seed of the noise and the drawn rig errors; default the plan's

    Returns
    -------
    Truth
        The true values behind the data, as in ``truth.json``.

    Raises
    ------
    InputError, tir.errors.TirError
        The plan or the tyre's file is wrong, or ``out`` has a file that no earlier run wrote; then nothing is written.
    """
    read = [Path(plan)] if isinstance(plan, str | Path) else []
    plan = plan if isinstance(plan, RigPlan) else load_plan(plan)
    read += [path for path in (plan.tyre_path, plan.declared.base_path) if path is not None]
    campaign = run(plan, tir.read(plan.tyre_path), seed)
    with output_folder(Path(out), by="simulate", protected=read) as folder:
        for name, table in campaign.tables.items():
            text = csv_text(table).encode()  # equal tables make equal files, packed or not
            (folder / name).write_bytes(gzip.compress(text, mtime=0) if name.endswith(".gz") else text)
        (folder / "tyre.toml").write_text(configuration_text(campaign.configuration), encoding="utf-8")
        truth = json.dumps(campaign.truth.to_json(), indent=2, allow_nan=False)
        (folder / TRUTH).write_text(truth + "\n", encoding="utf-8")
        if plan.declared.base_path is not None:
            shutil.copyfile(plan.declared.base_path, folder / plan.declared.base_path.name)
    return campaign.truth


TRUTH = "truth.json"
"""Name of the file with the true values behind the data."""


def configuration_text(configuration: Mapping[str, Any]) -> str:
    """The text of tyre.toml."""
    head = "# Written by `mffit simulate`; truth.json holds the true values behind these data.\n"
    return f"{head}\n{toml_text(configuration)}"
