"""``mffit simulate``: from rig.toml to a folder of sweeps."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import tir
from mffit.output import output_folder
from mffit.virtual_rig.campaign import run
from mffit.virtual_rig.loading import load_plan
from mffit.virtual_rig.plan import RigPlan
from mffit.virtual_rig.truth import Truth
from mffit.virtual_rig.writing import TRUTH, write


def simulate(
    plan: RigPlan | Mapping[str, Any] | str | Path, out: str | Path, seed: int | None = None
) -> Truth:
    """Run a virtual test campaign and write what a rig would hand over.

    Parameters
    ----------
    plan : path of a ``rig.toml``, its content, or a loaded plan
    out : folder for the sweeps, ``tyre.toml`` and ``truth.json``
    seed : of the noise and the drawn faults; default the plan's

    Returns
    -------
    Truth
        What the data were made from, as written to ``truth.json``.

    Raises
    ------
    InputError, tir.errors.TirError
        The plan or the tyre's file is wrong, or a file in ``out`` is not one that an earlier run wrote;
        nothing is written then.
    """
    read = [Path(plan)] if isinstance(plan, str | Path) else []
    plan = plan if isinstance(plan, RigPlan) else load_plan(plan)
    read += [path for path in (plan.tyre_path, plan.declared.base_path) if path is not None]
    campaign = run(plan, tir.read(plan.tyre_path), seed)
    with output_folder(Path(out), by="simulate", protected=read, record=TRUTH) as folder:
        write(campaign, plan, folder)
    return campaign.truth
