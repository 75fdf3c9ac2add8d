"""What is kept on disk of cameras that somebody moved."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import pytest

from surveillance_domain.cameras.base import Position
from surveillance_domain.control.kept_memory import KeptMemory
from surveillance_domain.control.watch_state import WatchState
from surveillance_domain.site.load import load_site
from surveillance_domain.world.memory import Stood

NOW_S = 1_700_000_000.0
HERE = Position(55.5, -40.0, None)


@pytest.mark.example
def test_it_outlives_the_process(tmp_path: Path) -> None:
    paths = [tmp_path / "one.moved", tmp_path / "two.moved"]
    KeptMemory(paths, lambda: NOW_S).keep(Stood(HERE, 2.0))
    assert json.loads(paths[0].read_text()) == {"pan": 55.5, "tilt": -40.0, "zoom": None, "still_since": NOW_S - 2}
    assert sorted(tmp_path.iterdir()) == paths  # nothing is left beside them
    later = KeptMemory(paths[1:], lambda: NOW_S + 10)
    assert later.recall() == Stood(HERE, 12.0)
    later.keep(None)
    later.keep(None)
    assert later.recall() is None


@pytest.mark.example
def test_a_clock_that_was_set_back_makes_it_now(tmp_path: Path) -> None:
    path = tmp_path / "one.moved"
    KeptMemory([path], lambda: NOW_S).keep(Stood(HERE, 0.0))
    assert KeptMemory([path], lambda: NOW_S - 3600).recall() == Stood(HERE, 0.0)


@pytest.mark.example
def test_of_two_addresses_that_were_looked_at_at_different_times_the_later_counts(tmp_path: Path) -> None:
    older, newer = tmp_path / "one.moved", tmp_path / "two.moved"
    KeptMemory([older], lambda: NOW_S).keep(Stood(Position(1.0, 2.0, 3.0), 0.0))
    KeptMemory([newer], lambda: NOW_S + 5).keep(Stood(HERE, 0.0))
    assert KeptMemory([older, newer], lambda: NOW_S + 6).recall() == Stood(HERE, 1.0)


@pytest.mark.example
@pytest.mark.parametrize(
    "content",
    [
        "{ torn",
        "[]",
        '"pan"',
        '{"pan": 1, "tilt": 2, "zoom": 3}',
        '{"pan": 1, "tilt": 2, "zoom": 3, "still_since": NaN}',
        '{"pan": 1, "tilt": 2, "zoom": Infinity, "still_since": 1}',
        '{"pan": "left", "tilt": 2, "zoom": 3, "still_since": 1}',
    ],
)
def test_what_cannot_be_read_is_not_remembered(tmp_path: Path, content: str) -> None:
    path = tmp_path / "one.moved"
    path.write_text(content, encoding="utf-8")
    assert KeptMemory([path]).recall() is None


@pytest.mark.example
def test_a_place_that_cannot_be_written_stops_nobody(tmp_path: Path) -> None:
    memory = KeptMemory([tmp_path / "missing" / "one.moved"])
    memory.keep(Stood(HERE, 0.0))
    memory.keep(None)
    assert memory.recall() is None


@pytest.mark.example
def test_all_site_files_that_name_the_camera_share_it(tmp_path: Path) -> None:
    site = load_site("lego")
    first, second = (
        replace(site, cameras=(site.cameras[0].model_copy(update={"name": name, "url": url}), *site.cameras[1:]))
        for name, url in (("south", "http://192.168.0.90"), ("yard", "http://192.168.0.90:80/"))
    )
    mine, theirs = (WatchState(one, tmp_path / one.cameras[0].name).memories() for one in (first, second))
    assert (set(mine), set(theirs)) == ({"south"}, {"yard"})  # those of an address only
    mine["south"].keep(Stood(HERE, 0.0))
    stood = theirs["yard"].recall()
    assert stood is not None
    assert stood.position == HERE
