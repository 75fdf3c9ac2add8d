"""The decomposed solver against the exponential one, on every action; and what it refuses."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy import sparse

import factored_pomdp as fp
from factored_pomdp.domains.machine_repair import machine_repair
from factored_pomdp.structure import structure_of
from solvers import DecomposedMyopic, JointMyopic
from tests.belief_steps import joint_of, next_step
from tests.plain import PlainModel
from tests.strategies import TIES, random_beliefs, random_models
from tests.tied_models import tied_models


def agree(model: fp.FactoredPOMDP, belief: fp.ProductBelief) -> None:
    """Same value for every action, and a choice as good as the best."""
    fast, literal = DecomposedMyopic(model), JointMyopic(model)
    joint = joint_of(model, belief)
    for action in PlainModel(model).actions:
        assert fast.value(belief, action) == pytest.approx(literal.value(joint, action), abs=1e-9)
    chosen, best = fast.decide(belief), literal.decide(joint)
    assert chosen.value == pytest.approx(best.value, abs=1e-9)
    assert literal.value(joint, chosen.action) == pytest.approx(best.value, abs=1e-9)
    assert model.is_legal(chosen.action, belief.known)
    assert chosen.proved


@pytest.mark.property
@settings(max_examples=12)
@given(data=st.data(), seed=st.integers(0, 2**32 - 1))
def test_value_and_choice_are_those_of_the_exponential_solver(data: st.DataObject, seed: int) -> None:
    model = data.draw(random_models(most_states=3))
    belief = data.draw(random_beliefs(model))
    agree(model, belief)
    step = next_step(model, joint_of(model, belief), np.random.default_rng(seed))
    agree(model, belief.predict(step.action).condition(step.observation, known=step.read))


@pytest.mark.property
@pytest.mark.parametrize("kind", [*TIES, "none"])
@settings(max_examples=4)
@given(data=st.data())
def test_also_where_two_variables_are_tied(kind: str, data: st.DataObject) -> None:
    model = data.draw(tied_models(kind))
    agree(model, data.draw(random_beliefs(model)))


@pytest.mark.property
@settings(max_examples=6)
@given(data=st.data())
def test_the_value_is_a_sum_over_blocks(data: st.DataObject) -> None:
    """Of a model without ties, each block's rewards alone give that block's share (eq:policy3)."""
    model = data.draw(tied_models("none"))
    belief = data.draw(random_beliefs(model))
    whole = DecomposedMyopic(model)
    for action in PlainModel(model).actions:
        shares = []
        for names in belief.blocks:
            alone = belief
            for other in belief.blocks:
                alone = alone if other == names else alone.without_block(other[0])
            shares.append(whole.value(alone, action))
        assert whole.value(belief, action) == pytest.approx(sum(shares), abs=1e-9)


@pytest.mark.example
def test_machines_by_hand() -> None:
    model = machine_repair(3)
    solver = DecomposedMyopic(model)
    belief = solver.start().with_arrays([np.array([[1.0, 0.2, 0.0], [0.0, 0.3, 0.0], [0.0, 0.5, 1.0]])])
    all_run = {f"machine{k}.hand": "run" for k in (1, 2, 3)}
    assert solver.value(belief, all_run) == pytest.approx(1.0 + 0.38 + 0.0)
    assert solver.value(belief, all_run | {"machine3.hand": "repair"}) == pytest.approx(1.38 - 2)
    decision = solver.decide(belief)
    assert (dict(decision.action), decision.value) == (all_run, pytest.approx(1.38))


BIT = [0, 1]


def chained(**changes: Any) -> fp.FactoredPOMDP:
    """Known gears that follow one another within a step, a lamp of chance, readings that no hidden variable moves."""
    given: dict[str, Any] = {
        "transition": {
            "last": lambda middle_next: 1 - middle_next,
            "middle": lambda first_next, last: first_next ^ last,
            "first": lambda push: push,
            "lamp": lambda push: {1: 0.75, 0: 0.25} if push else 0,
            "x": lambda x, middle_next: {x: 0.75, 1 - x: 0.25} if middle_next else x,
        },
        "observation": {
            "dial": lambda last_next, lamp_next: (
                {last_next: 0.9, 1 - last_next: 0.1} if lamp_next else {0: 0.5, 1: 0.5}
            ),
            "see": lambda x_next, lamp_next: {x_next: 0.8, 1 - x_next: 0.2} if lamp_next else 0,
        },
        "reward": {
            "dial": lambda dial, push: dial - 0.5 * push,
            "both": lambda x_next, dial, lamp_next: x_next * (1.0 + dial) - 0.25 * lamp_next,
            "see": lambda see, first_next, x: see * (1 + first_next) - x,
        },
        "initial": {"last": 0, "middle": 1, "first": 0, "lamp": 0, "x": {0: 0.5, 1: 0.5}},
        "known": ["lamp"],
    }
    given |= changes
    return fp.FactoredPOMDP(
        states=[fp.Variable(name, BIT) for name in given["transition"]],
        actions=[fp.Variable("push", BIT)],
        observations=[fp.Variable(name, BIT) for name in given["observation"]],
        **given,
    )


@pytest.mark.example
def test_rewards_on_what_is_known_by_function_or_chance_and_on_observations_of_it() -> None:
    model = chained()
    assert structure_of(model).known == ("last", "middle", "first", "lamp")
    agree(model, fp.initial_belief(model))


@pytest.mark.example
def test_a_reward_on_a_reading_of_a_known_variable_that_a_hidden_one_moves() -> None:
    model = chained(
        transition=chained().transition | {"lamp": lambda x, push: {1: 0.75, 0: 0.25} if x and push else 0},
    )
    assert "lamp" in structure_of(model).known
    assert "lamp" in structure_of(model).blocks[0].likelihood
    agree(model, fp.initial_belief(model))


@pytest.mark.example
def test_a_reward_on_a_pair_of_readings() -> None:
    def pair(x: int, y: int) -> dict[tuple[int, int], float]:
        return {(a, b): (0.8 if a == x else 0.2) * (0.7 if b == y else 0.3) for a in BIT for b in BIT}

    model = fp.FactoredPOMDP(
        states=[fp.Variable("x", BIT), fp.Variable("y", BIT)],
        actions=[fp.Variable("wait", ["on"])],
        observations=[fp.Variable("pair", [(a, b) for a in BIT for b in BIT])],
        transition={"x": lambda x: {x: 0.9, 1 - x: 0.1}, "y": lambda y: {y: 0.9, 1 - y: 0.1}},
        observation={"pair": fp.table("x.next", "y.next", values=pair)},
        reward={"sum": lambda pair: float(sum(pair))},
        initial={"x": 0, "y": {0: 0.5, 1: 0.5}},
    )
    belief = fp.initial_belief(model)
    agree(model, belief)
    # x: 0.1 · 0.8 + 0.9 · 0.2; y: 0.5 · 0.7 + 0.5 · 0.3
    assert DecomposedMyopic(model).value(belief, "on") == pytest.approx(0.26 + 0.5)


def watched(cameras: int, one_action: bool = False) -> fp.FactoredPOMDP:
    """A target on two axes, cameras that detect it by chance; the context is not in the order of the states."""
    column, row = fp.Variable("column", [0, 1, 2]), fp.Variable("row", [0, 1])
    seen = fp.Variable("seen", ["nothing", *((c, r) for c in range(3) for r in range(2))])
    lenses = [fp.Variable(f"lens{k}", ["wide", "narrow"]) for k in range(cameras)]
    turns = (
        [fp.Variable("turn", ["wide", "narrow"])]
        if one_action
        else [v.renamed(f"turn{k}") for k, v in enumerate(lenses)]
    )
    rng = np.random.default_rng(8)
    exact = sparse.csr_array(np.eye(7)[[1 + 2 * c + r for r in range(2) for c in range(3)]])
    causes = [fp.Cause(lens.next, rng.random((2, 6)) * (rng.random((2, 6)) < 0.6), exact) for lens in lenses]
    return fp.FactoredPOMDP(
        states=[column, row, *lenses],
        actions=turns,
        observations=[seen],
        transition={
            "column": lambda column: {column: 0.5, (column + 1) % 3: 0.5},
            "row": lambda row, column: {row: 0.75, 1 - row: 0.25} if column else row,
            **{
                lens.name: fp.table(turns[k % len(turns)].name, values=lambda turn: turn)
                for k, lens in enumerate(lenses)
            },
        },
        observation={"seen": fp.NoisyOr([row.next, column.next], seen, "nothing", causes)},
        reward={
            "seen": lambda seen: float(seen != "nothing"),
            "right": lambda seen, row_next: 2.0 * (seen != "nothing") * row_next,
        },
        initial={"column": [0.5, 0.25, 0.25], "row": {0: 0.5, 1: 0.5}, **{lens.name: "wide" for lens in lenses}},
        groups=[["column", "row"]],
    )


@pytest.mark.example
@pytest.mark.parametrize("one_action", [False, True])
def test_noisy_sight_step_after_step(one_action: bool) -> None:
    """What was worked out in the first decision is only reweighed in the next ones."""
    model = watched(2, one_action)
    fast, literal = DecomposedMyopic(model), JointMyopic(model)
    belief, rng = fast.start(), np.random.default_rng(2)
    for _ in range(4):
        joint = joint_of(model, belief)
        for action in PlainModel(model).actions:
            assert fast.value(belief, action) == pytest.approx(literal.value(joint, action), abs=1e-9)
        assert fast.decide(belief).value == pytest.approx(literal.decide(joint).value, abs=1e-9)
        step = next_step(model, joint, rng)
        belief = belief.predict(step.action).condition(step.observation)


@pytest.mark.example
def test_thirty_cameras() -> None:
    model = watched(30)
    solver = DecomposedMyopic(model)
    belief = solver.start()
    decision = solver.decide(belief)
    assert decision.value == pytest.approx(solver.value(belief, decision.action), abs=1e-9)
    assert decision.upper_bound >= decision.value
    assert "2^30" not in decision.method
    assert "greedy" in decision.method
    after = belief.predict(decision.action).condition("nothing")
    assert after.exact
    all_wide = {f"turn{k}": "wide" for k in range(30)}
    assert solver.value(belief, all_wide) <= decision.upper_bound + 1e-9


@pytest.mark.example
def test_legal_and_preferred_actions() -> None:
    """A wheel turns by one position at a time."""
    model = fp.FactoredPOMDP(
        states=[fp.Variable("wheel", range(4)), fp.Variable("mark", range(4))],
        actions=[fp.Variable("to", range(4))],
        observations=[],
        transition={"wheel": lambda to: to, "mark": lambda mark: {mark: 0.5, (mark + 1) % 4: 0.5}},
        observation={},
        reward={"met": lambda wheel_next, mark_next: float(wheel_next == mark_next)},
        initial={"wheel": 0, "mark": {2: 0.5, 0: 0.5}},
        legal={"to": lambda wheel, to: (to - wheel) % 4 in (0, 1, 3)},
    )
    solver = DecomposedMyopic(model)
    belief = solver.start()
    assert [solver.value(belief, to) for to in range(4)] == [0.25, 0.25, 0.25, 0.25]
    assert solver.decide(belief).action == {"to": 0}
    assert solver.decide(belief, prefer={"to": 3}).action == {"to": 3}
    assert solver.decide(belief, prefer={"to": 2}).action == {"to": 0}
    turned = belief.predict(3)
    assert turned.known == {"wheel": 3}
    assert solver.decide(turned, prefer={"to": 2}).action == {"to": 2}
    agree(model, belief)


@pytest.mark.example
def test_it_says_what_it_cannot_do_and_what_it_costs() -> None:
    ability = DecomposedMyopic.can_solve(machine_repair(4))
    assert ability
    assert ability.because == "4 block(s), the largest with 3 states"
    assert ability.estimate == "96 bytes a belief; 16 joint actions to choose from"
    tied = DecomposedMyopic.can_solve(machine_repair(4, coupled=True))
    assert (bool(tied), tied.because) == (True, "1 block(s), the largest with 81 states")
    huge = DecomposedMyopic.can_solve(machine_repair(16, coupled=True))
    assert not huge
    assert huge.because == "1 block(s), the largest with 43,046,721 states; more than 20,000,000"
    hidden = chained(legal={"push": lambda x, push: x <= push})
    assert DecomposedMyopic.can_solve(hidden).because == "legal values of push depend on the hidden x"
    with pytest.raises(ValueError, match="legal values of push depend on the hidden x"):
        DecomposedMyopic(hidden)


@pytest.mark.example
def test_an_unread_camera_is_left_out_and_a_reward_on_what_is_unread_is_refused() -> None:
    model = watched(2)
    solver = DecomposedMyopic(model)
    stay = {"turn0": "wide", "turn1": "narrow"}
    unread = solver.start().predict(stay).condition(known={"lens0": None})
    # the next step's action moves it all the same
    assert solver.value(unread, stay) > 0
    stuck = chained(transition=chained().transition | {"first": lambda first, push: first ^ push})
    lost = fp.initial_belief(stuck).predict(1).condition(known={"first": None, "lamp": 1})
    with pytest.raises(ValueError, match="first was not read back, and the reward depends on it"):
        DecomposedMyopic(stuck).value(lost, 1)
