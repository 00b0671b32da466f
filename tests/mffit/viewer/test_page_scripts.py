"""The scripts of the pages: their numbers in an engine without a browser, against the build in Python; and a linter."""

from __future__ import annotations

import base64
import csv
import io
import json
import re
import shutil
import subprocess
import sys
import zlib
from dataclasses import replace
from importlib.resources import files
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from small_rigs import SAMPLE

import tir
from mffit.config.lines import line_ranges, ranges_text
from mffit.constants import COVERAGE_FACTOR_95
from mffit.points import concatenate
from mffit.rig import Simulation
from mffit.viewer import files_page, project_data, project_html
from mffit.viewer.bundle import EXPORT, IMPORT, module, script
from mffit.viewer.packing import packed
from mffit.viewer.page import recordings_html
from mffit.viewer.project_points import delivered, differing
from mffit.virtual_rig.machine import loaded_radius
from tir.codegen.javascript import javascript

SIX_DIGITS = 1e-4
"""Agreement [-] of misfits: points have six digits in a page, and a misfit is a hundredth of a force."""
RULES: dict[str, Any] = {
    "env": {"browser": True, "es2024": True},
    "plugins": ["import"],
    "categories": {"correctness": "error"},
    "rules": {
        **dict.fromkeys(("no-undef", "no-unused-vars", "no-redeclare", "eqeqeq", "import/named"), "error"),
        "oxc/erasing-op": "off",
    },
}
"""``0.0 * PEY5`` is what the generated code of the equations has where an input is zero."""


IMPORTED = re.compile(r"^import \{([^}]*)\}", re.MULTILINE)
EXPORTED = re.compile(r"^export (?:async )?(?:function|const|let) (\w+)", re.MULTILINE)
MODULES = [path for path in files("mffit.viewer").joinpath("scripts").iterdir() if path.name.endswith(".js")]


class Engine:
    """The page's model with its state, without a page."""

    def __init__(self, data: dict[str, Any]) -> None:
        self.context = pytest.importorskip("quickjs").Context()
        html = project_html("small", data, turn_slip=data["turn_slip"], star=data["star"])
        models = html[html.index("const MODELS") : html.index("(() => {")]
        self.context.eval(models + script("curves"))
        content = list(zlib.decompress(base64.b64decode(data["points"]["bytes"])))
        self(f"take({json.dumps(data)}, Uint8Array.from({content}))")
        self("filter()")

    def __call__(self, script: str) -> Any:
        """The value of an expression, by way of JSON; NaN is None."""
        plain = "(key, x) => ArrayBuffer.isView(x) ? [...x] : x === undefined ? null : x"
        return json.loads(self.context.eval(f"JSON.stringify(({script}) ?? null, {plain})"))

    def try_out(self, name: str, value: float, dragging: bool = False) -> None:
        self(f"(trial = {{{name}: {value}}}, recompute({json.dumps(dragging)}))")

    def panel(self, x: str, y: str) -> dict[str, Any]:
        return self(f"(globalThis.panel = {{x: '{x}', y: '{y}'}}, placed(panel))")


@pytest.fixture(scope="module")
def data(result):
    return project_data(result)


@pytest.fixture
def engine(data):
    return Engine(data)


def test_columns_come_back_as_they_were(engine):
    rng = np.random.default_rng(0)
    columns = {
        "a": rng.normal(0.0, 1e3, 7),
        "b": np.array([np.nan, -0.0, np.inf]),
        "c": np.array([-1, 3]),
        "d": np.array([70_000, 2]),
        "e": np.array([], dtype=int),
    }
    found = packed(columns)
    assert [kind for _, kind, _ in found["layout"]] == ["f4", "f4", "i1", "i4", "u1"]
    content = list(zlib.decompress(base64.b64decode(found["bytes"])))
    given = engine(f"unpacked(Uint8Array.from({content}), {json.dumps(found['layout'])})")
    assert given["a"] == pytest.approx(columns["a"], rel=1e-6)
    assert given["b"] == [None, 0, None]
    assert given["c"] == [-1, 3]
    assert given["d"] == [70_000, 2]
    assert given["e"] == []


