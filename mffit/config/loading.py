"""From the text of ``tyre.toml`` to a checked :class:`Config`, or one sentence that says what to correct."""

from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path

from mffit.config.by_hand import of_command_line
from mffit.config.models import Config
from mffit.config.problems import Keys, known_keys, validated
from mffit.config.toml_file import TomlKind, read_toml
from mffit.errors import InputError
from mffit.sheets import file_of

WILD = frozenset("*?[")


def with_globs_expanded(
    content: Mapping[str, object],
    path: Path | None,
    folder: Path,
    lines: dict[str, int],
    *,
    awaiting: bool = False,
) -> tuple[Mapping[str, object], dict[str, int]]:
    """The content with one entry per file in place of every pattern, sorted by name, and the lines of its keys.

    The name of an existing file is never a pattern, even if it contains ``*``, ``?`` or ``[``. With ``awaiting``, a pattern
    that matches nothing yet is kept.

    Raises InputError if a pattern matches nothing.
    """
    sweeps = content.get("sweep")
    if isinstance(sweeps, Mapping):
        sweeps = [sweeps]
    if not isinstance(sweeps, list) or not any(_is_pattern(entry, folder) for entry in sweeps):
        return content, lines
    expanded: list[object] = []
    found_lines = {key: line for key, line in lines.items() if not key.startswith("sweep.")}
    for index, entry in enumerate(sweeps):
        own = {key: line for key, line in lines.items() if f"{key}.".startswith(f"sweep.{index}.")}
        names: list[str | None] = [None]
        if _is_pattern(entry, folder):
            names = [*matches(entry["file"], folder)] or ([None] if awaiting else [])
        if not names:
            raise InputError(
                f'no file in {folder.absolute()} matches "{entry["file"]}"; correct the pattern',
                file=path,
                line=own.get(f"sweep.{index}.file"),
                key=f"sweep[{index + 1}].file",
            )
        for name in names:
            for key, line in own.items():
                found_lines[f"sweep.{len(expanded)}{key.removeprefix(f'sweep.{index}')}"] = line
            expanded.append(entry if name is None else {**entry, "file": name})
    return {**content, "sweep": expanded}, found_lines


def _is_pattern(entry: object, folder: Path) -> bool:
    file = entry.get("file") if isinstance(entry, Mapping) else None
    return isinstance(file, str) and is_pattern(file, folder)


def is_pattern(file: str, folder: Path) -> bool:
    """Whether the text is a pattern and not the name of an existing file."""
    return bool(WILD & set(file)) and not file_of(folder / file).exists()


def matches(pattern: str, folder: Path) -> list[str]:
    """Names of the files that match a pattern, sorted; relative to the folder unless the pattern is absolute."""
    start = Path(pattern)
    root = Path(start.anchor) if start.is_absolute() else folder
    relative = str(start.relative_to(start.anchor)) if start.is_absolute() else pattern
    try:
        found = sorted(found for found in root.glob(relative) if found.is_file())
    except (ValueError, NotImplementedError, OSError):
        return []
    return [str(file) if start.is_absolute() else file.relative_to(folder).as_posix() for file in found]


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
    awaiting: bool = False,
) -> Config:
    """Read and check a configuration.

    Parameters
    ----------
    source : path of a ``tyre.toml``, its content as a mapping, or a Config, which is returned unchanged
    folder : where relative file names start; default the file's own, the current one for a mapping
    coefficients : ``NAME=VALUE``, each instead of the entry of [coefficients] of this name; not for a Config
    awaiting : keep a pattern of [[sweep]] that matches no file yet

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
    path = None if isinstance(source, Mapping) else Path(source)
    content, lines = (source, {}) if isinstance(source, Mapping) else _tables(Path(source))
    given, own = of_command_line(coefficients), content.get("coefficients", {})
    if given and isinstance(own, Mapping):
        content = {**content, "coefficients": {**own, **given}}
    start = Path(folder or (path.parent if path else "."))
    try:
        return checked(content, path=path, folder=start, lines=lines, awaiting=awaiting)
    except InputError as error:
        name = (error.key or "").removeprefix("coefficients.")
        if name in given:  # has no line
            raise InputError(error.sentence, key=f"--set {name}") from None
        raise


def _tables(path: Path) -> tuple[Mapping[str, object], dict[str, int]]:
    """Content of a ``tyre.toml`` and the line of every key."""
    content, lines = read_toml(path, TYRE_TOML)
    if plan := content.keys() & RIG_TOML_TABLES:
        raise InputError(
            f"has the table [{min(plan)}], so it is a rig.toml for the virtual rig: run `mffit simulate` on it and build the "
            "tyre.toml that it writes",
            file=path,
        )
    return content, lines


def checked(
    content: Mapping[str, object],
    *,
    path: Path | None,
    folder: Path,
    lines: dict[str, int],
    known: Keys | None = None,
    awaiting: bool = False,
) -> Config:
    """The configuration that a mapping holds; arguments and errors as in :func:`load`.

    ``path`` is the file it came from, None for a mapping; ``lines`` has the line of every key in it; ``known`` are keys to
    suggest for an unknown one, those of ``tyre.toml`` by default.
    """
    content, lines = with_globs_expanded(content, path, folder, lines, awaiting=awaiting)
    config = validated(Config, content, path=path, lines=lines, known=known or known_keys(Config))
    config._path, config._folder, config._lines = path, folder, lines
    return config


@contextmanager
def as_declared(config: Config) -> Iterator[None]:
    """Within this block, errors about a sweep name its file from here, its column by the file's heading and declared unit."""
    try:
        yield
    except InputError as error:
        file, column, sentence = error.file, error.column, error.sentence
        if file is None:
            raise
        of_file = [entry for entry in config.sweep if Path(entry.file).name == file.name]
        if any(Path(entry.file) == file for entry in of_file):
            file = config.folder / file
        known = [
            columns[column]
            for columns in (*(one.columns for one in of_file), config.columns)
            if column in columns
        ]
        if column is not None and known:
            heading = known[0].column or column
            sentence = sentence.replace(f'column = "{column}"', f'column = "{heading}"')
            if known[0].unit is not None:
                sentence += f"; {heading} is declared as {known[0].unit}"
            column = heading
        raise InputError(sentence, file=file, line=error.line, column=column, key=error.key) from None
