"""``mffit build A.toml B.toml ...``: many tyres, one after the other, in processes or on a Dask cluster."""

import contextlib
import json
import threading
import time
from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from mffit import config as configuration
from mffit.config import Config
from mffit.errors import InputError
from mffit.fleet import read
from mffit.made import made
from mffit.output import BUILT, written_by
from mffit.pipeline.build_output import EXPLAINED, FOLDER, REPORT, WRITTEN, resolved_text
from mffit.pipeline.building import build
from mffit.pipeline.inputs import input_hashes
from mffit.pipeline.workers import Job, Outcomes, in_processes, on_cluster
from mffit.results import BuildOutcome
from tir.errors import TirError

Done = Callable[[BuildOutcome], None]
"""Called with every finished tyre, in the order in which they finish."""
ONE_AT_A_TIME = threading.Lock()
"""Drawing changes settings of the whole process, so the threads of a cluster's worker take turns."""


def build_many(
    sources: Sequence[str | Path],
    out: str | Path | None = None,
    *,
    jobs: int | str = 1,
    ensemble: int = 0,
    with_report: bool = True,
    done: Done = lambda outcome: None,
) -> tuple[BuildOutcome, ...]:
    """Build many tyres; a failure does not stop the others, and output that is complete and current is left unchanged.

    Parameters
    ----------
    sources : paths of ``tyre.toml``
    out : folder in which each tyre gets a folder of its name; default ``out`` next to each ``tyre.toml``
    jobs : number of processes, each of which builds one tyre at a time; 1 builds in this process. Or the address of a Dask
        scheduler, whose workers see the same files and have mffit
    ensemble, with_report : as in :func:`build`
    done : called with every finished tyre

    Returns
    -------
    tuple
        The outcome of each build, in the order of ``sources``.

    Raises
    ------
    InputError
        Two tyres would write to the same folder, or the cluster cannot be reached; nothing is built then.
    KeyboardInterrupt
        Builds reported to ``done`` are complete; the others have left no files.
    """
    paths = [Path(source) for source in sources]
    wanted, finished = _jobs(paths, None if out is None else Path(out), ensemble, with_report=with_report)
    for outcome in finished.values():
        done(outcome)
    with contextlib.closing(_outcomes(wanted, jobs)) as outcomes:
        for outcome in outcomes:
            finished[outcome.source] = outcome
            done(outcome)
    return tuple(finished[path] for path in paths)


def _outcomes(wanted: Sequence[Job], jobs: int | str) -> Outcomes:
    """Outcomes of the builds as they finish."""
    if isinstance(jobs, str):
        return on_cluster(wanted, jobs, build_one)
    return in_processes(wanted, jobs, build_one) if jobs > 1 else (build_one(job) for job in wanted)


def build_one(job: Job) -> BuildOutcome:
    """Build one tyre unless its output is current; errors become part of the outcome."""
    began = time.perf_counter()
    with ONE_AT_A_TIME:
        try:
            outcome = _built(job)
        except (InputError, TirError) as error:
            outcome = BuildOutcome(job.source, job.name, job.out, "refused", _one_line(str(error)))
        except Exception as error:  # a bug must not cost the other tyres
            said = _one_line(f"{type(error).__name__}: {error}")
            outcome = BuildOutcome(job.source, job.name, job.out, "failed", said)
    return replace(outcome, seconds=time.perf_counter() - began)


def _built(job: Job) -> BuildOutcome:
    """The outcome of a build, with the numbers that its folder holds."""
    config = configuration.load(job.source)
    current = is_current(config, job.out, ensemble=job.ensemble, with_report=job.with_report)
    if not current:
        build(config, job.out, ensemble=job.ensemble, with_report=job.with_report)
    specimen = read(job.out)
    return BuildOutcome(
        source=job.source,
        name=job.name,
        out=job.out,
        state="unchanged" if current else "built",
        epsilon_gamma=specimen.epsilon_gamma,
        misfit=specimen.misfit,
        warnings=len(specimen.warnings),
        file=specimen.file,
        reasons=specimen.reasons,
        in_doubt=specimen.in_doubt,
    )


def _one_line(text: str) -> str:
    return " ".join(text.split())


def _jobs(
    paths: Sequence[Path], out: Path | None, ensemble: int, *, with_report: bool
) -> tuple[list[Job], dict[Path, BuildOutcome]]:
    """The tyres to build, and the outcomes of those whose ``tyre.toml`` cannot be read."""
    wanted: list[Job] = []
    refused: dict[Path, BuildOutcome] = {}
    for path in paths:
        if path in refused or path in [job.source for job in wanted]:
            raise InputError("is named twice; remove one", file=path)
        try:
            name = configuration.load(path).tyre.name
        except InputError as error:
            refused[path] = BuildOutcome(path, str(path), None, "refused", str(error))
            continue
        folder = (path.parent / "out" if out is None else out / name).absolute()
        if other := next((job for job in wanted if job.out == folder), None):
            remedy = f'both are named "{name}" in [tyre], change one' if out else "name a folder with --out"
            raise InputError(f"would be built into {folder}, like {other.source}: {remedy}", file=path)
        wanted.append(Job(path, name, folder, ensemble, with_report))
    return wanted, refused


def is_current(config: Config, out: Path, *, ensemble: int = 0, with_report: bool = True) -> bool:
    """Whether ``out`` holds a complete, unedited build of this source, configuration and inputs.

    ``ensemble`` is the number of drawn files required, 0 accepts any; ``with_report`` requires the report.
    """
    kept = written_by(out, "build")
    try:
        result = json.loads((out / BUILT).read_text(encoding="utf-8"))
        files = [*WRITTEN, "resolved.toml", *result["files"].values()]
        drawn = sum(name.startswith(f"{FOLDER}/") and name.endswith(".tir") for name in kept)
        stated, now = result["made"], made(input_hashes(config))
        return (
            {name for name in files if with_report or name != REPORT} <= kept
            and ensemble in (0, drawn)
            and (out / "resolved.toml").read_bytes() == resolved_text(config, out)
            and stated["source"] == now.source
            and stated["inputs"] == now.inputs
        )
    except (OSError, ValueError, LookupError, TypeError, AttributeError):
        return False


def explained(out: Path) -> tuple[str, dict[str, Any]]:
    """All that is said about a build, and the content of its ``result.json``, from the folder that it wrote."""
    text = (out / EXPLAINED).read_text(encoding="utf-8").rstrip("\n")
    return text, json.loads((out / BUILT).read_text(encoding="utf-8"))
