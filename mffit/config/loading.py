"""From the text of ``tyre.toml`` to a checked :class:`Config`, or one sentence that says what to correct."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from pathlib import Path

from mffit.config.by_hand import of_command_line
from mffit.config.globs import with_globs_expanded
from mffit.config.models import Config
from mffit.config.problems import Keys, known_keys, validated
from mffit.config.toml_file import TomlKind, read_toml
from mffit.errors import InputError

RIG_TOML_TABLES = frozenset({"truth", "faults", "noise", "conditions"})
"""Tables that only ``rig.toml`` has."""

STAND_IN = {"unloaded_radius": 0.3, "nominal_load": 1500.0, "nominal_pressure": 250.0}
"""Placeholder for a tyre that is not known yet; no result of reading depends on it."""

TYRE_TOML = TomlKind(
    name="tyre.toml",
    tables=Config.model_fields.keys(),
    example="`mffit init DIR`",
    base='`mffit check` checks it, and a tyre.toml names it as base = "..." under [tyre]',
    otherwise=lambda path: (
        f"if it is a recording or a table of points, `mffit init --from {path.name} DIR` writes one for it"
    ),
)


def load(
    source: str | Path | Mapping[str, object] | Config,
    *,
    folder: str | Path | None = None,
    coefficients: Iterable[str] = (),
) -> Config:
    """Read and check a configuration.

    Parameters
    ----------
    source : path of a ``tyre.toml``, its content as a mapping, or a Config, which is returned unchanged
    folder : where relative file names start; default the file's own, the current one for a mapping
    coefficients : ``NAME=VALUE``, each instead of the entry of [coefficients] of this name; not for a Config

    Returns
    -------
    Config
        Every default filled in.

    Raises
    ------
    InputError
        The file cannot be read or is not TOML, or a key is unknown or missing or has an impossible value.
    """
    if isinstance(source, Config):
        return source
    if given := of_command_line(coefficients):
        return _with(source, given, folder)
    if isinstance(source, Mapping):
        return checked(source, path=None, folder=Path(folder or "."), lines={})
    path = Path(source)
    content, lines = _tables(path)
    return checked(content, path=path, folder=Path(folder or path.parent), lines=lines)


def _tables(path: Path) -> tuple[dict[str, object], dict[str, int]]:
    """Content of a ``tyre.toml`` and the line of every key."""
    content, lines = read_toml(path, TYRE_TOML)
    if plan := content.keys() & RIG_TOML_TABLES:
        raise InputError(
            f"has the table [{min(plan)}], so it is a rig.toml for the virtual rig: run `mffit simulate` on it and build the "
            "tyre.toml that it writes",
            file=path,
        )
    return content, lines


def _with(
    source: str | Path | Mapping[str, object], given: Mapping[str, object], folder: str | Path | None
) -> Config:
    """The configuration with some entries of [coefficients] replaced; a mistake in one of these has no line."""
    path = None if isinstance(source, Mapping) else Path(source)
    content, lines = (dict(source), {}) if isinstance(source, Mapping) else _tables(Path(source))
    own = content.get("coefficients", {})
    if isinstance(own, Mapping):
        content["coefficients"] = {**own, **given}
    start = Path(folder or (path.parent if path else "."))
    try:
        return checked(content, path=path, folder=start, lines=lines)
    except InputError as error:
        name = (error.key or "").removeprefix("coefficients.")
        if name in given:
            raise InputError(error.sentence, key=f"--set {name}") from None
        raise


def checked(
    content: Mapping[str, object],
    *,
    path: Path | None,
    folder: Path,
    lines: dict[str, int],
    known: Keys | None = None,
) -> Config:
    """The configuration that a mapping holds.

    Parameters
    ----------
    content : tables and keys of a ``tyre.toml``
    path : the file it came from; None for a mapping
    folder : where relative file names start
    lines : line of every key in the file
    known : keys to suggest for an unknown one; those of ``tyre.toml`` by default

    Raises
    ------
    InputError
        As :func:`load`.
    """
    content, lines = with_globs_expanded(content, path, folder, lines)
    config = validated(Config, content, path=path, lines=lines, known=known or known_keys(Config))
    config._path, config._folder, config._lines = path, folder, lines
    return config
