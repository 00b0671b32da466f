"""Coefficients from elsewhere: of a sister tyre, or of another campaign of this tyre."""
