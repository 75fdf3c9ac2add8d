"""What the page keeps of the steps."""

from __future__ import annotations

import pytest

from surveillance_domain.page.feed import COURSE_STEPS, Feed, Point
from tests.page_snapshots import camera, picture, snapshot


@pytest.mark.example
def test_there_is_nothing_before_the_first_step() -> None:
    assert Feed().latest() is None


@pytest.mark.example
def test_the_course_has_the_last_steps_only() -> None:
    feed = Feed()
    for number in range(1, COURSE_STEPS + 11):
        feed.put(snapshot(number, percent_obs=None, expected=None))
    latest = feed.latest()
    assert latest is not None
    assert latest.snapshot.number == COURSE_STEPS + 10
    assert len(latest.course) == COURSE_STEPS
    assert latest.course[0] == Point(11, None, None, 1)
    assert latest.age_s >= 0


@pytest.mark.example
def test_a_camera_keeps_its_last_picture() -> None:
    feed = Feed()
    feed.put(snapshot(1, cameras=(camera("north", picture=picture(1)), camera("south", picture=picture(1)))))
    feed.put(snapshot(2, cameras=(camera("north", picture=picture(2)), camera("south"))))
    latest = feed.latest()
    assert latest is not None
    assert {name: one.step for name, one in latest.pictures.items()} == {"north": 2, "south": 1}
