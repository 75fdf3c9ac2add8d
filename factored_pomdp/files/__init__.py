"""Models in files: Cassandra's ``.pomdp``, SARSOP's ``.pomdpx``."""

from factored_pomdp.files.faults import FileError, FileFault
from factored_pomdp.files.storage import ENDINGS, load, save

__all__ = ["ENDINGS", "FileError", "FileFault", "load", "save"]
