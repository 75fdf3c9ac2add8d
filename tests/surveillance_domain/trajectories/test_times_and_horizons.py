"""Seconds, frames and Unix times; and a homography that cannot be this recording's."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from surveillance_domain.trajectories.conventions import Conventions
from surveillance_domain.trajectories.load import load_tracks
from surveillance_domain.trajectories.rows import TrajectoryError
from surveillance_domain.trajectories.transitions import transitions


def recorded(folder: Path, times: Callable[[int], str], header: str = "time_s", name: str = "people.csv") -> Path:
    """Eight people, each of whom walks for 37 intervals of 0.4 s at 1 m/s, told with the times of the intervals."""
    lines = [f"{header},id,x,y"]
    for person in range(8):
        lines += [f"{times(3 * person + k)},{person},{0.4 * k:.1f},{2.0 * person}" for k in range(37)]
    path = folder / name
    path.write_text("\n".join(lines))
    return path


@pytest.mark.example
def test_a_frame_rate_is_not_for_a_file_that_tells_seconds(tmp_path: Path) -> None:
    path = recorded(tmp_path, lambda k: f"{0.4 * k:.1f}")
    plain, given = load_tracks(path), load_tracks(path, Conventions(15.0))
    assert plain.warnings == ()
    (warning,) = given.warnings
    assert "tells the time in seconds: 15 frames a second, which was given, is for files that count frames" in warning
    assert given.frame_s == plain.frame_s == pytest.approx(0.4)
    assert given.tracks[0].times_s.tolist() == plain.tracks[0].times_s.tolist()


@pytest.mark.example
def test_seconds_go_before_frames_unless_the_frames_were_named(tmp_path: Path) -> None:
    path = recorded(tmp_path, lambda k: f"{10 * k},{0.4 * k:.1f}", "frame,time_s")
    assert load_tracks(path, Conventions(50.0)).frame_s == pytest.approx(0.4)
    named = load_tracks(path, Conventions(50.0, columns={"frame": "frame"}))
    assert named.frame_s == pytest.approx(10 / 50)
    assert not any("tells the time" in warning for warning in named.warnings)


@pytest.mark.example
@pytest.mark.parametrize(("unit", "a_second"), [("milliseconds", 10**3), ("microseconds", 10**6)])
@pytest.mark.parametrize("start", [0, 1_600_000_000])
def test_times_in_milliseconds_are_refused_with_the_way_to_read_them(
    tmp_path: Path, unit: str, a_second: int, start: int
) -> None:
    path = recorded(tmp_path, lambda k: str(a_second * start + 4 * k * a_second // 10), "stamp")
    with pytest.raises(TrajectoryError) as caught:
        load_tracks(path, Conventions(columns={"time_s": "stamp", "id": "id"}))
    assert f"stamp: found a point of one person every {4 * a_second // 10:g}, which would be a walk in {unit}" in str(
        caught.value
    )
    assert f"--columns frame=stamp,id=id --frames-per-s {a_second}" in str(caught.value)
    found = load_tracks(path, Conventions(float(a_second), columns={"frame": "stamp", "id": "id"}))
    assert found.frame_s == pytest.approx(0.4)
    assert found.warnings == ()


@pytest.mark.property
@pytest.mark.parametrize("start", [1e3, 1.6e9, 1_699_999_999.2, -2.0e9])
def test_shifted_times_change_nothing(tmp_path: Path, start: float) -> None:
    here = load_tracks(recorded(tmp_path, lambda k: f"{0.4 * k:.1f}"))
    there = load_tracks(recorded(tmp_path, lambda k: f"{start + 0.4 * k:.1f}", name="shifted.csv"))
    assert (there.counts, there.frame_s) == (here.counts, here.frame_s)
    for step_s in (0.4, 0.8, 1.0):
        mine, other = transitions(here.tracks, step_s), transitions(there.tracks, step_s)
        assert len(other.moves_mps) == len(mine.moves_mps)
        assert other.points_m == pytest.approx(mine.points_m, abs=1e-8)
    assert len(transitions(there.tracks, 0.4).moves_mps) == 8 * 36


@pytest.mark.example
def test_a_gap_of_just_the_limit_is_filled_in_unix_times(tmp_path: Path) -> None:
    path = tmp_path / "people.csv"
    path.write_text("time_s,id,x,y\n" + "".join(f"{1.6e9 + t:.1f},a,{t},0\n" for t in (0, 0.4, 2.4, 2.8)))
    assert load_tracks(path).counts.gaps_filled == 1
    assert load_tracks(path).findings[0].first["time_s"] == 1.6e9 + 2.4
    assert "the first at time 1600000002.4, line 4" in load_tracks(path).findings[0].message


@pytest.mark.example
def test_a_horizon_among_the_points_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "px.txt"
    path.write_text("\n".join(f"{k} 1 {100 + k} {50 + k}" for k in range(10)))
    sidecar = tmp_path / "px.txt.toml"
    sidecar.write_text("frames_per_s = 1\nhomography = [[1,0,0],[0,1,0],[1,0,-102.5]]\n")
    with pytest.raises(TrajectoryError) as caught:
        load_tracks(path)
    assert str(caught.value).startswith(
        f"{path}: homography in px.txt.toml: found a matrix that has 3 of 10 points on its horizon or beyond it, "
        "the first on line 1; expected the matrix from the points of this file to metres on the floor"
    )
    given = Conventions(
        1.0, homography=np.array([[1.0, 0, 0], [0, 1, 0], [-1, 0, 109]]), homography_from="--homography"
    )
    with pytest.raises(TrajectoryError, match=r"--homography: found .* 1 of 10 points .*the first on line 10"):
        load_tracks(path, given)


@pytest.mark.example
@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_a_matrix_may_have_either_sign(tmp_path: Path, sign: float) -> None:
    path = tmp_path / "px.txt"
    path.write_text("\n".join(f"{k} 1 {100 + k} 50" for k in range(10)))
    matrix = sign * np.array([[0.01, 0, 0], [0, 0.01, 0], [0, 0, 1.0]])
    (track,) = load_tracks(path, Conventions(1.0, homography=matrix)).tracks
    assert track.points_m[3].tolist() == pytest.approx([1.03, 0.5])
