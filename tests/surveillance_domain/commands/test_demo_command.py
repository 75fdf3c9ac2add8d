"""The demonstration, small."""

from __future__ import annotations

import json
import re
from html.parser import HTMLParser
from pathlib import Path

import pytest

from surveillance_domain.commands import demo


@pytest.mark.end_to_end
@pytest.mark.slow
def test_the_demonstration_leaves_what_its_page_shows(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as ended:
        demo.main(["--small", "--workers", "2", "--out", str(tmp_path / "demo")])
    assert ended.value.code == 0
    told = capsys.readouterr().err
    assert "no difference above rounding" in told
    assert str(tmp_path / "demo") in told.replace("\n", "")
    page = (tmp_path / "demo" / "index.html").read_text(encoding="utf-8")
    HTMLParser().feed(page)
    named = set(re.findall(r'(?:src|href)="([^"]+)"', page))
    assert {"hall/comparison.svg", "office/run.gif", "verify/result.json", "coverage/office.svg"} <= named
    for name in named:
        assert (tmp_path / "demo" / name).stat().st_size > 0
    assert json.loads((tmp_path / "demo" / "verify" / "result.json").read_text())["holds"] is True
    for folder in ("", "hall", "office", "verify", "coverage"):
        carried = json.loads((tmp_path / "demo" / folder / "provenance.json").read_text())
        assert carried["command"].startswith("python -m surveillance_domain.commands.demo --small")
        assert carried["inputs"]


@pytest.mark.end_to_end
def test_without_the_examples_it_says_so(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(demo, "EXAMPLE", tmp_path / "nowhere.toml")
    with pytest.raises(SystemExit) as ended:
        demo.main(["--out", str(tmp_path / "demo")])
    assert ended.value.code == 2
    assert "run it in a clone" in capsys.readouterr().err
    assert list(tmp_path.iterdir()) == []