def test_the_misfit_is_that_of_the_build(engine, result, data):
    """Also of channels that are fitted by themselves."""
    for row in data["channels"]:
        assert engine(f"misfit('{row['name']}').rmse") == pytest.approx(row["rmse"], rel=SIX_DIGITS)
    for name in result.fit.channels:
        found = engine(f"misfit('{name}')")
        assert found["rmse"] == pytest.approx(result.fit.channels[name].rmse, rel=SIX_DIGITS)
        assert found["over_noise"] == pytest.approx(result.trust.over_noise[name], rel=SIX_DIGITS)


def test_what_the_rig_read_is_what_the_tyre_felt_and_the_rig_added(engine, result):
    whole = concatenate([result.points, result.excluded])
    for name in ("Fy", "Mz"):
        assert engine(f"columns.shift.{name} !== undefined")
        assert engine(f"columns.read.{name}") == pytest.approx(whole.channel(name), rel=1e-5, abs=1e-3)
    assert engine("columns.read.alpha ?? columns.alpha") == pytest.approx(whole.alpha, rel=1e-5, abs=1e-6)


def test_a_flipped_tyre_has_its_conicity_the_other_way(result):
    """If every second reading is declared as one of a flipped tyre, the page shows the misfit that the simulation has."""
    points = result.points.replace(mount=np.where(np.arange(len(result.points)) % 2, -1, 1))
    values = result.fit.tyre.values | {"PHY1": 0.004, "PVY1": 0.03}
    tyre = result.fit.tyre.replace(**{name: values[name] for name in ("PHY1", "PVY1")})
    simulation = result.fit.simulation.with_numbers({name: tyre[name] for name in ("PHY1", "PVY1")})
    fit = replace(result.fit, tyre=tyre, simulation=simulation)
    engine = Engine(project_data(replace(result, points=points, fit=fit)))
    wanted, unflipped = (
        float(np.sqrt(np.mean((simulation.readings(one).Fy - one.Fy) ** 2)))
        for one in (points, result.points)
    )
    assert abs(wanted - unflipped) > 0.1 * wanted
    assert engine("misfit('Fy').rmse") == pytest.approx(wanted, rel=1e-3)


def test_a_moved_coefficient_gives_the_misfit_of_that_tyre(engine, result):
    """Computed again by the simulation of the fit: this rig, the other coefficient. Other channels stay as they are."""
    rolling = engine("misfit('My')")
    engine.try_out("PCY1", 1.5)
    readings = result.fit.simulation.with_numbers({"PCY1": 1.5}).readings(result.points)
    wanted = float(np.sqrt(np.mean((readings.Fy - result.points.Fy) ** 2)))
    # the rig's play, whose side the moment decides, stays as fitted
    assert engine("misfit('Fy').rmse") == pytest.approx(wanted, rel=1e-3)
    assert wanted > 2.0 * result.fit.channels["Fy"].rmse
    assert engine("own.My === fitOwn.My")
    assert engine("misfit('My')") == rolling


def test_a_fit_with_temperature_is_shown_with_its_own_points(result, data):
    """Another fit of the same readings: its misfit in the page is that of its simulation; only what differs travels twice."""
    tyre = result.fit.tyre.replace(PDY1=1.1 * result.fit.tyre["PDY1"])
    warm = result.fit.simulation.with_numbers({"PDY1": tyre["PDY1"], "gain": 1.04, "F0_N": 20.0})
    other = replace(result.fit, tyre=tyre, simulation=warm)
    over = differing(result.points, result.excluded, result.fit, other)
    names = {name for name, *_ in over["layout"]}
    assert "Fy" in names
    assert not names & {"Fz", "kappa", "t", "line", "Mx"}
    engine = Engine(data)
    packed_twice = [list(zlib.decompress(base64.b64decode(part["bytes"]))) for part in (data["points"], over)]
    whole, added = (f"Uint8Array.from({content})" for content in packed_twice)
    values = data["values"] | {"PDY1": tyre["PDY1"]}
    engine(f"take({json.dumps(data | {'values': values, 'over': over['layout']})}, {whole}, {added})")
    readings = warm.readings(result.points)
    wanted = float(np.sqrt(np.mean((readings.Fy - result.points.Fy) ** 2)))
    assert engine("misfit('Fy').rmse") == pytest.approx(wanted, rel=SIX_DIGITS)


