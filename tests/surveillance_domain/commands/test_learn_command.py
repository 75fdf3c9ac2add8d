"""``surveillance learn``."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from surveillance_domain.site.load import load_site

BUILTIN = Path(__file__).parents[3] / "surveillance_domain" / "site" / "builtin"
SHARED = Path(__file__).parents[3] / ".." / "shared" / "data" / "trajectories"
KEYS = ("sigma_direction_deg", "sigma_speed_mps", "mean_speed_mps", "trajectories", "steps", "speeds")


@pytest.fixture
def people(tmp_path: Path) -> Path:
    """Twelve people who walk for twenty steps of half a second, at 1 or 2 m/s, and turn a little."""
    rng = np.random.default_rng(0)
    lines = []
    for person in range(12):
        headings = np.cumsum(rng.normal(0, 0.2, 20))
        moves = 0.5 * (1 + person % 2) * np.stack([np.cos(headings), np.sin(headings)], axis=1)
        for frame, (x, y) in enumerate(np.cumsum(moves, axis=0)):
            lines.append(f"{10 * frame} {person} {x} {y}")
    path = tmp_path / "people.txt"
    path.write_text("\n".join(lines))
    return path


def a_little_later(people: Path) -> str:
    """The same ways a minute later: other people, of the same names."""
    return "\n".join(
        f"{int(line.split()[0]) + 1200} {line.split(' ', 1)[1]}" for line in people.read_text().splitlines()
    )


@pytest.mark.end_to_end
def test_learn_writes_a_site_and_a_picture(surveillance: Callable[..., Any], people: Path, tmp_path: Path) -> None:
    site = tmp_path / "site.toml"
    site.write_text((BUILTIN / "hall.toml").read_text().replace("step_s = 1.0", "step_s = 0.5"))
    answer = surveillance(
        *("learn", people, "--step-s", 0.5, "--cell-m", 1, "--frames-per-s", 20, "--speeds", 2),
        *("--write", site, "--picture", tmp_path / "fit.png", "--json"),
    )
    assert answer.code == 0, answer.err
    found = answer.json
    assert set(KEYS) <= found.keys()
    assert (found["trajectories"], found["steps"], found["turns"]) == (12, 12 * 19, 12 * 18)
    assert found["sigma_direction_deg"] == pytest.approx(np.degrees(0.2), rel=0.1)
    assert found["speeds"] == pytest.approx([1.0, 2.0])
    assert found["mean_speed_mps"] == pytest.approx(1.5)
    judged = found["held_out"]
    assert found["held_out_log_likelihood"] == judged["model"] > judged["random_walk"]
    assert judged["trajectories"] == 4  # three tenths of twelve
    assert np.sum(found["prior"]["rows_from_below"]) == pytest.approx(1)
    targets = load_site(site).targets
    assert targets.speeds_mps == (1.0, 2.0)
    assert targets.sigma_direction_deg == pytest.approx(found["sigma_direction_deg"], abs=1e-3)
    assert (tmp_path / "fit.png").stat().st_size > 10_000
    assert found["written"] == [str(tmp_path / "fit.png"), str(tmp_path / "fit.svg"), str(site)]


@pytest.mark.end_to_end
def test_writing_leaves_all_else_in_the_site_file(
    surveillance: Callable[..., Any], people: Path, tmp_path: Path
) -> None:
    site = tmp_path / "site.toml"
    for name, step_s in (("hall", "1.0"), ("corridor", "1.0"), ("lego", "1.5")):
        before = (BUILTIN / f"{name}.toml").read_text()
        assert f"step_s = {step_s}" in before
        site.write_text(before)
        answer = surveillance("learn", people, "--step-s", step_s, "--cell-m", 1, "--frames-per-s", 20, "--write", site)
        assert answer.code == 0, answer.err
        changed = {"speeds_mps", "sigma_direction_deg", "sigma_speed_mps"}

        def others(text: str, changed: set[str] = changed) -> list[str]:
            return [line for line in text.splitlines() if line.split(" = ")[0] not in changed]

        assert others(site.read_text()) == others(before)
        found, was = load_site(site), load_site(name)
        kept = set(type(was.targets).model_fields) - changed
        assert all(getattr(found.targets, key) == getattr(was.targets, key) for key in kept)
        assert found.cameras == was.cameras


@pytest.mark.end_to_end
@pytest.mark.parametrize(
    ("words", "told"),
    [
        (("--step-s", 0.5, "--cell-m", 1), "--frames-per-s F"),
        (("--step-s", 0.1, "--cell-m", 1, "--frames-per-s", 20), "recorded every 0.5 s"),
        (("--step-s", 0, "--cell-m", 1, "--frames-per-s", 20), "--step-s 0: expected a number above 0"),
        (("--step-s", 1, "--cell-m", 1, "--frames-per-s", 0), "--frames-per-s 0: expected a number above 0"),
        (("--step-s", 1, "--cell-m", 1, "--frames-per-s", 2000), "--metres-per-unit or --homography"),
        (("--step-s", 1, "--cell-m", 1, "--columns", "x"), "--columns x: expected NAME=HEADER"),
        (("--step-s", 1, "--cell-m", 1, "--homography", "no.txt"), "no.txt"),
        (("--step-s", 1, "--cell-m", 1, "--picture", "fit.pdf"), "ends in .png"),
        (("--step-s", 1, "--cell-m", 1, "--frames-per-s", 20, "--write", "no.toml"), "no such file"),
        (("--step-s", 0.5, "--cell-m", 1, "--frames-per-s", 20, "--write", BUILTIN / "hall.toml"), "--step-s 1"),
    ],
)
def test_what_is_wrong_is_told_in_one_message(
    surveillance: Callable[..., Any], people: Path, words: tuple[object, ...], told: str
) -> None:
    answer = surveillance("learn", people, *words)
    assert answer.code == 2
    assert told in answer.err
    assert answer.out == ""


@pytest.mark.end_to_end
def test_two_scenes_together_have_no_common_prior(surveillance: Callable[..., Any], people: Path) -> None:
    other = people.with_name("others.txt")
    other.write_text(a_little_later(people))
    answer = surveillance("learn", people, other, "--step-s", 0.5, "--cell-m", 1, "--frames-per-s", 20, "--json")
    assert answer.code == 0
    assert answer.json["trajectories"] == 24  # the same names, but other people
    assert answer.json["prior"] is None


@pytest.mark.end_to_end
def test_cells_out_of_reach_are_warned_of(surveillance: Callable[..., Any], people: Path) -> None:
    answer = surveillance(
        "learn", people, "--step-s", 1, "--cell-m", 0.25, "--frames-per-s", 20, "--directions", 4, "--json"
    )
    assert answer.code == 0
    assert "take more directions or speeds, larger cells or shorter steps" in answer.err
    assert answer.json["held_out"]["impossible_on_grid"] > 0.5


@pytest.mark.end_to_end
def test_eth_at_its_own_rate_walks_at_its_own_pace(surveillance: Callable[..., Any]) -> None:
    recording = SHARED / "ewap_seq_eth" / "obsmat.txt"
    if not recording.is_file():
        pytest.skip("no shared recording of ETH")
    answer = surveillance("learn", recording, "--step-s", 0.4, "--cell-m", 1, "--frames-per-s", 15, "--json")
    assert answer.code == 0
    found = answer.json
    assert (found["trajectories"], found["steps"]) == (360, 8908 - 360)
    assert found["mean_speed_mps"] == pytest.approx(1.4, abs=0.05)
    assert found["held_out"]["model"] > found["held_out"]["random_walk"] + 0.5


def words(people: Path, *more: object) -> tuple[object, ...]:
    return ("learn", people, "--step-s", 0.5, "--cell-m", 1, "--frames-per-s", 20, *more)


@pytest.fixture
def site(tmp_path: Path) -> Path:
    path = tmp_path / "site.toml"
    path.write_text((BUILTIN / "hall.toml").read_text().replace("step_s = 1.0", "step_s = 0.5"))
    return path


@pytest.mark.end_to_end
@pytest.mark.parametrize("speeds", [1, 20])
def test_few_and_many_speeds(surveillance: Callable[..., Any], people: Path, speeds: int) -> None:
    found = surveillance(*words(people, "--speeds", speeds, "--json"))
    assert found.code == 0, found.err
    assert found.json["speeds"][0] >= 0
    assert len(found.json["speeds"]) == (1 if speeds == 1 else 2)  # they walk at 1 or 2 m/s
    if speeds == 1:
        assert found.json["speeds"] == pytest.approx([1.5])


@pytest.mark.end_to_end
def test_the_table_says_what_the_numbers_mean(surveillance: Callable[..., Any], people: Path) -> None:
    answer = surveillance(*words(people))
    assert answer.code == 0
    told = " ".join(answer.out.split())
    assert "half of the time in" in told
    assert "foretells the next cell better than a random walk; " in told
    assert "from the nearest of 8 directions and of 2 speeds on cells of 1 m" in told
    found = surveillance(*words(people, "--json")).json
    judged = found["held_out"]
    low, high = judged["model_over_constant_velocity_ci95"]
    assert judged["verdict"]["constant_velocity"] == ("better" if low > 0 else "worse" if high < 0 else "undecided")
    assert judged["verdict"]["random_walk"] == "better"
    assert "provenance" not in found
    assert {"command", "version", "inputs", "seed"} <= found.keys()


@pytest.mark.end_to_end
def test_the_order_of_rows_and_files_plays_no_part(surveillance: Callable[..., Any], people: Path) -> None:
    other = people.with_name("others.txt")
    other.write_text("\n".join(line.replace(" ", " 7", 1) for line in people.read_text().splitlines()[60:]))
    first = surveillance(*words(people, other, "--json")).json
    people.write_text("\n".join(reversed(people.read_text().splitlines())))
    again = surveillance("learn", other, *words(people, "--json")[1:]).json
    for key in ("held_out", "sigma_direction_deg", "sigma_speed_mps", "speeds"):
        assert first[key] == again[key]


@pytest.mark.end_to_end
def test_faults_are_told_and_in_the_answer(surveillance: Callable[..., Any], people: Path) -> None:
    people.write_text(people.read_text() + "\n0 lonely 3 3\n")
    answer = surveillance(*words(people, "--json"))
    (fault,) = answer.json["faults"]
    assert (fault["kind"], fault["first_people"], fault["left_out"]) == ("single_points", ["lonely"], 1)
    assert fault["message"] in answer.err
    assert "1 of 13 people left out altogether" in answer.err
    assert answer.json["counts"]["single_points"] == 1


@pytest.mark.end_to_end
def test_tiny_cells_are_refused_with_the_size(surveillance: Callable[..., Any], people: Path) -> None:
    answer = surveillance("learn", people, "--step-s", 0.5, "--cell-m", 1e-3, "--frames-per-s", 20)
    assert answer.code == 2
    assert "cells of 0.001 m; give a larger --cell-m" in answer.err
    other = people.with_name("others.txt")
    other.write_text(a_little_later(people))
    answer = surveillance("learn", people, other, "--step-s", 0.5, "--cell-m", 1e-4, "--frames-per-s", 20)
    assert answer.code == 2
    assert "GB), the longest move in 0.5 s going over 10,000 cells" in answer.err


@pytest.mark.end_to_end
def test_a_placed_prior_is_written_beside_the_site_file(
    surveillance: Callable[..., Any], people: Path, site: Path
) -> None:
    answer = surveillance(*words(people, "--write", site, "--offset-m", "10,5", "--rotate-deg", 90, "--json"))
    assert answer.code == 0, answer.err
    beside = site.with_name("site-prior.csv")
    assert answer.json["written"] == [str(site), str(beside)]
    loaded = load_site(site)
    assert loaded.targets.prior == beside.name
    assert loaded.prior is not None
    assert (loaded.prior > 0).all()  # everybody can walk to every cell of the hall
    assert answer.json["prior_in_site"]["points"] > 0
    # the busiest cell is where the turned and moved recording says
    x, y = np.array([line.split()[2:] for line in people.read_text().splitlines()], dtype=float).T
    cells = np.floor(np.stack([10 - y, 5 + x], axis=1)).astype(int)
    on_map = cells[((cells >= 0) & (cells < [20, 10])).all(axis=1)]
    assert len(on_map) == answer.json["prior_in_site"]["points"]
    visits = np.bincount(on_map[:, 1] * 20 + on_map[:, 0], minlength=200)
    assert loaded.prior == pytest.approx((visits + 0.5) / (visits.sum() + 100), rel=1e-4)
    again = surveillance(*words(people, "--write", site, "--offset-m", "10,5", "--rotate-deg", 90, "--json"))
    assert again.code == 0  # its own prior may be written again


@pytest.mark.end_to_end
def test_without_a_place_the_prior_is_not_written_and_it_says_why(
    surveillance: Callable[..., Any], people: Path, site: Path
) -> None:
    answer = surveillance(*words(people, "--write", site))
    assert answer.code == 0
    assert "prior over cells was not written" in answer.err
    assert "--offset-m X,Y" in answer.err
    assert load_site(site).targets.prior == "uniform"
    assert not site.with_name("site-prior.csv").exists()


@pytest.mark.end_to_end
@pytest.mark.parametrize(
    ("more", "told"),
    [
        (("--offset-m", "1,1"), "expected --write SITE.toml too"),
        (("--write", "site.toml", "--offset-m", "1"), "--offset-m 1: expected two numbers"),
        (("--write", "site.toml", "--offset-m", "500,500"), "nobody is ever on the map"),
    ],
)
def test_a_place_that_is_none_is_refused(
    surveillance: Callable[..., Any], people: Path, site: Path, more: tuple[str, ...], told: str
) -> None:
    before = site.read_bytes()
    answer = surveillance(*words(people, *(str(site) if one == "site.toml" else one for one in more)))
    assert answer.code == 2
    assert told in answer.err
    assert site.read_bytes() == before


@pytest.mark.end_to_end
def test_what_must_not_be_written_is_left_alone(surveillance: Callable[..., Any], people: Path, site: Path) -> None:
    before = site.read_bytes()
    site.chmod(0o444)
    answer = surveillance(*words(people, "--write", site))
    assert answer.code == 2
    assert "a read-only file, which is left as it is" in answer.err
    site.chmod(0o644)
    strange = site.with_name("site-prior.csv")
    strange.write_text("mine\n")
    answer = surveillance(*words(people, "--write", site, "--offset-m", "10,5"))
    assert answer.code == 2
    assert "is there already and not of this site" in answer.err
    assert (site.read_bytes(), strange.read_text()) == (before, "mine\n")


@pytest.mark.end_to_end
def test_a_folder_that_cannot_be_written_in_is_named_with_a_way_out(
    surveillance: Callable[..., Any], people: Path, site: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def refused(*arguments: object, **options: object) -> None:
        raise PermissionError(13, "Permission denied", "/somewhere/.site-x.toml")

    monkeypatch.setattr("tempfile.TemporaryFile", refused)  # root may write anywhere
    answer = surveillance(*words(people, "--write", site))
    assert answer.code == 2
    assert f"cannot write in the folder {site.parent}: permission denied" in answer.err
    assert "expected a folder in which you may write" in answer.err
    assert ".site-x.toml" not in answer.err


@pytest.mark.end_to_end
def test_comments_among_the_speeds_stay(surveillance: Callable[..., Any], people: Path, site: Path) -> None:
    text = site.read_text()
    speeds = next(line for line in text.splitlines() if line.startswith("speeds_mps"))
    many = "speeds_mps = [\n  0.5, # a stroll\n  # those in a hurry\n  1.5,\n  2.5, # they run\n]"
    site.write_text(text.replace(speeds, many))
    answer = surveillance(*words(people, "--speeds", 2, "--write", site))
    assert answer.code == 0
    assert "speeds_mps = [\n  1.0, # a stroll\n  # those in a hurry\n  2.0,\n]" in site.read_text()
    assert "comments of speeds that are no more went with them: # they run" in answer.err


@pytest.mark.end_to_end
def test_a_link_to_a_site_file_stays_a_link(
    surveillance: Callable[..., Any], people: Path, site: Path, tmp_path: Path
) -> None:
    elsewhere = tmp_path / "elsewhere"
    elsewhere.mkdir()
    link = elsewhere / "link.toml"
    link.symlink_to(site)
    answer = surveillance(*words(people, "--write", link, "--offset-m", "10,5", "--json"))
    assert answer.code == 0, answer.err
    assert link.is_symlink()
    assert answer.json["written"] == [str(site), str(site.with_name("site-prior.csv"))]
    assert load_site(site).targets.prior == "site-prior.csv"
    assert load_site(link).prior is not None  # what a site file names lies beside the file, not beside the link


@pytest.mark.end_to_end
def test_directions_too_few_for_how_people_turn_are_told(surveillance: Callable[..., Any], people: Path) -> None:
    """They turn by 11.5 degrees a step: bins of 90 degrees lose that, those of 22.5 are within two sigmas."""
    words = ("learn", people, "--step-s", 0.5, "--cell-m", 1, "--frames-per-s", 20, "--json")
    assert not any("directions a target turns" in told for told in surveillance(*words).json["warnings"])
    coarse = surveillance(*words, "--directions", 4)
    (told,) = (told for told in coarse.json["warnings"] if "directions a target turns" in told)
    assert told.startswith("with 4 directions a target turns by ")
    assert "--directions 16 has bins no wider than two sigmas" in told
    assert told in coarse.err.replace("\n", " ")
