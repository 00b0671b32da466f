"""The compiled kernels of this process, and when one is loaded or compiled by itself.

A meter counts what is computed without machine code. When that has taken about as long as loading the kernel takes, the kernel is
loaded from the cache of the user, or compiled if it is not there, once per machine. So a program with few calls pays nothing.
"""

import contextlib
import math
from functools import cache

from tir import constants
from tir.codegen.cpython import kernel
from tir.codegen.cpython.kernel import Kernel
from tir.codegen.program import Switches
from tir.errors import TirError

WORTH_LOADING = {
    "one": int(constants.SCALAR_CALLS_WORTH_LOADING),
    "batch": int(constants.CONDITIONS_WORTH_LOADING),
}
WITHOUT_KERNEL = (TirError, ImportError, OSError, RuntimeError)
"""What a broken llvmlite or a full disk raises; calls then continue without the kernel, which nobody requested."""


class Meter:
    """What is left to compute without machine code, in scalar calls or conditions, for one combination of switches."""

    __slots__ = ("kind", "left", "loaded", "switches")

    def __init__(self, kind: str, switches: Switches):
        self.kind, self.switches = kind, switches
        self.left: float = WORTH_LOADING[kind]
        self.loaded: Kernel | None = None

    def kernel(self) -> Kernel | None:
        """The kernel if it is loaded or has become worth it; else None."""
        if self.loaded is None and self.left <= 0.0:
            self.left = math.inf  # there is one attempt
            if kernel.obstacle() is None:
                with contextlib.suppress(*WITHOUT_KERNEL):
                    self.load()
        return self.loaded

    def load(self) -> None:
        """Load or compile the kernel now; counted calls then use it."""
        self.loaded = kernel.load(self.kind, self.switches)
        self.left = 0.0


@cache
def meter(kind: str, switches: Switches) -> Meter:
    """The meter of this process for a kind of calls."""
    return Meter(kind, switches)
