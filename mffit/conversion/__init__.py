"""Property files of MF 5.2 and PAC2002 as files of MF 6.2, and back: a new fit to the other's forces, with its misfit stated."""

from mffit.conversion.backwards import KINDS, to_old
from mffit.conversion.convert import READERS, check_old, convert, write
from mffit.conversion.old_files import read_old
from mffit.conversion.result import Conversion
from tir.formula import is_old
