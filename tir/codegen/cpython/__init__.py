"""Machine code as a built-in function of CPython: the only place that knows CPython's C interface."""

import numpy as np

SCALARS = frozenset({float, int, bool, np.float64, np.float32, np.int64, np.int32})
"""Types of the arguments that a scalar call takes as they are."""
