"""A local window in the browser for a project: adjust, refit, save; the page is that of ``mffit show tyre.toml``."""

from mffit.window.serving import open_path
