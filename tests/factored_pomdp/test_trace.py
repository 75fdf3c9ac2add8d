"""A record a step: belief, every action's value, what came of the chosen one."""

from __future__ import annotations

import json
import tempfile

import pytest

import factored_pomdp as fp
from factored_pomdp.episodes import episodes
from factored_pomdp.trace import record
from solvers.base import Decision
from solvers.mdp import MDP
from solvers.myopic import DecomposedMyopic
from solvers.myopic_joint import JointMyopic
from solvers.point_based import PointBased
from solvers.solution import Limits


def traced(model: fp.FactoredPOMDP, actor: object, steps: int) -> list[dict]:
    with tempfile.TemporaryFile("w+", encoding="utf-8") as lines:
        list(episodes(model, actor, 1, steps, 3, lines))
        lines.seek(0)
        return [json.loads(line) for line in lines]


@pytest.mark.example
def test_tigers_belief_is_the_one_by_hand() -> None:
    model = fp.domain("tiger")
    first, second = traced(model, PointBased(model).solve(Limits(precision=0.1)).policy, 2)
    assert first["belief"] == {"tiger": {"left": 0.5, "right": 0.5}}
    assert first["action"] == {"act": "listen"}
    assert first["values"][0]["action"] == {"act": "listen"}
    assert first["actions_valued"] == len(first["values"]) == 3
    assert second["belief"]["tiger"][first["observation"]["heard"]] == pytest.approx(0.85)


@pytest.mark.property
def test_every_kind_of_belief_tells_the_same_marginals() -> None:
    model = fp.domain("machine-repair", machines=2)
    actors = [DecomposedMyopic(model), JointMyopic(model), MDP(model).solve(Limits()).policy]
    runs = [traced(model, actor, 4) for actor in actors]
    assert {len(run) for run in runs} == {4}
    for lines in zip(*runs, strict=True):
        assert lines[0]["belief"].keys() == {"machine1", "machine2"}
        for line in lines[1:]:
            for name, chances in lines[0]["belief"].items():
                assert line["belief"][name] == pytest.approx(chances, abs=1e-9)


@pytest.mark.example
def test_of_many_actions_the_ten_best_and_the_count() -> None:
    model = fp.domain("machine-repair", machines=7)
    line = traced(model, DecomposedMyopic(model), 1)[0]
    assert line["actions_valued"] == 128
    assert [entry["value"] for entry in line["values"]] == pytest.approx([7.0, *[4.0] * 7, 1.0, 1.0])


@pytest.mark.example
def test_known_variables_are_no_part_of_the_belief_and_silent_policies_say_so() -> None:
    model = fp.domain("surveillance", site="micro", targets=1)
    solver = DecomposedMyopic(model)
    belief, decision = solver.start(), Decision({"camera": "left"}, 0.5, float("inf"), "by hand")
    line = record(model, {"x": 1}, belief, decision, None, {"z": None}, 1.0)
    assert set(line["belief"]) == {name for block in belief.blocks for name in block}
    assert all(sum(chances.values()) == pytest.approx(1.0) for chances in line["belief"].values())
    assert (line["values"], line["actions_valued"], line["upper_bound"]) == (None, 0, None)
