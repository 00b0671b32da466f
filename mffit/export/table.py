"""A property file as lookup tables, one for each force."""

from collections.abc import Callable
from functools import partial
from pathlib import Path
from types import MappingProxyType
from typing import Any, NamedTuple, Unpack

import numpy as np

import tir
from mffit.errors import InputError
from mffit.export import constants
from mffit.export.code import stem
from mffit.export.forms import FORMS, LookupTable
from mffit.export.grid import Function, Grid, Ranges, grid_of
from mffit.output import output_folder
from mffit.progress import Progress, silent
from mffit.quantities import column
from mffit.tested import NO_FX, lacks_fx
from tir.codegen.program import Switches
from tir.correction import AXES
from tir.envelope import SEARCHED, box
from tir.mode import SwitchOptions, words

CONDITIONS = ("Fz_N", "alpha_deg", "gamma_deg", "kappa")
"""Axes of the tables in the order of a call of the tyre."""
SIDEWAYS = ("Fz_N", "alpha_deg", "gamma_deg")
PURE = {"Fx": ("Fz_N", "gamma_deg", "kappa"), **dict.fromkeys(("Fy", "Mx", "Mz"), SIDEWAYS)}
"""Channels and the axes of their tables in pure slip. My is left out: it depends on speed and jumps where the wheel locks."""
SLIPS = {"Fx": "kappa", "Fy": "alpha_deg"}
"""Channels with a slip stiffness, and the axis of the slip."""
SMALL_STEP = 1e-6
"""Step of a central difference over the range of the slip."""
COMBINED = dict.fromkeys(PURE, CONDITIONS)


class LookupTables(NamedTuple):
    """What :func:`write_table` wrote."""

    written: list[Path]
    tables: list[LookupTable]
    warnings: list[str]  #: tables that miss the goal or are left out, and what helps


def write_table(
    path: str | Path,
    out: str | Path,
    *,
    form: str,
    error: float = constants.TABLE_ERROR,
    ranges: Ranges = MappingProxyType({}),
    progress: Progress = silent,
    **switches: Unpack[SwitchOptions],
) -> LookupTables:
    """Write a property file as lookup tables of Fx, Fy, Mx and Mz on a straight path, at the file's speed and pressure.

    Parameters
    ----------
    path : the property file
    out : folder to write to
    form : ``csv`` or ``mat``: pure and combined slip, in ISO-W axes, N, Nm and degrees
    error : largest error of linear interpolation between nodes, over the largest value of the channel
    ranges : lowest and highest value of ``Fz_N``, ``alpha_deg``, ``gamma_deg``, ``kappa``, within those of the file; default:
        those of the file, to 60 deg of camber and 30 deg of sideslip
    progress : called with a sentence at each step
    switches : ``turn_slip``, ``star``, ``limits``, as in :func:`tir.export_c`; spin is that of camber

    Returns
    -------
    LookupTables
        The files and their tables, each with the error that was found.

    Raises
    ------
    InputError, TirError
        A range or a form is unusable, a force is not a number, the file cannot be read, or the folder cannot be written to.
    """
    path, out = Path(path), Path(out)
    if form not in FORMS:
        raise InputError(f"there are no tables for {form!r}, only for {', '.join(FORMS)}")
    if not 0.0 < error < 1.0:
        raise InputError(f"an error of {100.0 * error:g} % is not between 0 and 100 %", key="--error")
    tyre = tir.read(path)
    chosen = tyre.switches(**switches)
    tables, warnings = _tables(partial(_force, tyre, chosen), _ranges(tyre, path, ranges), error, progress)
    wrong = [table.heading for table in tables if not np.isfinite(table.grid.largest)]
    if wrong:
        raise InputError(f"{wrong[0]} is not a number everywhere in the ranges; see mffit check", file=path)
    at = f"straight path, {tyre['LONGVL']:g} m/s, {tyre['INFLPRES'] / 1e3:g} kPa; ISO-W axes, degrees, N, Nm"
    about = f"{path.name}, {words(chosen)}, {at}" + f"; {NO_FX}" * lacks_fx(tyre)
    with output_folder(out, by="export", protected=[path]) as folder:
        names = FORMS[form](folder, stem(path, tyre, chosen), about, tables)
    return LookupTables([out / name for name in names], tables, warnings)


