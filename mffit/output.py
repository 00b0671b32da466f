"""A folder that is written whole or not at all, and never over what somebody else put there."""

from __future__ import annotations

import errno
import hashlib
import json
import os
import platform
import re
import shutil
import tempfile
from collections.abc import Collection, Iterable, Iterator, Mapping
from contextlib import contextmanager, suppress
from pathlib import Path, PurePosixPath
from typing import NamedTuple

from mffit.errors import InputError

RECORD = ".mffit.json"
"""The usual record of a folder: each file that a run wrote there, with its SHA-256 and the command that did."""

ABOUT = "Written by mffit: it replaces the files listed here, while they are unchanged, and no others."

READY = ".ready.json"
"""Stands in a temporary folder from the moment in which its files begin to move: the next run ends what a killed one began."""
NO_ROOM = frozenset({errno.ENOSPC, errno.EROFS, errno.EDQUOT, errno.EFBIG})
"""What a full or read-only disk says."""


class Entry(NamedTuple):
    """What a record says of a file; ``by:sha256`` in JSON."""

    by: str  #: the command that wrote it
    sha256: str


@contextmanager
def output_folder(
    out: Path,
    *,
    by: str = "mffit",
    protected: Iterable[Path] = (),
    outdated: Iterable[str] = (),
    record: str = RECORD,
) -> Iterator[Path]:
    """A temporary folder beside ``out`` whose files go to ``out`` only if the block succeeds.

    Parameters
    ----------
    out : folder to write to; made if need be
    by : the command that writes, so that it clears away only pictures of its own
    protected : files that the run reads
    outdated : names that would pass for this run's output if an earlier one left them
    record : JSON file of ``out`` that lists, under ``files``, what was written; one of the run's own JSON
        files may serve, which then carries that key

    Raises
    ------
    InputError
        ``out`` cannot be written to, or a file in the way is not this program's to replace; ``out`` is as
        it was then.

    Notes
    -----
    A file of ``out`` is replaced only if an earlier run wrote it and nobody changed it since (the record
    tells), or if it would get the bytes that it has. A file that the run reads is never replaced by other
    bytes, whoever wrote it. Files that the run does not write stay. In folders within ``out`` (``plots``),
    what an earlier run of the same command wrote, and this one does not, goes, if it is unchanged.

    An interrupted or failing run leaves ``out`` as it was. A killed one leaves its temporary folder, which
    the next run to the same place removes: its name tells machine and process. If it was killed while its
    finished files were moving, the next run moves the rest first.
    """
    parent = out.absolute().parent
    if out.exists() and not out.is_dir():
        raise InputError(f"{out} is a file, and the output needs a folder: name another with --out")
    try:
        parent.mkdir(parents=True, exist_ok=True)
        _remove_litter(out.absolute())
        temporary = Path(tempfile.mkdtemp(prefix=f"{_prefix(out.name)}{os.getpid()}-", dir=parent))
    except OSError as error:
        raise InputError(
            f"cannot write to {parent} ({error.strerror}): name another folder with --out"
        ) from error
    try:
        yield temporary
        files = sorted(path for path in temporary.rglob("*") if path.is_file())
        written = {path.relative_to(temporary).as_posix(): digest(path) for path in files}
        recorded = _recorded(out, record)
        # A record lists itself by being one.
        itself = {record: Entry(by, digest(out / record))} if recorded else {}
        _refuse(out, written, recorded | itself, protected)
        try:
            _move(temporary, out, written, recorded, by, record, frozenset(outdated))
        except OSError as error:
            raise InputError(
                f"cannot be written to ({error.strerror}: {error.filename}); close what uses it or name another "
                "folder with --out",
                file=out,
            ) from error
    except OSError as error:
        if error.errno not in NO_ROOM:
            raise
        raise InputError(
            f"cannot be written to ({error.strerror}); make room or name another folder with --out", file=out
        ) from error
    finally:
        shutil.rmtree(temporary, ignore_errors=True)


