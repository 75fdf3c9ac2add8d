"""What is wrong in a recording is told once a kind: how many, who, where, what was done, what can be done."""

from __future__ import annotations

from pathlib import Path

import pytest

from surveillance_domain.trajectories.conventions import Conventions
from surveillance_domain.trajectories.findings import Finding
from surveillance_domain.trajectories.load import load_tracks
from surveillance_domain.trajectories.rows import TrajectoryError

WALK = [(frame, "a", 0.5 * frame, 0.0) for frame in range(8)]
FIRST_LINE_OF_OTHERS = len(WALK) + 1


def told(folder: Path, rows: list[tuple[float, str, float, float]]) -> dict[str, Finding]:
    path = folder / "people.txt"
    path.write_text("\n".join(f"{frame} {name} {x} {y}" for frame, name, x, y in rows))
    return {one.kind: one for one in load_tracks(path, Conventions(1.0)).findings}


def others(name: str, *frames: float, y: float = 3.0) -> list[tuple[float, str, float, float]]:
    return [(frame, name, 0.5 * frame, y) for frame in frames]


@pytest.mark.example
def test_a_clean_recording_has_nothing_to_tell(tmp_path: Path) -> None:
    assert told(tmp_path, WALK) == {}


@pytest.mark.example
@pytest.mark.parametrize(
    ("kind", "more", "number", "first", "words"),
    [
        ("repeated_rows", others("b", 1, 2, 2), 1, ("b", 2.0, 11), ("stand there twice", "taken once")),
        (
            "contradictory_frames",
            [*others("b", 1, 2, 3), (3, "b", 9.0, 9.0)],
            1,
            ("b", 3.0, 11),
            ("one person at two places", "left out", "ids of their own"),
        ),
        ("out_of_order_rows", others("b", 2, 1, 3), 1, ("b", 1.0, 10), ("earlier frame", "put in order")),
        (
            "gaps_filled",
            others("b", 1, 3, 4),
            1,
            ("b", 3.0, 10),
            ("gaps of up to 2 s", "filled", "smaller --max-gap-s"),
        ),
        ("gaps_cut", others("b", 1, 2, 6, 7), 1, ("b", 6.0, 11), ("more than 2 s", "cut there", "larger --max-gap-s")),
        (
            "jumps",
            [*others("b", 1, 2), *others("b", 3, 4, y=99.0)],
            1,
            ("b", 3.0, 11),
            ("faster than 10 m/s", "cut there", "--fastest-mps"),
        ),
        ("single_points", others("b", 4), 1, ("b", 4.0, 9), ("single point", "1 of 2 people left out altogether")),
    ],
)
def test_every_kind_is_told_once_with_who_and_where(
    tmp_path: Path,
    kind: str,
    more: list[tuple[float, str, float, float]],
    number: int,
    first: tuple[str, float, int],
    words: tuple[str, ...],
) -> None:
    found = told(tmp_path, [*WALK, *more])
    assert set(found) == {kind}
    one = found[kind]
    assert (one.number, one.people, one.first_people) == (number, 1, ("b",))
    assert tuple(one.first.values()) == first
    assert f"of 1 person: id b; the first at frame {first[1]:g}, line {first[2]}" in one.message
    assert all(word in one.message for word in words)


@pytest.mark.example
def test_people_in_other_units_are_named_and_counted(tmp_path: Path) -> None:
    rows = list(WALK)
    for number in range(12):
        rows += [(f, f"in-m-{number}", x, y + number) for f, _, x, y in WALK]
    for number in range(6):
        rows += [(f, f"in-px-{number}", 100 * x, 0.0) for f, _, x, _ in WALK]
    one = told(tmp_path, rows)["other_units"]
    assert (one.number, one.people, one.left_out) == (6, 6, 6)
    assert one.first_people == tuple(f"in-px-{number}" for number in range(5))
    assert "id in-px-0, in-px-1, in-px-2, in-px-3, in-px-4 and 1 more; the first at frame 0, line 105" in one.message
    assert "6 of 19 people left out altogether" in one.message
    assert "--metres-per-unit or --homography" in one.message


@pytest.mark.example
def test_people_whose_every_frame_contradicts_are_no_single_points(tmp_path: Path) -> None:
    rows = list(WALK)
    for name in "bcde":
        rows += others(name, 1, 2) + others(name, 1, 2, y=9.0)
    path = tmp_path / "people.txt"
    path.write_text("\n".join(f"{frame} {name} {x} {y}" for frame, name, x, y in rows))
    tracks = load_tracks(path, Conventions(1.0))
    assert tracks.counts.single_points == 0
    assert (tracks.counts.contradictory_frames, tracks.counts.contradictory_people) == (8, 4)
    (one,) = (finding for finding in tracks.findings if finding.kind == "contradictory_frames")
    assert (one.number, one.people, one.left_out) == (8, 4, 4)


@pytest.mark.example
def test_where_nothing_is_left_the_reasons_are_told(tmp_path: Path) -> None:
    with pytest.raises(TrajectoryError) as caught:
        told(tmp_path, others("b", 1, 2) + others("b", 1, 2, y=9.0))
    assert "no track of two points that is left" in str(caught.value)
    assert "frames that have one person at two places: 2, of 1 person: id b" in str(caught.value)


@pytest.mark.example
def test_where_the_file_tells_times_they_are_told(tmp_path: Path) -> None:
    path = tmp_path / "people.csv"
    path.write_text("time_s,id,x,y\n0,a,0,0\n0.5,a,0.5,0\n1,a,1,0\n4.5,a,2,0\n5,a,2.5,0\n")
    (one,) = load_tracks(path).findings
    assert one.first == {"id": "a", "time_s": 4.5, "line": 5}
    assert "the first at time 4.5, line 5" in one.message
