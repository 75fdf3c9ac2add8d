"""Wrong input: one clear message, exit code 2, nothing written."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

WRONG = {
    "no targets": (("simulate", "tiny", "--targets", "0"), "greater than or equal to 1"),
    "negative targets": (("simulate", "tiny", "--targets", "-3"), "greater than or equal to 1"),
    "targets in words": (("simulate", "tiny", "--targets", "two"), "--targets"),
    "no runs": (("simulate", "tiny", "--runs", "0"), "greater than or equal to 1"),
    "no steps": (("compare", "tiny", "--steps", "0"), "greater than or equal to 1"),
    "negative seed": (("compare", "tiny", "--seed", "-1"), "greater than or equal to 0"),
    "unknown controller": (("simulate", "tiny", "--controller", "pomdb"), "did you mean 'pomdp'?"),
    "two controllers": (("simulate", "tiny", "--controller", "mp,sys"), "surveillance compare"),
    "unknown site": (("simulate", "hal"), "did you mean hall?"),
    "a folder as site": (("simulate", "."), "expected a readable site file"),
    "unknown truth": (("simulate", "tiny", "--truth", "real"), "'real' is not one of"),
    "unknown option": (("simulate", "tiny", "-o", "detection=1"), "did you mean 'detection_probability'?"),
    "option without value": (("simulate", "tiny", "-o", "cell_noise_m"), "expected KEY=VALUE"),
    "option in words": (("simulate", "tiny", "-o", "cell_noise_m=much"), "'much' is not a number"),
    "option twice": (("simulate", "tiny", "-o", "cell_noise_m=1", "--cell-noise-m", "1"), "given twice"),
    "impossible probability": (("simulate", "tiny", "--detection-probability", "1.5"), "detection_probability"),
    "probability nan": (("simulate", "tiny", "--detection-probability", "nan"), "detection_probability"),
    "counts with a hole": (("compare", "tiny", "--targets", "1,,5"), "'' is not a whole number"),
    "counts with a zero": (("compare", "tiny", "--targets", "5,0"), "0 targets; expected 1 or more"),
    "counts twice": (("compare", "tiny", "--targets", "5,5"), "5 stands there twice"),
    "unknown among controllers": (
        ("compare", "tiny", "--controllers", "pomdp,msq"),
        "no controller 'msq' (did you mean",
    ),
    "controllers twice": (("compare", "tiny", "--controllers", "mp,mp"), "mp stands there twice"),
    "unknown command": (("simulat", "tiny"), "simulate"),
    "no site": (("compare",), "SITE"),
}


@pytest.mark.end_to_end
@pytest.mark.parametrize("case", WRONG)
def test_wrong_input_is_refused(surveillance: Callable[..., Any], case: str) -> None:
    words, expected = WRONG[case]
    answer = surveillance(*words)
    assert answer.code == 2
    assert answer.out == ""
    assert expected in " ".join(answer.err.replace("│", " ").split())
    assert "Traceback" not in answer.err


@pytest.mark.end_to_end
@pytest.mark.parametrize("words", [("simulate", "tiny", "--runs", "1"), ("compare", "tiny")])
def test_a_place_that_cannot_be_written_is_found_first(
    surveillance: Callable[..., Any], tmp_path: Path, words: tuple[str, ...]
) -> None:
    (tmp_path / "file").write_text("in the way")
    answer = surveillance(*words, "--out", tmp_path / "file" / "below.png")
    assert answer.code == 2
    assert "cannot write in" in answer.err
    assert [path.name for path in tmp_path.iterdir()] == ["file"]


@pytest.mark.end_to_end
def test_a_fault_in_a_site_file_is_one_message(surveillance: Callable[..., Any], tmp_path: Path) -> None:
    site = tmp_path / "bad.toml"
    site.write_text("schema_version = 1\n[map]\ncell_m = 1.0\nrows = ['..']\n")
    for words in (("simulate", site), ("compare", site), ("coverage", site, "--out", tmp_path / "a.png")):
        answer = surveillance(*words)
        assert answer.code == 2
        assert "bad.toml" in answer.err
        assert "cameras" in answer.err
    assert [path.name for path in tmp_path.iterdir()] == ["bad.toml"]


@pytest.mark.end_to_end
def test_sites_of_the_same_name_are_told_apart_by_nobody(surveillance: Callable[..., Any], tmp_path: Path) -> None:
    from importlib import resources

    (tmp_path / "tiny.toml").write_bytes(
        (resources.files("surveillance_domain.site") / "builtin" / "tiny.toml").read_bytes()
    )
    answer = surveillance("compare", "tiny", tmp_path / "tiny.toml", "--targets", "1")
    assert answer.code == 2
    assert "same name" in answer.err
    answer = surveillance("compare", "tiny", "tiny", "--targets", "1")
    assert (answer.code, answer.err) == (2, "SITE: tiny stands there twice\n")
