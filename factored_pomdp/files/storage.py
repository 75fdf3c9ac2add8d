"""Load and save models, in the format that the file's name ends with."""

from __future__ import annotations

from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from factored_pomdp.model import FactoredPOMDP

__all__ = ["ENDINGS", "load", "save"]

ENDINGS = (".pomdp", ".pomdpx")
"""Read and written in any mixture of capitals."""


def load(path: str | PathLike[str]) -> FactoredPOMDP:
    """The model in a file: Cassandra's ``.pomdp``, or ``.pomdpx``, which keeps variables and factors apart.

    Parameters
    ----------
    path : path-like

    Raises
    ------
    FileError
        With every fault of the file, each with its line.
    ValueError
        For another ending.
    OSError
        Where the file cannot be read.
    """
    found = Path(path)
    if _ending(found) == ".pomdp":
        from factored_pomdp.files.cassandra.reader import read_cassandra

        return read_cassandra(found)
    from factored_pomdp.files.pomdpx.reader import read_pomdpx

    return read_pomdpx(found)


def save(model: FactoredPOMDP, path: str | PathLike[str]) -> None:
    """Write a model; an existing file is replaced once the new one is complete.

    Parameters
    ----------
    model : FactoredPOMDP
    path : path-like
        ``.pomdpx`` keeps the variables and factors; for ``.pomdp`` they are flattened (see
        `factored_pomdp.files.flatten.flattened`). Names that are no words become words; groups are not written.

    Raises
    ------
    TooLarge
        Where the flat model, or a factor that has to be laid out, would be too large.
    ValueError
        For another ending, or where the format has no place for a part of the model.
    OSError
        Where the file cannot be written.
    """
    place = Path(path)
    if _ending(place) == ".pomdp":
        from factored_pomdp.files.cassandra.writer import write_cassandra

        write_cassandra(model, place)
        return
    from factored_pomdp.files.pomdpx.writer import write_pomdpx

    write_pomdpx(model, place)


def _ending(path: Path) -> str:
    ending = path.suffix.lower()
    if ending not in ENDINGS:
        raise ValueError(f"{path}: {path.suffix or 'no ending'!r}; expected a name that ends with .pomdp or .pomdpx")
    return ending
