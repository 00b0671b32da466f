"""Writes a campaign into a folder that ``mffit build`` takes."""

from __future__ import annotations

import gzip
import json
import shutil
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import pandas as pd
import tomli_w

from mffit.virtual_rig.campaign import Campaign
from mffit.virtual_rig.plan import RigPlan

TRUTH = "truth.json"
"""What is true behind the data; also lists the files of the campaign, so that a later run knows them."""


def write(campaign: Campaign, plan: RigPlan, folder: Path) -> None:
    """Write sweeps, ``tyre.toml``, ``truth.json`` and a copy of the base file into an existing folder."""
    for name, table in campaign.tables.items():
        write_table(table, folder / name)
    (folder / "tyre.toml").write_text(configuration_text(campaign.configuration), encoding="utf-8")
    truth = json.dumps(campaign.truth.to_json(), indent=2, allow_nan=False)
    (folder / TRUTH).write_text(truth + "\n", encoding="utf-8")
    base = plan.declared.base_path
    if base is not None:
        shutil.copyfile(base, folder / base.name)


def configuration_text(configuration: Mapping[str, Any]) -> str:
    """The text of tyre.toml; a list becomes one ``[[table]]`` per entry, as a person would write it."""
    parts = ["# Made by `mffit simulate`; what is true behind these data stands in truth.json.\n"]
    for name, content in configuration.items():
        if isinstance(content, list | tuple):
            parts += [f"[[{name}]]\n{tomli_w.dumps(entry)}" for entry in content]
        else:
            parts.append(tomli_w.dumps({name: content}))
    return "\n".join(parts)


def write_table(table: pd.DataFrame, path: Path) -> None:
    """Write a table as CSV, compressed if the name ends in .gz; equal tables make equal files."""
    text = table.to_csv(index=False, lineterminator="\n").encode()
    path.write_bytes(gzip.compress(text, mtime=0) if path.suffix == ".gz" else text)
