"""The recordings that ``surveillance learn`` is given: which are used, and what names them when they are not."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

BUILTIN = Path(__file__).parents[3] / "surveillance_domain" / "site" / "builtin"


def walkers(seed: int, people: int = 10) -> list[tuple[int, int, float, float]]:
    """Frame, id, x and y of people who walk twenty steps of half a second at 1 m/s and turn a little."""
    rng = np.random.default_rng(seed)
    rows = []
    for person in range(people):
        headings = np.cumsum(rng.normal(0, 0.2, 20))
        places = np.cumsum(0.5 * np.stack([np.cos(headings), np.sin(headings)], axis=1), axis=0)
        rows += [(frame, person, float(x), float(y)) for frame, (x, y) in enumerate(places)]
    return rows


@pytest.fixture
def counted(tmp_path: Path) -> Path:
    """Ten people, two frames a second."""
    path = tmp_path / "counted.txt"
    path.write_text("\n".join(f"{frame} {person} {x} {y}" for frame, person, x, y in walkers(0)))
    return path


@pytest.fixture
def timed(tmp_path: Path) -> Path:
    """Ten others, with seconds."""
    path = tmp_path / "timed.csv"
    rows = [f"{0.5 * frame},{person},{x},{y}" for frame, person, x, y in walkers(1)]
    path.write_text("\n".join(["time_s,id,x,y", *rows]))
    return path


def words(*files: Path, more: tuple[object, ...] = ("--frames-per-s", 2)) -> tuple[object, ...]:
    return ("learn", *files, "--step-s", 0.5, "--cell-m", 1, *more)


@pytest.mark.end_to_end
def test_a_frame_rate_is_for_the_files_that_count_frames(
    surveillance: Callable[..., Any], counted: Path, timed: Path
) -> None:
    found = surveillance(*words(counted, timed), "--json")
    assert found.code == 0, found.err
    assert found.json["mean_speed_mps"] == pytest.approx(1.0)
    assert found.json["recorded_every_s"] == {str(counted): 0.5, str(timed): 0.5}
    (warning,) = found.json["warnings"]
    assert warning.startswith(f"{timed}: the file tells the time in seconds: 2 frames a second, which was given,")


@pytest.mark.end_to_end
def test_people_are_counted_once(surveillance: Callable[..., Any], counted: Path, timed: Path) -> None:
    copy = counted.with_name("copy.txt")
    copy.write_text("\n".join(reversed(counted.read_text().replace(" 3 ", " three ").splitlines())))
    once = surveillance(*words(counted, timed), "--json").json
    answer = surveillance(*words(counted, timed, copy, counted), "--json")
    assert answer.code == 0, answer.err
    again = answer.json
    assert again["trajectories"] == once["trajectories"] == 20
    assert again["held_out"] == once["held_out"]
    twice, same, _ = again["warnings"]
    assert twice == f"{counted}: given 2 times; taken once"
    assert same.startswith(f"{copy}: holds the same as {counted}, to the last point; passed over")
    assert twice in answer.err
    assert same in answer.err
    alone = surveillance(*words(counted, copy), "--json").json
    assert alone["prior"] is not None  # one recording, and so one frame


@pytest.mark.end_to_end
def test_people_told_in_rounded_numbers_are_warned_of(
    surveillance: Callable[..., Any], counted: Path, timed: Path
) -> None:
    again = counted.with_name("again.txt")
    rows = [f"{frame} {person} {x:.2f} {y:.2f}" for frame, person, x, y in walkers(0) if person > 3]
    again.write_text("\n".join(rows))
    found = surveillance(*words(counted, timed, again), "--json")
    assert found.code == 0, found.err
    twice, *_ = found.json["warnings"]
    assert twice.startswith(f"{again}: 6 of its 6 people are within 10 cm of somebody in {counted} at the same times")
    assert "id 4, 5, 6, 7, 8 and 1 more; they count twice" in twice
    assert twice in found.err


@pytest.mark.end_to_end
def test_a_comma_for_the_point_is_told(surveillance: Callable[..., Any], timed: Path) -> None:
    timed.write_text("time_s,id,x,y\n0,1,8,46,3,59\n")
    answer = surveillance(*words(timed, more=()))
    assert answer.code == 2
    assert "found 6 columns; expected 4, as the header has; decimals stand behind a point: 8.46, not 8,46" in answer.err
    timed.write_text("time_s,id,x,y\n0,1,8.46,3.59,late\n")
    answer = surveillance(*words(timed, more=()))
    assert answer.err.endswith("found 5 columns; expected 4, as the header has\n")


@pytest.mark.end_to_end
def test_one_person_far_away_is_named(surveillance: Callable[..., Any], counted: Path) -> None:
    counted.write_text(counted.read_text() + "".join(f"\n{frame} wild {1e9 + frame / 2} 7" for frame in range(5)))
    answer = surveillance(*words(counted))
    assert answer.code == 2
    assert answer.err.startswith(f"{counted}: 1 of 11 people is far from all others, who keep within ")
    assert f"id wild of {counted}, at (1e+09, 7) m on line 205" in answer.err
    assert "--cell-m" not in answer.err


@pytest.mark.end_to_end
def test_people_who_really_spread_are_told_of_cells(surveillance: Callable[..., Any], tmp_path: Path) -> None:
    path = tmp_path / "far.txt"
    path.write_text("\n".join(f"{f} {p} {x + 1e4 * p} {y + 1e4 * p}" for f, p, x, y in walkers(0)))
    answer = surveillance(*words(path))
    assert answer.code == 2
    assert answer.err.startswith(f"{path}: people spread over 90,0")
    assert "cells of 1 m; give a larger --cell-m" in answer.err


@pytest.mark.end_to_end
def test_several_people_far_away_are_named(surveillance: Callable[..., Any], counted: Path) -> None:
    wild = "".join(f"\n{f} wild{k} {1e9 * (k + 1) + f / 2} 7" for k in range(3) for f in range(5))
    counted.write_text(counted.read_text() + wild)
    answer = surveillance(*words(counted))
    assert answer.code == 2
    assert answer.err.startswith(f"{counted}: people spread over 3,000,000,0")
    assert f"the farthest: id wild2 of {counted}, at (3e+09, 7) m on line 215; id wild1 of {counted}" in answer.err


@pytest.mark.end_to_end
def test_who_does_not_walk_is_told_with_the_file(surveillance: Callable[..., Any], tmp_path: Path) -> None:
    path = tmp_path / "still.txt"
    path.write_text("\n".join(f"{f} {p} {p} 0" for p in range(3) for f in range(9)))
    answer = surveillance(*words(path))
    assert answer.code == 2
    still, none = answer.err.splitlines()
    assert still.startswith(f"{path}: nobody moves at more than 0.3 m/s, and at most at 0 m/s")
    assert none.startswith(f"{path}: nobody walks two steps of 0.5 s on end")


@pytest.mark.end_to_end
@pytest.mark.parametrize("angle", ["nan", "inf"])
def test_an_angle_that_is_none_is_refused(
    surveillance: Callable[..., Any], counted: Path, tmp_path: Path, angle: str
) -> None:
    site = tmp_path / "site.toml"
    site.write_text((BUILTIN / "hall.toml").read_text().replace("step_s = 1.0", "step_s = 0.5"))
    for given in (
        (*words(counted), "--write", site, "--offset-m", "10,5", "--rotate-deg", angle),
        ("replay", site, counted, "--frames-per-s", 2, "--offset-m", "10,5", "--rotate-deg", angle),
    ):
        answer = surveillance(*given)
        assert (answer.code, answer.out) == (2, "")
        assert answer.err.strip() == f"--rotate-deg {angle}: expected a number of degrees, such as -90"


@pytest.mark.end_to_end
def test_nobody_on_the_map_is_told_with_the_file(
    surveillance: Callable[..., Any], counted: Path, tmp_path: Path
) -> None:
    answer = surveillance("replay", "hall", counted, "--frames-per-s", 2, "--offset-m", "500,500")
    assert answer.code == 2
    assert answer.err.startswith(f"{counted}: nobody is ever on the map")


@pytest.mark.end_to_end
def test_motion_that_sticks_to_walls_is_told_with_the_remedy(
    surveillance: Callable[..., Any], counted: Path, tmp_path: Path
) -> None:
    site = tmp_path / "site.toml"
    text = (BUILTIN / "hall.toml").read_text().replace("step_s = 1.0", "step_s = 0.5")
    site.write_text(text)
    answer = surveillance(*words(counted), "--write", site, "--json")
    assert answer.code == 0, answer.err
    (warning,) = answer.json["warnings"]
    assert warning in answer.err
    assert warning.startswith(f'{site}: with walls = "reject" people who turn by ')
    assert 'of 200 cells, with walls = "reflect" in ' in warning
    site.write_text(text.replace('walls = "reject"', 'walls = "reflect"'))
    assert surveillance(*words(counted), "--write", site, "--json").json["warnings"] == []


@pytest.mark.end_to_end
@pytest.mark.parametrize("name", [".", "/"])
def test_a_folder_is_no_recording(surveillance: Callable[..., Any], name: str) -> None:
    answer = surveillance(*words(Path(name)))
    assert answer.code == 2
    assert answer.err.startswith(f"{name}: found is a directory; expected a readable file of trajectories")


@pytest.mark.end_to_end
def test_an_empty_offset_is_refused(surveillance: Callable[..., Any], counted: Path, tmp_path: Path) -> None:
    site = tmp_path / "site.toml"
    site.write_text((BUILTIN / "hall.toml").read_text().replace("step_s = 1.0", "step_s = 0.5"))
    answer = surveillance(*words(counted), "--write", site, "--offset-m", "")
    assert (answer.code, answer.out) == (2, "")
    assert "expected two numbers, such as 3.5,-2" in answer.err
