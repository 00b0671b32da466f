"""``file = "runs/*.mat"`` in a [[sweep]]: one entry for every file it matches."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from mffit.errors import InputError

WILD = frozenset("*?[")


def with_globs_expanded(
    content: Mapping[str, Any], path: Path | None, folder: Path, lines: dict[str, int]
) -> tuple[Mapping[str, Any], dict[str, int]]:
    """The content with every pattern replaced by its files in the order of their names, and the lines to go with it.

    A name of an existing file stays what it is, whatever letters it has.

    Raises
    ------
    InputError
        A pattern matches nothing.
    """
    sweeps = content.get("sweep")
    if isinstance(sweeps, Mapping):
        sweeps = [sweeps]
    if not isinstance(sweeps, list) or not any(_is_wild(entry, folder) for entry in sweeps):
        return content, lines
    expanded: list[Any] = []
    found_lines = {key: line for key, line in lines.items() if not key.startswith("sweep.")}
    for index, entry in enumerate(sweeps):
        own = {key: line for key, line in lines.items() if f"{key}.".startswith(f"sweep.{index}.")}
        names = matches(entry["file"], folder) if _is_wild(entry, folder) else [None]
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


def _is_wild(entry: Any, folder: Path) -> bool:
    file = entry.get("file") if isinstance(entry, Mapping) else None
    return isinstance(file, str) and is_wild(file, folder)


def is_wild(file: str, folder: Path) -> bool:
    """Whether a name is a pattern and not that of an existing file."""
    return bool(WILD & set(file)) and not (folder / file).exists()


def matches(pattern: str, folder: Path) -> list[str]:
    """Files that a pattern matches, named relative to the folder, or absolute if the pattern is."""
    start = Path(pattern)
    root = Path(start.anchor) if start.is_absolute() else folder
    relative = str(start.relative_to(start.anchor)) if start.is_absolute() else pattern
    try:
        found = sorted(found for found in root.glob(relative) if found.is_file())
    except (ValueError, NotImplementedError, OSError):
        return []
    return [str(file) if start.is_absolute() else file.relative_to(folder).as_posix() for file in found]