def test_the_loaded_radius_of_a_page_carries_the_load():
    """The rig's own formula, by bisection, with the forces and the wheel speed of the tyre; also rolling backwards."""
    tyre = tir.Tyre.from_values(
        {
            **dict(
                UNLOADED_RADIUS=0.3, WIDTH=0.2, ASPECT_RATIO=0.5, VERTICAL_STIFFNESS=2e5, Q_FZ2=10.0, PFZ1=0.6
            ),
            **dict(
                Q_RE0=1.004, Q_V1=1e-3, Q_V2=0.05, Q_FCX=0.2, Q_FCY=0.3, Q_CAM1=0.2, Q_CAM2=0.8, Q_CAM3=0.4
            ),
            **dict(FNOMIN=1500.0, PDY1=-1.0, PKY1=15.0, PKY2=1.5, PCY1=1.3, PDX1=1.1, PKX1=20.0, PCX1=1.6),
        }
    )
    context = pytest.importorskip("quickjs").Context()
    context.eval(f"radius = ({javascript(('RL',), turn_slip=False)})({json.dumps(dict(tyre.p.__dict__))})")
    for Fz, alpha, gamma, kappa, Vx, p in (
        (1500.0, 0.0, 0.0, 0.0, 10.0, tyre["NOMPRES"]),
        (1200.0, 0.08, -0.1, 0.0, 25.0, 1.1 * tyre["NOMPRES"]),
        (2000.0, -0.05, 0.06, 0.03, -15.0, 0.8 * tyre["NOMPRES"]),
    ):
        at = dict(Fz=Fz, alpha=alpha, gamma=gamma, kappa=kappa, Vx=Vx, p=p, turn_slip=False)
        out = tyre(**at)
        wanted = loaded_radius(
            tyre.values, SimpleNamespace(Fx=out.Fx, Fy=out.Fy, Fz=Fz), gamma, tyre.state(**at).omega, p
        )
        found = context.eval(f"radius({Fz}, {alpha}, {gamma}, {kappa}, 0, {Vx}, {p}).RL")
        assert found == pytest.approx(float(wanted), rel=1e-6), at


def test_a_moving_slider_asks_for_some_points_only_and_says_so(engine, result):
    engine.try_out("PCY1", 1.5)
    whole = engine("misfit('Fy')")
    n = len(result.points)
    engine(f"(columns.count, every = Math.ceil({n} / 20), predicted(models, 'Fy', moved.Fy.fill(0), every))")
    rows = np.flatnonzero(engine("moved.Fy"))
    assert 10 < len(rows) <= 20
    some = engine("(misfits = {}, misfit('Fy'))")
    assert some["about"]
    assert not whole["about"]
    assert some["rmse"] == pytest.approx(whole["rmse"], rel=0.5)


def test_the_curve_of_the_page_is_that_of_the_file(engine, result):
    Fz, alpha, gamma, p = 1400.0, 0.05, 0.1, 250e3
    wanted = result.fit.tyre(Fz, alpha, gamma, Vx=10.0, p=p, turn_slip=result.fit.simulation.turn_slip)
    found = [
        engine(f"models[1].{name}({Fz}, {alpha}, {gamma}, 0, 0, 10, {p}).{name}") for name in ("Fy", "Mz")
    ]
    assert found == pytest.approx([wanted.Fy, wanted.Mz], rel=1e-9)


@pytest.mark.parametrize(("x", "y"), [("alpha", "Fy"), ("Fy", "Mz")])
def test_a_point_lies_as_far_from_its_curve_as_the_model_misses_it(engine, result, x, y):
    """Brought to the conditions of the curve, the medians of its points; along the sideslip where both axes are forces."""
    shown = np.array(engine.panel(x, y)["py"], dtype=float)
    curved = engine(
        f"groupsOver('alpha').flatMap(group => {{ const model = alongGroup(models, group, '{y}');"
        " return [...group.members].map(i => [i, model(columns.alpha[i])]); })"
    )
    curved = [(i, on) for i, on in curved if i < len(result.points)]
    assert len(curved) > len(result.points) / 2
    rows, on = (np.array(column) for column in zip(*curved, strict=True))
    missed = (result.points.channel(y) - result.fit.simulation.readings(result.points)[y])[rows]
    assert shown[rows] - on == pytest.approx(missed, abs=2e-3)
    assert np.ptp(missed) > 1.0


