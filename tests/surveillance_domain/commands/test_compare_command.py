"""``surveillance compare``."""

from __future__ import annotations

import csv
import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

BUILTIN = Path(__file__).parents[3] / "surveillance_domain" / "site" / "builtin"
SMALL = (
    "compare",
    "tiny",
    "micro",
    "--targets",
    "2,1",
    "--controllers",
    "pomdp,sys,mp-hold",
    "--steps",
    5,
    "--runs",
    3,
)


@pytest.mark.end_to_end
def test_rows_differences_and_files(surveillance: Callable[..., Any], tmp_path: Path) -> None:
    answer = surveillance(*SMALL, "--workers", 1, "--out", tmp_path, "--json")
    assert answer.code == 0
    found = answer.json
    cases = [(row["site"], row["targets"], row["controller"]) for row in found["rows"]]
    names = ("pomdp", "sys", "mp-hold")
    assert cases == [(site, m, name) for site in ("tiny", "micro") for m in (1, 2) for name in names]
    per_run = {case: row["per_run"] for case, row in zip(cases, found["rows"], strict=True)}
    for row in found["differences"]:
        ours = per_run[row["site"], row["targets"], "pomdp"]
        theirs = per_run[row["site"], row["targets"], row["controller"]]
        paired = [a - b for a, b in zip(ours, theirs, strict=True)]
        assert row["mean"] == pytest.approx(sum(paired) / 3)
        assert row["ci95"][0] <= row["mean"] <= row["ci95"][1]
    assert len(found["differences"]) == 8
    assert set(found["provenance"]["inputs"]) == {"tiny", "micro"}
    assert found["provenance"]["seed"] == 0
    files = [
        "comparison.csv",
        "comparison.png",
        "comparison.svg",
        "differences.csv",
        "provenance.json",
        "result.json",
        "runs.jsonl",
    ]
    assert sorted(path.name for path in tmp_path.iterdir()) == files
    with (tmp_path / "comparison.csv").open(newline="") as file:
        lines = list(csv.DictReader(file))
    assert [float(line["mean"]) for line in lines] == pytest.approx([row["mean"] for row in found["rows"]], abs=1e-3)
    ends = [[float(line["low"]), float(line["high"])] for line in lines]
    assert ends == [pytest.approx(row["ci95"], abs=1e-3) for row in found["rows"]]
    assert json.loads((tmp_path / "result.json").read_text()) == found


@pytest.mark.end_to_end
def test_no_interval_goes_beyond_what_a_share_can_be(surveillance: Callable[..., Any], tmp_path: Path) -> None:
    few = ("--targets", "1", "--controllers", "pomdp,stat", "--steps", 2, "--runs", 2, "--workers", 1)
    found = surveillance("compare", "tiny", *few, "--out", tmp_path, "--json").json
    told = {"comparison.csv": (found["rows"], 0.0), "differences.csv": (found["differences"], -100.0)}
    cut = 0
    for name, (rows, least) in told.items():
        with (tmp_path / name).open(newline="") as file:
            lines = list(csv.DictReader(file))
        for line, row in zip(lines, rows, strict=True):
            assert [float(line["low"]), float(line["high"])] == pytest.approx(row["ci95"], abs=1e-3)
            assert least <= row["ci95"][0] <= row["ci95"][1] <= 100
            cut += row["ci95"][0] == least or row["ci95"][1] == 100
    assert cut > 0


@pytest.mark.end_to_end
def test_one_file_by_two_paths_is_one_site(surveillance: Callable[..., Any], tmp_path: Path) -> None:
    here = tmp_path / "room.toml"
    here.write_text((BUILTIN / "tiny.toml").read_text())
    link = tmp_path / "link.toml"
    link.symlink_to(here)
    (tmp_path / "other").mkdir()
    for other in (tmp_path / "other" / ".." / "room.toml", link):
        answer = surveillance("compare", here, other, "--targets", "1", "--runs", 1)
        assert (answer.code, answer.err) == (2, f"SITE: {here.resolve()} stands there twice\n")


@pytest.mark.end_to_end
def test_the_same_numbers_as_simulate(surveillance: Callable[..., Any]) -> None:
    one = ("--targets", "2", "--steps", 5, "--runs", 3, "--truth", "continuous", "--json")
    compared = surveillance("compare", "tiny", "--controllers", "pomdp,msp", "--workers", 1, *one).json
    simulated = surveillance("simulate", "tiny", "--controller", "msp", *one).json
    (row,) = (row for row in compared["rows"] if row["controller"] == "msp")
    assert row["per_run"] == simulated["percent_obs"]["per_run"]
    assert row["ci95"] == simulated["percent_obs"]["ci95"]


@pytest.mark.end_to_end
def test_tables_are_for_people_and_progress_goes_elsewhere(surveillance: Callable[..., Any]) -> None:
    answer = surveillance("compare", "micro", "--targets", "1", "--steps", 2, "--runs", 2, "--workers", 1, "--progress")
    assert answer.code == 0
    for words in ("micro: PercentObs, grid truth", "micro: P minus, grid truth", "full information"):
        assert words in answer.out
    assert "s left" in answer.err
    assert "s left" not in answer.out


@pytest.mark.end_to_end
@pytest.mark.parametrize("command", ["simulate", "compare"])
def test_wrong_input_leaves_no_folder(command: str, surveillance: Callable[..., Any], tmp_path: Path) -> None:
    out = tmp_path / "out"
    answer = surveillance(command, "nowhere", "--targets", "1", "--out", out, "--json")
    assert answer.code == 2
    assert not out.exists()
