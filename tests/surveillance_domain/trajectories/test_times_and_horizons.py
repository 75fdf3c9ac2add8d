"""Seconds, frames and Unix times; and a homography that cannot be this recording's."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from surveillance_domain.trajectories.cleaning import Limits
from surveillance_domain.trajectories.conventions import Conventions, read_homography
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
    def times(k: int) -> str:
        return str(a_second * start + 4 * k * a_second // 10)

    walk = f"a point of one person every {4 * a_second // 10:g}, which would be a walk in {unit}"
    with pytest.raises(TrajectoryError) as caught:
        load_tracks(recorded(tmp_path, times))
    assert f"time_s: found {walk}; expected seconds; {unit} are read with --columns frame=time_s" in str(caught.value)
    assert f"--frames-per-s {a_second}; if these are seconds, --columns time_s=time_s says so" in str(caught.value)
    path = recorded(tmp_path, times, "stamp")
    doubted, still = load_tracks(path, Conventions(columns={"time_s": "stamp", "id": "id"})).warnings
    assert doubted.startswith(f"stamp: {walk}; taken as seconds, since --columns or the sidecar says so")
    assert f"--columns frame=stamp,id=id --frames-per-s {a_second}" in doubted
    assert still.startswith("nobody moves at more than 0.3 m/s, and at most at ")
    assert still.endswith("are the times seconds and unit right?")
    found = load_tracks(path, Conventions(float(a_second), columns={"frame": "stamp", "id": "id"}))
    assert found.frame_s == pytest.approx(0.4)
    assert found.warnings == ()


@pytest.mark.example
def test_people_who_sit_are_read_where_the_column_of_seconds_is_named(tmp_path: Path) -> None:
    rng = np.random.default_rng(0)
    path = tmp_path / "sitting.csv"
    rows = [(60 * k, p, *rng.normal(p, 0.05, 2)) for p in range(8) for k in range(40)]
    path.write_text("time_s,id,x,y\n" + "\n".join(f"{t},{p},{x:.3f},{y:.3f}" for t, p, x, y in rows))
    with pytest.raises(TrajectoryError, match="would be a walk in milliseconds"):
        load_tracks(path, limits=Limits(gap_s=60.0))
    found = load_tracks(path, Conventions(columns={"time_s": "time_s"}), Limits(gap_s=60.0))
    assert (len(found.people), found.frame_s) == (8, 60)
    assert [told.split(" ")[0] for told in found.warnings] == ["time_s:", "nobody"]


@pytest.mark.example
def test_a_clock_that_is_not_quite_even_leaves_no_gaps(tmp_path: Path) -> None:
    rng = np.random.default_rng(0)
    path = tmp_path / "jitter.csv"

    def written(kept: list[int]) -> Path:
        rows = [(1.7e9 + 0.1 * k + rng.uniform(-0.01, 0.01), p, 0.12 * k) for p in range(8) for k in kept]
        path.write_text("time_s,id,x,y\n" + "\n".join(f"{t:.6f},{p},{x:.3f},0" for t, p, x in rows))
        return path

    whole = load_tracks(written(list(range(180))))
    assert whole.findings == ()
    assert whole.frame_s == pytest.approx(0.1, rel=0.02)
    holed = load_tracks(written([k for k in range(180) if k % 10]))
    assert holed.counts.gaps_filled == 8 * 17
    assert holed.frame_s == pytest.approx(0.1, rel=0.02)


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
@pytest.mark.parametrize("sign", [1.0, -1.0, 1e-14, -1e200])
def test_a_matrix_may_have_any_factor(tmp_path: Path, sign: float) -> None:
    path = tmp_path / "px.txt"
    path.write_text("\n".join(f"{k} 1 {100 + k} 50" for k in range(10)))
    matrix = sign * np.array([[0.01, 0, 0], [0, 0.01, 0], [0, 0, 1.0]])
    (tmp_path / "H.txt").write_text("\n".join(" ".join(map(repr, row)) for row in matrix.tolist()))
    given = Conventions(1.0, homography=read_homography(tmp_path / "H.txt"))
    (track,) = load_tracks(path, given).tracks
    assert track.points_m[3].tolist() == pytest.approx([1.03, 0.5])


@pytest.mark.example
def test_a_matrix_to_an_origin_far_away_is_not_singular(tmp_path: Path) -> None:
    (tmp_path / "H.txt").write_text("0.02 0 500000\n0 0.02 4600000\n0 0 1\n")
    assert read_homography(tmp_path / "H.txt")[1, 2] == 4.6e6


@pytest.mark.example
def test_what_cannot_be_read_as_a_matrix_is_told_as_elsewhere(tmp_path: Path) -> None:
    (tmp_path / "bytes").write_bytes(b"\xff\xfe\xfa")
    told = {"nowhere.txt": "no such file or directory", "": "is a directory", "bytes": "bytes that are no text"}
    for name, found in told.items():
        with pytest.raises(TrajectoryError) as caught:
            read_homography(tmp_path / name)
        assert str(caught.value) == f"{tmp_path / name}: found {found}; expected a text file of three rows of numbers"


@pytest.mark.example
@pytest.mark.parametrize("x", ["1e300", "-2e12"])
def test_a_place_beyond_all_places_is_named(tmp_path: Path, x: str) -> None:
    path = tmp_path / "people.txt"
    path.write_text("0 a 0 0\n1 a 1 0\n0 b 0 0\n1 b " + x + " 7\n")
    with pytest.raises(TrajectoryError) as caught:
        load_tracks(path, Conventions(1.0))
    assert str(caught.value) == f"{path}: line 4: found id b at ({float(x):g}, 7) m; expected metres on the floor"
