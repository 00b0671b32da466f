"""``mffit plan``: which further runs would tell most."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
from threadpoolctl import threadpool_limits

import mffit.planning as search
from mffit import config as configuration
from mffit.config import Config
from mffit.errors import InputError
from mffit.output import output_folder, refuse_early
from mffit.pipeline.building import build, finite_spin_bias, undistorted
from mffit.pipeline.inputs import inputs_of, read_base
from mffit.pipeline.measuring import measure
from mffit.planning import Goal, Kind, Plan, Run, read_goal, wording
from mffit.planning.goals import BANDS, EPSILON, JOINT
from mffit.planning.search import DirectU
from mffit.points import Points
from mffit.progress import Progress, silent
from mffit.results import BuildResult, as_json

WRITTEN = ("plan.json", "plan.html")
SHEETS = "runs"
"""Folder of the sheets to fill in at the rig."""


def plan(
    config: Config | Mapping[str, Any] | str | Path,
    goal: str | None = None,
    *,
    runs: int = 3,
    without: Collection[str] = (),
    out: str | Path | None = None,
    progress: Progress = silent,
) -> Plan:
    """What the sweeps identify, and the shortest list of further runs towards a goal.

    Parameters
    ----------
    config : path of a ``tyre.toml``, its content, or a loaded Config
    goal : ``"eps_gamma"`` (direct method), ``"eps_gamma:joint"``, ``"bands"``, ``"bands:Mz"``, ``"tie:ply-steer"`` or the name of
        a coefficient; default the eps_gamma that the file's PECP1 comes from, on a flat track ``"bands"``
    runs : length of the list at most
    without : kinds of runs that this rig cannot make, such as ``"other-side"``
    out : folder to write to; nothing is written if None
    progress : called with a sentence before each step

    Returns
    -------
    Plan
        What every run leaves uncertain, one standard deviation.

    Raises
    ------
    InputError
        On bad input, and if the goal or a kind of run is not known.
    """
    config = configuration.load(config)
    aim = _aim(config, goal)  # a goal that is not known ends the run before the work begins
    kinds = [_kind(word) for word in without]
    if out is not None:
        refuse_early(Path(out), WRITTEN, inputs_of(config))
    found = plan_of(build(config, progress=progress), aim, runs=runs, without=kinds, progress=progress)
    if out is not None:
        progress("writing the page")
        write_plan(found, Path(out))
    return found


def plan_of(
    result: BuildResult,
    goal: Goal | None = None,
    *,
    runs: int = 3,
    without: Collection[Kind] = (),
    progress: Progress = silent,
) -> Plan:
    """:func:`plan` for a build that has been made."""
    config, base = result.config, read_base(result.config)
    of_spin = undistorted(config, result.fit)

    def direct(declared: Config, points: Points) -> DirectU | None:
        try:
            _, raw = measure(declared, points, base)
        except InputError:
            return None
        if raw.epsilon_gamma is None:
            return None
        bias = finite_spin_bias(declared, points, of_spin, base)
        if bias is None:
            return DirectU(raw.epsilon_gamma.u, raw.epsilon_gamma.u)
        whole = raw.debiased(bias)
        assert whole.epsilon_gamma is not None
        assert whole.epsilon_gamma_debiased is not None
        debiased = whole.epsilon_gamma_debiased.u
        if declared.spin.pecp1 == "debiased":
            return DirectU(debiased, debiased)
        return DirectU(whole.epsilon_gamma.u, raw.epsilon_gamma.u)

    with threadpool_limits(1):  # the matrices are small: threads cost more than they bring
        return search.plan(
            config,
            result.points,
            result.measured,
            result.fit,
            goal or _aim(config, None),
            direct,
            most=runs,
            without=without,
            progress=progress,
        )


def _aim(config: Config, goal: str | None) -> Goal:
    """The goal as given, else what the file's PECP1 comes from, else the bands."""
    disc = config.rig.on_disc
    usual = (JOINT if config.spin.pecp1 == "model" else EPSILON) if disc else BANDS
    return read_goal(goal or usual, on_disc=disc)


def _kind(word: str) -> Kind:
    try:
        return Kind(word)
    except ValueError:
        known = ", ".join(kind.value for kind in Kind)
        raise InputError(f'"{word}" is no kind of run; known are {known}') from None


def write_plan(found: Plan, out: Path) -> None:
    """Write every output of a plan, or nothing: page, numbers, and a sheet of set-points for every run."""
    from mffit import report

    with output_folder(out, by="plan", protected=inputs_of(found.config)) as folder:
        as_json.write(folder / "plan.json", as_json.plan(found))
        runs = [step.run for step in found.steps]
        if runs:
            (folder / SHEETS).mkdir()
            (folder / SHEETS / "tyre-additions.toml").write_text(
                additions(found.config, runs), encoding="utf-8"
            )
        for run in runs:
            if run.points is not None:
                sheet(found.config, run.points).to_csv(folder / SHEETS / f"{run.name}.csv", index=False)
        report.write_plan(found, folder)


def sheet(config: Config, points: Points) -> pd.DataFrame:
    """The set-points of a run in the rig's axes and the contract's columns; the readings are left to fill in."""
    signs = configuration.axis_signs(config)
    angles = {name: np.degrees(getattr(points, name)) * signs[name] + 0.0 for name in ("alpha", "gamma")}
    table = pd.DataFrame({f"{name}_deg": values.round(4) for name, values in angles.items()})
    table["Fz_N"] = (points.Fz * signs["Fz"]).round(1)
    table["p_kPa"], table["V_mps"] = (points.p / 1e3).round(1), points.V
    table["direction"] = np.where(points.direction > 0, "forward", "backward")
    return table.assign(Fy_N="", Mz_Nm="")


def additions(config: Config, runs: Sequence[Run]) -> str:
    """What tyre.toml gains by the runs, as TOML that can stand behind it; what changes in a table it has is a comment."""
    usual = configuration.path_curvature(config.rig)
    lines = [
        "# Copy to tyre.toml once the sheets are filled in; the files are named as in this folder."
        if any(run.points is not None for run in runs)
        else "# What changes in tyre.toml once this has been measured."
    ]
    for run in runs:
        lines += ["", f"# {wording.title(run)}", *wording.instructions(run)]
        if run.points is None:
            continue
        lines += ["[[sweep]]", f'file = "{run.name}.csv"']
        phi_t = float(run.points.phi_t[0])
        if run.points.mount[0] < 0:
            lines.append('mount = "flipped"')
        if phi_t * usual < 0.0:
            lines.append(f'path_centre = "{"left" if phi_t < 0.0 else "right"}"')
        if not np.isclose(abs(phi_t), abs(usual)):
            lines.append(f"path_radius = {1.0 / abs(phi_t):.4f}")
    return "\n".join(lines) + "\n"
