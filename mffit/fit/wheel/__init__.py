"""Separate fits: radii and rolling resistance of the freely rolling wheel."""
