"""Coefficients from elsewhere: of the base file at the nominal conditions, and of a sister tyre."""
