"""Who is in two recordings: known by times and places, but for rounding."""

from __future__ import annotations

import numpy as np
import pytest

from surveillance_domain.trajectories.copies import copied
from surveillance_domain.trajectories.tracks import Track


def walk(name: str, start_s: float, y: float, points: int = 20) -> Track:
    """Somebody who goes 0.4 m east, and a little north, every 0.4 s."""
    times = start_s + 0.4 * np.arange(points)
    return Track(name, times, np.stack([times - start_s, y + 0.05 * np.sin(times)], axis=1))


def rounded(track: Track, name: str) -> Track:
    return Track(name, track.times_s, track.points_m.round(2))


CROWD = [walk("a", 0.0, 0.0), walk("b", 2.0, 3.0), walk("c", 4.0, 6.0)]


@pytest.mark.example
def test_rounded_places_and_other_names_are_the_same_people() -> None:
    assert copied([rounded(track, f"{track.name}-2") for track in CROWD], CROWD) == ("a-2", "b-2", "c-2")
    assert copied([rounded(CROWD[1], "only")], CROWD) == ("only",)


@pytest.mark.example
def test_half_a_track_on_another_raster_is_the_same_person() -> None:
    whole = CROWD[0]
    times = np.arange(1.0, 6.0, 0.25)
    half = Track("half", times, np.stack([np.interp(times, whole.times_s, one) for one in whole.points_m.T], axis=1))
    assert copied([half], CROWD) == ("half",)
    assert copied([whole], [half]) == ("a",)


@pytest.mark.example
@pytest.mark.parametrize(
    "other",
    [
        walk("beside", 0.0, 0.3),  # abreast
        walk("later", 1.0, 0.0),  # the same way, one second behind
        walk("elsewhere", 500.0, 0.0),
        Track("crossing", np.array([0.0, 7.6]), np.array([[7.6, 0.0], [0.0, 0.0]])),
    ],
    ids=lambda track: track.name,
)
def test_others_are_others(other: Track) -> None:
    assert copied([other], CROWD) == ()
    assert copied([other], []) == ()
