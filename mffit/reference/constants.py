"""Tables of all numbers of judgement."""

from __future__ import annotations

import importlib
import pkgutil
from collections.abc import Iterator
from types import ModuleType

import mffit
import tir
from tir.constant import Count, Real, Series


def modules() -> Iterator[ModuleType]:
    """The modules ``constants`` of both packages by name, without this one."""
    for package in (mffit, tir):
        for found in pkgutil.walk_packages(package.__path__, f"{package.__name__}."):
            name = found.name
            if name.endswith(".constants") and name != __name__:
                yield importlib.import_module(name)


def constants(module: ModuleType) -> dict[str, Real | Count | Series]:
    """The constants of a module by name."""
    return {name: x for name, x in vars(module).items() if isinstance(x, Real | Count | Series)}


def tables() -> str:
    """A table in Markdown for each folder, which the build of the site adds to ``docs/constants.md``."""
    lines = []
    for module in modules():
        folder = module.__name__.rpartition(".")[0]
        lines += ["", f"## {folder}", "| name | value | unit | why |", "|---|---|---|---|"]
        lines += [_row(name, x) for name, x in constants(module).items()]
    return "\n".join(lines) + "\n"


def _row(name: str, x: Real | Count | Series) -> str:
    value = ", ".join(f"{v:g}" for v in x) if isinstance(x, Series) else f"{x:g}"
    why = f"{x.why} *{x.study}.*" if x.study else x.why
    return f"| `{name}` | {value} | {x.unit} | {why} |".replace("|F_", "\\|F_")
