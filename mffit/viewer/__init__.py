"""Pages that evaluate tyres by themselves: curves of property files, or a project with its points and coefficients."""

from mffit.viewer.page import Page, files_page
from mffit.viewer.project import project_data, project_html, project_page, readings_data
