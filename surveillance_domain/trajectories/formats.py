"""Which form a file of trajectories has, and its rows."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

from surveillance_domain.site.faults import Fault
from surveillance_domain.trajectories.columns_text import read_frame_text, read_obsmat
from surveillance_domain.trajectories.named_csv import read_csv
from surveillance_domain.trajectories.rows import Rows, TrajectoryError, number_of
from surveillance_domain.trajectories.trajnet import read_trajnet

__all__ = ["FORMATS", "read_rows"]

FORMATS = ("frame-text", "obsmat", "trajnet", "csv")
_MOST_BYTES = 500_000_000
_FORMS = (
    "four columns (frame id x y), the eight of obsmat.txt (frame id x z y vx vz vy), TrajNet++ ndjson, "
    "or CSV with a header that names frame or time_s, id, x and y"
)


def read_rows(path: Path, form: str | None = None, columns: Mapping[str, str] | None = None) -> Rows:
    """The rows of a file.

    Parameters
    ----------
    path : Path
    form : {"frame-text", "obsmat", "trajnet", "csv"}, optional
        Without it the first line decides: a JSON object, four numbers, eight numbers, or names.
    columns : mapping, optional
        Names of a CSV file's columns, where they are others.

    Raises
    ------
    TrajectoryError
        If the file cannot be read, has none of the forms, or has lines that do not fit.
    """
    source = str(path)
    lines = _lines(path)
    first = next((line for line in lines if line.strip()), "")
    if not first:
        raise TrajectoryError(source, (Fault("", "an empty file", f"trajectories: {_FORMS}"),))
    form = form or _form_of(first, source)
    if form == "csv":
        return read_csv(lines, source, columns)
    if columns:
        raise TrajectoryError(source, (Fault("", f"columns for a file of the form {form}", "them for CSV only"),))
    read = {"frame-text": read_frame_text, "obsmat": read_obsmat, "trajnet": read_trajnet}
    if form not in read:
        raise TrajectoryError(source, (Fault("", f"the form {form!r}", f"one of {', '.join(FORMATS)}"),))
    return read[form](lines, source)


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


def _lines(path: Path) -> Sequence[str]:
    try:
        if path.stat().st_size > _MOST_BYTES:
            raise TrajectoryError(str(path), (Fault("", f"{path.stat().st_size:,} bytes", "at most 500 million"),))
        return path.read_text(encoding="utf-8-sig").splitlines()
    except UnicodeDecodeError as error:
        raise TrajectoryError(str(path), (Fault("", f"bytes that are not UTF-8 ({error.reason})", "text"),)) from None
    except OSError as error:
        found = (error.strerror or str(error)).lower()
        raise TrajectoryError(str(path), (Fault("", found, f"a readable file of trajectories: {_FORMS}"),)) from None
