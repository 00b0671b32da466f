"""Campaigns on drawn rigs with drawn tyres, built and compared with the truth; tests/studies/recovery_study.py runs many.

Every rig has its own load-cell offset, misalignments, radii and noise, drawn from the uncertainties that it declares; every
tyre is a sample's with all its fitted coefficients up to a tenth off; every base file is up to 30 % off that, or absent.
"""

from __future__ import annotations

import tempfile
import tomllib
from collections.abc import Callable, Collection, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
import tomli_w

import mffit
import tir
from mffit import virtual_rig
from mffit.errors import InputError
from mffit.fit.priors import scatter
from mffit.points import make_points
from mffit.rig import Simulation
from mffit.scatter import rms
from mffit.virtual_rig.truth import DirectTruth, Truth, direct_truth
from tir.parameters import TABLE

SAMPLES = Path(__file__).parents[3] / "samples"
SAMPLE = SAMPLES / "front-120-70"
STAGED = tuple(row.name for row in TABLE if row.stage)
NO_FORCE_AT_REST = dict.fromkeys(("PHX1", "PHX2", "PVX1", "PVX2"), 0.0)
"""No longitudinal force without longitudinal slip: its moment grows with camber, and the fit would assign it to QDZ6 and QDZ8."""
DECLARED = {
    "u_loadcell_offset_N": 10.0,
    "u_camber_alignment_deg": 0.5,
    "u_slip_alignment_N": 25.0,
    "u_camber_skew_deg": 0.1,
}
"""Keys of [rig] that drawn rigs declare, unless a study says otherwise; ``Kind.rig_off`` multiplies the errors behind them."""
SAFE = 1.959964
"""Coverage factor of 95 % intervals."""


def backward_camber(content: Mapping[str, Any]) -> dict[str, Any]:
    """A sweep of eleven cambers rolled backwards at the nominal load."""
    angles = [-40, -30, -20, -10, -5, 0, 5, 10, 20, 30, 40]
    load = content["tyre"]["nominal_load"]
    return {"file": "camber_backward.csv", "load_N": load, "gamma_deg": angles, "direction": "backward"}


@dataclass(frozen=True)
class Kind:
    """A kind of campaign."""

    sample: str = "front-120-70"
    base: str = "another's"  #: "another's": up to 30 % off in every coefficient; "sample's"; "none"
    thin: bool = False  #: half of the angles, one pressure
    one_load: bool = False
    """Most sweeps 40 kPa below the nominal pressure, other pressures at the lowest load only, a base file without pressure and
    shift terms, and a tyre whose pressure terms are drawn from the priors that the fit has for them."""
    upright: bool = False  #: sideslip sweeps and zeros only
    rig_off: float = 1.0  #: how many times the declared uncertainties the rig's errors are drawn from
    tyre_off: float = 0.0  #: how far the tyre's coefficients may be from the sample's, relative
    pecp1: str = "model"


@dataclass(frozen=True)
class Band:
    """A 95 % band at drawn conditions, beside the truth."""

    inside: float  #: share of conditions whose truth it holds
    half: float  #: rms half width [N] or [Nm]
    error: float  #: rms difference of the model from the truth


@dataclass
class Draw:
    """Differences of one build of a drawn campaign from the truth."""

    misfit: dict[str, float] = field(default_factory=dict)  #: rms over stated noise, by channel
    pulls: dict[str, float] = field(default_factory=dict)  #: (found - true) / standard error
    stderr: dict[str, float] = field(default_factory=dict)  #: the standard error itself
    inside: dict[str, bool] = field(default_factory=dict)  #: whether the 95 % interval holds the truth
    error: dict[str, float] = field(default_factory=dict)  #: against the noise-free truth, in units
    bands: dict[str, Band] = field(default_factory=dict)
    seconds: float = 0.0
    doubted: int = 0  #: sweeps that the build doubts, although all are sound
    refused: str = ""  #: the sentence with which it ended; everything else is empty then

    def note(
        self,
        name: str,
        value: float,
        stderr: float,
        truth: float,
        interval: tuple[float, float] | None = None,
    ) -> None:
        """Keep how far a number is from its truth; without ``interval``, that of 95 % follows from the standard error."""
        low, high = interval or (value - SAFE * stderr, value + SAFE * stderr)
        self.pulls[name], self.stderr[name] = (value - truth) / stderr, stderr
        self.inside[name] = low <= truth <= high

    def note_coefficients(self, fit: Any, true: tir.Tyre, names: Collection[str]) -> None:
        """Keep the named coefficients that the fit found and that are not at a bound."""
        for name, row in fit.coefficients.items():
            if row.stderr and row.interval and name in names and not row.at_bound:
                label = name if row.status == "fitted" else f"{name} ({row.status})"
                self.note(label, row.value, row.stderr, true[name], row.interval)


PRESSURE = ("PPY1", "PPY2", "PPY3", "PPY4", "PPY5", "PPZ1", "PPZ2")
SHIFTS = ("PHY1", "PHY2", "PVY1", "PVY2")


