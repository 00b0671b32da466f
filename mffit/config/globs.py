"""Expansion of patterns in [[sweep]]: ``file = "runs/*.mat"`` becomes one entry per matching file."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from mffit.errors import InputError

WILD = frozenset("*?[")


def with_globs_expanded(
    content: Mapping[str, object], path: Path | None, folder: Path, lines: dict[str, int]
) -> tuple[Mapping[str, object], dict[str, int]]:
    """The content with one entry per file in place of every pattern, sorted by name, and the lines of its keys.

    The name of an existing file is never a pattern, even if it contains ``*``, ``?`` or ``[``.

    Raises
    ------
    InputError
        A pattern matches nothing.
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
        names = matches(entry["file"], folder) if _is_pattern(entry, folder) else [None]
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
    return bool(WILD & set(file)) and not (folder / file).exists()


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
