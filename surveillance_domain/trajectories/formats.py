"""Which form a file of trajectories has, and its rows."""

from __future__ import annotations

import gzip
import zlib
from collections.abc import Callable, Iterator, Mapping, Sequence
from io import BufferedReader, TextIOWrapper
from itertools import chain
from pathlib import Path

from surveillance_domain.site.faults import Fault
from surveillance_domain.trajectories.columns_text import parted, read_frame_text, read_obsmat
from surveillance_domain.trajectories.named_csv import read_csv
from surveillance_domain.trajectories.rows import (
    COMMENT_SIGNS,
    WITH_POINTS,
    LineBlock,
    Rows,
    TrajectoryError,
    has_decimal_comma,
    number_of,
    numbered,
)
from surveillance_domain.trajectories.trajnet import read_trajnet

__all__ = ["FORMATS", "read_rows"]

FORMATS = ("frame-text", "obsmat", "trajnet", "csv")
_MOST_BYTES = 500_000_000
_AT_MOST = "at most 500 million"
_BLOCK_BYTES = 2_000_000
_GZIP = b"\x1f\x8b"
_UTF_16 = (b"\xff\xfe", b"\xfe\xff")
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
        Told how many more bytes of the file have been read.

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
    except UnicodeError as error:
        reason = getattr(error, "reason", str(error))
        expected = "text in UTF-8 or UTF-16, as it is or packed by gzip; unpack other archives first"
        raise TrajectoryError(source, (Fault("", f"bytes that are no text ({reason})", expected),)) from None
    except (EOFError, zlib.error, gzip.BadGzipFile) as error:
        raise TrajectoryError(source, (Fault("", f"a broken .gz file: {error}", "a whole one"),)) from None
    except OSError as error:
        found = (error.strerror or str(error)).lower()
        raise TrajectoryError(source, (Fault("", found, f"a readable file of trajectories: {_FORMS}"),)) from None


def _blocks(path: Path, advance: Callable[[int], object] | None) -> Iterator[Sequence[str]]:
    """The file's lines, some at a time; what gzip packed is unpacked, and UTF-16 is known by its first two bytes."""
    if path.stat().st_size > _MOST_BYTES:
        raise TrajectoryError(str(path), (Fault("", f"{path.stat().st_size:,} bytes", _AT_MOST),))
    with path.open("rb") as packed, _text(packed) as text:
        read, characters = 0, 0
        while lines := text.readlines(_BLOCK_BYTES):
            characters += sum(map(len, lines))
            if characters > _MOST_BYTES:
                raise TrajectoryError(str(path), (Fault("", f"more than {_MOST_BYTES:,} characters", _AT_MOST),))
            if advance is not None:
                advance(packed.tell() - read)
                read = packed.tell()
            yield lines


def _text(packed: BufferedReader) -> TextIOWrapper:
    content: BufferedReader | gzip.GzipFile = packed
    if packed.peek(2)[:2] == _GZIP:
        content = gzip.GzipFile(fileobj=packed)
    return TextIOWrapper(content, encoding="utf-16" if content.peek(2)[:2] in _UTF_16 else "utf-8-sig")


def _first_words(block: LineBlock) -> str:
    """The first line that is not empty."""
    return next((line for line in block[1] if line.strip()), "")


def _form_of(first: str, source: str) -> str:
    words = parted(first).split()
    if first.lstrip().startswith("{"):
        return "trajnet"
    if first.lstrip().startswith(COMMENT_SIGNS):
        without = "no comments, which may name columns in another order than they are read in"
        raise TrajectoryError(source, (Fault("line 1", _shown(first), f"{without}: {_FORMS}"),))
    if has_decimal_comma(first):
        raise TrajectoryError(source, (Fault("line 1", _shown(first), f"{_FORMS}{WITH_POINTS}"),))
    if words and all(number_of(word) is not None for column, word in enumerate(words) if column != 1):  # ids: any words
        forms = {4: "frame-text", 8: "obsmat"}
        if len(words) in forms:
            return forms[len(words)]
        raise TrajectoryError(source, (Fault("line 1", f"{len(words)} numbers", _FORMS),))
    if any(sign in first for sign in ",;\t") and words and number_of(words[0]) is None:
        return "csv"
    raise TrajectoryError(source, (Fault("line 1", _shown(first), _FORMS),))


def _shown(line: str) -> str:
    return repr(line.strip()[:60])
