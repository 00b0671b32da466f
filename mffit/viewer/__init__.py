"""Property files as a page that evaluates them: curves of several tyres in common panels, with sliders."""

from mffit.viewer.page import Page, show

__all__ = ["Page", "show"]
