"""``surveillance coverage``."""

from __future__ import annotations

from collections.abc import Callable
from importlib import resources
from pathlib import Path
from typing import Any

import pytest


@pytest.mark.end_to_end
def test_coverage_draws_and_counts(surveillance: Callable[..., Any], tmp_path: Path) -> None:
    answer = surveillance("coverage", "micro", "--out", tmp_path / "micro.png", "--json")
    assert answer.code == 0
    found = answer.json
    assert sorted(path.name for path in tmp_path.iterdir()) == ["micro.png", "micro.svg"]
    assert found["free_cells"] == 4
    cells = {camera["name"]: [preset["cells"] for preset in camera["presets"]] for camera in found["cameras"]}
    assert cells == {"west": [1, 1], "east": [1, 1]}  # the site file: each preset sees one cell
    assert found["joint_preset"]["share"] == 0.5
    assert found["joint_preset"]["proved_best"] is True
    assert found["all_presets_share"] == 0.75  # neither camera sees the upper right cell
    assert found["provenance"]["inputs"]["micro"].startswith("sha256:")


@pytest.mark.end_to_end
@pytest.mark.parametrize("name", ["micro.pdf", "micro", ""])
def test_other_pictures_are_not_made(surveillance: Callable[..., Any], tmp_path: Path, name: str) -> None:
    answer = surveillance("coverage", "micro", "--out", tmp_path / name)
    assert answer.code == 2
    assert "expected the name of a file that ends in .png" in answer.err
    assert list(tmp_path.iterdir()) == []


@pytest.mark.end_to_end
def test_no_folder_is_made_for_a_file(surveillance: Callable[..., Any], tmp_path: Path) -> None:
    answer = surveillance("coverage", "micro", "--out", tmp_path / "none" / "micro.png")
    assert answer.code == 2
    assert f"there is no folder {tmp_path / 'none'}" in answer.err
    assert list(tmp_path.iterdir()) == []


@pytest.mark.end_to_end
def test_cells_behind_a_privacy_mask_are_missing(surveillance: Callable[..., Any], tmp_path: Path) -> None:
    text = (resources.files("surveillance_domain.site") / "builtin" / "micro.toml").read_text(encoding="utf-8")
    site = tmp_path / "micro.toml"
    # From [0, 0], 2.5 m up, the preset "far" sees the cell of which [0.5, 1.5] is the centre: at pan 18.4, tilt -57.7.
    for pan, code in (("[19, 30]", 0), ("[18, 30]", 2)):
        mask = f"privacy_masks = [{{ pan_deg = {pan}, tilt_deg = [-60, -55] }}]"
        site.write_text(text.replace('name = "west"', f'name = "west"\n{mask}'), encoding="utf-8")
        answer = surveillance("coverage", site, "--out", tmp_path / "micro.png")
        assert answer.code == code, answer.err
    assert "sees no free cell; expected a clear view: privacy_masks hide 1 of 1 free cells" in answer.err
