"""``mffit plan``: which further runs would lower an uncertainty most."""

from collections.abc import Collection, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
from threadpoolctl import threadpool_limits

from mffit import as_json, fit, planning
from mffit import config as configuration
from mffit.additions import Addition, PlannedRun, addition_named
from mffit.config import Config
from mffit.csv_tables import write_csv
from mffit.errors import InputError
from mffit.measured import Measured
from mffit.measured.result import AfterFit
from mffit.output import output_folder, refuse_early
from mffit.pipeline.building import build
from mffit.pipeline.inputs import inputs_of, project_of, read_base
from mffit.pipeline.measuring import epsilon_gamma, measure
from mffit.pipeline.refining import spin_of_model, undistorted
from mffit.planning import Goal, NextRun, Plan, next_run, read_goal
from mffit.planning.goals import BANDS, EPSILON, FILE, JOINT
from mffit.planning.plan import U
from mffit.planning.prospect import Direct, DirectProspect, DirectU, Prospect, nominal_load
from mffit.points import Points
from mffit.progress import Progress, silent
from mffit.quantities import column
from mffit.results import BuildResult

WRITTEN = ("plan.json", "plan.html")
SHEETS = "runs"
"""Folder with the sheets to fill in at the rig."""


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
    goal : ``"eps_gamma"`` (direct method), ``"eps_gamma:joint"``, ``"bands"``, ``"bands:Mz"``, ``"file"``, ``"road"`` or the
        name of a coefficient; default the eps_gamma that the file's PECP1 comes from, on a flat track ``"bands"``
    runs : largest number of runs in the list
    without : kinds of runs that this rig cannot make, for example ``"other-side"``
    out : folder to write to; nothing is written if None
    progress : called with a sentence before each step

    Returns
    -------
    Plan
        The list, and the uncertainty after each run, one standard deviation.

    Raises
    ------
    InputError
        The input is wrong, or the goal or a kind of run is unknown.
    """
    config = configuration.load(config)
    aim = _aim(config, goal)  # an unknown goal or kind ends the command before the work begins
    excluded = [addition_named(word) for word in without]
    if out is not None:
        refuse_early(Path(out), WRITTEN, inputs_of(config), project_of(config))
    found = plan_of(build(config, progress=progress), aim, runs=runs, without=excluded, progress=progress)
    if out is not None:
        progress("writing the page")
        write_plan(found, Path(out))
    return found


def plan_of(
    result: BuildResult,
    goal: Goal | None = None,
    *,
    runs: int = 3,
    without: Collection[Addition] = (),
    progress: Progress = silent,
) -> Plan:
    """:func:`plan` for a finished build."""
    direct = _direct_method(result)
    with threadpool_limits(1):  # the matrices are small: threads cost more than they bring
        prospect = Prospect(result.config, result.points, result.measured, result.fit, direct)
        aim = goal or _aim(result.config, None)
        return planning.plan(prospect, aim, most=runs, without=without, progress=progress)


def next_run_of(config: Config, points: Points, measured: Measured) -> NextRun | None:
    """The most informative next run, before a build: for eps_gamma by the direct method, whose readings there the measured
    slopes predict; on a flat track for the file, by a first fit.

    None if no run lowers the uncertainty enough, or if the points cannot determine a first fit yet.
    """
    base, on_disc = read_base(config), config.rig.on_disc
    goal = read_goal(EPSILON if on_disc else FILE, on_disc=on_disc)

    def direct(points: Points) -> DirectU | None:
        found = epsilon_gamma(config, points, base)
        return None if found is None else DirectU(found.u, found.u)

    try:
        if on_disc:
            rig = fit.begin(config, points, measured, base).simulation

            def predicted(run: PlannedRun) -> Points:
                return run.points.replace(**rig.readings(run.points))

            u: U = DirectProspect(points, nominal_load(config, measured), predicted, direct).u
        else:
            found = fit.sketch(config, points, measured, base)
            u = Prospect(config, points, measured, found, direct).u_of(goal)
        return next_run(config, points, goal, u)
    except InputError:
        return None


def _direct_method(result: BuildResult) -> Direct:
    """The direct method as a build runs it, with the bias of finite spin of this build's model."""
    config = result.config
    base, model = read_base(config), undistorted(config, result.fit)

    def direct(points: Points) -> DirectU | None:
        try:
            measured = measure(config, points, base)[1]
        except InputError:
            return None
        if measured.carried is None:
            return None
        spin = spin_of_model(config, points, measured, model, base)
        known = measured if spin is None else measure(config, points, base, AfterFit(spin=spin))[1]
        assert known.carried is not None
        of_fit = known if known.carried.source == "debiased" else measured  # that which the fit holds
        assert of_fit.carried is not None
        return DirectU(stated=known.carried.pecp1.u, held=of_fit.carried.pecp1.u)

    return direct


