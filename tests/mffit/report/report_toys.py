"""A build's result from a known tyre: real records, readings made by the rig model with a little noise."""

from __future__ import annotations

import io
import zipfile
from html.parser import HTMLParser
from pathlib import Path
from typing import Any
from urllib.request import urlopen

import numpy as np

import tir
from mffit import config, measured, parts
from mffit.fit.agreement import agreement
from mffit.fit.coefficients import Coefficient
from mffit.fit.coverage import coverage
from mffit.fit.result import FitResult
from mffit.made import made
from mffit.numbers import Numbers
from mffit.points import Points, make_points
from mffit.results import BuildResult
from mffit.rig import Simulation
from tir.parameters import BY_NAME

TRUE = Path(__file__).parents[3] / "samples" / "front-120-70" / "true.tir"
R = 1.323
NOISE_FY, NOISE_MZ = 6.0, 0.6
SIDESLIP = np.array([-8, -6, -4, -3, -2, -1, -0.5, 0, 0.5, 1, 2, 3, 4, 6, 8.0])
CAMBER = np.array([-50, -40, -30, -20, -15, -10, -5, 0, 5, 10, 15, 20, 30, 40, 50.0])
ZEROS = np.array([-1, -0.5, 0, 0.5, 1.0])
STATUSES = ("fitted", "measured", "regularised", "base", "default")


def sweep(alpha, gamma, Fz, p=250e3, direction=1) -> dict[str, np.ndarray]:
    columns = np.broadcast_arrays(alpha, gamma, float(Fz), float(p), direction)
    return dict(zip(("alpha", "gamma", "Fz", "p", "direction"), columns, strict=True))


def programme(loads=(900.0, 1500.0)) -> dict[str, dict[str, np.ndarray]]:
    """Set-points [deg, N, Pa] by sweep name."""
    sweeps = {}
    for load in loads:
        sweeps[f"sideslip_{load:.0f}"] = sweep(SIDESLIP, 0.0, load)
        sweeps[f"camber_{load:.0f}"] = sweep(0.0, CAMBER, load)
        sweeps[f"backward_{load:.0f}"] = sweep(ZEROS, 0.0, load, direction=-1)
    coupled = [sweep(SIDESLIP, gamma, loads[-1]) for gamma in (-20.0, 20.0)]
    sweeps["coupled"] = {key: np.concatenate([c[key] for c in coupled]) for key in coupled[0]}
    sweeps["soft"] = sweep(SIDESLIP, 0.0, loads[0], p=200e3)
    return sweeps


def made_points(sweeps, *, phi_t=-1 / R, seed=1, u_Fy=NOISE_FY, u_Mz=NOISE_MZ, moment=True) -> Points:
    """Points of a programme as the rig would read them from the true tyre."""
    columns = {key: np.concatenate([s[key] for s in sweeps.values()]) for key in next(iter(sweeps.values()))}
    number = np.repeat(np.arange(len(sweeps)), [len(s["Fz"]) for s in sweeps.values()])
    points = make_points(
        np.radians(columns["alpha"]),
        np.radians(columns["gamma"]),
        columns["Fz"],
        p=columns["p"],
        V=6.0,
        phi_t=phi_t,
        u_Fy=u_Fy,
        u_Mz=u_Mz,
        direction=columns["direction"],
        sweep=number,
        file=number,
        sweep_names=tuple(sweeps),
        files=tuple(f"{name}.csv" for name in sweeps),
    )
    rng = np.random.default_rng(seed)
    Fy, Mz = Simulation.of(tir.read(TRUE), turn_slip=phi_t != 0.0).readings(points).values()
    n = len(points)
    return points.replace(
        Fy=Fy + NOISE_FY * rng.standard_normal(n),
        Mz=Mz + NOISE_MZ * rng.standard_normal(n) if moment else np.full(n, np.nan),
    )


def made_coefficients() -> dict[str, Coefficient]:
    """One coefficient of each status, one of them at its bound."""
    tyre = tir.read(TRUE)
    names = ("PKY1", "PECP1", "PHYP2", "QBZ1", "PHY2")
    out = {}
    for name, status in zip(names, STATUSES, strict=True):
        fixed = status not in ("fitted", "regularised")
        out[name] = Coefficient(
            value=tyre[name],
            stderr=None if fixed else 0.02,
            stage=BY_NAME[name].stage,
            fixed=fixed,
            at_bound=name == "PHYP2",
            status=status,
            correlated_with="PKY2" if name == "PKY1" else "",
            correlation=-0.97,
        )
    return out


