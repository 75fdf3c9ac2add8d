"""How the subcommands ask for recorded trajectories, and read them."""

from __future__ import annotations

import hashlib
import math
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from factored_pomdp.commands.answers import InputError, side_console
from surveillance_domain.commands.options import input_checked

if TYPE_CHECKING:
    from surveillance_domain.trajectories.conventions import Conventions
    from surveillance_domain.trajectories.staging import Placement
    from surveillance_domain.trajectories.tracks import Tracks

__all__ = [
    "Columns",
    "FastestMps",
    "FramesPerS",
    "HomographyFile",
    "MaxGap",
    "MetresPerUnit",
    "OffsetM",
    "RotateDeg",
    "about",
    "conventions",
    "count_lines",
    "digest_of",
    "placement_of",
    "read_tracks",
]

FramesPerS = Annotated[
    float | None,
    typer.Option(
        help="Of all files that count frames (ETH 15, UCY 25); not needed with TrajNet++. For one file alone: "
        "the line frames_per_s = 15 in its sidecar, FILE.toml beside FILE."
    ),
]
MetresPerUnit = Annotated[float | None, typer.Option(help="Where positions are not metres: how long a pixel … is.")]
HomographyFile = Annotated[
    Path | None,
    typer.Option("--homography", metavar="FILE", help="Three rows of three numbers, from points to metres."),
]
Columns = Annotated[
    str | None,
    typer.Option(metavar="NAME=HEADER,…", help="Of a CSV file: frame or time_s, id, x, y, and their headers."),
]
MaxGap = Annotated[float, typer.Option("--max-gap-s", help="Longer gaps are not filled; the track is cut there.")]
OffsetM = Annotated[
    str, typer.Option("--offset-m", metavar="X,Y", help="Where in the site the recording's origin comes to lie.")
]
RotateDeg = Annotated[float, typer.Option("--rotate-deg", help="Of the recording, counter-clockwise about its origin.")]
FastestMps = Annotated[float, typer.Option("--fastest-mps", help="Faster moves are jumps; the track is cut there.")]


def conventions(
    frames_per_s: float | None, metres_per_unit: float | None, homography: Path | None, columns: str | None
) -> Conventions:
    """The options put together.

    Raises
    ------
    InputError
        For numbers that are not above zero, or text that does not read as columns.
    """
    from surveillance_domain.trajectories.conventions import Conventions, read_homography

    for name, value in (("--frames-per-s", frames_per_s), ("--metres-per-unit", metres_per_unit)):
        if value is not None and not 0 < value < float("inf"):
            raise InputError(f"{name} {value:g}: expected a number above 0")
    with input_checked():
        matrix = None if homography is None else read_homography(homography)
    told_by = f"--homography {homography}"
    return Conventions(frames_per_s, metres_per_unit, matrix, columns=_columns(columns), homography_from=told_by)


def _columns(text: str | None) -> dict[str, str] | None:
    if text is None:
        return None
    pairs = [part.partition("=") for part in text.split(",")]
    wrong = [key for key, equals, header in pairs if not (equals and key.strip() and header.strip())]
    if wrong:
        raise InputError(f"--columns {text}: expected NAME=HEADER, such as x=pos_x,id=person")
    return {key.strip(): header.strip() for key, _, header in pairs}


def placement_of(offset_m: str, rotate_deg: float) -> Placement:
    """Where a recording lies in a site, from an offset such as ``3.5,-2`` and an angle.

    Raises
    ------
    InputError
        For an offset that is not two finite numbers of metres, or an angle that is none.
    """
    from surveillance_domain.trajectories.conventions import MOST_M
    from surveillance_domain.trajectories.rows import number_of
    from surveillance_domain.trajectories.staging import Placement

    numbers = [number for number in map(number_of, offset_m.split(",")) if number is not None]
    if len(numbers) != 2 or offset_m.count(",") != 1:
        raise InputError(f"--offset-m {offset_m}: expected two numbers, such as 3.5,-2")
    if max(map(abs, numbers)) > MOST_M:
        raise InputError(f"--offset-m {offset_m}: expected metres, of which no place is more than {MOST_M:g} away")
    if not math.isfinite(rotate_deg):
        raise InputError(f"--rotate-deg {rotate_deg:g}: expected a number of degrees, such as -90")
    return Placement((numbers[0], numbers[1]), rotate_deg)


@contextmanager
def about(files: Iterable[Path]) -> Iterator[None]:
    """What is wrong with recordings becomes one message that names their files."""
    try:
        yield
    except InputError:
        raise
    except ValueError as problem:
        raise InputError(f"{', '.join(map(str, files))}: {problem}") from problem


def read_tracks(
    path: Path,
    given: Conventions,
    max_gap_s: float,
    fastest_mps: float,
    advance: Callable[[int, str], object] | None = None,
) -> Tracks:
    """A file's tracks; what looks wrong, and what was wrong and dealt with, is told on standard error.

    Raises
    ------
    InputError
        With everything that is wrong with the file.
    """
    from surveillance_domain.trajectories.cleaning import Limits
    from surveillance_domain.trajectories.load import load_tracks

    if not (max_gap_s >= 0 and fastest_mps > 0):
        raise InputError(f"--max-gap-s {max_gap_s:g}, --fastest-mps {fastest_mps:g}: expected 0 or more, and above 0")
    with input_checked():
        found = load_tracks(path, given, Limits(max_gap_s, fastest_mps), advance)
    for warning in (*found.warnings, *(finding.message for finding in found.findings)):
        side_console().print(f"{path}: {warning}", style="yellow", soft_wrap=True)
    return found


def digest_of(path: Path) -> str:
    """SHA-256 of a file's bytes."""
    with path.open("rb") as file:
        return f"sha256:{hashlib.file_digest(file, 'sha256').hexdigest()}"


def count_lines(counts: Mapping[str, int]) -> list[tuple[str, str]]:
    """Counts of a file as lines of a table, those that are zero left out."""
    return [(name.replace("_", " "), f"{number:,}") for name, number in counts.items() if number]
