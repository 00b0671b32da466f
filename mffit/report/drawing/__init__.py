"""Pictures as records, and matplotlib's drawing of them: ``records`` say what is shown, ``pictures`` makes PNG.

``pictures`` loads matplotlib, so other modules import it inside functions.
"""