def test_each_picture_has_the_sweeps_that_vary_over_its_axis(engine, result):
    """Sideslip over sideslip, camber over camber; the plan names its sweeps by what they vary. No reading is lost."""
    panels = engine("defaultPanels()")
    assert [(p["x"], p["y"]) for p in panels if p["y"] == "Fy"] == [("alpha", "Fy"), ("gamma", "Fy")]
    whole = concatenate([result.points, result.excluded])
    kinds = np.array([name.partition("_")[0].removesuffix(".csv") for name in whole.sweep_names])[whole.sweep]
    seen = np.zeros(len(whole), dtype=bool)
    for panel in panels:
        shown = engine.panel(panel["x"], panel["y"])
        drawn = np.array([x is not None for x in shown["px"]])
        assert (
            set(kinds[drawn])
            == {"alpha": {"sideslip", "coupled", "forward"}, "gamma": {"camber", "forward"}}[panel["x"]]
        )
        assert len(shown["curves"]) == {"alpha": 4, "gamma": 2}[panel["x"]] * (not shown["residual"])
        seen |= drawn
    assert seen.all()


def test_residuals_are_readings_less_model(engine, result):
    """The page has six digits of a reading: a thousandth of a newton here."""
    shown = np.array(engine.panel("alpha", "residual of Fy")["py"], dtype=float)[: len(result.points)]
    assert shown == pytest.approx(
        result.points.Fy - result.fit.simulation.readings(result.points).Fy, abs=2e-3
    )


def test_curves_are_points_that_share_all_other_settings(engine, result):
    """The plan's: sideslip sweeps upright at two loads, and the sideslips at two cambers of the coupled sweep."""
    found = engine("groupsOver('alpha').map(group => [group.fixed, group.members, group.from, group.to])")
    settings = {(round(fixed[0], -2), round(np.degrees(fixed[2]))) for fixed, *_ in found}
    assert settings == {(900, 0), (1400, 0), (1400, -20), (1400, 20)}
    whole = concatenate([result.points, result.excluded])
    for fixed, members, low, high in found:
        assert whole.Fz[members] == pytest.approx(fixed[0], rel=0.1)
        assert [low, high] == pytest.approx(
            [whole.alpha[members].min(), whole.alpha[members].max()], abs=2e-3
        )
    everywhere = [i for _, members, *_ in found for i in members]
    assert len(everywhere) == len(set(everywhere))


def test_what_a_level_hides_is_what_has_it(engine, result):
    engine("(state.hidden = {Fz: [facet('Fz').labels[0]]}, filter())")
    whole = concatenate([result.points, result.excluded])
    assert engine("visible") == (whole.Fz > 1150.0).astype(int).tolist()
    engine("(state.hidden = {}, state.ranges = {alpha: [null, -1]}, filter())")
    felt = np.degrees(engine("columns.alpha"))
    assert engine("visible") == (felt <= -1.0).astype(int).tolist()


def test_the_reading_left_out_is_found_by_its_line(engine, result):
    rows = np.flatnonzero(engine("left"))
    assert rows.tolist() == [len(result.points)]
    assert engine(f"whyLeftOut({rows[0]})") == "belt tracking"
    engine("markLeftOut([{file: 'camber_900.csv', lines: '3-5, 8'}])")
    whole = concatenate([result.points, result.excluded])
    wanted = (whole.file == whole.files.index("camber_900.csv")) & np.isin(whole.line, [3, 4, 5, 8])
    assert engine("left") == wanted.astype(int).tolist()
    every_other = ", ".join(str(line) for line in range(2, 50_000, 2))
    engine(f"markLeftOut([{{file: 'camber_900.csv', lines: '{every_other}'}}])")
    wanted = (whole.file == whole.files.index("camber_900.csv")) & (whole.line % 2 == 0)
    assert engine("left") == wanted.astype(int).tolist()


