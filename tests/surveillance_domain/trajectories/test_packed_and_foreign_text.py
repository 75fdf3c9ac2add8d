"""Packed files, other encodings and separators; and what is told where a file's form is nearly right."""

from __future__ import annotations

import gzip
from pathlib import Path

import pytest

from surveillance_domain.trajectories.conventions import Conventions
from surveillance_domain.trajectories.formats import read_rows
from surveillance_domain.trajectories.load import load_tracks
from surveillance_domain.trajectories.rows import Rows, TrajectoryError

FOUR = "780 1 8.46 3.59\n790 1 9.57 3.79\n780 2 1 2\n790 2 1.5 2\n"
NAMED = "frame,id,x,y\n0,ann,0,0\n1,ann,0.5,0\n"


def same(found: Rows, other: Rows) -> bool:
    return (
        found.names == other.names
        and found.frames.tolist() == other.frames.tolist()
        and found.points.tolist() == other.points.tolist()
        and found.lines.tolist() == other.lines.tolist()
    )


@pytest.mark.example
@pytest.mark.parametrize("text", [FOUR, NAMED])
@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "utf-16", "utf-16-le", "utf-16-be"])
@pytest.mark.parametrize("packed", [False, True])
def test_gzip_and_utf_16_are_read_as_the_plain_file(tmp_path: Path, text: str, encoding: str, packed: bool) -> None:
    plain = tmp_path / "plain"
    plain.write_text(text, encoding="utf-8")
    mark = "\ufeff" if encoding[-2:] in ("le", "be") else ""
    content = (mark + text).encode(encoding)
    other = tmp_path / "other"
    other.write_bytes(gzip.compress(content) if packed else content)
    told: list[int] = []
    assert same(read_rows(other, advance=told.append), read_rows(plain))
    assert sum(told) == other.stat().st_size  # progress is of the bytes that the file has


@pytest.mark.example
@pytest.mark.parametrize("separator", ["\t", ",", ";", "; "])
def test_what_stands_between_columns(tmp_path: Path, separator: str) -> None:
    plain, other = tmp_path / "plain", tmp_path / "other"
    plain.write_text(FOUR)
    other.write_text(FOUR.replace(" ", separator))
    assert same(read_rows(other), read_rows(plain))


def told(path: Path, content: bytes) -> str:
    path.write_bytes(content)
    with pytest.raises(TrajectoryError) as caught:
        load_tracks(path, Conventions(10.0))
    assert str(caught.value).startswith(str(path))
    return str(caught.value)


@pytest.mark.example
@pytest.mark.parametrize(
    ("content", "words"),
    [
        (b"# frame id x y\n" + FOUR.encode(), ("line 1: found '# frame id x y'; expected no comments",)),
        (FOUR.encode() + b"# the end of this day\n", ("line 5: found a comment; expected 4 numbers",)),
        (b"780 1 8,46 3,59\n", ("line 1: found '780 1 8,46 3,59'", "decimals stand behind a point: 8.46, not 8,46")),
        (b"780;1;8,46;3,59\n", ("line 1: found '780;1;8,46;3,59'", "behind a point")),
        (FOUR.encode() + b"800;1;8,46;3,59\n", ("line 5: found 6 columns; expected 4 numbers", "behind a point")),
        (b"frame;id;x;y\n1;a;8,46;3,59\n", ("line 2: found x = '8,46', y = '3,59'", "behind a point")),
        (b"PK\x03\x04\xff\xff\x80", ("bytes that are no text", "unpack other archives first")),
        (gzip.compress(FOUR.encode(), mtime=0)[:-9], ("a broken .gz file",)),
        (gzip.compress(FOUR.encode(), mtime=0)[:-8] + b"12345678", ("a broken .gz file",)),
        (b"\xff\xfe7\x00\x00\xd8", ("bytes that are no text",)),
    ],
    ids=[
        *("comment at the head", "comment at the end", "commas", "commas, semicolons", "one such line", "with heads"),
        *("another archive", "torn", "wrong length", "no text"),
    ],
)
def test_the_cause_is_told(tmp_path: Path, content: bytes, words: tuple[str, ...]) -> None:
    message = told(tmp_path / "people.txt", content)
    assert all(word in message for word in words), message
