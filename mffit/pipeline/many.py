"""``mffit build A.toml B.toml ...``: many tyres, each in a process of its own, here or on a Dask cluster."""

from __future__ import annotations

import contextlib
import multiprocessing
import os
import signal
import threading
import time
from collections import deque
from collections.abc import Callable, Generator, Iterable, Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, CancelledError, Executor, Future, ProcessPoolExecutor, wait
from concurrent.futures.process import BrokenProcessPool
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from mffit import config as configuration
from mffit.errors import InputError
from mffit.fleet import read
from mffit.pipeline.building import build
from mffit.pipeline.current import is_current
from mffit.results import Outcome
from tir.errors import TirError

Done = Callable[[Outcome], None]
"""Called with every tyre that is finished, in the order in which they are."""
Task = Callable[["Job"], Outcome]
Outcomes = Generator[Outcome, None, None]
FEW = 1000
"""Builds that a cluster is given at a time."""
STARTED = "spawn"
"""How a worker process is started: afresh, as a copy of a process with threads may hang."""
PATIENCE = 10
"""Seconds after which a scheduler that does not answer is taken for absent."""
ONE_AT_A_TIME = threading.Lock()
"""Pictures are drawn with settings of the whole process: the threads of a cluster's worker take turns."""


@dataclass(frozen=True, slots=True)
class Job:
    """One tyre to build."""

    source: Path
    name: str
    out: Path
    ensemble: int = 0


def build_many(
    sources: Sequence[str | Path],
    out: str | Path | None = None,
    *,
    jobs: int = 1,
    dask: str | None = None,
    ensemble: int = 0,
    done: Done = lambda outcome: None,
) -> tuple[Outcome, ...]:
    """Build many tyres; one that fails does not stop the others, and one whose output is whole and current is left as it is.

    Parameters
    ----------
    sources : paths of ``tyre.toml``
    out : folder in which each tyre gets a folder of its name; default ``out`` beside each ``tyre.toml``
    jobs : tyres at a time, each in a process of its own; 1: one after the other in this process
    dask : address of a Dask scheduler, whose workers see the same files and have mffit; ``jobs`` does not count then
    ensemble : as of :func:`build`
    done : called with every tyre that is finished

    Returns
    -------
    tuple
        What became of each, in the order of ``sources``.

    Raises
    ------
    InputError
        Two tyres would write to the same folder, or the cluster cannot be reached; nothing is built then.
    KeyboardInterrupt
        What was finished before is whole, as ``done`` was told; what was not has left no trace.
    """
    paths = [Path(source) for source in sources]
    wanted, finished = _jobs(paths, None if out is None else Path(out), ensemble)
    for outcome in finished.values():
        done(outcome)
    how = _on_cluster(wanted, dask) if dask else _here(wanted) if jobs <= 1 else in_processes(wanted, jobs)
    with contextlib.closing(how):
        for outcome in how:
            finished[outcome.source] = outcome
            done(outcome)
    return tuple(finished[path] for path in paths)


def build_one(job: Job) -> Outcome:
    """Build one tyre, or see that it need not be; what goes wrong is told, not raised."""
    began = time.perf_counter()

    def ended(state: Any, sentence: str = "") -> Outcome:
        seconds = time.perf_counter() - began
        return Outcome(job.source, job.name, job.out, state, " ".join(sentence.split()), seconds)

    with ONE_AT_A_TIME:
        try:
            config = configuration.load(job.source)
            current = is_current(config, job.out, ensemble=job.ensemble)
            if not current:
                build(config, job.out, ensemble=job.ensemble)
            return _described(ended("unchanged" if current else "built"))
        except (InputError, TirError) as error:
            return ended("refused", str(error))
        except Exception as error:  # a bug, told beside the others' results
            return ended("failed", f"{type(error).__name__}: {error}")


def _described(outcome: Outcome) -> Outcome:
    """With the numbers of the table, which stand in the folder."""
    assert outcome.out is not None
    specimen = read(outcome.out)
    return outcome.having(
        epsilon_gamma=specimen.epsilon_gamma,
        misfit=specimen.misfit,
        warnings=len(specimen.warnings),
        file=specimen.file,
    )


def _jobs(paths: Sequence[Path], out: Path | None, ensemble: int) -> tuple[list[Job], dict[Path, Outcome]]:
    """What is to be built, and what is refused at once because it cannot be read."""
    wanted: list[Job] = []
    refused: dict[Path, Outcome] = {}
    for path in paths:
        if path in refused or path in [job.source for job in wanted]:
            raise InputError("is named twice; remove one", file=path)
        try:
            name = configuration.load(path).tyre.name
        except InputError as error:
            refused[path] = Outcome(path, str(path), None, "refused", str(error))
            continue
        folder = (path.parent / "out" if out is None else out / name).absolute()
        for other in wanted:
            if other.out == folder:
                raise InputError(
                    f"would be built into {folder}, like {other.source}: "
                    + (
                        "name a folder with --out"
                        if out is None
                        else f'both are named "{name}" in [tyre], change one'
                    ),
                    file=path,
                )
        wanted.append(Job(path, name, folder, ensemble))
    return wanted, refused


