"""A :class:`RigPlan` from ``rig.toml``, or an InputError that says what to correct."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from mffit.config import Config
from mffit.config.loading import checked
from mffit.config.problems import known_keys, validated
from mffit.config.toml_file import TomlKind, read_toml
from mffit.errors import InputError
from mffit.virtual_rig.plan import RigPlan, RigTables

OWN = frozenset(RigTables.model_fields)
"""Tables that only ``rig.toml`` has; all others are as in ``tyre.toml``."""

RIG_TOML = TomlKind(
    name="rig.toml",
    tables=OWN,
    example="`mffit init --sample front-120-70 DIR`",
    base='a rig.toml names it as tyre = "..." under [truth]',
    otherwise=lambda path: "`mffit init --sample front-120-70 DIR` writes one to start from",
)


def load_plan(source: str | Path | Mapping[str, Any], *, folder: str | Path | None = None) -> RigPlan:
    """The checked plan of a virtual test campaign.

    Parameters
    ----------
    source : path of a ``rig.toml``, or its content as a mapping
    folder : base of relative file names; default the file's folder, for a mapping the current one

    Raises
    ------
    InputError
        The file cannot be read or is not TOML, or a key is unknown or missing or has an impossible value.
    """
    if isinstance(source, Mapping):
        return _checked(source, None, Path(folder or "."), {})
    path = Path(source)
    content, lines = read_toml(path, RIG_TOML)
    return _checked(content, path, Path(folder or path.parent), lines)


def _checked(content: Mapping[str, Any], path: Path | None, folder: Path, lines: dict[str, int]) -> RigPlan:
    known = known_keys(RigTables, Config)
    own = {key: value for key, value in content.items() if key in OWN}
    tables = validated(RigTables, own, path=path, lines=lines, known=known)
    shared = {key: value for key, value in content.items() if key not in OWN}
    shared["sweep"] = [{"file": sweep.file} for sweep in tables.sweep]
    declared = checked(shared, path=path, folder=folder, lines=lines, known=known)
    if declared.rig.type == "flat-track" and any(
        row.u_effective_radius is None for row in tables.rolling_radius
    ):
        raise InputError(
            "a flat track has no disc to turn; give u_effective_radius", file=path, key="rolling_radius"
        )
    return RigPlan(declared, tables, folder)