def made_config(rig: dict[str, Any] | None = None) -> config.Config:
    """A tyre.toml; the size would break a page that does not escape."""
    return config.load(
        {
            "tyre": {
                "name": "front-1",
                "size": "120/70 <ZR17>",
                "unloaded_radius": 0.2992,
                "nominal_load": 1500.0,
                "nominal_pressure": 250.0,
            },
            "rig": rig or {"path_radius": R},
            "rolling_radius": [{"effective_radius": 0.2945, "u_effective_radius": 0.0005}],
            "sweep": [{"file": "sideslip.csv"}],
        }
    )


def made_result(**changes: Any) -> BuildResult:
    """A whole result; ``changes`` go to :func:`made_points`, except ``rig``, which goes to tyre.toml."""
    settings = made_config(changes.pop("rig", None))
    points = made_points(programme(), **changes)
    halves = parts.split(points)
    tyre = tir.read(TRUE)
    simulation = Simulation.of(tyre, turn_slip=bool(points.phi_t.any()))
    readings = simulation.readings(points)
    Fy, Mz = readings.values()
    fitted = FitResult(
        tyre=tyre,
        written=tyre,
        coefficients=made_coefficients(),
        channels={"Fy": agreement(Fy, points.Fy), "Mz": agreement(Mz, points.Mz)},
        odd={"Fy": agreement(Fy, points.Fy), "Mz": agreement(Mz, points.Mz)},
        simulation=simulation,
        rig={"F0_N": (1.5, 3.0)},
        model=readings,
        coverage=coverage(points, "left"),
        explanations=("The file is for simulations with turn slip on.",),
        warnings=(),
        seconds=1.5,
        posterior=Numbers.of(
            ("PKY1", "PDY1", "PKY6", "QDZ1"), np.zeros(4), np.diag([0.05, 0.01, 0.005, 0.002]) ** 2
        ),
    )
    return BuildResult(
        config=settings,
        points=points,
        parts=halves,
        measured=measured.measure(settings, points, halves, None),
        fit=fitted,
        files={"turn-slip": "front-1.tir"},
        tyres={"turn-slip": tyre},
        made=made({"sideslip.csv": 4 * "0123456789abcdef"}),
        plain="turn-slip",
        warnings=("the camber sweep at 900 N is short & noisy",),
        seconds=3.25,
    )


VOID = frozenset({"meta", "img", "br", "col", "input"})
INLINE = frozenset({"sub", "sup", "span", "em", "code", "strong", "a", "i"})


class PageReader(HTMLParser):
    """Collects tags and text; stops at a tag closed out of order.

    ``text`` is what is read: words of different blocks are apart, a symbol and its index are not.
    """

    def __init__(self) -> None:
        super().__init__()
        self.open: list[str] = []
        self.drawings: list[str] = []  # what each picture shows, in words
        self.tables: dict[str, str] = {}  # numbers behind a picture, by its name
        self.references: list[str] = []
        self.ids: list[str] = []
        self.text = ""

    def handle_starttag(self, tag, attrs):
        attributes = dict(attrs)
        if tag not in VOID:
            self.open.append(tag)
        if attributes.get("role") == "img":
            self.drawings.append(attributes["aria-label"])
        if "download" in attributes:
            name = attributes["download"].removesuffix(".zip")
            self.tables[name] = content(attributes["href"], f"{name}.csv")
        if "id" in attributes:
            self.ids.append(attributes["id"])
        self.references += [v for k, v in attributes.items() if k in ("src", "href") and v]
        self._apart(tag)

    def handle_endtag(self, tag):
        assert self.open.pop() == tag
        self._apart(tag)

    def handle_data(self, data):
        if "style" not in self.open:
            self.text += data

    def _apart(self, tag):
        if tag not in INLINE:
            self.text += " "


def content(address: str, name: str) -> str:
    """The file in an archive whose address begins with ``data:``."""
    with urlopen(address) as answer, zipfile.ZipFile(io.BytesIO(answer.read())) as archive:
        return archive.read(name).decode()


def read_page(path: Path) -> PageReader:
    """The page, with every tag closed."""
    reader = PageReader()
    reader.feed(path.read_text(encoding="utf-8"))
    reader.close()
    assert reader.open == []
    return reader
