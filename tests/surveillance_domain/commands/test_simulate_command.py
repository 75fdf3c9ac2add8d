"""``surveillance simulate``."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from surveillance_domain.site.load import load_site

SMALL = ("simulate", "tiny", "--targets", 2, "--steps", 6, "--runs", 3, "--seed", 7)


@pytest.mark.end_to_end
def test_the_answer_has_the_promised_keys(surveillance: Callable[..., Any]) -> None:
    answer = surveillance(*SMALL, "--json")
    assert answer.code == 0
    assert answer.err == ""
    found = answer.json
    assert {key: found[key] for key in ("site", "controller", "targets", "steps", "runs", "truth")} == {
        "site": "tiny",
        "controller": "pomdp",
        "targets": 2,
        "steps": 6,
        "runs": 3,
        "truth": "grid",
    }
    percent = found["percent_obs"]
    assert len(percent["per_run"]) == 3
    assert percent["mean"] == pytest.approx(np.mean(percent["per_run"]))
    assert percent["ci95"][0] <= percent["mean"] <= percent["ci95"][1]
    assert 0 < found["decision_ms"]["median"] <= found["decision_ms"]["p99"]
    assert found["restarts"] == 0
    carried = found["provenance"]
    assert carried["command"] == "surveillance simulate tiny --targets 2 --steps 6 --runs 3 --seed 7 --json"
    assert carried["seed"] == 7
    assert carried["version"]
    assert carried["inputs"] == {"tiny": f"sha256:{load_site('tiny').digest}"}
    assert {key: found[key] for key in carried} == carried


@pytest.mark.end_to_end
def test_same_seed_same_result_whatever_way_an_option_is_given(surveillance: Callable[..., Any]) -> None:
    ways = (
        ("-o", "detection_probability=0.5", "-o", "cell_noise_m=0.5"),
        ("--detection-probability", 0.5, "--cell-noise-m", 0.5),
    )
    first, second = (surveillance(*SMALL, *way, "--json").json for way in ways)
    assert first["percent_obs"] == second["percent_obs"]
    assert (first["detection_probability"], first["cell_noise_m"]) == (0.5, 0.5)
    assert surveillance(*SMALL, "--json").json["percent_obs"]["mean"] > first["percent_obs"]["mean"]


@pytest.mark.end_to_end
def test_one_run_has_no_interval(surveillance: Callable[..., Any]) -> None:
    answer = surveillance("simulate", "tiny", "--runs", 1, "--steps", 2, "--controller", "sys", "--json")
    assert answer.json["percent_obs"]["ci95"] == [None, None]


@pytest.mark.end_to_end
def test_the_table_is_for_people(surveillance: Callable[..., Any]) -> None:
    answer = surveillance(*SMALL, "--controller", "stat", "--truth", "continuous")
    assert answer.code == 0
    assert "PercentObs" in answer.out
    assert "continuous" in answer.out


@pytest.mark.end_to_end
def test_the_folder_holds_animation_table_and_provenance(surveillance: Callable[..., Any], tmp_path: Path) -> None:
    out = tmp_path / "new" / "folder"
    answer = surveillance(*SMALL, "--out", out, "--json")
    assert answer.code == 0
    names = ["last-step.png", "last-step.svg", "provenance.json", "result.json", "run.gif", "steps.csv"]
    assert sorted(path.name for path in out.iterdir()) == names
    assert json.loads((out / "result.json").read_text()) == answer.json
    assert json.loads((out / "provenance.json").read_text()) == answer.json["provenance"]
    without = surveillance(*SMALL, "--json").json
    assert answer.json["percent_obs"] == without["percent_obs"]
    (out / "mine.txt").write_text("stays")
    assert surveillance(*SMALL, "--controller", "sys", "--out", out).code == 0
    assert json.loads((out / "result.json").read_text())["controller"] == "sys"
    assert sorted(path.name for path in out.iterdir()) == sorted([*names, "mine.txt"])


@pytest.mark.end_to_end
def test_when_a_picture_fails_the_old_folder_stands(
    surveillance: Callable[..., Any], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    from surveillance_domain.pictures import animation

    def fail(*arguments: object) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(animation, "write_animation", fail)
    (tmp_path / "result.json").write_text("old")
    found = surveillance(*SMALL, "--out", tmp_path)
    assert (found.code, found.out, found.err) == (2, "", f"cannot write in {tmp_path}: no space left on device\n")
    assert [(path.name, path.read_text()) for path in tmp_path.iterdir()] == [("result.json", "old")]
