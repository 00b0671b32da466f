"""Coefficients from other tyres: a base file converted to the nominal conditions."""
