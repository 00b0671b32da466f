"""The errors of the rig that a fit frees, and their priors."""
