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
    other.write_text(people.read_text())
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
    assert "take more directions, larger cells or shorter steps" in answer.err
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
