"""The `factored-pomdp` command, the way a person or a script uses it."""

from __future__ import annotations

import json
import subprocess
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest

from factored_pomdp import __version__, verification
from factored_pomdp.commands import main

pytestmark = pytest.mark.end_to_end

Run = Callable[..., tuple[int, str, str]]

WEATHER = '''
import factored_pomdp as fp

WEATHER = fp.Variable("weather", ["sun", "rain"])


def model(rainy: float = 0.3, tied: bool = False) -> fp.FactoredPOMDP:
    """Whether to take an umbrella."""
    return fp.FactoredPOMDP(
        name="weather",
        states=[WEATHER],
        actions=[fp.Variable("take", ["umbrella", "nothing"])],
        observations=[fp.Variable("sky", ["blue", "grey"])],
        transition={"weather": lambda weather: {weather: 1 - rainy, "rain" if weather == "sun" else "sun": rainy}},
        observation={"sky": lambda weather_next: {"blue": 0.9, "grey": 0.1} if weather_next == "sun" else {"grey": 1}},
        reward={"dry": lambda weather, take: -1.0 if weather == "rain" and take == "nothing" else 0.0},
        initial={"weather": {"sun": 0.5, "rain": 0.5}},
    )


def other() -> int:
    """No model."""
    return 3


def failing() -> None:
    """Fails."""
    raise KeyError("umbrella")
'''


@pytest.fixture
def run(capsys: pytest.CaptureFixture[str]) -> Run:
    """Run the command in this process: exit code, standard output, standard error."""

    def go(*arguments: str) -> tuple[int, str, str]:
        with pytest.raises(SystemExit) as stop:
            main(arguments)
        out, err = capsys.readouterr()
        code = stop.value.code
        return code if isinstance(code, int) else 0, out, err

    return go


@pytest.fixture
def weather(tmp_path: Path) -> Path:
    path = tmp_path / "weather.py"
    path.write_text(WEATHER, encoding="utf-8")
    return path


def asked(run: Run, *arguments: str, code: int = 0) -> dict[str, Any]:
    """The one JSON object on standard output."""
    got, out, err = run(*arguments, "--json")
    assert got == code, err
    found = json.loads(out)
    assert isinstance(found, dict)
    return found


def test_domains(run: Run) -> None:
    found = asked(run, "domains")
    tiger = next(entry for entry in found["domains"] if entry["name"] == "tiger")
    assert tiger == {
        "name": "tiger",
        "summary": "The tiger problem.",
        "distribution": f"factored-pomdp {__version__}",
        "error": None,
    }
    assert found["command"] == "factored-pomdp domains --json"
    code, out, _ = run("domains")
    assert code == 0
    assert "machine-repair" in out


def test_info(run: Run) -> None:
    found = asked(run, "info", "machine-repair", "-o", "machines=2")
    assert found["states"] == [{"name": "machine1", "size": 3}, {"name": "machine2", "size": 3}]
    assert found["actions"][0] == {"name": "machine1.hand", "size": 2}
    assert found["observations"][1] == {"name": "machine2.part", "size": 3}
    assert (found["joint_states"], found["joint_actions"], found["joint_observations"]) == (9, 4, 9)
    assert found["discount"] == 0.95
    assert {"kind": "transition", "name": "machine1", "stored": 18}.items() <= found["factors"][2].items()
    code, out, _ = run("info", "machine-repair", "-o", "machines=2")
    assert code == 0
    assert "9 joint states, 4 joint actions, 9 joint observations, discount 0.95" in out


@pytest.mark.parametrize(
    ("name", "expected"),
    [
        ("heard", ["left", "listen", "0.85", "0.15"]),
        ("observation heard", ["left", "listen", "0.85", "0.15"]),
        ("tiger.next", ["left", "open-right", "0.5", "0.5"]),
        ("initial tiger", ["0.5", "0.5"]),
        ("reward", ["left", "open-left", "-100"]),
    ],
)
def test_a_table_is_printed_with_value_names(run: Run, name: str, expected: list[str]) -> None:
    code, out, _ = run("info", "tiger", "--table", name)
    assert code == 0
    assert expected in [line.split() for line in out.splitlines()]


def test_a_table_as_json(run: Run) -> None:
    found = asked(run, "info", "tiger", "--table", "reward")["table"]
    assert found["scope"] == ["tiger", "act"]
    assert ["left", "open-left", -100.0] in found["entries"]
    assert len(found["entries"]) == 6


