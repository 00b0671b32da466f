"""From tyre-rig sweeps to an MF-6.2 property file with a measured camber reduction factor.

>>> import mffit
>>> result = mffit.build("samples/front-120-70/tyre.toml")  # doctest: +SKIP
>>> result.measured.epsilon_gamma  # doctest: +SKIP
"""

import sys
import warnings
from importlib.machinery import ModuleSpec
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING, Any

_REINSTALL = "pip install --force-reinstall --no-deps mffit"


def _wrong_tir(found: ModuleSpec | None) -> str:
    """Why ``import tir`` does not give what mffit needs; empty if it does. A project on PyPI has a package of this name, too."""
    if found is None or found.origin is None:  # a folder that pip left behind has no origin
        return (
            "the package tir is missing, probably because mffit-tir or tir, which have files of the same names as mffit, "
            f"was removed: {_REINSTALL}"
        )
    try:
        source = found.loader.get_data(found.origin)  # type: ignore[union-attr]
    except (AttributeError, OSError):
        return ""  # packed by a program that shows no sources
    if b"MF-6.2" in source or not found.origin.endswith(".py"):
        return ""
    replaced = Path(found.origin).parents[1] == Path(__file__).parents[1]
    remedy = f"pip uninstall tir, then {_REINSTALL}" if replaced else "rename it, or start in another folder"
    return f"{found.origin} is not the tir that mffit needs, but has its name: {remedy}"


_TIR = find_spec("tir")
if _WRONG := _wrong_tir(_TIR):
    # The command line cannot catch what happens before its first line.
    if sys.argv[:1] == ["-m"] or Path(*sys.argv[:1]).stem == "mffit":
        print(f"mffit: {_WRONG}", file=sys.stderr)
        raise SystemExit(2)
    raise ImportError(_WRONG)
assert _TIR is not None
assert _TIR.origin is not None
for _other in ("mffit-tir", "tir"):
    if any(Path(_TIR.origin).parents[1].glob(f"{_other.replace('-', '_')}-*.dist-info")):
        warnings.warn(
            f"mffit and {_other} are both installed and have files of the same names, so that removing one breaks the other: "
            f"pip uninstall {_other}, then {_REINSTALL}",
            stacklevel=2,
        )

if TYPE_CHECKING:
    from mffit.conversion.convert import convert
    from mffit.export import write_c, write_fmu, write_matlab, write_table
    from mffit.pipeline import align, build, compare, diagnose, plan, predict, show, spin, watch, write_tydex

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
    "watch",
    "write_c",
    "write_fmu",
    "write_matlab",
    "write_table",
    "write_tydex",
]


def __getattr__(name: str) -> Any:
    """A workflow, imported when it is first asked for because most need scipy and pandas; or the version."""
    if name == "__version__":
        from importlib.metadata import PackageNotFoundError, version

        try:
            return version("mffit")
        except PackageNotFoundError:  # a source tree that nobody installed
            return "unknown"
    from mffit.on_demand import on_demand

    return on_demand(__name__)(name)


def __dir__() -> list[str]:
    """The public names, whether imported yet or not."""
    return sorted([*__all__, "__version__", *(name for name in globals() if name.startswith("__"))])
