"""Where targets are at the start: ``uniform``, or a weight for each cell from a CSV file beside the site file.

The file has a header ``column,row,weight`` and a line for each cell; cells that it leaves out have no weight.
"""

from __future__ import annotations

import csv
import io
import math
from pathlib import Path

import numpy as np
from jaxtyping import Float

from surveillance_domain.site.faults import Fault
from surveillance_domain.site.grid import Grid

__all__ = ["UNIFORM", "prior_text", "read_prior"]

UNIFORM = "uniform"
_HEADER = ["column", "row", "weight"]
_WHERE = "targets.prior"
_MOST_BYTES = 100_000_000
_MOST_FAULTS = 10


def read_prior(
    named: str, folder: Path, grid: Grid
) -> tuple[Float[np.ndarray, " cells"] | None, bytes, tuple[Fault, ...]]:
    """The probability of each free cell, and what the file holds.

    Parameters
    ----------
    named : str
        What the site file says: "uniform", or the path of a file.
    folder : Path
        Where a relative path starts.
    grid : Grid

    Returns
    -------
    (cells,) float or None
        Sums to one; ``None`` for "uniform", or with a fault.
    bytes
        Of the file, for the site's digest.
    tuple of Fault
        Everything that is wrong with it.
    """
    if named == UNIFORM:
        return None, b"", ()
    path = folder / named
    try:
        if path.stat().st_size > _MOST_BYTES:
            return None, b"", (Fault(_WHERE, f'"{named}", {path.stat().st_size:,} bytes', "at most 100 million"),)
        content = path.read_bytes()
        text = content.decode("utf-8-sig")
    except UnicodeDecodeError:
        return None, b"", (Fault(_WHERE, f'"{named}", which is not UTF-8 text', "CSV: column,row,weight"),)
    except OSError as error:
        found = f'"{named}", {(error.strerror or str(error)).lower()}'
        expected = f'"{UNIFORM}", or the path of a CSV file (column,row,weight), relative to {folder}'
        return None, b"", (Fault(_WHERE, found, expected),)
    weights, faults = _weights(text, grid)
    if not faults and not weights.any():
        faults = [Fault("", "no weight above 0", "one cell, at least, where targets can be")]
    if faults:
        more = len(faults) - _MOST_FAULTS
        told = [Fault(_WHERE, f"in {named}, {f.where}: {f.found}".replace(", :", ":"), f.expected) for f in faults]
        rest = [Fault(_WHERE, f"in {named}: {more} more faults of this kind", "as above")] if more > 0 else []
        return None, b"", (*told[:_MOST_FAULTS], *rest)
    scaled = weights / weights.max()
    return scaled / scaled.sum(), content, ()


def _weights(text: str, grid: Grid) -> tuple[Float[np.ndarray, " cells"], list[Fault]]:
    reader = csv.reader(io.StringIO(text), skipinitialspace=True)
    weights, faults = np.zeros(grid.size), list[Fault]()
    lines: dict[int, int] = {}
    header = [word.strip().lower() for word in next(reader, [])]
    if header != _HEADER:
        return weights, [Fault("line 1", ",".join(header) or "nothing", "the header column,row,weight")]
    for words in reader:
        if not any(word.strip() for word in words):
            continue
        where, found = f"line {reader.line_num}", ",".join(words)
        try:
            column, row, weight = int(words[0]), int(words[1]), float(words[2])
        except (ValueError, IndexError):
            faults.append(Fault(where, found, "three numbers: column, row, weight"))
            continue
        if len(words) != len(_HEADER):
            faults.append(Fault(where, found, "three numbers: column, row, weight"))
        elif not (0 <= column < grid.columns and 0 <= row < grid.rows):
            expected = f"a column of 0 to {grid.columns - 1} and a row of 0 to {grid.rows - 1}, from the lower left"
            faults.append(Fault(where, f"cell [{column}, {row}], which is not on the map", expected))
        elif (number := int(grid.number[row, column])) < 0:
            faults.append(Fault(where, f"cell [{column}, {row}], which is blocked", "free cells only"))
        elif number in lines:
            faults.append(Fault(where, f"cell [{column}, {row}], as on line {lines[number]}", "each cell once"))
        elif not (math.isfinite(weight) and weight >= 0):
            faults.append(Fault(where, f"weight {words[2].strip()}", "a finite number, 0 or more"))
        else:
            weights[number] = weight
            lines[number] = reader.line_num
    return weights, faults


def prior_text(weights: Float[np.ndarray, " cells"], grid: Grid) -> str:
    """The file of a prior; cells without weight are left out."""
    told = (
        f"{column},{row},{weight:.6g}"
        for (column, row), weight in zip(grid.cells.tolist(), weights.tolist(), strict=True)
        if weight > 0
    )
    return "\n".join([",".join(_HEADER), *told]) + "\n"
