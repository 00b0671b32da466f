"""Whether the output of a build is there, whole, and of these very inputs."""

from __future__ import annotations

import json
from pathlib import Path

import mffit
import tir
from mffit.config import Config
from mffit.output import written_by
from mffit.pipeline.building import WRITTEN, resolved_text
from mffit.pipeline.members import FOLDER
from mffit.pipeline.provenance import PROGRAM, fitted_to
from tir.errors import TirError


def is_current(config: Config, out: Path, *, ensemble: int = 0) -> bool:
    """Whether a build into ``out`` would write what is there: same version, configuration and inputs, nothing missing or edited.

    Parameters
    ----------
    config : as it would be built
    out : folder of an earlier build, which may not be there
    ensemble : number of drawn files that there should be
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
