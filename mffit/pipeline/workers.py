"""Builds in processes of their own, on this machine or on a Dask cluster."""

from __future__ import annotations

import contextlib
import multiprocessing
import os
import signal
from collections import deque
from collections.abc import Callable, Generator, Iterable, Sequence
from concurrent.futures import FIRST_COMPLETED, CancelledError, Executor, Future, ProcessPoolExecutor, wait
from concurrent.futures.process import BrokenProcessPool
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Any

from mffit.errors import InputError
from mffit.results import BuildOutcome

CLUSTER_BUILDS_IN_FLIGHT = 1000
"""Builds submitted to a Dask cluster at a time; more than any cluster works on at once."""
START_METHOD = "spawn"
"""A forked copy of a process with threads may hang, so worker processes start from scratch."""


@dataclass(frozen=True, slots=True)
class Job:
    """One tyre to build."""

    source: Path
    name: str
    out: Path
    ensemble: int = 0
    with_report: bool = True


BuildOne = Callable[[Job], BuildOutcome]
"""Builds one tyre; raises nothing but KeyboardInterrupt."""
Outcomes = Generator[BuildOutcome, None, None]


def in_processes(wanted: Sequence[Job], jobs: int, build_one: BuildOne) -> Outcomes:
    """Outcomes of builds in ``jobs`` processes; builds in progress when a process died are repeated one at a time."""
    left, suspects = deque(wanted), list[Job]()
    while left:
        suspects += yield from _pooled(left, jobs, build_one)
    for job in suspects:
        killed = yield from _pooled(deque([job]), 1, build_one)
        for _ in killed:
            yield _lost(job)


def on_cluster(wanted: Sequence[Job], address: str, build_one: BuildOne) -> Outcomes:
    """Outcomes of builds on a Dask cluster, which repeats the builds of workers that died.

    Raises
    ------
    InputError
        Dask is not installed, or no scheduler answers.
    """
    try:
        from distributed import Client
    except ImportError:
        raise InputError("--dask needs the package distributed: pip install 'mffit[dask]'") from None
    try:
        client = Client(address, timeout=10)
    except (OSError, ValueError, TypeError) as error:
        raise InputError(
            f"no Dask scheduler answers at {address} ({type(error).__name__}): start one with `dask scheduler`, "
            "or correct --dask"
        ) from None
    absolute = [replace(job, source=job.source.absolute()) for job in wanted]
    given = {job.source.absolute(): job.source for job in wanted}
    with client:
        executor = client.get_executor(pure=False)
        for outcome in _submitted(executor, deque(absolute), CLUSTER_BUILDS_IN_FLIGHT, build_one):
            yield replace(outcome, source=given[outcome.source])


def _pooled(left: deque[Job], jobs: int, build_one: BuildOne) -> Generator[BuildOutcome, None, list[Job]]:
    """Build until nothing is left or a process dies; returns the jobs in progress at that moment."""
    pool = ProcessPoolExecutor(
        jobs, mp_context=multiprocessing.get_context(START_METHOD), initializer=_ignore_interrupts
    )
    others = set(multiprocessing.active_children())
    try:
        return (yield from _submitted(pool, left, jobs, partial(_interruptible, build_one)))
    except (KeyboardInterrupt, GeneratorExit):
        _interrupt(set(multiprocessing.active_children()) - others)
        raise
    finally:
        pool.shutdown(cancel_futures=True)


def _submitted(
    executor: Executor, left: deque[Job], at_once: int, build_one: BuildOne
) -> Generator[BuildOutcome, None, list[Job]]:
    """Outcomes as they arrive; returns the jobs in progress if a process died and the pool with it, else none.

    At most ``at_once`` jobs are submitted, so that an interruption leaves none queued.
    """
    in_flight: dict[Future[BuildOutcome], Job] = {}
    while left or in_flight:
        try:
            while left and len(in_flight) < at_once:
                in_flight[executor.submit(build_one, left[0])] = left[0]
                left.popleft()
        except BrokenProcessPool:
            return list(in_flight.values()) or [left.popleft()]
        wait(in_flight, return_when=FIRST_COMPLETED)
        ended = {future: future.exception() for future in in_flight if future.done()}
        for future, error in ended.items():
            if isinstance(error, KeyboardInterrupt):
                raise error
            if not isinstance(error, BrokenProcessPool):
                job = in_flight.pop(future)
                yield future.result() if error is None else _lost(job, error)
        if any(isinstance(error, BrokenProcessPool) for error in ended.values()):
            return list(in_flight.values())
    return []


def _lost(job: Job, error: BaseException | None = None) -> BuildOutcome:
    """The outcome of a job whose process ended."""
    why = f" ({type(error).__name__})" if error is not None and not isinstance(error, CancelledError) else ""
    sentence = f"its process ended early{why}, perhaps for lack of memory; build it again alone"
    return BuildOutcome(job.source, job.name, job.out, "failed", sentence)


def _ignore_interrupts() -> None:
    """Make an idle worker ignore Ctrl-C; its parent ends it."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)


def _interruptible(build_one: BuildOne, job: Job) -> BuildOutcome:
    """Build with Ctrl-C enabled, so that an interrupted build removes its temporary files."""
    signal.signal(signal.SIGINT, signal.default_int_handler)
    try:
        return build_one(job)
    finally:
        _ignore_interrupts()


def _interrupt(children: Iterable[Any]) -> None:
    """Send the workers the signal of Ctrl-C, which may have reached only this process."""
    for child in children:
        if os.name == "nt" or child.pid is None:
            child.terminate()
        else:
            with contextlib.suppress(ProcessLookupError):
                os.kill(child.pid, signal.SIGINT)
