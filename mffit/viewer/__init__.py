"""Property files as a page that evaluates them: curves of several tyres over one another, with sliders."""

from mffit.viewer.page import Page, show

__all__ = ["Page", "show"]
