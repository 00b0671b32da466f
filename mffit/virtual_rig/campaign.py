"""A whole virtual test campaign: from the plan to tables, tyre.toml and truth, in memory."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import pandas as pd

from mffit.errors import InputError
from mffit.rig_errors import Faults
from mffit.virtual_rig.faults import drawn, given
from mffit.virtual_rig.machine import Channels, Machine, steady
from mffit.virtual_rig.plan import NoiseTable, RigPlan, SweepPlan
from mffit.virtual_rig.recording import record
from mffit.virtual_rig.revolution import written_down
from mffit.virtual_rig.settings import Settings, settings_of, usual_speed
from mffit.virtual_rig.tables import point_table, recorded_table
from mffit.virtual_rig.truth import DirectTruth, Truth, coefficients_of, direct_truth
from tir import Tyre

LEADING = ("tyre", "rig", "rolling_radius")
"""Tables that come first in tyre.toml."""


@dataclass(frozen=True, slots=True)
class Campaign:
    """The output of the virtual rig."""

    tables: dict[str, pd.DataFrame]  #: one per sweep by file name, in the rig's axes and the contract's units
    configuration: dict[str, Any]  #: the content of tyre.toml
    truth: Truth


def run(plan: RigPlan, tyre: Tyre, seed: int | None = None) -> Campaign:
    """Test a tyre on the virtual rig.

    Parameters
    ----------
    plan : the sweeps and the rig errors
    tyre : the true tyre
    seed : of the noise and the drawn rig errors; default the plan's

    Returns
    -------
    Campaign
        The same plan, tyre and seed give the same numbers.
    """
    seed = plan.tables.seed if seed is None else seed
    if seed < 0:
        raise InputError(f"the seed is {seed}; give a whole number, 0 or larger")
    # Every sweep has random numbers of its own, so that one more sweep does not change the others.
    for_faults, for_radii, *for_sweeps = np.random.SeedSequence(seed).spawn(2 + len(plan.tables.sweep))
    faults = faults_of(plan, tyre, np.random.default_rng(for_faults))
    sweeps = settings_of(plan)
    machine = Machine(tyre, faults, plan.phi_t_sign, usual_speed(sweeps))
    tables = {
        sweep.file: sweep_table(plan, machine, sweep, settings, np.random.default_rng(stream))
        for sweep, settings, stream in zip(plan.tables.sweep, sweeps, for_sweeps, strict=True)
    }
    truth = truth_of(plan, machine, seed)
    return Campaign(tables, configuration_of(plan, machine, np.random.default_rng(for_radii)), truth)


def faults_of(plan: RigPlan, tyre: Tyre, generator: np.random.Generator) -> Faults:
    """The rig errors of the plan; with ``draw``, declared errors that it does not give are drawn."""
    table, rig = plan.tables.faults, plan.declared.rig
    values = table.values()
    if rig.radius is None and "path_radius_m" in values:
        raise InputError("a flat track has no path radius; remove it", key="faults.path_radius_m")
    if not table.draw:
        return given(rig, values)
    nominal = plan.declared.tyre.nominal_load
    C_alpha = float(tyre.state(nominal, Vx=plan.tables.conditions.V_mps).K_ya)
    return drawn(rig, values, C_alpha, generator)


def sweep_table(
    plan: RigPlan, machine: Machine, sweep: SweepPlan, settings: Settings, generator: np.random.Generator
) -> pd.DataFrame:
    """Run one sweep, as finished points or as a recording."""
    machine = machine.with_faults(sweep.faults.values())
    if sweep.recording is not None:
        return recorded_table(plan, record(machine, settings, sweep.recording, generator))
    return point_table(plan, settings, scattered(steady(machine, settings), plan.tables.noise, generator))


def scattered(forces: Channels, noise: NoiseTable, generator: np.random.Generator) -> Channels:
    """Finished points with noise."""
    Fy, Mz, My = generator.standard_normal((3, len(forces.Fy)))
    return forces._replace(
        Fy=forces.Fy + noise.Fy_N * Fy,
        Mz=forces.Mz + noise.Mz_Nm * Mz,
        My=forces.My + (noise.My_Nm or 0.0) * My,
    )


def truth_of(plan: RigPlan, machine: Machine, seed: int) -> Truth:
    """The true values at the loads of the campaign and at the nominal load."""
    nominal = plan.declared.tyre.nominal_load
    loads = sorted({sweep.load_N for sweep in plan.tables.sweep})
    rows = {load: _direct(plan, machine, load) for load in sorted({nominal, *loads})}
    return Truth(
        nominal=rows[nominal],
        per_load=tuple(rows[load] for load in loads),
        faults=machine.faults,
        faults_of_sweeps={s.file: s.faults.values() for s in plan.tables.sweep if s.faults.values()},
        coefficients=coefficients_of(machine.tyre),
        seed=seed,
    )


def _direct(plan: RigPlan, machine: Machine, load: float) -> DirectTruth:
    return direct_truth(
        machine.tyre,
        load,
        speed=plan.tables.conditions.V_mps,
        pressure=1e3 * plan.declared.tyre.nominal_pressure,
        phi_t=machine.phi_t_sign / machine.faults["path_radius_m"],
        R=machine.faults["path_radius_m"],
    )


def configuration_of(plan: RigPlan, machine: Machine, generator: np.random.Generator) -> dict[str, Any]:
    """The content of tyre.toml: the declaration, the measured rolling radii and the sweeps."""
    content = plan.declared.model_dump(exclude_unset=True)
    content["sweep"] = [_sweep_entry(sweep) for sweep in plan.tables.sweep]
    radii = [
        written_down(
            row,
            _direct(plan, machine, row.load_N).r_e_m,
            machine.faults["path_radius_m"],
            generator,
        )
        for row in plan.tables.rolling_radius
    ]
    content["rolling_radius"] = radii
    if plan.declared.base_path is not None:
        content["tyre"]["base"] = plan.declared.base_path.name  # its copy is beside tyre.toml
    if plan.declared.priors_path is not None:
        content["tyre"]["priors"] = str(plan.declared.priors_path.absolute())
    # TOML requires plain keys before tables. The many sweeps come last; empty tables are left out.
    first = [name for name, value in content.items() if not isinstance(value, dict | list | tuple)]
    order = dict.fromkeys([*first, *(name for name in LEADING if name in content), *content])
    order = dict.fromkeys([*(name for name in order if name != "sweep"), "sweep"])
    return {name: content[name] for name in order if content[name] not in ({}, [], ())}


def _sweep_entry(sweep: SweepPlan) -> dict[str, Any]:
    names = ("file", "direction", "mount", "path_centre", "path_radius")
    entry = {name: getattr(sweep, name) for name in names}
    return {key: value for key, value in entry.items() if value not in ("forward", "normal", None)}
