"""A virtual test campaign in memory: tables, tyre.toml and truth from a plan."""

import math
import zlib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import pandas as pd

from mffit.config import RigTable, declared_faults, declared_rig
from mffit.config.models import SetupTable
from mffit.errors import InputError
from mffit.rig_errors import BY_NAME, ZEROS, Faults, number_of
from mffit.virtual_rig.machine import Channels, Machine, steady
from mffit.virtual_rig.plan import MEASURED, NoiseTable, RigPlan, RollingRadiusPlan, SweepPlan
from mffit.virtual_rig.recording import record
from mffit.virtual_rig.settings import Settings, settings_of, usual_speed
from mffit.virtual_rig.tables import point_table, recorded_table
from mffit.virtual_rig.truth import DirectTruth, Truth, coefficients_of, direct_truth, driven_truth
from tir import Tyre

LEADING = ("tyre", "rig", "rolling_radius")
"""Tables that come first in tyre.toml."""


@dataclass(frozen=True, slots=True)
class Campaign:
    """Output of the virtual rig."""

    tables: dict[str, pd.DataFrame]  #: one per sweep by file name, in the rig's axes and the contract's units
    configuration: dict[str, Any]  #: the content of tyre.toml
    truth: Truth


def run(plan: RigPlan, tyre: Tyre, seed: int | None = None) -> Campaign:
    """The campaign of a tyre on the virtual rig.

    Parameters
    ----------
    plan : the sweeps and the rig errors
    tyre : the true tyre
    seed : seed of the noise and the drawn rig errors; default the plan's

    Returns
    -------
    Campaign
        The same plan, tyre and seed give the same numbers.
    """
    seed = plan.tables.seed if seed is None else seed
    if seed < 0:
        raise InputError(f"the seed is {seed}; give a whole number, 0 or larger")
    # Every sweep has its own random numbers, so an additional sweep does not change the others.
    for_faults, for_radii, *for_sweeps = np.random.SeedSequence(seed).spawn(2 + len(plan.tables.sweep))
    faults = faults_in_setups(plan, tyre, np.random.default_rng(for_faults))
    sweeps = settings_of(plan)
    machines = {
        setup: Machine(
            tyre,
            own,
            plan.phi_t_sign,
            usual_speed(sweeps),
            plan.tables.drive.drag_Nm,
            plan.tables.drive.slip_against,
        )
        for setup, own in faults.items()
    }
    tables = {
        sweep.file: sweep_table(plan, machines[setup], sweep, settings, np.random.default_rng(stream))
        for sweep, setup, settings, stream in zip(
            plan.tables.sweep, plan.setups, sweeps, for_sweeps, strict=True
        )
    }
    machine = machines[plan.setups[0]]
    truth = truth_of(plan, machine, faults, seed)
    return Campaign(tables, configuration_of(plan, machine, np.random.default_rng(for_radii)), truth)


def faults_in_setups(plan: RigPlan, tyre: Tyre, generator: np.random.Generator) -> dict[str, Faults]:
    """The rig errors of every set-up; with ``draw``, declared errors without a value in the plan are drawn."""
    table, rig = plan.tables.faults, plan.declared.rig
    setups = tuple(dict.fromkeys(plan.setups))
    for name in plan.tables.setup:
        if name not in setups:
            known = ", ".join(filter(None, setups)) or "none"
            raise InputError(
                f"no sweep belongs to this set-up (set-ups of the sweeps: {known}); give its sweeps setup",
                key=f"setup.{name}",
            )
    values = table.values()
    if rig.radius is None and "path_radius_m" in values:
        raise InputError("a flat track has no path radius; remove it", key="faults.path_radius_m")
    if table.draw:
        nominal = plan.declared.tyre.nominal_load
        C_alpha = float(tyre.state(nominal, Vx=plan.tables.conditions.V_mps).K_ya)
        faults = drawn(rig, values, C_alpha, generator, setups)
    else:
        faults = dict.fromkeys(setups, given(rig, values))
    for name, own in plan.tables.setup.items():
        added = {error: faults[name][error] + x for error, x in own.values().items()}
        faults[name] = faults[name].replace(**added)
    return faults


def sweep_table(
    plan: RigPlan, machine: Machine, sweep: SweepPlan, settings: Settings, generator: np.random.Generator
) -> pd.DataFrame:
    """The table of one sweep, as finished points or as a recording."""
    machine = machine.with_faults(sweep.faults.values())
    if sweep.recording is not None:
        return recorded_table(
            plan, record(machine, settings, sweep.recording, generator, plan.tables.noise.added)
        )
    return point_table(plan, settings, scattered(steady(machine, settings), plan.tables.noise, generator))


def scattered(forces: Channels, noise: NoiseTable, generator: np.random.Generator) -> Channels:
    """The channels of finished points with added noise."""
    for name in (*MEASURED, *noise.added):
        channel = name.partition("_")[0]
        scatter = (noise.of(name) or 0.0) * generator.standard_normal(len(forces.Fy))
        forces = forces._replace(**{channel: getattr(forces, channel) + scatter})
    return forces


