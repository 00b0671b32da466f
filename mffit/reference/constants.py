"""The page of all numbers of judgement."""

from __future__ import annotations

import importlib
import pkgutil
from collections.abc import Iterator
from types import ModuleType

import mffit
import tir
from tir.constant import Count, Real, Series


def modules() -> Iterator[ModuleType]:
    """The modules ``constants`` of both packages, by name; this one is none of them."""
    for package in (mffit, tir):
        for found in pkgutil.walk_packages(package.__path__, f"{package.__name__}."):
            name = found.name
            if name.endswith(".constants") and name != __name__:
                yield importlib.import_module(name)


def constants(module: ModuleType) -> dict[str, Real | Count | Series]:
    """The constants of a module by name."""
    return {name: x for name, x in vars(module).items() if isinstance(x, Real | Count | Series)}


def page() -> str:
    """The page in Markdown: a table per folder."""
    found = {module.__name__.rpartition(".")[0]: constants(module) for module in modules()}
    lines = [
        "# Numbers of judgement",
        "",
        "Limits, tolerances and starting points that somebody judged, with the reason for each. A study or publication that set "
        "the value is named behind it; without one the value is plain judgement. This page is written from the records in the "
        "modules `constants.py`. Sizes and limits of rig errors are in [their own table](rig-errors.md).",
        "",
        f"{sum(map(len, found.values()))} numbers in {len(found)} folders.",
    ]
    for folder, rows in found.items():
        lines += ["", f"## {folder}", "| name | value | unit | why |", "|---|---|---|---|"]
        lines += [_row(name, x) for name, x in rows.items()]
    return "\n".join(lines) + "\n"


def _row(name: str, x: Real | Count | Series) -> str:
    value = ", ".join(f"{v:g}" for v in x) if isinstance(x, Series) else f"{x:g}"
    why = f"{x.why} *{x.study}.*" if x.study else x.why
    return f"| `{name}` | {value} | {x.unit} | {why} |".replace("|F_", "\\|F_")
