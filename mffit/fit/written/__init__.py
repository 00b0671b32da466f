"""The written files: for turn slip on, off or both, their ranges, and their misfit to the fitted model."""