def test_a_large_table_is_cut_with_a_note(run: Run, weather: Path) -> None:
    days = 'fp.Variable("weather", range(250))'
    source = WEATHER.replace('fp.Variable("weather", ["sun", "rain"])', days)
    source = source.replace('{weather: 1 - rainy, "rain" if weather == "sun" else "sun": rainy}', "weather")
    weather.write_text(source.replace('{"sun": 0.5, "rain": 0.5}', "{0: 1.0}"), encoding="utf-8")
    code, out, _ = run("info", str(weather), "--table", "weather.next")
    assert code == 0
    assert ["199", "199", "1"] in [line.split() for line in out.splitlines()]
    assert "… and 50 more entries (with --json, all of them)" in out
    assert len(asked(run, "info", str(weather), "--table", "weather.next")["table"]["entries"]) == 250


def test_notes_of_a_mended_model_are_shown(run: Run, weather: Path) -> None:
    weather.write_text(WEATHER.replace('{"grey": 1}', '{"grey": 0.999999}'), encoding="utf-8")
    found = asked(run, "info", str(weather))
    assert len(found["notes"]) == 1
    assert "renormalised" in found["notes"][0]
    assert "note: observation of sky" in run("info", str(weather))[1]


def test_decompose_says_yes_and_no(run: Run) -> None:
    yes = asked(run, "decompose", "machine-repair")
    assert (yes["decomposes"], yes["known"], yes["ties"]) == (True, [], [])
    assert yes["blocks"] == [["machine1"], ["machine2"], ["machine3"]]
    no = asked(run, "decompose", "machine-repair", "-o", "coupled=true", code=1)
    assert no["decomposes"] is False
    assert no["blocks"] == [["machine1", "machine2", "machine3"]]
    assert [tie["kind"] for tie in no["ties"]] == ["transition", "transition"]
    assert all(tie["counterexample"] for tie in no["ties"])
    code, out, _ = run("decompose", "machine-repair", "-o", "coupled=true")
    assert code == 1
    assert "counterexample (transition of machine2.next)" in out


def test_decompose_of_the_cameras(run: Run) -> None:
    found = asked(run, "decompose", "surveillance", "-o", "site=micro", "-o", "targets=2")
    assert found["decomposes"] is True
    assert len(found["blocks"]) == 2


def test_verify(run: Run) -> None:
    found = asked(run, "verify", "tiger", "--beliefs", "4", "--steps", "2", "--seed", "7")
    assert (found["beliefs"], found["steps"], found["seed"]) == (4, 2, 7)
    assert max(found["max_value_difference"], found["max_belief_difference"]) <= 1e-9
    assert found["actions_agree"] == 1.0
    assert found["joint_seconds"] > 0
    assert found["decomposed_seconds"] > 0
    assert found["first_difference"] is None
    code, out, _ = run("verify", "tiger", "--beliefs", "2")
    assert code == 0
    assert "No difference above rounding." in out


def test_equal_seeds_find_the_same(run: Run) -> None:
    keys = ("beliefs", "max_value_difference", "max_belief_difference", "actions_agree", "inputs", "seed", "version")
    one, two = (asked(run, "verify", "machine-repair", "-o", "machines=2", "--beliefs", "2") for _ in range(2))
    assert [one[key] for key in keys] == [two[key] for key in keys]