def truth_of(plan: RigPlan, machine: Machine, faults: Mapping[str, Faults], seed: int) -> Truth:
    """The true values at the loads of the campaign and at the nominal load; ``machine`` is the one of the first set-up."""
    nominal = plan.declared.tyre.nominal_load
    loads = sorted({load for sweep in plan.tables.sweep for load in sweep.load_N})
    driven = plan.reports_slip or bool(plan.tables.noise.added)
    rows = {load: _direct(plan, machine, load) for load in sorted({nominal, *loads})}
    return Truth(
        nominal=rows[nominal],
        per_load=tuple(rows[load] for load in loads),
        faults=machine.faults,
        faults_of_sweeps={s.file: s.faults.values() for s in plan.tables.sweep if s.faults.values()},
        faults_of_setups={
            setup: {name: own[name] for name in _differing(plan, setup)}
            for setup, own in faults.items()
            if len(faults) > 1
        },
        coefficients=coefficients_of(machine.tyre, driven=driven),
        seed=seed,
        driven=tuple(driven_truth(machine.tyre, load, machine.usual_speed) for load in loads)
        if driven
        else (),
        drive=plan.tables.drive.model_dump(),
    )


def _differing(plan: RigPlan, setup: str) -> list[str]:
    """Names of the rig errors that may differ between set-ups."""
    table = plan.tables.setup.get(setup)
    return list(dict.fromkeys([*(error.name for error in ZEROS), *(table.values() if table else ())]))


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
    content["sweep"] = [
        sweep.model_dump(include=set(SetupTable.model_fields), exclude_defaults=True)
        for sweep in plan.tables.sweep
    ]
    radii = [
        written_down(
            row, _direct(plan, machine, row.load_N).r_e_m, machine.faults["path_radius_m"], generator
        )
        for row in plan.tables.rolling_radius
    ]
    content["rolling_radius"] = radii
    against = plan.tables.drive.slip_against
    if plan.reports_slip and against != "free-rolling":
        content["columns"] = {**content.get("columns", {}), "kappa": {"against": against}}
    if plan.declared.base_path is not None:
        content["tyre"]["base"] = plan.declared.base_path.name  # its copy is next to tyre.toml
    if plan.declared.priors_path is not None:
        content["tyre"]["priors"] = str(plan.declared.priors_path.absolute())
    # TOML requires plain keys before tables. The many sweeps come last; empty tables are left out.
    first = [name for name, value in content.items() if not isinstance(value, dict | list | tuple)]
    order = dict.fromkeys([*first, *(name for name in LEADING if name in content), *content])
    order = dict.fromkeys([*(name for name in order if name != "sweep"), "sweep"])
    return {name: content[name] for name in order if content[name] not in ({}, [], ())}


def written_down(
    row: RollingRadiusPlan, r_e: float, R: float, generator: np.random.Generator
) -> dict[str, Any]:
    """The table ``[[rolling_radius]]`` of tyre.toml for one load, from the true radii of wheel and path [m]; R is infinite on a
    belt.

    Angles are read to 0.1 deg. The notches of the disc are aligned by eye at the start and at the end, so the wheel travels ``2
    pi R`` plus two small random arcs. Errors are normally distributed with the declared uncertainties.
    """
    chance = generator.standard_normal(4)
    if row.u_effective_radius is not None:
        known = round(float(r_e + row.u_effective_radius * chance[0]), 5)
        return {"load_N": row.load_N, "effective_radius": known, "u_effective_radius": row.u_effective_radius}
    travelled = 2.0 * math.pi * R + row.u_arc_m * (chance[0] + chance[1])
    start = 10.0
    turned = start + math.degrees(travelled / r_e) + row.u_angle_deg * (chance[2] + chance[3])
    revolutions, end = divmod(float(turned), 360.0)
    return {
        "load_N": row.load_N,
        "revolutions": int(revolutions),
        "angle_start_deg": start,
        "angle_end_deg": round(end, 1),
        "u_angle_deg": row.u_angle_deg,
        "u_arc_m": row.u_arc_m,
    }


def given(rig: RigTable, values: Mapping[str, float]) -> Faults:
    """The declared rig, with its play and path radius, and with errors of given size."""
    radius = math.inf if rig.radius is None else rig.radius
    return declared_faults(rig).replace(**{"path_radius_m": radius, **values})


def drawn(
    rig: RigTable,
    values: Mapping[str, float],
    C_alpha: float,
    generator: np.random.Generator,
    setups: Sequence[str] = ("",),
) -> dict[str, Faults]:
    """Random rig errors of every set-up by the declared uncertainties; the zeros are drawn for each set-up.

    Errors in ``values`` are not drawn. ``C_alpha`` [N/rad] converts ``u_slip_alignment_N`` to an angle. The first set-up has
    the same errors as a rig with one set-up.
    """
    # Each error has its own stream, seeded by its name: fixing or adding one error does not change the others.
    seed = int(generator.integers(2**32))
    out = {}
    for k, setup in enumerate(setups):
        found = {}
        for name, prior in declared_rig(rig, C_alpha).items():
            stream = number_of(name, setup) if k and BY_NAME[name].of_setup else name
            own = np.random.default_rng([seed, zlib.crc32(stream.encode())])
            found[name] = max(prior.value + prior.u * own.standard_normal(), BY_NAME[name].lower)
        out[setup] = given(rig, {**found, **values})
    return out
