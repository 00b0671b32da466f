"""From tyre-rig sweeps to an MF-6.2 property file with a measured camber reduction factor.

>>> import mffit
>>> result = mffit.build("samples/front-120-70/tyre.toml")  # doctest: +SKIP
>>> result.measured.epsilon_gamma  # doctest: +SKIP
"""

from __future__ import annotations

import warnings
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING, Any

_TIR = find_spec("tir")
if _TIR is None or _TIR.origin is None:  # a folder that pip left behind has no origin
    raise ImportError(
        "the package tir is missing, probably because mffit-tir, which has the same files as mffit, was removed: "
        "pip install --force-reinstall --no-deps mffit"
    )
if any(Path(_TIR.origin).parents[1].glob("mffit_tir-*.dist-info")):
    warnings.warn(
        "mffit and mffit-tir are both installed and have the same files, so that removing one breaks the other: "
        "pip uninstall mffit-tir, then pip install --force-reinstall --no-deps mffit",
        stacklevel=2,
    )

if TYPE_CHECKING:
    from mffit.export import write_c, write_fmu
    from mffit.pipeline import (
        align,
        build,
        compare,
        diagnose,
        plan,
        predict,
        show,
        spin,
        verify,
        watch,
        write_tydex,
    )

    __version__: str

__all__ = [
    "align",
    "build",
    "compare",
    "convert",
    "diagnose",
    "plan",
    "predict",
    "show",
    "spin",
    "verify",
    "watch",
    "write_c",
    "write_fmu",
    "write_tydex",
]
ELSEWHERE = {
    "write_c": "mffit.export",
    "write_fmu": "mffit.export",
    "convert": "mffit.conversion",
}
"""Public names that are not the pipeline's."""


def __getattr__(name: str) -> Any:
    """A workflow, imported when it is first asked for because most need scipy and pandas; or the version."""
    if name == "__version__":
        from importlib.metadata import PackageNotFoundError, version

        try:
            return version("mffit")
        except PackageNotFoundError:  # a source tree that nobody installed
            return "unknown"
    if name in __all__:
        from importlib import import_module

        return getattr(import_module(ELSEWHERE.get(name, "mffit.pipeline")), name)
    raise AttributeError(f"module 'mffit' has no attribute {name!r}")


def __dir__() -> list[str]:
    """The public names, whether imported yet or not."""
    return sorted([*__all__, "__version__", *(name for name in globals() if name.startswith("__"))])