def _here(wanted: Sequence[Job]) -> Outcomes:
    yield from map(build_one, wanted)


def in_processes(wanted: Sequence[Job], jobs: int, task: Task | None = None) -> Outcomes:
    """Each in a process of its own; those in flight when one of the processes died are tried again one at a time."""
    left, suspects = deque(wanted), list[Job]()
    while left:
        suspects += yield from _pooled(left, jobs, task or _in_worker)
    for job in suspects:
        killed = yield from _pooled(deque([job]), 1, task or _in_worker)
        for _ in killed:
            yield _lost(job)


def _pooled(left: deque[Job], jobs: int, task: Task) -> Generator[Outcome, None, list[Job]]:
    """Build until nothing is left or a process dies; returns what was in flight then."""
    pool = ProcessPoolExecutor(
        jobs, mp_context=multiprocessing.get_context(STARTED), initializer=_quiet_worker
    )
    others = set(multiprocessing.active_children())
    try:
        yield from _submitted(pool, left, jobs, task)
        return []
    except _Died as died:
        return died.jobs
    except (KeyboardInterrupt, GeneratorExit):
        _interrupt(set(multiprocessing.active_children()) - others)
        raise
    finally:
        pool.shutdown(cancel_futures=True)


def _on_cluster(wanted: Sequence[Job], address: str) -> Outcomes:
    """On the workers of a Dask cluster; it takes care of those that die and runs their builds elsewhere."""
    try:
        from distributed import Client
    except ImportError:
        raise InputError("--dask needs the package distributed: pip install 'mffit[dask]'") from None
    try:
        client = Client(address, timeout=PATIENCE)
    except (OSError, ValueError, TypeError) as error:
        raise InputError(
            f"no Dask scheduler answers at {address} ({type(error).__name__}): start one with `dask scheduler`, "
            "or correct --dask"
        ) from None
    absolute = [Job(job.source.absolute(), job.name, job.out, job.ensemble) for job in wanted]
    given = {job.source.absolute(): job.source for job in wanted}
    with client:
        for outcome in _submitted(client.get_executor(pure=False), deque(absolute), FEW, build_one):
            yield outcome.having(source=given[outcome.source])


class _Died(Exception):
    """A worker process ended, and with it the pool; ``jobs`` were in flight."""

    def __init__(self, jobs: list[Job]) -> None:
        self.jobs = jobs


def _submitted(executor: Executor, left: deque[Job], at_once: int, task: Task) -> Iterator[Outcome]:
    """Outcomes as they come; no more in flight than are worked on, so that an interruption leaves none waiting."""
    flying: dict[Future[Outcome], Job] = {}
    while left or flying:
        try:
            while left and len(flying) < at_once:
                flying[executor.submit(task, left[0])] = left[0]
                left.popleft()
        except BrokenProcessPool:
            raise _Died(list(flying.values()) or [left.popleft()]) from None
        ended, _ = wait(flying, return_when=FIRST_COMPLETED)
        broken = [flying[f] for f in ended if isinstance(f.exception(), BrokenProcessPool)]
        for future in ended:
            job = flying[future]
            error = future.exception()
            if isinstance(error, KeyboardInterrupt):
                raise error
            if isinstance(error, BrokenProcessPool):
                continue
            del flying[future]
            yield _lost(job, error) if error is not None else future.result()
        if broken:
            for future in [f for f in flying if f.done() and f.exception() is None]:
                del flying[future]
                yield future.result()
            raise _Died(list(flying.values()))


def _lost(job: Job, error: BaseException | None = None) -> Outcome:
    why = f" ({type(error).__name__})" if error is not None and not isinstance(error, CancelledError) else ""
    sentence = f"its process ended before its time{why}, perhaps for lack of memory; build it again alone"
    return Outcome(job.source, job.name, job.out, "failed", sentence)


def _quiet_worker() -> None:
    """A worker that waits hears no Ctrl-C: its parent ends it."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)


def _in_worker(job: Job) -> Outcome:
    """A worker that builds does hear it, and clears away what it has begun."""
    signal.signal(signal.SIGINT, signal.default_int_handler)
    try:
        return build_one(job)
    finally:
        signal.signal(signal.SIGINT, signal.SIG_IGN)


def _interrupt(children: Iterable[Any]) -> None:
    """What Ctrl-C does in a terminal, for whom it was sent to this process alone."""
    for child in children:
        if os.name == "nt" or child.pid is None:
            child.terminate()
        else:
            with contextlib.suppress(ProcessLookupError):
                os.kill(child.pid, signal.SIGINT)