def _aim(config: Config, goal: str | None) -> Goal:
    """The given goal, else the eps_gamma that determines PECP1, else the bands."""
    disc = config.rig.on_disc
    held = {name for name, entry in config.coefficients.items() if entry.is_held}
    joint = config.spin.pecp1 == "model" and "PECP1" not in held
    usual = (JOINT if joint else EPSILON) if disc else BANDS
    return read_goal(goal or usual, on_disc=disc, held=held)


def write_plan(found: Plan, out: Path) -> None:
    """Write every output of a plan, or nothing: the page, the numbers, and a sheet of set-points per run."""
    from mffit import report

    config = found.config
    with output_folder(out, by="plan", of=project_of(config), protected=inputs_of(config)) as folder:
        as_json.write(folder / "plan.json", found)
        runs = [step.run for step in found.steps]
        if runs:
            (folder / SHEETS).mkdir()
            text = additions(config, runs)
            (folder / SHEETS / "tyre-additions.toml").write_text(text, encoding="utf-8")
        for run in runs:
            table = sheet(config, run.points, run.addition.measures)
            write_csv(table, folder / SHEETS / f"{run.name}.csv")
        report.write_plan(found, folder)


def sheet(config: Config, points: Points, measures: Sequence[str] = ()) -> pd.DataFrame:
    """The set-points of a run in the rig's axes and the columns of sweep files; the readings are empty.

    ``measures`` are channels in addition to Fy and Mz.
    """
    signs = configuration.axis_signs(config)
    angles = {name: np.degrees(getattr(points, name)) * signs[name] + 0.0 for name in ("alpha", "gamma")}
    table = pd.DataFrame({f"{name}_deg": values.round(4) for name, values in angles.items()})
    table["Fz_N"] = (points.Fz * signs["Fz"]).round(1)
    table["p_kPa"], table["V_mps"] = (points.p / 1e3).round(1), points.V
    table["direction"] = np.where(points.direction > 0, "forward", "backward")
    if np.any(points.kappa):
        table.insert(2, "kappa", points.kappa.round(5))
    return table.assign(**{column(channel): "" for channel in ("Fy", "Mz", *measures)})


def additions(config: Config, runs: Sequence[PlannedRun]) -> str:
    """TOML to append to tyre.toml for these runs."""
    usual = configuration.path_curvature(config.rig)
    lines = ["# Append to tyre.toml once the sheets are filled in; the file names are those of this folder."]
    for run in runs:
        lines += ["", f"# {run.title}"]
        lines += ["[[sweep]]", f'file = "{run.name}.csv"', *_place(run.points, usual)]
    return "\n".join(lines) + "\n"


def _place(points: Points, usual: float) -> list[str]:
    """Lines on the mount and the path of points, where they are not usual."""
    lines = []
    phi_t = float(points.phi_t[0])
    if points.mount[0] < 0:
        lines.append('mount = "flipped"')
    if phi_t * usual < 0.0:
        lines.append(f'path_centre = "{"left" if phi_t < 0.0 else "right"}"')
    if not np.isclose(abs(phi_t), abs(usual)):
        lines.append(f"path_radius = {1.0 / abs(phi_t):.4f}")
    return lines
