"""What is fitted for itself: radii and rolling resistance of the freely rolling wheel."""
