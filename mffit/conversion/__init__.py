"""Property files of MF 5.2 and PAC2002 as files of MF 6.2: a new fit to the old forces, with its misfit stated."""

from mffit.conversion.convert import convert, write
from mffit.conversion.old_files import is_old, read_old
from mffit.conversion.result import Conversion

__all__ = ["Conversion", "convert", "is_old", "read_old", "write"]
