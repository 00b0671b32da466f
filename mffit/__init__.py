"""From tyre-rig sweeps to an MF-6.2 property file with a measured camber reduction factor.

>>> import mffit
>>> result = mffit.build("samples/front-120-70/tyre.toml")  # doctest: +SKIP
>>> result.measured.epsilon_gamma  # doctest: +SKIP
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from mffit.export import write_c, write_fmu
    from mffit.pipeline import align, build, compare, diagnose, plan, spin, write_tydex
    from mffit.viewer import show

__version__ = "0.1.0"

__all__ = [
    "align",
    "build",
    "compare",
    "diagnose",
    "plan",
    "show",
    "spin",
    "write_c",
    "write_fmu",
    "write_tydex",
]
ELSEWHERE = {"show": "mffit.viewer", "write_c": "mffit.export", "write_fmu": "mffit.export"}
"""Public names that are not the pipeline's."""


def __getattr__(name: str) -> Any:
    """Import a workflow when it is first asked for: most need scipy and pandas."""
    if name in __all__:
        from importlib import import_module

        return getattr(import_module(ELSEWHERE.get(name, "mffit.pipeline")), name)
    raise AttributeError(f"module 'mffit' has no attribute {name!r}")


def __dir__() -> list[str]:
    """The public names, imported yet or not."""
    return sorted([*__all__, *(name for name in globals() if name.startswith("__"))])
