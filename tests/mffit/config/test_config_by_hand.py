"""``[coefficients]``: what may be set by hand, and the sentence about everything else."""

from __future__ import annotations

from pathlib import Path

import pytest
import tomli_w
from test_config_loading import MINIMAL

from mffit import config
from mffit.errors import InputError


def project(folder: Path, text: str, *, tyre: str = "", spin: str = "") -> Path:
    """A tyre.toml of a disc with these lines under [coefficients], [tyre] and [spin]."""
    path = folder / "tyre.toml"
    content = MINIMAL.replace("[tyre]\n", f"[tyre]\n{tyre}\n", 1)
    path.write_text(f"{content}\n[spin]\n{spin}\n[coefficients]\n{text}\n", encoding="utf-8")
    return path


def line_of(path: Path, name: str) -> int:
    lines = path.read_text(encoding="utf-8").splitlines()
    return next(k for k, line in enumerate(lines, 1) if line.startswith(f"{name} "))


WRONG = [
    ("PEY1 = { min = 2.5 }", "PEY1.min", "lies beyond the bounds -10 to 2; give max, too"),
    ("PEY1 = { max = -20.0 }", "PEY1.max", "lies beyond the bounds -10 to 2; give min, too"),
    ("PEY1 = { start = -20.0 }", "PEY1.start", "-20 is outside the bounds -10 to 2; correct it, or give min and max"),
    ("PEY1 = { min = 0.5, max = -3.0 }", "PEY1.min", "0.5 is not below max, -3; exchange the two"),
    ("PEY1 = { min = 0.5, max = 0.5 }", "PEY1.min", "0.5 is not below max, 0.5; write PEY1 = 0.5 to hold it"),
    ("PEY1 = { start = 0.9, max = 0.5 }", "PEY1.start", "0.9 is outside the bounds -10 to 0.5; correct it, or give min and max"),
    ("PEY1 = { value = -4.0, u = 1, min = -3 }", "PEY1.value", "-4 is outside the bounds -3 to 2; correct it, or give min"),
    ("PCY1 = " + 400 * "1", "PCY1", "has more digits than a number can have; correct it"),
    ("PCY1 = " + 5000 * "1", "PCY1", "has more digits than a number can have; correct it"),
    ("PCY1 = { min = -" + 400 * "1" + " }", "PCY1.min", "has more digits than a number can have; correct it"),
    ("PDY1 = -5", "PDY1", "-5 is negative, but the lateral friction at nominal load is positive (ISO-W axes); correct the sign"),
    ("PKY1 = { max = 9.0 }", "PKY1.max", "9 is positive, but the largest cornering stiffness over nominal load is negative"),
    ("PEY1 = nan", "PEY1", "nan is not a finite number; write one"),
    ("PEY1 = { max = inf }", "PEY1.max", "inf is not a finite number; write one"),
    ("PDY2 = { value = -0.1 }", "PDY2.u", "is missing; add one standard deviation of the value, or write PDY2 = -0.1 to hold it"),
    ("PDY2 = { u = 0.1 }", "PDY2.value", "is missing, but u needs it; add what is known of the coefficient"),
    ("PDY2 = { value = -0.1, u = 0 }", "PDY2.u", "0 is not above 0; write PDY2 = -0.1 to hold the value exactly"),
    ("PCYI = 1.3", "PCYI", "is not a coefficient of MF 6.2; did you mean PCY1?"),
    ("pcy1 = 1.3", "pcy1", "is not a coefficient of MF 6.2; did you mean PCY1?"),
    ("PEY1 = { maximum = 1 }", "PEY1", 'has the unknown key "maximum"; did you mean "max"?'),
    ('PCY1 = "1.3"', "PCY1", '"1.3" is a text, not a number; remove the quotes'),
    ("QSX4 = { min = 1.0 }", "QSX4", 'has bounds or a prior, but no fit frees QSX4; write a number or "base"'),
    ("FNOMIN = 1200.0", "FNOMIN", "is set by nominal_load under [tyre]; write it there"),
    ("FZMAX = 5000.0", "FZMAX", "is a range of the file, which follows from the points; remove it"),
    ("USE_MODE = 124", "USE_MODE", "is decided by the build; remove it"),
    ("LMUY = true", "LMUY", 'is not a number; write a number to hold it, "base", or a table such as'),
    ('PCY1 = "base"', "PCY1", 'is "base", but [tyre] names no base file; add base there, or write a number'),
    ("PECP1 = -0.1", "PECP1", "is set, but PECP1 comes from the direct measurement;"),
]  # fmt: skip


