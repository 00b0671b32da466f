"""``mffit plan``: which further runs would lower an uncertainty most."""

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
from mffit.csv_tables import write_csv
from mffit.errors import InputError
from mffit.output import output_folder, refuse_early
from mffit.pipeline.building import build
from mffit.pipeline.inputs import inputs_of, read_base
from mffit.pipeline.measuring import measure
from mffit.pipeline.refining import finite_spin_bias, undistorted
from mffit.planning import Addition, Goal, Plan, PlannedRun, addition_named, read_goal, wording
from mffit.planning.apart import sample_noise
from mffit.planning.goals import BANDS, EPSILON, JOINT
from mffit.planning.outlook import Direct, DirectU
from mffit.points import Points
from mffit.progress import Progress, silent
from mffit.quantities import CHANNELS, column
from mffit.results import BuildResult, as_json

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
    goal : ``"eps_gamma"`` (direct method), ``"eps_gamma:joint"``, ``"bands"``, ``"bands:Mz"``, ``"tie:ply-steer"`` or the name of
        a coefficient; default the eps_gamma that the file's PECP1 comes from, on a flat track ``"bands"``
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
        refuse_early(Path(out), WRITTEN, inputs_of(config))
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
    config = result.config
    with threadpool_limits(1):  # the matrices are small: threads cost more than they bring
        return search.plan(
            config,
            result.points,
            result.measured,
            result.fit,
            goal or _aim(config, None),
            _direct_method(result),
            most=runs,
            without=without,
            progress=progress,
        )


def _direct_method(result: BuildResult) -> Direct:
    """The direct method as a build runs it, with the bias of finite spin of this build's model."""
    base, model = read_base(result.config), undistorted(result.config, result.fit)

    def direct(config: Config, points: Points) -> DirectU | None:
        try:
            _, measured = measure(config, points, base)
        except InputError:
            return None
        raw = measured.epsilon_gamma
        if raw is None:
            return None
        bias = finite_spin_bias(config, points, model, base)
        if bias is None:
            return DirectU(stated=raw.u, held=raw.u)
        measured = measured.debiased(bias)
        assert measured.epsilon_gamma is not None
        assert measured.epsilon_gamma_debiased is not None
        if config.spin.pecp1 == "debiased":
            u = measured.epsilon_gamma_debiased.u
            return DirectU(stated=u, held=u)
        return DirectU(stated=measured.epsilon_gamma.u, held=raw.u)

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

    with output_folder(out, by="plan", protected=inputs_of(found.config)) as folder:
        as_json.write(folder / "plan.json", as_json.plan(found))
        runs = [step.run for step in found.steps]
        if runs:
            (folder / SHEETS).mkdir()
            texts = {"tyre-additions.toml": additions, "rig-additions.toml": simulated}
            for name, text in texts.items():
                (folder / SHEETS / name).write_text(text(found.config, runs), encoding="utf-8")
        for run in runs:
            if run.points is not None:
                table = sheet(found.config, run.points, run.addition.measures)
                write_csv(table, folder / SHEETS / f"{run.name}.csv")
        report.write_plan(found, folder)


def sheet(config: Config, points: Points, measures: Sequence[str] = ()) -> pd.DataFrame:
    """The set-points of a run in the rig's axes and the columns of sweep files; the readings are empty.

    ``measures`` are channels beside Fy and Mz.
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
    """TOML to append to tyre.toml for these runs; changes to tables that it already has are comments."""
    usual = configuration.path_curvature(config.rig)
    lines = [
        "# Append to tyre.toml once the sheets are filled in; the file names are those of this folder."
        if any(run.points is not None for run in runs)
        else "# Change in tyre.toml once this has been measured."
    ]
    for run in runs:
        lines += ["", f"# {wording.title(run)}", *wording.instructions(run)]
        if run.points is not None:
            lines += _sweep_table(f"{run.name}.csv", run.points, usual)
    return "\n".join(lines) + "\n"


def simulated(config: Config, runs: Sequence[PlannedRun]) -> str:
    """TOML to append to the rig.toml of `mffit simulate`, which then makes these runs."""
    signs = configuration.axis_signs(config)
    lines = ["# Append to rig.toml: mffit simulate makes these runs."]
    for run in runs:
        if run.points is None:
            continue
        for number, part in enumerate(_grids(run.points), 1):
            several, steps = f"-{number}" if number > 1 else "", run.addition.steps
            lines += ["", "[[sweep]]", f'file = "{run.name}{several}.csv"']
            lines += [f"load_N = {_listed(part.Fz)}", f"p_kPa = {_listed(part.p / 1e3)}"]
            lines += [
                f"alpha_deg = {_listed(signs['alpha'] * np.degrees(part.alpha), ordered=steps == 'alpha')}"
            ]
            lines += [f"gamma_deg = {_listed(signs['gamma'] * np.degrees(part.gamma))}"]
            lines += [
                f"kappa = {_listed(part.kappa, ordered=steps == 'kappa')}",
                f"V_mps = {_listed(part.V)}",
            ]
            lines += ['direction = "backward"'] if part.direction[0] < 0 else []
            lines += _place(part, configuration.path_curvature(config.rig))
            lines += ["free_rolling = true"] if run.addition.rolling else []
            lines += [_recorded(part)] if steps else []
    return "\n".join(lines) + "\n"


def _recorded(points: Points) -> str:
    """How a simulated run of steps is recorded; samples scatter more than the points of the project, which are means."""
    rate, hold, correlation = (
        search.constants.PLAN_STEP_RATE, search.constants.PLAN_STEP_HOLD, search.constants.PLAN_STEP_CORRELATION
    )  # fmt: skip
    keys = {
        "rate_Hz": rate, "hold_s": hold, "correlation_s": correlation, "steering_deg_per_s": 50.0, "slip_per_s": 0.5
    }  # fmt: skip
    for channel in CHANNELS:
        u = float(points.u(channel)[0])
        if channel == "Fx" and not np.isfinite(u):  # not measured yet: as the side force
            u = float(points.u_Fy[0])
        if np.isfinite(u):
            keys[f"noise_{column(channel)}"] = sample_noise(u)
    return f"recording = {{ {', '.join(f'{key} = {x:.3g}' for key, x in keys.items())} }}"


def _grids(points: Points) -> list[Points]:
    """The points in parts that vary one condition, or all combinations of load and pressure."""
    held = np.column_stack(
        [
            points.direction,
            points.gamma != 0.0,
            np.sign(points.gamma),
            np.where(points.kappa.any(), np.sign(points.alpha), 0),
        ]
    )
    if np.ptp(points.gamma) and not np.ptp(points.alpha):
        held = held[:, :1]  # a camber sweep
    _, part = np.unique(held, axis=0, return_inverse=True)
    part = part.ravel()
    return [points.select(part == k) for k in dict.fromkeys(part.tolist())]


def _listed(values: np.ndarray, *, ordered: bool = False) -> str:
    """Different values of a condition as a TOML list, in ascending order or as they are."""
    rounded = np.round(values, 6) + 0.0
    kept = rounded if ordered else np.unique(rounded)
    return f"[{', '.join(f'{x:g}' for x in kept.tolist())}]"


def _sweep_table(file: str, points: Points, usual: float) -> list[str]:
    """Lines of the [[sweep]] table of a run, with the path where it is not the ``usual`` curvature [1/m]."""
    lines = ["[[sweep]]", f'file = "{file}"']
    return lines + _place(points, usual)


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