def refuse_early(out: Path, names: Collection[str], protected: Iterable[Path] = ()) -> None:
    """Refuse before the work what :func:`output_folder` would refuse after it, as far as names are known.

    Raises
    ------
    InputError
        One of ``names`` stands in ``out`` and is not this program's to replace.
    """
    if out.is_dir():
        _refuse(out, dict.fromkeys(names, ""), _recorded(out, RECORD), protected)


def written_by(out: Path, by: str, record: str = RECORD) -> frozenset[str]:
    """Files of ``out`` that the command ``by`` wrote and that are as it left them; empty where nothing is recorded."""
    try:
        recorded = _recorded(out, record)
        return frozenset(
            name
            for name, entry in recorded.items()
            if entry.by == by and (out / name).is_file() and digest(out / name) == entry.sha256
        )
    except (InputError, OSError):
        return frozenset()


def digest(path: Path) -> str:
    """SHA-256 of a file, in hex."""
    return hashlib.sha256(path.read_bytes()).hexdigest()


def _refuse(
    out: Path,
    written: Mapping[str, str],
    recorded: Mapping[str, Entry],
    protected: Iterable[Path],
) -> None:
    """Raise if a file of ``written`` would replace one that it must not."""
    inputs = [path for path in protected if path.exists()]
    for name, new in written.items():
        target = out / name
        for folder in list(target.parents)[: len(PurePosixPath(name).parents) - 1]:
            if folder.exists() and not folder.is_dir():
                raise InputError(
                    "is a file where the output has a folder; move it away or name another folder with --out",
                    file=folder,
                )
        if not os.path.lexists(target):
            continue
        if not target.is_file():
            raise InputError(
                "is no file, and the output writes one there; move it away or name another folder with --out",
                file=target,
            )
        old = digest(target)
        if old == new:
            continue
        if any(os.path.samefile(target, path) for path in inputs):
            raise InputError(
                "is an input of this run, and its output would replace it; name another folder with --out",
                file=target,
            )
        if name not in recorded:
            raise InputError(
                "would be replaced, and no run of mffit is known to have written it; move it away or name "
                "another folder with --out",
                file=target,
            )
        if recorded[name].sha256 != old:
            raise InputError(
                "would be replaced, and was changed since mffit wrote it; move it away or name another folder "
                "with --out",
                file=target,
            )


def _move(
    temporary: Path,
    out: Path,
    written: Mapping[str, str],
    recorded: Mapping[str, Entry],
    by: str,
    record: str,
    outdated: frozenset[str],
) -> None:
    """Put the files in their places, take away stale ones, and record it."""
    stale = _stale(out, written, recorded, by, outdated)
    kept = {name: entry for name, entry in recorded.items() if name not in stale and (out / name).is_file()}
    entries = kept | {name: Entry(by, new) for name, new in written.items() if name != record}
    file = temporary / record
    content = json.loads(file.read_text(encoding="utf-8")) if record in written else {"about": ABOUT}
    content["files"] = {name: ":".join(entry) for name, entry in sorted(entries.items())}
    file.write_text(json.dumps(content, indent=2, ensure_ascii=False) + "\n", encoding="utf-8")
    out.mkdir(exist_ok=True)
    (temporary / READY).write_text(json.dumps({"record": record, "stale": stale}), encoding="utf-8")
    _carry(temporary, out, [name for name in written if name != record], stale, record)


def _carry(temporary: Path, out: Path, names: Iterable[str], stale: Iterable[str], record: str) -> None:
    """Move the files, take the stale ones away, and the record last: it tells of a whole folder."""
    for name in names:
        (out / name).parent.mkdir(exist_ok=True)
        os.replace(temporary / name, out / name)
    for name in stale:
        (out / name).unlink(missing_ok=True)
    os.replace(temporary / record, out / record)


