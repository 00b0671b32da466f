"""The smallest rig.toml: one sweep of three points, without noise or base file."""

SMALL_PLAN = """\
[truth]
tyre = "true.tir"

[tyre]
name = "small"
unloaded_radius = 0.2992
nominal_load = 1400
nominal_pressure = 250

[rig]
path_radius = 1.323

[[sweep]]
file = "sideslip.csv"
load_N = 1400
alpha_deg = [-2, 0, 2]
"""