def plan_content(sample: Path = SAMPLE, *, pecp1: str = "model", thin: bool = False) -> dict[str, Any]:
    """The sample's campaign with drawn faults, every sweep as finished points."""
    content = tomllib.loads((sample / "rig.toml").read_text(encoding="utf-8"))
    content["faults"] = {"draw": True}
    for sweep in content["sweep"]:
        sweep.pop("recording", None)
        if thin:
            for angles in {"alpha_deg", "gamma_deg"} & sweep.keys():
                values = sweep[angles]
                sweep[angles] = sorted({values[0], *values[::2], values[-1], *(v for v in values if v == 0)})
    if thin:
        content["sweep"] = [sweep for sweep in content["sweep"] if "pressure_kPa" not in sweep]
    content["spin"] = {"exact": "turn-slip", "pecp1": pecp1}
    return content


def front_or_rear(seed: int, rng: np.random.Generator) -> tuple[Path, tir.Tyre]:
    """Folder of a sample, front and rear in turn, and its tyre with all fitted coefficients up to a tenth off."""
    sample = SAMPLES / ("front-120-70", "rear-190-55")[seed % 2]
    return sample, scaled(tir.read(sample / "true.tir").replace(**NO_FORCE_AT_REST), 0.1, rng)


def declares(config: dict[str, Any]) -> None:
    """State the usual uncertainties in a ``tyre.toml``."""
    config["rig"] |= DECLARED


@contextmanager
def on_disk(
    true: tir.Tyre,
    content: dict[str, Any],
    seed: int,
    *,
    base: tir.Tyre | None = None,
    edit: Callable[[dict[str, Any]], None] = lambda config: None,
) -> Iterator[tuple[Path, Truth]]:
    """``tyre.toml`` of a simulated campaign and the truth behind it.

    Parameters
    ----------
    true : the tyre of the rig
    content : plan of the campaign, which is changed
    seed : of noise and drawn faults
    base : the base file of the build, if it has one
    edit : changes what the owner of the rig writes into ``tyre.toml``
    """
    with tempfile.TemporaryDirectory() as made:
        folder = Path(made)
        true.write(folder / "drawn.tir")
        content["truth"] = {"tyre": "drawn.tir"}
        content["tyre"].pop("base", None)
        known = virtual_rig.simulate(virtual_rig.load_plan(content, folder=folder), folder / "rig", seed=seed)
        path = folder / "rig" / "tyre.toml"
        config = tomllib.loads(path.read_text(encoding="utf-8"))
        if base is not None:
            base.write(path.with_name("other.tir"))
            config["tyre"]["base"] = "other.tir"
        edit(config)
        path.write_text(tomli_w.dumps(config), encoding="utf-8")
        yield path, known


def one_rig(seed: int, kind: Kind = Kind(base="sample's")) -> Draw:
    """Draw, simulate and build one campaign."""
    rng = np.random.default_rng(1000 + seed)
    sample = SAMPLES / kind.sample
    true = scaled(tir.read(sample / "true.tir").replace(**NO_FORCE_AT_REST), kind.tyre_off, rng)
    if kind.one_load:
        true = true.replace(**_drawn_from_priors(PRESSURE, rng))
    content = plan_content(sample, pecp1=kind.pecp1, thin=kind.thin)
    content["rig"] |= {name: kind.rig_off * u for name, u in DECLARED.items()}
    if kind.one_load:
        _at_the_lowest_load(content)
    if kind.upright:
        content["sweep"] = [row for row in content["sweep"] if "gamma_deg" not in row]
    with on_disk(true, content, seed, base=_base(kind, true, rng), edit=declares) as (path, known):
        try:
            result = mffit.build(path)
        except InputError as error:
            return Draw(refused=str(error))
    return _compared(result, true, known.to_json(), rng)


def _base(kind: Kind, true: tir.Tyre, rng: np.random.Generator) -> tir.Tyre | None:
    if kind.base == "sample's":
        return tir.read(SAMPLES / kind.sample / "base.tir")
    if kind.base == "none":
        return None
    other = scaled(true, 0.3, rng)
    if kind.one_load:
        other = other.replace(**dict.fromkeys((*PRESSURE, *SHIFTS), 0.0))
    return other.replace(PECP1=0.5) if kind.upright else other


def _drawn_from_priors(names: tuple[str, ...], rng: np.random.Generator) -> dict[str, float]:
    """Coefficients that a base file does not state."""
    return {n: scatter(n, 0.0, from_base=True, curved=True) * rng.standard_normal() for n in names}


def _at_the_lowest_load(content: dict[str, Any]) -> None:
    """Moves every sweep at another pressure to the lowest load, and all pressures off the nominal one."""
    load, nominal = min(row["load_N"] for row in content["sweep"]), content["tyre"]["nominal_pressure"]
    for row in content["sweep"]:
        if "p_kPa" in row:
            row["load_N"] = load
        row["p_kPa"] = row.get("p_kPa", nominal) - 40.0


