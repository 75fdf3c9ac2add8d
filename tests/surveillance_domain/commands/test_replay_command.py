"""``surveillance replay``."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

BUILTIN = Path(__file__).parents[3] / "surveillance_domain" / "site" / "builtin"
SHARED = Path(__file__).parents[3] / ".." / "shared" / "data" / "trajectories"
CONTROLLERS = ("pomdp", "mp", "msp", "sys", "stat", "full-information", "clairvoyant")
DOORS = "[[targets.doors]]\ncells = [[0, 1], [0, 2]]\nrate_per_s = 0.02\n"
EAST_DOOR = "[[targets.doors]]\ncells = [[4, 1], [4, 2]]\nrate_per_s = 0.02\n"


@pytest.fixture
def site(tmp_path: Path) -> Path:
    path = tmp_path / "room.toml"
    text = (BUILTIN / "tiny.toml").read_text().replace("[control]", f"{DOORS}\n{EAST_DOOR}\n[control]")
    path.write_text(text.replace("speeds_mps = [1.5]", "speeds_mps = [0.5, 1.0]"))
    return path


@pytest.fixture
def people(tmp_path: Path) -> Path:
    """A crosses the room from west to east, b the other way and later; in the scene both walk north and south."""
    lines = ["frame,id,x,y"]
    for second in range(8):
        lines.append(f"{second},a,-1.5,{second - 0.5}")
        lines.append(f"{second + 4},b,-2.5,{6.5 - second}")
    path = tmp_path / "people.csv"
    path.write_text("\n".join(lines))
    return path


def words(site: Path, people: Path, *more: object) -> tuple[object, ...]:
    """A quarter turn clockwise makes north east; then x = y of the scene, y = -x."""
    return ("replay", site, people, "--frames-per-s", 1, "--rotate-deg", -90, "--steps", 11, *more, "--json")


@pytest.mark.end_to_end
def test_every_controller_watches_and_none_passes_the_clairvoyant(
    surveillance: Callable[..., Any], site: Path, people: Path
) -> None:
    shares = {}
    for name in CONTROLLERS:
        answer = surveillance(*words(site, people, "--controller", name))
        assert answer.code == 0, answer.err
        found = answer.json
        assert (found["site"], found["controller"], found["targets"]) == ("room", name, 2)
        assert (found["runs"], found["steps"], found["truth"]) == (1, 11, "recorded")
        shares[name] = found["percent_obs"]["mean"]
    assert all(share <= shares["clairvoyant"] + 1e-9 for share in shares.values())
    assert shares["pomdp"] > 0


@pytest.mark.end_to_end
def test_what_was_placed_and_who_came_is_counted(
    surveillance: Callable[..., Any], site: Path, people: Path, tmp_path: Path
) -> None:
    out = tmp_path / "out"
    found = surveillance(*words(site, people, "--out", out)).json
    # a is at x = -0.5 … 6.5 in seconds 0 … 7, on the map in seconds 1 to 5; b comes back in seconds 4 … 11: 6 to 10
    assert found["placed"]["off_map"] == 2 * 3
    assert found["people"] == {"entered_late": 2, "left_early": 2, "there_throughout": 0}
    assert found["counts"]["rows"] == 16
    assert len(found["percent_obs"]["per_run"]) == 1
    names = sorted(path.name for path in out.iterdir())
    assert names == ["last-step.png", "last-step.svg", "provenance.json", "result.json", "run.gif", "steps.csv"]
    lines = (out / "steps.csv").read_text().splitlines()
    present = [int(dict(zip(lines[0].split(","), line.split(","), strict=True))["present"]) for line in lines[1:]]
    assert present == [1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 0]


@pytest.mark.end_to_end
def test_somebody_who_moves_as_no_model_says_is_found_again_and_counted(
    surveillance: Callable[..., Any], site: Path, tmp_path: Path
) -> None:
    """Two metres in a second, there and back, where nobody is believed to go faster than 1 m/s."""
    places = [(2.5, 0.5)] * 8 + [(2.5, 2.5)] * 8 + [(2.5, 0.5)] * 8
    rows = [f"{second},a,{x},{y}" for second, (x, y) in enumerate(places)]
    recording = tmp_path / "people.csv"
    recording.write_text("frame,id,x,y\n" + "\n".join(rows))
    site.write_text((BUILTIN / "tiny.toml").read_text().replace("speeds_mps = [1.5]", "speeds_mps = [0.5, 1.0]"))
    answer = surveillance("replay", site, recording, "--frames-per-s", 1, "--steps", 23, "--json")
    assert answer.code == 0, answer.err
    found = answer.json
    assert found["people"] == {"entered_late": 0, "left_early": 0, "there_throughout": 1}
    assert found["restarts"] == 2
    assert found["percent_obs"]["mean"] == 100  # and it is not lost for that


@pytest.mark.end_to_end
def test_a_site_without_doors_is_warned_of(surveillance: Callable[..., Any], people: Path) -> None:
    answer = surveillance(*words(Path("tiny"), people, "--controller", "stat"))
    assert answer.code == 0
    assert "no [[targets.doors]]: everybody is believed to be on the map" in answer.err
    assert "fall off the map" not in answer.err


@pytest.mark.end_to_end
def test_a_placement_that_loses_most_of_the_recording_is_warned_of(
    surveillance: Callable[..., Any], site: Path, people: Path
) -> None:
    """Moved 3 m to the east, of each of the two only x = 2.5, 3.5 and 4.5 are on the map."""
    answer = surveillance(*words(site, people, "--offset-m", "3,0", "--controller", "stat"))
    assert answer.code == 0, answer.err
    lost = answer.json["placed"]["off_map"]
    (told,) = answer.json["warnings"]
    assert told.startswith(f"{lost} of 16 positions fall off the map and 0 into walls")
    assert "are --offset-m and --rotate-deg right?" in answer.err


@pytest.mark.end_to_end
def test_a_recording_coarser_than_the_steps_is_warned_of(
    surveillance: Callable[..., Any], site: Path, people: Path
) -> None:
    given = [word for word in words(site, people, "--controller", "stat", "--frames-per-s", 0.5, "--max-gap-s", 3)]
    found = surveillance(*given).json
    (told,) = found["warnings"]
    assert told.startswith("recorded every 2 s, and the site has step_s = 1: ")


@pytest.mark.end_to_end
def test_times_far_apart_are_warned_of_and_take_no_room(
    surveillance: Callable[..., Any], site: Path, people: Path
) -> None:
    late = [f"{1_600_000_000 + second},c,-1.5,{second - 0.5}" for second in range(8)]
    people.write_text("\n".join([people.read_text(), *late]))
    answer = surveillance(*words(site, people, "--controller", "stat"))
    assert answer.code == 0, answer.err
    found = answer.json
    assert (found["runs"], found["targets_per_run"]) == (2, [2, 1])
    (told,) = found["warnings"]
    assert told.startswith(
        "nobody is there for 1.6e+09 s, after 2 of 3 people; then comes id c at 1600000000 s, on line 18; "
    )


@pytest.mark.end_to_end
@pytest.mark.parametrize(
    ("more", "told"),
    [
        (("--offset-m", "100,0"), "nobody is ever on the map"),
        (("--offset-m", "1"), "--offset-m 1: expected two numbers"),
        (("--controller", "pomp"), "no controller 'pomp' (did you mean 'pomdp'?)"),
        (("--offset-m", "1e308,0"), "--offset-m 1e308,0: expected metres, of which no place is more than 1e+12 away"),
        (("--start-s", "1e300"), "nobody is on the map after --start-s 1e+300"),
        (("--start-s", 500), "nobody is on the map after --start-s 500"),
        (("--fastest-mps", 0), "expected 0 or more, and above 0"),
    ],
)
def test_what_is_wrong_is_told(
    surveillance: Callable[..., Any], site: Path, people: Path, more: tuple[object, ...], told: str
) -> None:
    answer = surveillance(*[word for word in words(site, people, *more) if word != "--json"])
    assert answer.code == 2
    assert told in answer.err
    assert answer.out == ""


@pytest.mark.end_to_end
def test_a_shared_recording_is_replayed_piece_by_piece(surveillance: Callable[..., Any]) -> None:
    recording = SHARED / "trajnetpp" / "crowds_zara01.ndjson"
    if not recording.is_file():
        pytest.skip("no shared recording of UCY")
    answer = surveillance(
        *(
            "replay",
            "hall",
            recording,
            "--offset-m",
            "9,6",
            "--steps",
            20,
            "--runs",
            2,
            "--controller",
            "stat",
            "--json",
        )
    )
    assert answer.code == 0, answer.err
    found = answer.json
    assert found["runs"] == 2
    assert len(found["targets_per_run"]) == 2
    assert 0 < found["percent_obs"]["mean"] < 100
