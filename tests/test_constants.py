"""Every number of judgement is a record with unit and reason, in the ``constants.py`` of its folder, under a name of its own."""

from __future__ import annotations

import ast
import copy
import importlib
import pickle
import re
from collections import Counter
from pathlib import Path

import pytest

from mffit import reference
from tir.constant import Count, Real, Series

ROOT = Path(__file__).parents[1]
MODULES = sorted(
    ".".join(path.relative_to(ROOT).with_suffix("").parts)
    for package in ("tir", "mffit")
    for path in (ROOT / package).rglob("constants.py")
    if "build" not in path.parts  # what `pip install ./tir` leaves behind
)


def constants(module: str) -> dict[str, object]:
    """The public upper-case names that a module itself assigns."""
    tree = ast.parse((ROOT / Path(*module.split("."))).with_suffix(".py").read_text(encoding="utf-8"))
    names = [
        target.id
        for statement in tree.body
        if isinstance(statement, ast.Assign)
        for target in statement.targets
        if isinstance(target, ast.Name)
    ]
    return {name: getattr(importlib.import_module(module), name) for name in names}


@pytest.mark.parametrize("module", MODULES)
def test_a_constant_says_its_unit_and_why(module):
    for name, value in constants(module).items():
        assert isinstance(value, Real | Count | Series), f"{module}.{name} is no record; write Real(...)"
        assert value.unit, f"{module}.{name} has no unit"
        assert value.why.endswith("."), f"{module}.{name} gives no reason in a sentence"


def test_a_name_means_one_thing():
    counted = Counter(name for module in MODULES for name in constants(module))
    twice = sorted(name for name, times in counted.items() if times > 1)
    assert not twice, f"{', '.join(twice)}: several constants of one name; say in the name which is which"


@pytest.mark.parametrize(
    "value", [Real(0.5, "deg", "x"), Count(3, "-", "x"), Series((1, 2.0), "m", "x", "y")]
)
@pytest.mark.parametrize("again", [copy.deepcopy, lambda x: pickle.loads(pickle.dumps(x))])
def test_a_constant_survives_a_copy(value, again):
    made = again(value)
    assert (made, type(made), made.unit, made.study) == (value, type(value), value.unit, value.study)


def test_only_degrees_have_radians():
    assert Real(180.0, "deg", "x").rad == pytest.approx(3.141592653589793)
    with pytest.raises(ValueError, match="not in degrees"):
        _ = Real(1.0, "m", "x").rad


def test_the_site_lists_every_constant_with_its_reason():
    listed = dict(re.findall(r"^\| `(\w+)` \| .* \| (.*) \|$", reference.page("constants.md"), re.MULTILINE))
    stated = {name: x for module in MODULES for name, x in constants(module).items()}
    assert listed.keys() == stated.keys()
    assert all(listed[name].replace("\\", "").startswith(x.why) for name, x in stated.items())


def test_every_constant_is_used():
    """By its name, somewhere in the code or its tables outside its own definition."""
    code = "\n".join(
        path.read_text(encoding="utf-8")
        for package in ("tir", "mffit")
        for path in (*(ROOT / package).rglob("*.py"), *(ROOT / package).rglob("*.toml"))
    )
    words = Counter(re.findall(r"\b[A-Z][A-Z0-9_]+\w*\b", code))
    unused = sorted(name for module in MODULES for name in constants(module) if words[name] < 2)
    assert not unused, f"no code uses {', '.join(unused)}"
