"""The table of parameters: every row is sound, and what it says of a tyre's symmetry is what the equations do."""

from __future__ import annotations

import csv
import math
import re
from pathlib import Path

import numpy as np
import pytest

import tir
from tir import units
from tir.parameters import BY_NAME, SECTIONS, TABLE, Parameter

PACKAGE = Path(tir.__file__).parent
CSV = PACKAGE / "parameters.csv"
EQUATIONS = "".join(path.read_text(encoding="utf-8") for path in sorted(PACKAGE.glob("equations/*.py")))
NEEDS = (
    "camber",
    "coupled",
    "combined",
    "side",
    "side_force",
    "both_sides",
    "curvature",
    "kappa",
    "speeds",
    "sideslips",
    "loads",
    "pressures",
    "pressure_loads",
)
COUNTED = {"speeds", "sideslips", "loads", "pressures", "pressure_loads"}
WORDS = {
    "kind": {"number", "text"},
    "divisor": {"", "yes"},
    "stage": {
        *(
            "",
            "held",
            "Fx",
            "Fx-camber",
            "Fx-pressure",
            "Fy",
            "camber",
            "pressure",
            "combined-Fx",
            "combined-Fy",
        ),
        *("trail", "residual", "combined-Mz", "spin", "shift", "Mx"),
    },
    "channel": {"", "Fx", "Fy", "Mx", "My", "Mz"},
    "symmetry": {"", "odd", "odd shift", "odd shift conicity"},
    "files": {"", "62", "motorcycle", "some", "rare", "adams"},
}
"""Every word that a column may hold; docs/parameters.md explains them."""
COEFFICIENTS = [
    row for row in TABLE if row.section.endswith("COEFFICIENTS") and not row.scaling and row.kind == "number"
]


def test_every_row_is_sound():
    with CSV.open(encoding="ascii", newline="") as stream:
        rows = list(csv.DictReader(stream))
    names = [row["name"] for row in rows]
    assert len(names) == len(set(names))
    assert [(row.name, row.order) for row in TABLE] == list(zip(names, range(1, len(rows) + 1), strict=True))
    assert [row["section"] for row in rows] == sorted(
        (row["section"] for row in rows), key=list(SECTIONS).index
    ), "a section's rows stand together"
    for row in rows:
        name = row["name"]
        assert None not in row, f"{name} has a cell too many"
        for column, words in WORDS.items():
            assert row[column] in words, f"{name}: {column} is {row[column]!r}, not one of {sorted(words)}"
        assert row["description"], name
        _sound_tie(row)
        _sound_needs(row)
        _sound_range(BY_NAME[name])


def _sound_tie(row: dict[str, str]) -> None:
    for tie in row["tied"].split():
        where, _, spread = tie.partition(":")
        spread, _, files = spread.partition("/")
        assert where in ("disc", "symmetric", "side", "tyres"), row["name"]
        assert float(spread) > 0.0, row["name"]
        counted = where == "tyres" and bool(row["stage"])
        assert counted == bool(files), (
            f"{row['name']}: the number of files stands behind the spread of tyres of a stage"
        )
        assert not counted or (int(files) >= 4 and float(row["default"]) == 0.0), row["name"]
        assert where == "tyres" or row["stage"], f"{row['name']} is tied, and no stage frees it"
        assert where != "side" or "both_sides" in row["needs"], f"{row['name']} is not held by one side"


def _sound_needs(row: dict[str, str]) -> None:
    name, words = row["name"], []
    for need in row["needs"].split():
        word, colon, levels = need.partition(":")
        assert word in NEEDS, f"{name}: needs {word!r}, not one of {NEEDS}"
        assert (word in COUNTED) == bool(colon), f"{name}: {need}; write a number after {COUNTED} only"
        assert not colon or int(levels) in (2, 3, 4), f"{name}: {need}; the number is 2 to 4"
        words.append(word)
    assert words == sorted(set(words), key=NEEDS.index), f"{name}: each need once, in the order of NEEDS"
    assert row["channel"] or not words, f"{name} needs data, and no channel"
    assert row["channel"] or not row["stage"], f"{name} is fitted, and to no channel"


def _sound_range(row: Parameter) -> None:
    lower, upper = row.bounds
    assert lower < upper
    if row.stage:
        assert math.isfinite(row.width), row.name
        assert lower <= row.usual[0] <= float(row.default) <= row.usual[1] <= upper, row.name
        assert row.equation, row.name
    if row.divisor:
        assert float(row.default) > 0.0, row.name
    if row.equation:
        assert row.equation in EQUATIONS, f"{row.name}: {row.equation} is not in the code"


def test_no_limit_excludes_a_published_tyre():
    """Extremes of 33 public files, in the signs of the table; 0, an effect that a file does not have, left out."""
    with (Path(__file__).parent / "published_extremes.csv").open(encoding="ascii", newline="") as stream:
        rows = list(csv.DictReader(stream))
    assert len(rows) > 100
    for row in rows:
        least, most = BY_NAME[row["name"]].bounds
        assert least <= float(row["lowest"]) <= float(row["highest"]) <= most, row


