"""Pages of the documentation that are written from records: ``python -m mffit.reference docs``."""

from mffit.reference.write import pages, write

__all__ = ["pages", "write"]
