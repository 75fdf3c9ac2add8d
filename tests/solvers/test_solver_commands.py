"""``factored-pomdp solve``, ``solvers`` and ``simulate``, used as a person uses them."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from factored_pomdp.commands import main

pytestmark = pytest.mark.end_to_end


def _run(capsys: pytest.CaptureFixture[str], *arguments: str) -> tuple[int, dict, str]:
    with pytest.raises(SystemExit) as ended:
        main([*arguments, "--json"])
    printed = capsys.readouterr()
    return int(ended.value.code or 0), json.loads(printed.out), printed.err


def test_solve_save_simulate_trace(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    policy, trace = str(tmp_path / "policy.npz"), tmp_path / "trace.jsonl"
    code, solved, _ = _run(capsys, "solve", "tiger", "--precision", "0.01", "--out", policy)
    assert code == 0
    assert solved["lower"] <= 19.371368 <= solved["upper"]
    assert solved["gap"] <= 0.01
    assert solved["solver"] == "point-based"
    assert solved["horizon"] is None
    assert solved["vectors"] >= 2
    assert solved["seconds"] > 0
    arguments = ("simulate", "tiger", "--policy", policy, "--runs", "20", "--steps", "10")
    code, simulated, _ = _run(capsys, *arguments, "--seed", "1", "--trace", str(trace))
    assert code == 0
    assert simulated["runs"] == 20
    assert simulated["ci95"][0] < simulated["mean"] < simulated["ci95"][1]
    assert simulated["truncation_error"] == pytest.approx(0.95**10 * 100 / 0.05)
    assert simulated["inputs"] == solved["inputs"]
    lines = [json.loads(line) for line in trace.read_text().splitlines()]
    assert len(lines) == 200
    assert lines[0].keys() >= {"state", "action", "value", "observation", "reward", "run", "step"}
    again = _run(capsys, *arguments, "--seed", "1")[1]
    assert again["mean"] == simulated["mean"]


def test_exact_with_a_horizon(capsys: pytest.CaptureFixture[str]) -> None:
    code, solved, _ = _run(capsys, "solve", "tiger", "--solver", "exact", "--horizon", "2")
    assert code == 0
    assert solved["lower"] == solved["upper"] == pytest.approx(-1.95)
    assert solved["horizon"] == 2


def test_solvers_are_asked(capsys: pytest.CaptureFixture[str]) -> None:
    code, asked, _ = _run(capsys, "solvers", "tiger", "-o", "discount=1.0")
    found = {entry["name"]: entry for entry in asked["solvers"]}
    assert code == 0
    assert found.keys() >= {"auto", "exact", "point-based", "mdp", "qmdp", "fib", "myopic", "myopic-joint"}
    assert not found["point-based"]["can_solve"]
    assert "discount 1" in found["point-based"]["because"]
    assert found["exact"]["can_solve"]


def test_a_step_by_step_solver_is_simulated(capsys: pytest.CaptureFixture[str]) -> None:
    code, simulated, _ = _run(capsys, "simulate", "machine-repair", "--policy", "myopic", "--runs", "5", "--steps", "3")
    assert code == 0
    assert 5 < simulated["mean"] <= 3 * (1 + 0.95 + 0.95**2)


@pytest.mark.parametrize(
    ("arguments", "code", "message"),
    [
        (("solve", "tiger", "--solver", "exakt"), 2, "did you mean 'exact'"),
        (("solve", "tiger", "--solver", "exact"), 2, "needs a horizon"),
        (("solve", "tiger", "--solver", "myopic"), 2, "chooses step by step"),
        (("solve", "tiger", "--precision", "0"), 2, "precision 0"),
        (("solve", "tiger", "--out", "/nowhere/policy.npz"), 2, "no folder /nowhere"),
        (("solve", "tiger", "-o", "discount=1", "--solver", "point-based"), 1, "discount 1"),
        (("solve", "machine-repair", "-o", "machines=16", "--solver", "point-based"), 1, "too many to list"),
        (("solve", "tiger", "--out", "."), 2, "--out .: a folder; expected the name of a file"),
        (("simulate", "tiger", "--policy", "qmdp", "--trace", "."), 2, "--trace .: a folder"),
        (("simulate", "tiger", "--policy", "tiger.pomdp"), 2, "tiger.pomdp: no such file"),
        (("simulate", "tiger", "--policy", "missing.npz"), 2, "no such file"),
        (("simulate", "tiger", "--policy", "myopic", "-o", "discount=1"), 2, "give --steps"),
    ],
)
def test_what_is_wrong_is_said(
    capsys: pytest.CaptureFixture[str], arguments: tuple[str, ...], code: int, message: str
) -> None:
    found, refusal, errors = _run(capsys, *arguments)
    assert found == code
    assert message in refusal["error"]
    assert "Traceback" not in errors


def test_runs_are_as_long_as_the_policy_plans(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    policy = str(tmp_path / "three.npz")
    _, solved, _ = _run(capsys, "solve", "tiger", "--solver", "exact", "--horizon", "3", "--out", policy)
    code, simulated, said = _run(capsys, "simulate", "tiger", "--policy", policy, "--runs", "300")
    assert (code, simulated["steps"], said) == (0, 3, "")
    low, high = simulated["ci95"]
    assert low - 1 < solved["lower"] < high + 1
    code, longer, said = _run(capsys, "simulate", "tiger", "--policy", policy, "--runs", "5", "--steps", "4")
    assert (code, longer["steps"]) == (0, 4)
    assert "plans for 3 steps, and runs have 4" in said
    code, _, _ = _run(capsys, "simulate", "tiger", "-o", "discount=1", "--policy", policy, "--runs", "5")
    assert code == 2


def test_a_time_limit_holds_where_blocks_are_simulated(capsys: pytest.CaptureFixture[str]) -> None:
    """Ten runs of all the steps that matter would take many times as long."""
    arguments = ("solve", "machine-repair", "-o", "machines=16", "-o", "discount=0.999", "--time-limit", "1")
    code, found, _ = _run(capsys, *arguments)
    assert code == 0
    assert (found["stopped"], found["lower_is"]) == ("time limit", "statistical")
    assert found["lower"] < found["upper"]
    steps = int(found["notes"][-1].partition("runs of ")[2].split()[0])
    assert steps < 5000
