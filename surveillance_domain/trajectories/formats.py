"""Which form a file of trajectories has, and its rows."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from itertools import chain
from pathlib import Path

from surveillance_domain.site.faults import Fault
from surveillance_domain.trajectories.columns_text import read_frame_text, read_obsmat
from surveillance_domain.trajectories.named_csv import read_csv
from surveillance_domain.trajectories.rows import LineBlock, Rows, TrajectoryError, number_of, numbered
from surveillance_domain.trajectories.trajnet import read_trajnet

__all__ = ["FORMATS", "read_rows"]

FORMATS = ("frame-text", "obsmat", "trajnet", "csv")
_MOST_BYTES = 500_000_000
_BLOCK_BYTES = 2_000_000
_FORMS = (
    "four columns (frame id x y), the eight of obsmat.txt (frame id x z y vx vz vy), TrajNet++ ndjson, "
    "or CSV with a header that names frame or time_s, id, x and y"
)


def read_rows(
    path: Path,
    form: str | None = None,
    columns: Mapping[str, str] | None = None,
    advance: Callable[[int], object] | None = None,
) -> Rows:
    """The rows of a file.

    Parameters
    ----------
    path : Path
    form : {"frame-text", "obsmat", "trajnet", "csv"}, optional
        Without it the first line decides: a JSON object, four numbers, eight numbers, or names.
    columns : mapping, optional
        Names of a CSV file's columns, where they are others.
    advance : callable, optional
        Told how many more characters have been read.

    Raises
    ------
    TrajectoryError
        If the file cannot be read, has none of the forms, or has lines that do not fit.
    """
    source = str(path)
    if form is not None and form not in FORMATS:
        raise TrajectoryError(source, (Fault("", f"the form {form!r}", f"one of {', '.join(FORMATS)}"),))
    try:
        blocks = numbered(_blocks(path, advance))
        begun = next((block for block in blocks if _first_words(block)), None)
        if begun is None:
            raise TrajectoryError(source, (Fault("", "an empty file", f"trajectories: {_FORMS}"),))
        form = form or _form_of(_first_words(begun), source)
        rest = chain([begun], blocks)
        if form == "csv":
            return read_csv(rest, source, columns)
        if columns:
            raise TrajectoryError(source, (Fault("", f"columns for a file of the form {form}", "them for CSV only"),))
        read = {"frame-text": read_frame_text, "obsmat": read_obsmat, "trajnet": read_trajnet}
        return read[form](rest, source)
    except UnicodeDecodeError as error:
        raise TrajectoryError(source, (Fault("", f"bytes that are not UTF-8 ({error.reason})", "text"),)) from None
    except OSError as error:
        found = (error.strerror or str(error)).lower()
        raise TrajectoryError(source, (Fault("", found, f"a readable file of trajectories: {_FORMS}"),)) from None


def _blocks(path: Path, advance: Callable[[int], object] | None) -> Iterator[Sequence[str]]:
    """The file's lines, some at a time."""
    if path.stat().st_size > _MOST_BYTES:
        raise TrajectoryError(str(path), (Fault("", f"{path.stat().st_size:,} bytes", "at most 500 million"),))
    with path.open(encoding="utf-8-sig") as file:
        while lines := file.readlines(_BLOCK_BYTES):
            if advance is not None:
                advance(sum(map(len, lines)))
            yield lines


def _first_words(block: LineBlock) -> str:
    """The first line that is not empty."""
    return next((line for line in block[1] if line.strip()), "")


def _form_of(first: str, source: str) -> str:
    words = first.replace(",", " ").split()
    if first.lstrip().startswith("{"):
        return "trajnet"
    if all(number_of(word) is not None for column, word in enumerate(words) if column != 1):  # ids are any words
        forms = {4: "frame-text", 8: "obsmat"}
        if len(words) in forms:
            return forms[len(words)]
        raise TrajectoryError(source, (Fault("line 1", f"{len(words)} numbers", _FORMS),))
    if any(sign in first for sign in ",;\t") and number_of(words[0]) is None and not first.startswith(("%", "#")):
        return "csv"
    raise TrajectoryError(source, (Fault("line 1", repr(first.strip()[:60]), _FORMS),))