def test_a_difference_exits_1_and_is_written_out(run: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(verification, "TOLERANCE", -1.0)
    found = asked(run, "verify", "tiger", "--beliefs", "2", code=1)
    first = found["first_difference"]
    assert set(first) == {"what", "where", "belief", "action", "observation", "at", "joint", "decomposed"}
    code, out, _ = run("verify", "tiger", "--beliefs", "2")
    assert code == 1
    assert "They differ." in out
    assert "belief: {'tiger': {'tiger=left'" in out


def test_ctrl_c_tells_what_was_done(run: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    original = verification.verifications

    def interrupted(*arguments: Any, **options: Any) -> Iterator[verification.Verification]:
        found = original(*arguments, **options)
        yield next(found)
        raise KeyboardInterrupt

    monkeypatch.setattr(verification, "verifications", interrupted)
    found = asked(run, "verify", "tiger", "--beliefs", "50", code=130)
    assert (found["interrupted"], found["beliefs"]) == (True, 1)
    monkeypatch.setattr("factored_pomdp.decomposition.decompose", interrupted_at_once)
    assert run("decompose", "tiger")[0] == 130


def interrupted_at_once(*_: Any) -> None:
    raise KeyboardInterrupt


def test_too_large_exits_1_with_sizes(run: Run) -> None:
    code, out, err = run("verify", "surveillance", "-o", "site=hall")
    assert (code, out) == (1, "")
    assert err.startswith("too large: 207,360,000 joint states, 81 joint actions, 40,401 joint observations")
    found = asked(run, "verify", "surveillance", "-o", "site=lego", code=1)
    assert found["error"].endswith("with --sparse it can be done")


def test_every_answer_says_where_it_comes_from(run: Run) -> None:
    found = asked(run, "decompose", "tiger", "-o", "accuracy=0.9")
    assert found["command"] == "factored-pomdp decompose tiger -o accuracy=0.9 --json"
    assert found["version"] == __version__
    assert found["inputs"]["model"].startswith("sha256:")
    assert asked(run, "info", "tiger", "-o", "accuracy=0.9")["inputs"] == found["inputs"]
    assert asked(run, "info", "tiger")["inputs"] != found["inputs"]


def test_a_function_in_a_file(run: Run, weather: Path) -> None:
    for name in (f"{weather}", f"{weather}:model"):
        found = asked(run, "info", name, "-o", "rainy=0.1", "--table", "weather.next")
        assert ["sun", "rain", 0.1] in found["table"]["entries"]
    assert asked(run, "verify", str(weather), "--beliefs", "2")["actions_agree"] == 1.0


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["info", "tigr"], "no domain 'tigr' is installed (did you mean 'tiger'?)"),
        (["info", "tiger", "-o", "acuracy=1"], "no option 'acuracy' (did you mean 'accuracy'?)"),
        (["info", "tiger", "-o", "accuracy=loud"], "option accuracy=loud: input should be a valid number"),
        (["info", "tiger", "-o", "accuracy"], "option 'accuracy': expected KEY=VALUE"),
        (["info", "tiger", "-o", "accuracy=1", "-o", "accuracy=0"], "option 'accuracy' is given twice: '1' and '0'"),
        (["info", "tiger", "-o", "accuracy=2"], "tiger: 4 faults in the model observation of heard at"),
        (["info", "tiger", "--table", "herd"], "tiger has no table 'herd' (did you mean 'heard'?)"),
        (["info", "nowhere.py"], "nowhere.py: no such file"),
        (["info", "WEATHER:modl"], "no function 'modl' (did you mean 'model'?)"),
        (["info", "WEATHER:other"], ":other returned a int; expected a FactoredPOMDP"),
        (["info", "WEATHER:failing"], "KeyError: 'umbrella' (weather.py, line 28)"),
        (
            ["info", "WEATHER", "-o", "rainy=2"],
            "weather.py: 4 faults in the model transition of weather.next at weather=sun, weather.next=sun: found -1",
        ),
        (["verify", "tiger", "--beliefs", "0"], "nothing to compare"),
        (["verify", "tiger", "--beliefs", "-1"], "--beliefs"),
        (["verify", "tiger", "--seed", "x"], "--seed"),
        (["decompos", "tiger"], "Did you mean 'decompose'?"),
        (["decompose"], "MODEL"),
    ],
)
def test_wrong_input_is_one_message_and_exit_2(run: Run, weather: Path, arguments: list[str], said: str) -> None:
    code, out, err = run(*(argument.replace("WEATHER", str(weather)) for argument in arguments))
    assert (code, out) == (2, "")
    assert said in " ".join(err.replace("│", " ").split())
    assert "Traceback" not in err


@pytest.mark.parametrize(
    ("source", "said"),
    [
        ("def model(:\n", "line 1: invalid syntax"),
        ("import no_such_module_anywhere\n", "ModuleNotFoundError: No module named 'no_such_module_anywhere'"),
        ("x = 1\n", "which function makes the model?"),
        ("def one(): ...\ndef two(): ...\n", "(there are: one, two)"),
    ],
)
def test_a_file_that_makes_no_model(run: Run, tmp_path: Path, source: str, said: str) -> None:
    path = tmp_path / "wrong.py"
    path.write_text(source, encoding="utf-8")
    code, _, err = run("info", str(path))
    assert code == 2
    assert said in " ".join(err.split())
    found = asked(run, "info", str(path), code=2)
    assert said in found["error"]


def test_installed_command_prints_nothing_but_json() -> None:
    command = Path(sys.executable).with_name("factored-pomdp")
    if not command.exists():
        pytest.skip("the console script is not installed beside this Python")
    answer = subprocess.run([command, "info", "tiger", "--json"], capture_output=True, text=True, check=True)
    assert json.loads(answer.stdout)["name"] == "tiger"
    assert answer.stderr == ""
