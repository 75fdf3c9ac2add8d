"""Duplicates, gaps, jumps, single points, other units: each is dealt with in one way, and counted."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from surveillance_domain.trajectories.cleaning import Limits
from surveillance_domain.trajectories.conventions import Conventions
from surveillance_domain.trajectories.load import load_tracks
from surveillance_domain.trajectories.resampling import resampled
from surveillance_domain.trajectories.rows import TrajectoryError
from surveillance_domain.trajectories.tracks import Counts, Track, Tracks

WALK = [(frame, "a", 0.5 * frame, 0.0) for frame in range(6)]


def loaded(folder: Path, rows: list[tuple[float, str, float, float]], **limits: float) -> Tracks:
    path = folder / "people.txt"
    path.write_text("\n".join(f"{frame} {name} {x} {y}" for frame, name, x, y in rows))
    return load_tracks(path, Conventions(1.0), Limits(**limits))


def found(tracks: Tracks) -> dict[str, int]:
    """What was counted besides rows and people."""
    return {name: n for name, n in tracks.counts.as_dict().items() if n and name not in ("rows", "people")}


@pytest.mark.example
def test_a_clean_track_is_left_alone(tmp_path: Path) -> None:
    tracks = loaded(tmp_path, WALK)
    assert found(tracks) == {}
    assert tracks.tracks[0].points_m[:, 0].tolist() == [0, 0.5, 1, 1.5, 2, 2.5]
    assert (tracks.counts.rows, tracks.counts.people) == (6, 1)


@pytest.mark.example
def test_rows_twice_and_out_of_order(tmp_path: Path) -> None:
    tracks = loaded(tmp_path, [*WALK[3:], *WALK[:3], WALK[1]])
    assert found(tracks) == {"out_of_order_rows": 2, "repeated_rows": 1}
    assert tracks.tracks[0].times_s.tolist() == [0, 1, 2, 3, 4, 5]


@pytest.mark.example
def test_a_frame_with_two_places_is_left_out(tmp_path: Path) -> None:
    tracks = loaded(tmp_path, [*WALK, (2, "a", 9.0, 9.0)])
    assert found(tracks) == {"out_of_order_rows": 1, "contradictory_frames": 1, "gaps_filled": 1}
    assert tracks.tracks[0].times_s.tolist() == [0, 1, 3, 4, 5]


@pytest.mark.example
def test_long_gaps_cut_and_short_ones_do_not(tmp_path: Path) -> None:
    rows = [*WALK[:2], *[(f, "a", x + 1, y) for f, _, x, y in WALK[4:]]]  # frames 2 and 3 are missing
    assert found(loaded(tmp_path, rows, gap_s=3.0)) == {"gaps_filled": 1}
    tracks = loaded(tmp_path, rows, gap_s=2.0)
    assert found(tracks) == {"gaps_cut": 1}
    assert [track.times_s.tolist() for track in tracks.tracks] == [[0, 1], [4, 5]]
    assert tracks.people == ("a",)


@pytest.mark.example
def test_a_jump_there_and_back_leaves_a_single_point(tmp_path: Path) -> None:
    rows = [(f, n, x, 50.0 if f == 3 else y) for f, n, x, y in WALK]
    tracks = loaded(tmp_path, rows)
    assert found(tracks) == {"jumps": 2, "single_points": 1}
    assert [track.times_s.tolist() for track in tracks.tracks] == [[0, 1, 2], [4, 5]]


@pytest.mark.example
def test_one_person_in_other_units_is_left_out_and_all_are_refused(tmp_path: Path) -> None:
    pixels = [(f, "b", 100 * x, y) for f, _, x, y in WALK]
    third = [(f, "c", x, y + 1) for f, _, x, y in WALK]
    tracks = loaded(tmp_path, [*WALK, *pixels, *third])
    assert found(tracks) == {"other_units": 1}
    assert tracks.people == ("a", "c")
    with pytest.raises(TrajectoryError, match=r"median speed of 50 m/s.*--metres-per-unit or --homography"):
        loaded(tmp_path, pixels)


@pytest.mark.example
def test_people_seen_once_are_counted(tmp_path: Path) -> None:
    assert found(loaded(tmp_path, [*WALK, (3, "b", 1.0, 1.0)])) == {"single_points": 1}


@pytest.mark.example
def test_counts_add_up() -> None:
    total = Counts(rows=3, jumps=1) + Counts(rows=4, gaps_cut=2)
    assert total == Counts(rows=7, jumps=1, gaps_cut=2)


@pytest.mark.example
def test_resampling_by_straight_lines() -> None:
    track = Track("a", np.array([0.0, 1.0, 3.0]), np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 4.0]]))
    own = resampled(track, 1.5)
    assert own is not None
    assert own.points_m.tolist() == [[0, 0], [1, 1], [1, 4]]
    common = resampled(track, 1.0, origin_s=-0.5)  # at 0.5, 1.5 and 2.5
    assert common is not None
    assert common.times_s.tolist() == [0.5, 1.5, 2.5]
    assert common.points_m.tolist() == [[0.5, 0], [1, 1], [1, 3]]
    assert resampled(track, 10.0, origin_s=-5.0) is None


@pytest.mark.property
@settings(max_examples=50)
@given(
    st.lists(st.tuples(st.floats(0.1, 2), st.floats(-3, 3), st.floats(-3, 3)), min_size=2, max_size=12),
    st.floats(0.2, 3),
)
def test_resampled_points_lie_on_the_track(points: list[tuple[float, float, float]], step_s: float) -> None:
    passed, x, y = np.array(points).T
    track = Track("a", np.cumsum(passed), np.stack([x, y], axis=1))
    stepped = resampled(track, step_s)
    assert stepped is not None
    assert stepped.times_s[0] == track.times_s[0]
    assert track.times_s[-1] - step_s < stepped.times_s[-1] <= track.times_s[-1] + 1e-6
    for time, point in zip(stepped.times_s, stepped.points_m, strict=True):
        after = min(int(np.searchsorted(track.times_s, time, side="right")), len(x) - 1)
        share = (time - track.times_s[after - 1]) / (track.times_s[after] - track.times_s[after - 1])
        on_line = track.points_m[after - 1] + min(share, 1) * (track.points_m[after] - track.points_m[after - 1])
        assert point == pytest.approx(on_line, abs=1e-6)
