"""Rig errors that a fit frees, and their priors."""
