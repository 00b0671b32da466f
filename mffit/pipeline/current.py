"""Whether the output of an earlier build is complete and current."""

from __future__ import annotations

import json
from pathlib import Path

import mffit
import tir
from mffit.config import Config
from mffit.output import written_by
from mffit.pipeline.build_output import WRITTEN, resolved_text
from mffit.pipeline.members import FOLDER
from mffit.pipeline.provenance import PROGRAM, fitted_to
from tir.errors import TirError


def is_current(config: Config, out: Path, *, ensemble: int = 0) -> bool:
    """Whether ``out`` holds a complete, unedited build of this version, configuration and inputs.

    Parameters
    ----------
    config : configuration of the build
    out : folder of an earlier build; it need not exist
    ensemble : number of drawn files required; 0 accepts any
    """
    kept = written_by(out, "build")
    try:
        result = json.loads((out / "result.json").read_text(encoding="utf-8"))
        files = [*WRITTEN, "resolved.toml", *result["files"].values()]
        tyre = tir.read(out / result["tir"])
        drawn = sum(name.startswith(f"{FOLDER}/") and name.endswith(".tir") for name in kept)
        return (
            set(files) <= kept
            and ensemble in (0, drawn)
            and (out / "resolved.toml").read_bytes() == resolved_text(config, out)
            and tyre.provenance.get(PROGRAM) == f"mffit {mffit.__version__}"
            and fitted_to(tyre, config)
        )
    except (OSError, ValueError, LookupError, TypeError, AttributeError, TirError):
        return False