def test_points_that_follow_each_other_are_left_out_as_one_range(engine, result):
    points = result.points
    file = points.files.index("sideslip_900.csv")
    lines = [2, 3, 4, 7, 8]
    rows = [int(np.flatnonzero((points.file == file) & (points.line == line))[0]) for line in reversed(lines)]
    ranges = engine(f"lineRanges({rows})")
    assert ranges == [{"file": "sideslip_900.csv", "lines": "2-4, 7-8"}]
    whole = [one["lines"] for one in engine("lineRanges(columns.line.keys())")]
    assert len(", ".join(whole).split(",")) <= len(points.files) + 1


def test_bands_are_those_of_the_prediction(engine, result):
    """Asked anew of the predictor at the points of a curve, where no other point of it is near."""
    curves = engine.panel("alpha", "Fy")["curves"]
    tyre = Simulation.of(result.fit.tyre, turn_slip=result.fit.simulation.turn_slip)
    felt = delivered(result.fit).felt(result.points)
    known = result.fit.prediction.forces(tyre, tyre, felt)["Fy"]
    half = COVERAGE_FACTOR_95 * np.sqrt(known.of_run)
    compared = 0
    for k, curve in enumerate(curves):
        members = np.array([i for i in curve["path"]["members"] if i < len(felt)])
        for x, low, middle, high in engine(f"bandOf(panel.kept.curves[{k}])"):
            assert middle == pytest.approx((high + low) / 2.0)
            near = members[np.abs(np.degrees(felt.alpha[members]) - x) < 1.5]
            on = engine(f"alongGroup(fitModels, groupsOver('alpha')[{k}], 'Fy')({np.radians(x)})")
            if len(near) != 1:
                continue
            assert (high - low) / 2.0 == pytest.approx(half[near[0]], rel=1e-3)
            assert middle - on == pytest.approx((known.best - known.file)[near[0]], abs=0.01)
            compared += 1
    assert compared >= 4


def test_a_picture_is_saved_as_its_numbers(engine, result):
    shown = engine.panel("alpha", "Fy")
    table = list(csv.DictReader(io.StringIO(engine("csvOf(panel, name => name)"))))
    kinds = [row["what"] for row in table]
    assert kinds.count("point") == sum(x is not None for x in shown["px"]) - 1
    assert kinds.count("left out") == 1
    assert kinds.count("curve") == sum(curve["steps"] + 1 for curve in shown["curves"])
    wanted = {
        (result.points.files[f], line): y
        for f, line, y in zip(result.points.file, result.points.line, shown["py"], strict=False)
    }
    for row in table:
        if row["what"] == "point":
            assert float(row["Fy"]) == pytest.approx(wanted[row["file"], int(row["line"])], rel=1e-5)
    Fz, _, gamma, _, _, Vx, p = shown["curves"][0]["path"]["fixed"]
    first = [row for row in table if row["what"] == "curve"][: shown["curves"][0]["steps"] + 1]
    alpha = np.radians([float(row["alpha"]) for row in first])
    tyre = result.fit.tyre(Fz, alpha, gamma, Vx=Vx, p=p, turn_slip=result.fit.simulation.turn_slip)
    assert [float(row["Fy"]) for row in first] == pytest.approx(tyre.Fy, rel=1e-5, abs=1e-3)
    order = [float(row["alpha"]) for row in table if row["file"]]
    assert order == sorted(order)


@pytest.mark.parametrize(
    ("curve", "passes"),
    [
        ([0, 0, 10, 10], True),  # through the middle, no point of it inside
        ([0, 6, 10, 6], True),
        ([0, 0, 10, 2], False),
        ([0, 6, 3, 6], False),  # ends before
        ([7, 0, 7, 10], False),
    ],
)
def test_a_label_is_crossed_by_the_curves_that_pass_through_its_box(engine, curve, passes):
    """Left, top, right and bottom 4, 4, 6, 8, in pixels as the curve."""
    assert engine(f"crosses({curve}, [4, 4, 6, 8], x => x, y => y)") == passes