def _end(dead: Path, out: Path) -> None:
    """Move what a killed run had finished and not yet moved; nothing if somebody changed a file since."""
    ready = json.loads((dead / READY).read_text(encoding="utf-8"))
    record = ready["record"]
    if not (dead / record).is_file():
        return
    recorded = _recorded(out, record)
    left = {path.relative_to(dead).as_posix(): digest(path) for path in dead.rglob("*") if path.is_file()}
    moving = {name: new for name, new in left.items() if name not in (READY, record)}
    _refuse(out, moving, recorded, ())
    unchanged = [
        n
        for n in ready["stale"]
        if n in recorded and (out / n).is_file() and digest(out / n) == recorded[n].sha256
    ]
    _carry(dead, out, moving, unchanged, record)


def _stale(
    out: Path, written: Mapping[str, str], recorded: Mapping[str, Entry], by: str, outdated: frozenset[str]
) -> list[str]:
    """Files of an earlier run of this command, unchanged since, that this run did not write again.

    In the folders that it wrote to all of them; beside them those that would pass for its own, ``outdated``.
    """
    folders = {PurePosixPath(name).parent for name in written} - {PurePosixPath(".")}
    return [
        name
        for name, entry in recorded.items()
        if name not in written
        and (PurePosixPath(name).parent in folders or name in outdated)
        and entry.by == by
        and (out / name).is_file()
        and digest(out / name) == entry.sha256
    ]


def _recorded(out: Path, record: str) -> dict[str, Entry]:
    """What earlier runs wrote, by name relative to ``out``; a record of our own name must be one."""
    path = out / record
    try:
        files = json.loads(path.read_text(encoding="utf-8"))["files"]
        return {name: Entry(*text.split(":")) for name, text in files.items()}
    except FileNotFoundError:
        return {}
    except (OSError, ValueError, LookupError, TypeError, AttributeError):
        if record != RECORD:
            return {}
        raise InputError(
            "is not the record of written files that mffit keeps under this name; move it away", file=path
        ) from None


def _prefix(name: str) -> str:
    machine = re.sub(r"[^A-Za-z0-9]", "_", platform.node()) or "here"
    return f".{name}-{machine}-"


def _remove_litter(out: Path) -> None:
    """Remove temporary folders for ``out`` whose process, on this machine, is no more; first what they had finished moves."""
    prefix = _prefix(out.name)
    for path in out.parent.iterdir():
        found = re.fullmatch(r"(\d+)-\w{8}", path.name.removeprefix(prefix))
        if path.name.startswith(prefix) and found and path.is_dir() and not _alive(int(found[1])):
            if (path / READY).is_file():
                with suppress(InputError, OSError, ValueError, LookupError, TypeError):
                    _end(path, out)
            shutil.rmtree(path, ignore_errors=True)


def _alive(pid: int) -> bool:
    """Whether the process runs; taken to be so on Windows, where asking with a signal would end it."""
    if os.name == "nt":
        return True
    try:
        os.kill(pid, 0)
    except ProcessLookupError:
        return False
    except (PermissionError, OverflowError):
        return True
    return True


def must_be_new(folder: Path, names: Iterable[str]) -> None:
    """Refuse a folder that holds one of the names already."""
    for name in names:
        if (folder / name).exists():
            raise InputError("is there already; name another folder or move it away", file=folder / name)


def new_files(folder: Path, contents: Mapping[str, str | bytes]) -> list[Path]:
    """Write new files into a folder, none of which may be there already; returns their paths.

    Raises
    ------
    InputError
        One of the files is there already, or the folder cannot be written to.
    """
    must_be_new(folder, contents)
    try:
        folder.mkdir(parents=True, exist_ok=True)
        for name, content in contents.items():
            (folder / name).write_bytes(content.encode() if isinstance(content, str) else content)
    except (FileExistsError, NotADirectoryError):
        raise InputError("is a file; name a folder", file=folder) from None
    except OSError as error:
        raise InputError(
            f"cannot be written to ({error.strerror}); name another folder", file=folder
        ) from None
    return [folder / name for name in contents]
