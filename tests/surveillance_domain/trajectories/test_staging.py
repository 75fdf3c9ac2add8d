"""A recording placed into a site: rotation, offset, who is on the map when, walls, pieces."""

from __future__ import annotations

import numpy as np
import pytest

from surveillance_domain.site.grid import Grid
from surveillance_domain.trajectories.staging import Part, Placement, Stage, Staged, staged, windows
from surveillance_domain.trajectories.tracks import Track

HALL = Grid(np.ones((4, 6), dtype=bool), cell_m=1.0)


def walk(name: str, start_s: float, points: list[tuple[float, float]]) -> Track:
    return Track(name, start_s + np.arange(len(points)), np.array(points, dtype=float))


def whole(stage: Staged) -> Stage:
    return stage.window(0, stage.times - 1)


@pytest.mark.example
def test_turned_about_its_origin_and_then_moved() -> None:
    found = Placement((3.0, 1.0), 90.0).placed(np.array([[1.0, 0.0], [0.0, 2.0]]))
    assert found == pytest.approx(np.array([[3.0, 2.0], [1.0, 1.0]]))


@pytest.mark.example
def test_people_are_outside_before_and_after_and_beyond_the_map() -> None:
    tracks = [
        walk("a", 10.0, [(-1.5, 0.5), (0.5, 0.5), (1.5, 0.5)]),
        walk("b", 11.5, [(4.5, 2.0), (5.5, 2.0), (6.5, 2.0)]),
    ]
    found = staged(tracks, HALL, Placement(), 1.0)
    stage = whole(found)
    assert stage.people == ("a", "b")
    assert stage.path_m.shape == (4, 2, 2)  # seconds 10 to 13
    assert np.isfinite(stage.path_m[..., 0]).tolist() == [
        [False, False],  # a is off the map, b not yet there
        [True, False],
        [True, True],  # b halfway between its points
        [False, False],  # a has gone, and b is at x = 6, off the map
    ]
    assert stage.path_m[2, 1].tolist() == [5.0, 2.0]
    assert (found.off_map, found.positions) == (2, 3)


@pytest.mark.example
def test_points_in_walls_are_put_beside_them_or_left_out_and_counted() -> None:
    grid = Grid.from_rows(["......", ".###..", ".###..", ".###.."], cell_m=1.0)
    track = walk("a", 0.0, [(0.5, 0.5), (1.25, 0.5), (2.5, 0.5), (4.5, 0.5)])
    found = staged([track], grid, Placement(), 1.0)
    stage = whole(found)
    assert stage.path_m[1, 0] == pytest.approx([1.0, 0.5], abs=1e-5)  # a quarter of a cell to the left
    assert grid.number_at(stage.path_m[1, 0]) == grid.number[0, 0]
    assert np.isnan(stage.path_m[2, 0]).all()  # in the middle of the block
    assert (found.moved_out_of_walls, found.in_walls, found.off_map) == (1, 1, 0)


@pytest.mark.example
def test_a_scene_beside_the_map_is_refused_with_both_places() -> None:
    with pytest.raises(ValueError, match=r"between \(50.0, 0.5\) and \(51.0, 0.5\) m, the map between \(0.0, 0.0\)"):
        staged([walk("a", 0.0, [(50.0, 0.5), (51.0, 0.5)])], HALL, Placement(), 1.0)


@pytest.mark.example
def test_the_parts_of_a_cut_track_are_one_person() -> None:
    parts = [walk("a", 0.0, [(0.5, 0.5), (1.5, 0.5)]), walk("a", 3.0, [(3.5, 0.5), (4.5, 0.5)])]
    stage = whole(staged(parts, HALL, Placement(), 1.0))
    assert np.isfinite(stage.path_m[:, 0, 0]).tolist() == [True, True, False, True, True]


@pytest.mark.example
def test_pieces_hold_those_who_are_there_and_empty_ones_are_left_out() -> None:
    first, last = Part("a", 0, np.full((3, 2), 0.5)), Part("b", 7, np.full((1, 2), 1.5))
    stage = Staged(("a", "b"), (first, last), 9, 1.0)  # a at times 0, 1, 2; b at time 7 alone
    pieces, empty = windows(stage, 2)
    assert [piece.people for piece in pieces] == [("a",), ("b",)]
    assert empty == 2
    assert np.isnan(pieces[1].path_m[[0, 2]]).all()
    assert pieces[1].path_m[1, 0].tolist() == [1.5, 1.5]
    assert len(windows(stage, 2, most=1)[0]) == 1
    (only,), _ = windows(stage, 100)  # the recording is shorter than one piece
    assert len(only.path_m) == 9
    assert windows(stage, 2, start=8) == ([], 1)


@pytest.mark.example
def test_people_years_apart_take_no_room() -> None:
    tracks = [
        walk("a", 0.0, [(0.5, 0.5), (1.5, 0.5), (2.5, 0.5)]),
        walk("b", 1.6e9, [(4.5, 2.5), (3.5, 2.5), (2.5, 2.5)]),
        walk("a", 1.6e9, [(0.5, 1.5), (1.5, 1.5), (2.5, 1.5)]),
    ]
    stage = staged(tracks, HALL, Placement(), 1.0)
    assert stage.times == 1_600_000_003
    pieces, empty = windows(stage, 2)
    assert [piece.people for piece in pieces] == [("a",), ("a", "b"), ("a", "b")]  # in order of their first tracks
    assert empty == 800_000_001 - 3  # pieces begin at 0, 2, ..., 1,600,000,000
    assert pieces[2].path_m[:, :, 0].tolist() == [[0.5, 4.5], [1.5, 3.5], [2.5, 2.5]]
    assert windows(stage, 2, start=1_599_999_999)[0][0].people == ("a", "b")
    assert windows(stage, 2, start=10**300) == ([], 1)


@pytest.mark.example
def test_times_that_cannot_be_counted_or_laid_out_are_told() -> None:
    with pytest.raises(ValueError, match=r"goes from 0 to 1e\+300 s; expected times in seconds"):
        staged([walk("a", 0.0, [(0.5, 0.5)] * 2), walk("b", 1e300, [(0.5, 0.5)] * 2)], HALL, Placement(), 1.0)
    endless = Track("c", np.array([0.0, 1.6e9]), np.array([[0.5, 0.5], [1.5, 0.5]]))
    with pytest.raises(ValueError, match=r"id c goes on from 0 to 1.6e\+09 s without a break"):
        staged([endless], HALL, Placement(), 1.0)
