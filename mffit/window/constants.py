"""Numbers of judgement of the local window."""

from tir.constant import Count, Real

LOOK_AGAIN = Real(0.2, "s", "Time between looks at tyre.toml and at the progress: faster than one notices.")
TIME_TO_STOP = Real(
    3.0, "s", "Time in which a stopped run may remove its temporary files before it is killed."
)
LARGEST_REQUEST = Count(
    1_000_000, "-", "Largest request in bytes: seventy thousand single lines left out at once."
)