def _at_pressure_of_sweeps(points: Any, true: tir.Tyre, known: Mapping[str, Any]) -> DirectTruth:
    """What the direct method measures, which is at the pressure of most sweeps; ``truth.json`` holds at the nominal one."""
    R, speed = known["R_m"], float(np.median(points.V))
    return direct_truth(true, known["load_N"], speed, float(np.median(points.p)), -1.0 / R, R)


def scaled(tyre: tir.Tyre, off: float, rng: np.random.Generator, names: Collection[str] = STAGED) -> tir.Tyre:
    """The tyre with the named coefficients up to ``off`` of their size apart."""
    return tyre.replace(**{n: float(tyre[n] * (1.0 + off * rng.uniform(-1.0, 1.0))) for n in names})


def _compared(result: Any, true: tir.Tyre, known: Mapping[str, Any], rng: np.random.Generator) -> Draw:
    points, fit, measured = result.points, result.fit, result.measured
    draw = Draw(seconds=fit.seconds, doubted=len(fit.doubts))
    for channel, u in (("Fy", points.u_Fy), ("Mz", points.u_Mz)):
        draw.misfit[channel] = fit.channels[channel].rmse / float(np.sqrt(np.nanmean(u**2)))

    if measured.epsilon_gamma is not None:
        for name, quantity, truth in (
            ("eps_gamma", measured.epsilon_gamma, known["epsilon_gamma"]),
            ("C_phit", measured.nominal.C_phit, _at_pressure_of_sweeps(points, true, known).C_phit_secant_Nm),
        ):
            draw.note(name, quantity.value, quantity.u, truth)
        draw.error["eps_gamma"] = measured.epsilon_gamma.value - known["epsilon_gamma"]
        draw.error["eps_gamma debiased"] = measured.epsilon_gamma_debiased.value - known["epsilon_gamma"]
    draw.note_coefficients(fit, true, {*STAGED, "PECP1"})
    for name, (value, u) in fit.rig.items():
        draw.note(f"rig.{name}", value, u, known["faults"][name])
    draw.error["PECP1"] = fit.tyre["PECP1"] - true["PECP1"]
    for place, phi_t in (("disc", -1.0 / 1.323), ("straight", 0.0)):
        Fy, Mz = model_error(fit.tyre, true, phi_t, np.unique(np.round(points.Fz, -2)))
        draw.error[f"Fy on {place} [N]"], draw.error[f"Mz on {place} [Nm]"] = Fy, Mz
        main = dict.fromkeys(("PRESMIN", "PRESMAX"), float(np.median(points.p)))
        tested, written = fit.files.tested, fit.files.written
        for name, ranges in (
            ("tested", tested),
            ("tested, usual pressure", {**tested, **main}),
            ("written", written),
        ):
            for channel, band in _in_bands(fit, true, ranges, phi_t, rng).items():
                draw.bands[f"{channel} on {place}, {name}"] = band
    return draw


def _in_bands(fit, true, ranges, phi_t, rng, n: int = 400) -> dict[str, Band]:
    """The 95 % band of the fitted tyre at drawn conditions within the ranges, and whether it contains the true one."""

    def drawn(low: str, high: str) -> np.ndarray:
        return rng.uniform(ranges[low], ranges[high], n)

    where = make_points(
        drawn("ALPMIN", "ALPMAX"),
        drawn("CAMMIN", "CAMMAX"),
        drawn("FZMIN", "FZMAX"),
        p=drawn("PRESMIN", "PRESMAX"),
        V=10.0,
        phi_t=phi_t,
    )
    tyre = Simulation.of(fit.tyre)
    found, truth = tyre.readings(where), Simulation.of(true).readings(where)
    half = half_of_mean(fit, tyre, where)
    return {
        name: Band(
            float(np.mean(np.abs(found[name] - truth[name]) <= h)), rms(h), rms(found[name] - truth[name])
        )
        for name, h in half.items()
    }


def half_of_mean(fit: Any, tyre: Simulation, where: Any) -> dict[str, np.ndarray]:
    """Half width (n,) by channel of the 95 % band of the tyre's mean force around its fitted model."""
    found = fit.prediction.forces(tyre, tyre, where)
    return {n: SAFE * np.hypot(np.sqrt(one.variance), one.best - one.file) for n, one in found.items()}


def model_error(
    model: tir.Tyre, true: tir.Tyre, phi_t: float, loads: np.ndarray, pressure: float = 250e3
) -> tuple[float, float]:
    """Rms difference of Fy [N] and Mz [Nm] from the noise-free truth, between the measured conditions."""
    alpha = np.radians(np.concatenate([np.linspace(-7.5, 7.5, 31), np.linspace(-7.5, 7.5, 31), np.zeros(19)]))
    gamma = np.radians(np.concatenate([np.zeros(31), np.full(31, 15.0), np.linspace(-45.0, 45.0, 19)]))
    Fz = loads[:, None] * 1.03
    a, b = (tyre(Fz, alpha, gamma, phi_t=phi_t, Vx=6.0, p=pressure) for tyre in (model, true))
    return float(np.sqrt(np.mean((a.Fy - b.Fy) ** 2))), float(np.sqrt(np.mean((a.Mz - b.Mz) ** 2)))