@pytest.mark.parametrize(("text", "key", "sentence"), WRONG, ids=[text[:60] for text, _, _ in WRONG])
def test_a_contradiction_is_refused_with_line_and_reason(tmp_path, text, key, sentence):
    path = project(tmp_path, text)
    with pytest.raises(InputError) as caught:
        config.load(path)
    found = caught.value
    assert found.key == f"coefficients.{key}"
    assert found.line == line_of(path, text.split()[0])
    assert found.sentence.startswith(sentence)


def test_a_symmetric_tyre_has_no_odd_terms_to_set(tmp_path):
    path = project(tmp_path, "PHY1 = 0.001", tyre='side = "symmetric"')
    with pytest.raises(InputError, match="holds PHY1 at 0; remove it, or declare another side"):
        config.load(path)
    config.load(project(tmp_path, "PHY1 = 0.0", tyre='side = "symmetric"'))


def test_a_value_beyond_those_of_published_tyres_is_a_declaration(tmp_path):
    text = "PCY1 = 2.5\nPEY1 = { min = -20.0, max = -12.0, start = -15.0 }"
    found = config.load(project(tmp_path, text)).coefficients
    assert found["PCY1"].held == 2.5
    assert found["PEY1"].bounds("PEY1") == (-20.0, -12.0)


def test_every_mistake_is_named(tmp_path):
    path = project(tmp_path, "PCY1 = nan\nPDY1 = nan")
    with pytest.raises(InputError, match=r"also wrong: coefficients\.PDY1"):
        config.load(path)


ENTRIES = {
    "PCY1": 1.35,
    "PEY1": {"start": -0.5, "min": -3.0, "max": 0.5},
    "PDY2": {"value": -0.1, "u": 0.03},
    "RBX1": "base",
    "PECP1": {"value": -0.1, "u": 0.05},
}


def test_resolved_has_the_entries_as_they_were_written(tmp_path):
    text = tomli_w.dumps({"coefficients": ENTRIES}).replace("[coefficients]\n", "", 1)
    found = config.load(project(tmp_path, text, tyre='base = "base.tir"', spin='pecp1 = "model"'))
    content = config.resolved(found, tmp_path / "out")
    assert content["coefficients"] == ENTRIES
    again = tmp_path / "resolved.toml"
    again.write_bytes(tomli_w.dumps(config.resolved(found, tmp_path)).encode())
    assert config.load(again).coefficients == found.coefficients


def test_the_command_line_replaces_single_entries(tmp_path):
    path = project(tmp_path, "PCY1 = 1.35\nPDY1 = 1.2", tyre='base = "base.tir"')
    found = config.load(path, coefficients=["PCY1=1.3", "RBX1=base", "PEY1 = {min=-3, max=0.5}"])
    assert config.resolved(found, tmp_path)["coefficients"] == {
        "PCY1": 1.3,
        "PDY1": 1.2,
        "RBX1": "base",
        "PEY1": {"min": -3.0, "max": 0.5},
    }


@pytest.mark.parametrize(
    ("word", "said"),
    [
        ("PCY1", '--set: "PCY1" is not NAME=VALUE; write for example --set PCY1=1.3'),
        (f"PCY1={400 * '1'}", "--set PCY1: has more digits than a number can have; correct it"),
        (f"PCY1={5000 * '1'}", '--set PCY1: "1111111'),
        ("PCY1=much", '--set PCY1: "much" is not a value; write a number to hold it'),
        (
            "PCY1={min=2.5}",
            "--set PCY1 min: lies beyond the bounds 0.5 to 2; give max, too",
        ),
        (
            "RBX1=base",
            '--set RBX1: is "base", but [tyre] names no base file; add base there, or write a number',
        ),
    ],
)
def test_a_mistake_on_the_command_line_is_placed_there(tmp_path, word, said):
    with pytest.raises(InputError) as caught:
        config.load(project(tmp_path, "PCY1 = 1.35"), coefficients=[word])
    assert str(caught.value).startswith(said)
