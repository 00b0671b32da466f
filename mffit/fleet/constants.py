"""Numbers of judgement of the estimate of a fleet."""

from tir.constant import Real

INFORMED_VARIANCE_SHARE = Real(
    0.8, "-", "A tyre's points inform a number if the variance falls below this share of the prior's."
)
