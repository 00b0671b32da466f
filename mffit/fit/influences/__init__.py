"""Influences that a fit may model in addition to tyre and rig: temperature, hysteresis, lag, wear, scatter between runs."""