def _force(tyre: tir.Tyre, switches: Switches, channel: str, **at: Any) -> Any:
    """The channel at conditions by their columns; those not given are zero."""
    inputs = {AXES[name][0]: AXES[name][1] * x for name, x in at.items()}
    return getattr(tyre(**inputs, **switches._asdict()), channel)


def _tables(
    force: Callable[..., Any], inside: Ranges, error: float, progress: Progress
) -> tuple[list[LookupTable], list[str]]:
    """Tables of a function of channel and conditions, and sentences on those that miss the goal or are left out.

    They end at one that is not a number.
    """
    tables: list[LookupTable] = []
    warnings = []
    wanted = [*PURE.items(), *COMBINED.items()]
    for k, (channel, axes) in enumerate(wanted):
        name = channel + "_combined" * (k >= len(PURE))
        progress(f"table of {name}")
        grid = grid_of(partial(force, channel), {axis: inside[axis] for axis in axes}, error)
        if not grid.axes and np.isfinite(grid.largest):
            warnings.append(f"{name} does not depend on {', '.join(axes)}: no table")
            continue
        held = {axis: 0.0 for axis in CONDITIONS if axis not in axes}
        slope = _slope_error(partial(force, channel), SLIPS.get(channel, ""), grid)
        tables.append(LookupTable(name, column(channel), grid, held | grid.held, slope))
        if not np.isfinite(grid.largest):
            break
        if grid.error > error:
            warnings.append(
                f"{name} misses {100.0 * grid.error:.3g} % instead of {100.0 * error:g} %, as a table has at "
                f"most {constants.TABLE_NODES:d} nodes: narrow its ranges, for example --range alpha_deg=-12:12, "
                "or allow a larger --error"
            )
    return tables, warnings


def _slope_error(force: Function, slip: str, grid: Grid) -> tuple[float, float] | None:
    """Largest relative error of the table's slope at zero slip, at the loads of its nodes and halfway between, and that load.

    None for a table without zero slip, without loads, or of a tyre without stiffness.
    """
    if slip not in grid.axes or "Fz_N" not in grid.axes:
        return None
    nodes, loads = grid.axes[slip], grid.axes["Fz_N"]
    zero = int(np.argmin(np.abs(nodes)))
    if nodes[zero] != 0.0:
        return None
    upright = {name: float(x[np.argmin(np.abs(x))]) for name, x in grid.axes.items()} | grid.held

    def slope(low: float, high: float, Fz_N: np.ndarray) -> Any:
        at = {**upright, "Fz_N": Fz_N}
        return (force(**at | {slip: high}) - force(**at | {slip: low})) / (high - low)

    every = np.unique([*loads[loads > 0.0], *(0.5 * (loads[1:] + loads[:-1]))])
    step = SMALL_STEP * float(np.ptp(nodes))
    exact = slope(-step, step, every)
    sides = [slope(min(0.0, x), max(0.0, x), loads) for x in nodes[max(zero - 1, 0) : zero + 2].tolist() if x]
    stiff = exact != 0.0
    if not np.any(stiff):
        return None
    every, exact = every[stiff], exact[stiff]
    off = np.max([np.abs(np.interp(every, loads, side) / exact - 1.0) for side in sides], axis=0)
    return float(off.max()), float(every[np.argmax(off)])


def _ranges(tyre: tir.Tyre, path: Path, asked: Ranges) -> dict[str, tuple[float, float]]:
    """The range of each condition: as asked for, or of the file, as far as tyres are used; loads from zero."""
    for name in asked.keys() - set(CONDITIONS):
        raise InputError(f"there is no such condition, only {', '.join(CONDITIONS)}", key=f"--range {name}")
    usual = dict(zip(SEARCHED, box(tyre).T, strict=True))
    found = {}
    for name in CONDITIONS:
        key, unit = AXES[name]
        least, most = SEARCHED[key]
        whole, used = np.array([[tyre[least], tyre[most]], usual[key]]) / unit
        if key == "Fz":
            whole[0] = used[0] = 0.0
        if not whole[0] <= whole[1]:
            raise InputError(f"{least} is above {most}: correct the file", file=path)
        low, high = found[name] = asked.get(name, (float(used[0]), float(used[1])))
        if not whole[0] - 1e-6 <= low <= high <= whole[1] + 1e-6:
            raise InputError(
                f"{low:g}:{high:g} is not a range within {whole[0]:.6g}:{whole[1]:.6g} of the file",
                key=f"--range {name}",
            )
    return found
