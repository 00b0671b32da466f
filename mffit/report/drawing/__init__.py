"""Pictures as records: figures describe panels, and matplotlib draws each once for the page and for the PNG beside it.

``records`` say what is shown, ``panels`` draws a record into axes, ``pictures`` makes SVG and PNG of the same figures.
``panels`` and ``pictures`` load matplotlib, so other modules import them inside functions.
"""
