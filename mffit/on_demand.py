"""Packages that import their names on first use, so that a command loads only the modules that it needs."""

import ast
from collections.abc import Callable
from functools import cache
from importlib import import_module
from importlib.util import find_spec
from typing import Any


def on_demand(package: str) -> Callable[[str], Any]:
    """The ``__getattr__`` of a package: it imports a name listed under the package's ``if TYPE_CHECKING:`` on first use.

    Type checkers read the same list. A name must differ from those of the package's modules, which become attributes, too.
    """

    def attribute(name: str) -> Any:
        module = names_on_demand(package).get(name)
        if module is None:
            raise AttributeError(f"module {package!r} has no attribute {name!r}")
        return getattr(import_module(module), name)

    return attribute


@cache
def names_on_demand(package: str) -> dict[str, str]:
    """By name that a package imports on first use, the module that defines it."""
    spec = find_spec(package)
    assert spec is not None
    source = spec.loader.get_source(package)  # type: ignore[union-attr]
    (listed,) = (
        node.body
        for node in ast.parse(source).body
        if isinstance(node, ast.If) and ast.unparse(node.test) == "TYPE_CHECKING"
    )
    return {
        alias.name: str(node.module)
        for node in listed
        if isinstance(node, ast.ImportFrom)
        for alias in node.names
    }