@pytest.fixture(scope="module")
def symmetric() -> tir.Tyre:
    """Every coefficient at work, except those that a mirror-symmetric tyre does not have."""
    tyre = tir.read(Path(__file__).parent / "vectors" / "moto_front.tir")
    return tyre.replace(**{row.name: 0.0 if row.odd else tyre[row.name] or 0.07 for row in COEFFICIENTS})


@pytest.mark.parametrize("row", COEFFICIENTS, ids=lambda row: row.name)
def test_odd_is_what_breaks_the_mirror(symmetric, row):
    """By definition of mirror symmetry about the wheel plane; the signs of the six outputs are ISO-W's."""
    rng = np.random.default_rng(3)
    alpha, gamma, kappa, phi_t = (size * rng.uniform(-1, 1, 30) for size in (0.2, 0.5, 0.1, 0.5))
    tyre = symmetric.replace(**{row.name: symmetric[row.name] + 0.05})
    broken = 0.0
    for on in (True, False):
        left = tyre(1800.0, alpha, gamma, kappa, phi_t, turn_slip=on)
        right = tyre(1800.0, -alpha, -gamma, kappa, -phi_t, turn_slip=on)
        for a, b, sign in zip(left, right, (1, -1, 1, -1, 1, -1), strict=True):
            broken = max(broken, float(np.max(np.abs(a - sign * b))))
    assert (broken > 1e-6) == row.odd
    if row.conicity or row.shift:
        assert row.odd


def test_conicity_changes_sign_with_the_tyre_turned_on_its_rim():
    """Rolling backwards is rolling a turned tyre forwards: a tyre of conicity alone pushes the same way over the rig."""
    plain = tir.Tyre.from_values({"FNOMIN": 1500.0}).replace(**{r.name: 0.0 for r in TABLE if r.odd})
    for name in ("PVY1", "PHY1"):
        tyre = plain.replace(**{name: 0.005})
        assert tyre(1500.0, Vx=8.0).Fy != 0.0
        same = tyre(1500.0, Vx=-8.0).Fy == pytest.approx(tyre(1500.0, Vx=8.0).Fy)
        assert same == BY_NAME[name].conicity


def test_every_unit_of_a_file_has_the_value_of_its_definition():
    """SI prefixes, and the international yard and pound of 1959 with the standard acceleration of gravity."""
    inch, pound, gravity = 25.4e-3, 0.45359237, 9.80665
    foot, force = 12.0 * inch, pound * gravity
    defined = {
        "LENGTH": {"inch": inch, "in": inch} | dict.fromkeys(("foot", "feet", "ft"), foot),
        "FORCE": {
            "kg_force": gravity,
            "kgf": gravity,
            "pound_force": force,
            "lbf": force,
            "dyne": 1e-3 * 1e-2,
        },
        "ANGLE": dict.fromkeys(("degrees", "degree", "deg"), np.pi / 180.0),
        "MASS": {"pound_mass": pound, "lbm": pound, "slug": force / foot, "ton": 1e3, "tonne": 1e3}
        | {"kg": 1.0, "kilogram": 1.0, "g": 1e-3, "gram": 1e-3, "mg": 1e-6},
        "TIME": {"minute": 60.0, "hour": 60.0 * 60.0},
        "PRESSURE": {"bar": 1e5, "psi": force / inch**2},
    }
    plain = {
        "LENGTH": ("meter", "metre", "m"), "FORCE": ("newton", "n"), "ANGLE": ("radians", "radian", "rad"),
        "TIME": ("second", "seconds", "sec", "s"), "PRESSURE": ("pascal", "pa"),
    }  # fmt: skip
    prefixes = {
        "k": 1e3,
        "kilo": 1e3,
        "c": 1e-2,
        "centi": 1e-2,
        "milli": 1e-3,
        "m": 1e-3,
        "u": 1e-6,
        "mega": 1e6,
        "": 1.0,
    }
    for kind, words in units.KINDS.items():
        for word, value in words.items():
            known = defined[kind].get(word)
            if known is None:
                known = {before + one: x for before, x in prefixes.items() for one in plain[kind]}[word]
                known = 1e6 if kind == "PRESSURE" and word[0] == "m" else known  # no file states millipascal
            assert value == pytest.approx(known, rel=1e-9), word


@pytest.mark.parametrize("unit", sorted({row.unit for row in TABLE} - {"", "-"}))
def test_a_unit_of_the_table_is_made_of_the_units_of_a_file_as_it_is_written(unit):
    """A millimetre, kilonewton, gram, millisecond and degree to the powers that the text of the unit has."""
    words = {"LENGTH": "mm", "FORCE": "kn", "MASS": "g", "TIME": "ms", "ANGLE": "deg"}
    sizes = {"m": 1e-3, "N": 1e3, "kg": 1e-3, "s": 1e-3, "rad": np.pi / 180.0, "1": 1.0}
    over, _, under = {"Pa": "N/m2", "Hz": "1/s"}.get(unit, unit).partition("/")
    expected = 1.0
    for part, side in ((over, 1), (under, -1)):
        for base, power in re.findall(r"(1|[A-Za-z]+)(\d?)", part):
            expected *= sizes[base] ** (side * int(power or 1))
    assert units.factor(unit, words) == pytest.approx(expected, rel=1e-12)
