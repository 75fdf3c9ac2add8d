"""Values are set in a site file and nothing else is."""

from __future__ import annotations

import tomllib
from pathlib import Path

import pytest

from surveillance_domain.site.faults import SiteError
from surveillance_domain.site.load import load_site
from surveillance_domain.site.rewriting import rewrite_table, with_values

BUILTIN = Path(__file__).parents[3] / "surveillance_domain" / "site" / "builtin"
VALUES = {"speeds_mps": [0.2, 1.3], "sigma_direction_deg": 9.5, "sigma_speed_mps": 0.25}


@pytest.mark.example
@pytest.mark.parametrize("name", ["hall", "corridor", "junction", "lego", "micro"])
def test_built_in_sites_keep_all_but_the_three_keys(tmp_path: Path, name: str) -> None:
    path = tmp_path / "site.toml"
    before = (BUILTIN / f"{name}.toml").read_text()
    path.write_text(before)
    path.chmod(0o640)
    rewrite_table(path, "targets", VALUES)
    after = path.read_text()
    old, new = before.splitlines(), after.splitlines()
    assert [line for line in new if line not in old] == [
        line for line in new if line.split(" = ")[0] in VALUES
    ]  # no other line is new
    assert {line.split(" = ")[0] for line in old if line not in new} <= VALUES.keys()
    found, was = load_site(path), load_site(name)
    assert found.targets == was.targets.model_copy(update={**VALUES, "speeds_mps": (0.2, 1.3)})
    assert found.cameras == was.cameras
    assert path.stat().st_mode & 0o777 == 0o640
    assert [file.name for file in tmp_path.iterdir()] == ["site.toml"]


@pytest.mark.example
def test_comments_lists_over_lines_and_line_ends_stay() -> None:
    text = "a = 1\r\n[targets] # people\r\n  speeds_mps = [ # slow\r\n    1.0, # [\r\n"
    text += "  ] # set\r\nwalls = 'stay'\r\n[x]\r\n"
    assert with_values(text, "targets", {"speeds_mps": [2.0]}) == (
        "a = 1\r\n[targets] # people\r\n  speeds_mps = [2.0] # set\r\nwalls = 'stay'\r\n[x]\r\n"
    )


@pytest.mark.example
@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("[targets]\nb = 1\n[[targets.doors]]\na = 0\n", "[targets]\na = 2.0\nb = 1\n[[targets.doors]]\na = 0\n"),
        ("[[targets.doors]]\na = 0", "[[targets.doors]]\na = 0\n\n[targets]\na = 2.0\n"),
        ("[targets]", "[targets]\na = 2.0\n"),
        ("", "\n[targets]\na = 2.0\n"),
    ],
)
def test_keys_and_tables_that_are_missing_are_made(text: str, expected: str) -> None:
    assert with_values(text, "targets", {"a": 2.0}) == expected
    assert tomllib.loads(expected)["targets"]["a"] == 2


@pytest.mark.example
@pytest.mark.parametrize("text", ["targets = { a = 1 }\n", "targets.a = 1\n", '[targets]\n"a" = 1\n'])
def test_other_ways_to_write_the_table_are_refused(text: str) -> None:
    with pytest.raises(SiteError, match=r"set them by hand: a = 2.0"):
        with_values(text, "targets", {"a": 2.0})


@pytest.mark.example
def test_a_change_that_spoils_the_site_is_not_made(tmp_path: Path) -> None:
    path = tmp_path / "site.toml"
    before = (BUILTIN / "micro.toml").read_bytes()
    path.write_bytes(before)
    with pytest.raises(SiteError, match="speeds in rising order"):
        rewrite_table(path, "targets", {"speeds_mps": [2.0, 1.0]})
    assert path.read_bytes() == before
    assert [file.name for file in tmp_path.iterdir()] == ["site.toml"]
