"""From tyre-rig sweeps to an MF-6.2 property file with a measured camber reduction factor.

>>> import mffit
>>> result = mffit.build("samples/front-120-70/tyre.toml")  # doctest: +SKIP
>>> result.measured.epsilon_gamma  # doctest: +SKIP
"""

from __future__ import annotations

from typing import Any

__version__ = "0.1.0"

__all__ = ["align", "build", "diagnose", "spin"]


def __getattr__(name: str) -> Any:
    """Import the pipeline when one of its workflows is first asked for: it needs scipy and pandas."""
    if name in __all__:
        from importlib import import_module

        return getattr(import_module("mffit.pipeline"), name)
    raise AttributeError(f"module 'mffit' has no attribute {name!r}")