def test_lines_mean_the_same_in_a_page_and_in_python(engine, data):
    """What a page marks as left out by an entry of tyre.toml, and the entry that it writes for chosen points."""
    file, line, last = (np.array(engine(f"columns.{name}")) for name in ("file", "line", "last"))
    name = data["points"]["files"][0]
    mine = np.flatnonzero(file == 0)
    rng = np.random.default_rng(7)
    for _ in range(20):
        ends = np.sort(rng.integers(1, line[mine].max() + 3, size=(4, 2)))
        text = ", ".join(f"{a}-{b}" if a != b else str(a) for a, b in ends)
        engine(f"markLeftOut([{{file: {json.dumps(name)}, lines: {json.dumps(text)}}}])")
        wanted = np.zeros(len(line), dtype=bool)
        wanted[mine] = np.any([(a <= line[mine]) & (line[mine] <= b) for a, b in ends], axis=0)
        assert np.array_equal(np.array(engine("left"), dtype=bool), wanted)
        chosen = np.sort(rng.choice(mine, 5, replace=False))
        (entry,) = engine(f"lineRanges({chosen.tolist()})")
        assert entry["file"] == name
        assert entry["lines"] == ranges_text(line_ranges(", ".join(f"{line[i]}-{last[i]}" for i in chosen)))
    engine("markLeftOut([])")


def test_what_a_module_exports_another_one_imports():
    texts = [path.read_text(encoding="utf-8") for path in MODULES]
    imported = {
        name.strip() for text in texts for names in IMPORTED.findall(text) for name in names.split(",")
    }
    exported = {name for text in texts for name in EXPORTED.findall(text)}
    assert exported - imported == set()
    assert len(exported) > 50


@pytest.mark.parametrize("path", MODULES, ids=lambda path: path.name)
def test_a_module_imports_what_it_uses_and_each_line_can_be_read(path):
    """Names of other modules, each exported there; the joined script has one scope, in which a name means one thing."""
    text = path.read_text(encoding="utf-8")
    assert all(len(line) < 120 for line in text.splitlines())
    for names, source in re.findall(r'^import \{([^}]*)\} from "\./(\w+)\.js";', text, re.MULTILINE):
        exported = re.findall(r"^export (?:async )?(?:function|const|let) (.*)", module(source), re.MULTILINE)
        known = set(re.findall(r"\w+", " ".join(exported)))
        assert {name.strip() for name in names.split(",") if name.strip()} <= known
    rest = EXPORT.sub("", IMPORT.sub("", text))
    assert not re.search(r"^(import|export)\b", rest, re.MULTILINE)


def test_a_linter_finds_nothing(tmp_path):
    lint = shutil.which("oxlint", path=str(Path(sys.executable).parent)) or shutil.which("oxlint")
    if lint is None:
        pytest.skip("no oxlint on this machine")
    here = {"folder": "x", "endings": []}
    pages = {
        "project": project_html("x", None, turn_slip=False, star=False, window={"fits": 0}, here=here),
        "show": files_page(SAMPLE / "true.tir").html,
        "recordings": recordings_html("x", "", here),
    }
    texts = {
        name: "\n".join(re.findall(r"<script>(.*?)</script>", html, re.DOTALL))
        for name, html in pages.items()
    }
    whole = RULES | {"rules": RULES["rules"] | {"no-unused-vars": "off"}}  # a page may use a part of a module
    parts = RULES | {"globals": {"MODELS": "readonly"}}
    of_modules = {path.name: path.read_text(encoding="utf-8") for path in MODULES}
    for folder, rules, scripts in (
        ("pages", whole, {f"{name}.js": text for name, text in texts.items()}),
        ("modules", parts, of_modules),
    ):
        (tmp_path / folder).mkdir()
        (tmp_path / folder / "rules.json").write_text(json.dumps(rules), encoding="utf-8")
        for name, text in scripts.items():
            (tmp_path / folder / name).write_text(text, encoding="utf-8")
        command, where = [lint, "-c", "rules.json", "."], tmp_path / folder
        found = subprocess.run(command, cwd=where, capture_output=True, text=True)
        assert found.returncode == 0, found.stdout
