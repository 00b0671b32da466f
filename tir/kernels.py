"""The compiled kernels of this process, and when one is loaded or compiled by itself.

A meter counts what is computed without machine code. When that has taken about as long as loading the kernel takes, the kernel is
loaded from the cache of the user; if it is not there, a thread compiles it while the calls go on. So a program with few calls
pays nothing, and one with many pays at most twice what the best choice would have cost.
"""

from __future__ import annotations

import math
import os
from typing import TYPE_CHECKING

from tir import constants
from tir.codegen.cpython import kernel
from tir.codegen.cpython.kernel import Kernel
from tir.codegen.program import Switches
from tir.errors import TirError

if TYPE_CHECKING:
    from threading import Thread

WORTH_LOADING = {
    "one": int(constants.SCALAR_CALLS_WORTH_LOADING),
    "batch": int(constants.CONDITIONS_WORTH_LOADING),
}
LOADED: dict[tuple[str, Switches], Kernel] = {}
"""The kernels loaded in this process."""


class Meter:
    """What is left to compute without machine code, in scalar calls or conditions, for one combination of switches."""

    __slots__ = ("kind", "left", "switches")

    def __init__(self, kind: str, switches: Switches):
        self.kind, self.switches = kind, switches
        self.left: float = WORTH_LOADING[kind]

    def kernel(self, *, now: bool = False) -> Kernel | None:
        """The kernel if it is loaded, or has become worth it and is in the cache; else None, until it is compiled.

        ``now`` compiles it at once.
        """
        found = LOADED.get((self.kind, self.switches))
        if found is not None or (self.left > 0.0 and not now):
            return found
        self.left = math.inf
        if not kernel.available():
            return None
        try:
            if now or kernel.is_cached(self.kind, self.switches):
                return load(self.kind, self.switches)
        except WITHOUT_KERNEL:
            return None
        _start(self)
        return None


WITHOUT_KERNEL = (TirError, ImportError, OSError, RuntimeError)
"""What a broken llvmlite or a full disk raises; nobody asked for the kernel, so the calls go on without it."""
METERS: dict[tuple[str, Switches], Meter] = {}
_THREADS: list[Thread] = []
"""Threads that compile, and a mark that forks wait for them."""


def meter(kind: str, switches: Switches) -> Meter:
    """The meter of this process for a kind of calls."""
    if (kind, switches) not in METERS:
        METERS[kind, switches] = Meter(kind, switches)
    return METERS[kind, switches]


def load(kind: str, switches: Switches) -> Kernel:
    """The kernel, loaded or compiled now; calls that were counted change over to it."""
    wait()
    LOADED[kind, switches] = found = kernel.load(kind, switches)
    meter(kind, switches).left = 0.0
    return found


def wait() -> None:
    """Return when no kernel is being compiled in the background."""
    while _THREADS:
        _THREADS[-1].join()
        _THREADS.pop()


def _start(asked: Meter) -> None:
    """Compile in a thread, for which forks of this process wait: a copy of a compiler at work could not be used."""
    from threading import Thread  # imported late, so that import tir is quick

    global _forks_wait
    if not _forks_wait and hasattr(os, "register_at_fork"):
        os.register_at_fork(before=wait)
    _forks_wait = True
    thread = Thread(target=_compile, args=(asked,), name="tir compiles")
    _THREADS.append(thread)
    thread.start()


_forks_wait = False


def _compile(asked: Meter) -> None:
    try:
        LOADED[asked.kind, asked.switches] = kernel.load(asked.kind, asked.switches)
    except WITHOUT_KERNEL:
        return
    asked.left = 0.0
