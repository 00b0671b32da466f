"""From tyre-rig sweeps to an MF-6.2 property file with a measured camber reduction factor."""

__version__ = "0.1.0"
