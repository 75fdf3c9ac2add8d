"""``convert``, and a file as MODEL."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

import factored_pomdp as fp
from factored_pomdp.commands import main
from tests.factored_pomdp.files.test_cassandra_errors import GOOD
from tests.factored_pomdp.files.test_pomdpx_format import document


def run(capsys: pytest.CaptureFixture[str], *arguments: object) -> tuple[int, str, str]:
    with pytest.raises(SystemExit) as ended:
        main([str(argument) for argument in arguments])
    written = capsys.readouterr()
    return int(ended.value.code or 0), written.out, written.err


@pytest.mark.end_to_end
def test_convert_there_and_back(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "rock.pomdpx").write_text(document())
    code, out, _ = run(capsys, "convert", tmp_path / "rock.pomdpx", tmp_path / "rock.POMDP", "--json")
    assert code == 0
    assert json.loads(out)["written"] == str(tmp_path / "rock.POMDP")
    assert fp.load(tmp_path / "rock.POMDP").joint_states == 6
    code, out, _ = run(capsys, "convert", tmp_path / "rock.POMDP", tmp_path / "flat.pomdpx")
    assert code == 0
    assert "written" in out
    assert len(fp.load(tmp_path / "flat.pomdpx").states) == 1


@pytest.mark.end_to_end
def test_a_domain_can_be_written(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    code, _, _ = run(capsys, "convert", "machine-repair", tmp_path / "out.pomdpx", "-o", "machines=2")
    assert code == 0
    assert fp.decompose(fp.load(tmp_path / "out.pomdpx")).decomposes


@pytest.mark.end_to_end
def test_a_file_is_a_model_for_every_command(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "rock.pomdpx").write_text(document())
    code, out, _ = run(capsys, "info", tmp_path / "rock.pomdpx", "--json")
    assert code == 0
    assert json.loads(out)["states"] == [{"name": "rover", "size": 3}, {"name": "rock", "size": 2}]
    code, out, _ = run(capsys, "decompose", tmp_path / "rock.pomdpx", "--json")
    found = json.loads(out)
    assert found["decomposes"] is True
    assert (found["known"], found["blocks"]) == (["rover"], [["rock"]])


@pytest.mark.end_to_end
def test_wrong_input_gets_one_message(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    bad = tmp_path / "bad.pomdp"
    bad.write_text(GOOD.replace("T: open", "T: opne"))
    out = tmp_path / "out.pomdpx"
    for arguments, expected in (
        (("info", bad), f"{bad}: line 7: T: found 'opne'; expected an action (did you mean 'open'?) or *"),
        (("convert", bad, out), "line 7"),
        (("decompose", tmp_path / "no.pomdpx"), "no.pomdpx: no such file"),
        (("convert", "tiger", tmp_path / "out.txt"), "expected a name that ends with .pomdp or .pomdpx"),
        (("convert", "tiger", tmp_path / "nowhere" / "out.pomdp"), "No such file or directory"),
        (("info", bad, "-o", "a=1"), "a file takes no options"),
    ):
        code, printed, told = run(capsys, *arguments)
        assert code == 2
        assert printed == ""
        assert expected in told
        assert "Traceback" not in told
    code, _, told = run(
        capsys, "convert", "surveillance", tmp_path / "hall.pomdp", "-o", "site=hall", "-o", "targets=3"
    )
    assert code == 1
    assert "too large" in told
    assert not out.exists()
