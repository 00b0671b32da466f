"""Pictures as records: figures describe panels, and one layout gives the SVG of the page and the PNG beside it.

``records`` say what is shown, ``layout`` turns a panel into a few plain shapes, ``svg`` and ``png`` write the same shapes.
"""
