"""The examples of docs/contributing.md work as they are printed, and the files that it names exist."""

from __future__ import annotations

import csv
import dataclasses
import io
import json
import re
import tomllib
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from click.testing import CliRunner

import tir
from mffit.effects import NEEDS
from mffit.effects.catalog import tyre_effect
from mffit.errors import InputError
from mffit.report import page
from mffit.report.build_view import view_of
from mffit.rig_errors.catalog import rig_error
from tests.mffit.report.report_toys import made_result
from tir.equations.stiffness import camber_stiffness
from tir.evaluate import evaluate
from tir.parameters import BY_NAME

ROOT = Path(__file__).parents[1]
PAGE = (ROOT / "docs" / "contributing.md").read_text(encoding="utf-8")
SAMPLE = ROOT / "samples" / "front-120-70" / "true.tir"


@pytest.fixture(scope="module")
def examples() -> dict:
    """The names that the Python blocks of the page define, except those that are marked as not run."""
    names: dict[str, object] = {"__name__": "page"}
    for block in re.findall(r"(?<!-->\n)^```python\n(.*?)^```$", PAGE, re.MULTILINE | re.DOTALL):
        exec(block, names)
    return names


def test_every_file_of_the_tables_exists_unless_it_is_new():
    rows = re.findall(r"^\| (`[^|]*`[^|]*) \| ([^|]*) \|$", PAGE, re.MULTILINE)
    named = {
        file for files, change in rows if "new" not in change for file in re.findall(r"`([^`]*)`", files)
    }
    assert len(named) > 20
    missing = sorted(file for file in named if not (ROOT / file).exists())
    assert not missing, f"docs/contributing.md names {', '.join(missing)}"


def test_the_records_are_complete():
    tables = re.findall(
        r"^```toml\n(\[(?:Fz_0_N|curvature-load)\]\n.*?)^```$", PAGE, re.MULTILINE | re.DOTALL
    )
    effect, error = (
        read(*tomllib.loads(table).popitem())
        for read, table in zip((tyre_effect, rig_error), tables, strict=True)
    )
    assert set(effect.parameters) <= set(BY_NAME)
    seen = (effect, error.seen_as)
    assert {word for one in seen for word in one.needs} <= set(NEEDS)


def test_both_formulae_of_the_rig_error_agree(examples):
    settings = type("Settings", (), {"Fz": np.array([900.0, 1400.0])})
    true = examples["FORMULAE"]["Fz_0_N"](20.0, settings.Fz, None)
    factor = examples["LOADS"]["Fz_0_N"](20.0, settings, None)
    np.testing.assert_allclose(true, settings.Fz * factor, rtol=1e-15)


def test_the_reader_reads(examples, tmp_path):
    path = tmp_path / "a.json"
    path.write_text(json.dumps({"alpha_deg": [0.0, 1.0], "Fy_N": [3.1, -240.5]}))
    table = examples["read_json"](path)
    assert table.headings == ("alpha_deg", "Fy_N")
    np.testing.assert_array_equal(table.column("Fy_N"), [3.1, -240.5])
    assert examples["FORMATS"][-1].read is examples["read_json"]


def test_the_exporter_writes_the_tyre(examples):
    """Its lines are Python's too, once the words of the language are defined there."""
    tyre = tir.read(SAMPLE)
    code = examples["export_julia"](tyre, name="front")
    assert "turn slip on" in code.splitlines()[1]
    body = re.search(r"function (.*\n(?s:.*))^end", code, re.MULTILINE)[1].replace("^", "**")
    head, _, rest = body.partition("\n")
    namespace = {
        "ifelse": np.where, "atan": np.arctan, "acos": np.arccos, "true": True, "false": False, "Inf": np.inf, "NaN": np.nan,
        **{name: getattr(np, name) for name in ("sqrt", "exp", "sin", "cos", "tan", "abs")},
    }  # fmt: skip
    exec(f"def {head}:\n{rest}", namespace)
    given = (1400.0, 0.05, 0.3, 0.02, 0.0, 10.0, 2.2e5)
    wanted = evaluate(tyre.p, *given, turn_slip=True)[0]
    np.testing.assert_allclose(namespace["front"](*given), wanted, rtol=1e-12)
    with pytest.raises(tir.TirError, match="taken in Julia"):
        examples["export_julia"](tyre, name="end")


@pytest.mark.parametrize(
    "text",
    [
        "",
        "{",
        "[1, 2]",
        "{}",
        '{"a": 1}',
        '{"a": []}',
        '{"a": [[1]]}',
        '{"a": [1], "b": [1, 2]}',
        '{"a": "x"}',
    ],
)
def test_the_reader_refuses_a_damaged_file_in_one_sentence(examples, tmp_path, text):
    path = tmp_path / "a.json"
    path.write_text(text)
    with pytest.raises(InputError, match=r"a\.json") as caught:
        examples["read_json"](path)
    assert "\n" not in str(caught.value)


def test_the_picture_is_drawn_where_it_appears_and_its_numbers_are_the_readings(examples, tmp_path):
    view = view_of(made_result())
    picture = page.picture(tmp_path, "loads", examples["loads"](view))
    assert (tmp_path / "plots" / "loads.png").stat().st_size > 1000
    rows = list(csv.DictReader(io.StringIO(picture.table)))
    assert [float(row["y"]) for row in rows] == pytest.approx(view.points.Fz)
    alike = view.points.replace(Fz=np.full(len(view.points), 900.0))
    assert page.picture(tmp_path, "loads", examples["loads"](dataclasses.replace(view, points=alike))) is None


def test_the_command_prints_text_or_json(examples):
    command = examples["stiffness"]
    text = CliRunner().invoke(command, [str(SAMPLE)])
    value = json.loads(CliRunner().invoke(command, [str(SAMPLE), "--json"]).output)["C_alpha_N_per_rad"]
    assert f"{value:.0f} N/rad at 1400 N" in text.output
    assert value > 0.0


def test_the_row_of_the_parameter_fits_the_table():
    (row,) = re.findall(r"^```text\n(PKY8,.*)\n```$", PAGE, re.MULTILINE)
    with (ROOT / "tir" / "parameters.csv").open(encoding="ascii", newline="") as stream:
        table = csv.DictReader([next(iter(stream)), row])
        cells = next(table)
    assert None not in cells
    assert None not in cells.values()
    neighbour = BY_NAME["PKY7"]
    assert (cells["section"], cells["stage"], cells["equation"]) == (
        neighbour.section,
        neighbour.stage,
        neighbour.equation,
    )
    assert "PKY8" not in BY_NAME, "the program has PKY8 now; take another name for the example"


def test_the_example_of_the_parameter_is_the_equation_where_it_is_zero(examples):
    p = SimpleNamespace(PKY6=-0.9, PKY7=0.2, PKY8=0.0, PPY5=-0.4, LKYC=1.1)
    q = SimpleNamespace(Fz=1900.0, dfz=0.3, dpi=0.1)
    assert examples["camber_stiffness"](p, q) == pytest.approx(camber_stiffness(p, q), rel=1e-15)
