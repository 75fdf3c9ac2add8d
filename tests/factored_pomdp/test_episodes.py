"""Runs of a policy: which ended, which were cut, and what cutting may have left out."""

from __future__ import annotations

import json
import math
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import factored_pomdp as fp
from factored_pomdp.commands import main
from factored_pomdp.episodes import Episode, Returns, episodes
from factored_pomdp.verification import TOLERANCE, verify
from solvers import DecomposedMyopic, JointMyopic
from tests.ending_models import ending_models

COINS = '''
import factored_pomdp as fp

def coins(number: int = 1, ends: bool = True, discount: float = 1.0) -> fp.FactoredPOMDP:
    """Coins, thrown until one shows heads; each throw costs one."""
    names = [f"coin{n}" for n in range(number)]
    return fp.FactoredPOMDP(
        states=[fp.Variable(name, ["tails", "heads"]) for name in names],
        actions=[fp.Variable("throw", ["all"])],
        observations=[],
        transition={name: {"tails": 0.5, "heads": 0.5} for name in names},
        observation={},
        reward=-1.0,
        initial={name: "tails" for name in names},
        discount=discount,
        terminal=fp.table(*names, values=lambda *shown: "heads" in shown) if ends else None,
    )
'''


def coins(**options: Any) -> fp.FactoredPOMDP:
    space: dict[str, Any] = {}
    exec(COINS, space)
    return space["coins"](**options)


@pytest.mark.example
def test_runs_that_end_and_runs_that_are_cut() -> None:
    model = coins()
    runs = list(episodes(model, DecomposedMyopic(model), 80, 3, seed=1))
    assert {(run.total, run.ended) for run in runs} == {(-1.0, True), (-2.0, True), (-3.0, True), (-3.0, False)}
    cut = sum(not run.ended for run in runs)
    assert 2 <= cut <= 18  # an eighth of 80, give or take nearly three standard deviations
    returns = Returns(model, 3)
    for run in runs:
        returns.add(run)
    assert returns.cut == cut
    assert returns.truncation_error == math.inf


@pytest.mark.example
@pytest.mark.parametrize(
    ("ends", "discount", "ended", "error"),
    [
        (True, 1.0, [True, True], 0.0),
        (True, 1.0, [True, False], math.inf),
        (False, 1.0, [False, False], 0.0),
        (True, 0.5, [True, False], 0.5 * 0.5**3 / 0.5),
        (False, 0.5, [False, False], 0.5**3 / 0.5),
        (True, 0.5, [True, True], 0.0),
        (True, 0.0, [False, False], 0.0),
    ],
)
def test_what_cutting_leaves_out(ends: bool, discount: float, ended: list[bool], error: float) -> None:
    returns = Returns(coins(ends=ends, discount=discount), 3)
    for over in ended:
        returns.add(Episode(-1.0, over))
    assert returns.truncation_error == pytest.approx(error)


@pytest.mark.example
def test_an_episode_may_be_over_before_it_begins() -> None:
    model = fp.FactoredPOMDP(
        states=[fp.Variable("coin", ["tails", "heads"])],
        actions=[fp.Variable("throw", ["all"])],
        observations=[],
        transition={"coin": {"heads": 1.0}},
        observation={},
        reward=-1.0,
        initial={"coin": {"tails": 0.5, "heads": 0.5}},
        terminal={"heads": 1},
    )
    runs = list(episodes(model, DecomposedMyopic(model), 50, 5, seed=0))
    assert {(run.total, run.ended) for run in runs} == {(0.0, True), (-1.0, True)}


@pytest.mark.example
def test_the_world_refuses_an_illegal_action() -> None:
    arm = fp.Variable("arm", ["up", "down"])
    model = fp.FactoredPOMDP(
        states=[arm],
        actions=[fp.Variable("move", ["raise", "lower", "stay"])],
        observations=[],
        transition={"arm": lambda arm, move: {"raise": "up", "lower": "down"}.get(move, arm)},
        observation={},
        reward=0.0,
        initial={"arm": "up"},
        legal={"move": lambda arm, move: (arm, move) not in {("up", "raise"), ("down", "lower")}},
    )
    world, rng = fp.Simulation(model), np.random.default_rng(0)
    with pytest.raises(ValueError, match="move='raise' is not legal at arm='up'; legal: 'lower', 'stay'"):
        world.step({"arm": "up"}, "raise", rng)
    assert world.step({"arm": "up"}, "lower", rng)[0] == {"arm": "down"}
    assert all(decides.decide(decides.start()).action["move"] != "raise" for decides in _myopic(model))


def _myopic(model: fp.FactoredPOMDP) -> list[Any]:
    return [DecomposedMyopic(model), JointMyopic(model)]


@pytest.mark.property
@settings(max_examples=10)
@given(ending_models(), st.integers(0, 2**32 - 1))
def test_verification_of_random_models_that_end(model: fp.FactoredPOMDP, seed: int) -> None:
    found = verify(model, 2, 3, np.random.default_rng(seed))
    assert found.holds, found.first_difference
    assert (found.beliefs, found.steps, found.actions_agree) == (2, 3, 1.0)
    assert max(found.max_value_difference, found.max_belief_difference) <= TOLERANCE


@pytest.mark.end_to_end
def test_simulate_counts_runs_that_were_cut(tmp_path: Any, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "coins.py").write_text(COINS, encoding="utf-8")
    model = f"{tmp_path / 'coins.py'}:coins"

    def simulated(*arguments: str) -> dict[str, Any]:
        with pytest.raises(SystemExit) as ended:
            main(["simulate", model, "--policy", "myopic", "--runs", "60", *arguments, "--json"])
        assert not ended.value.code
        return json.loads(capsys.readouterr().out)

    short = simulated("--steps", "2")
    assert 0 < short["cut"] < 60
    assert short["truncation_error"] is None
    long = simulated("--steps", "500")
    assert (long["cut"], long["truncation_error"]) == (0, 0.0)
    assert long["ci95"][0] < -2.0 < long["ci95"][1]
    several = simulated("-o", "number=3", "-o", "discount=0.5", "--steps", "1")
    assert several["truncation_error"] == pytest.approx(several["cut"] / 60)
    with pytest.raises(SystemExit) as refused:
        main(["simulate", model, "--policy", "myopic", "--runs", "60"])
    assert refused.value.code == 2
    assert "discount 1: give --steps" in capsys.readouterr().err
    with pytest.raises(SystemExit):
        main(["simulate", model, "--policy", "myopic", "--runs", "100", "--steps", "2"])
    assert "no bound at discount 1" in capsys.readouterr().out
