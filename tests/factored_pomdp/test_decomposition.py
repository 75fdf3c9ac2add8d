"""Certificates: blocks that stay apart, and the very factor that ties others, with a counterexample of its kind."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings

import factored_pomdp as fp
from solvers import DecomposedMyopic, JointMyopic
from tests.counterexamples import confirm
from tests.small_cameras import camera_model, printed_null
from tests.strategies import independent_models

BIT = [0, 1]
FAIR = {0: 0.5, 1: 0.5}


def keeps(x: int) -> dict[int, float]:
    return {x: 0.9, 1 - x: 0.1}


def three(**changes: Any) -> fp.FactoredPOMDP:
    """Three bits that flip now and then, each seen dimly; some parts changed."""
    names = ["t1", "t2", "t3"]
    given: dict[str, Any] = {
        "transition": {name: fp.table(name, values=keeps) for name in names},
        "observation": {f"o{k}": fp.table(f"t{k}.next", values=lambda t: {t: 0.8, 1 - t: 0.2}) for k in (1, 2, 3)},
        "reward": {name: fp.table(f"{name}.next", values=float) for name in names},
        "initial": dict.fromkeys(names, FAIR),
    }
    values = changes.pop("values", {})
    groups = changes.pop("groups", ())
    for part, change in changes.items():
        given[part] = given[part] | change
    return fp.FactoredPOMDP(
        states=[fp.Variable(name, BIT) for name in names],
        actions=[fp.Variable("act", BIT)],
        observations=[fp.Variable(name, values.get(name, BIT)) for name in given["observation"]],
        groups=groups,
        **given,
    )


APART = (("t1",), ("t2",), ("t3",))
TOGETHER = (("t1", "t2"), ("t3",))


@pytest.mark.example
def test_three_targets_that_have_nothing_to_do_with_each_other() -> None:
    certificate = fp.decompose(three())
    assert (certificate.blocks, certificate.ties, certificate.known) == (APART, (), ())
    assert certificate.decomposes
    assert "decomposes: yes" in str(certificate)


TIES = {
    "transition": (
        {"transition": {"t2": lambda t1, t2: keeps(t2) if t1 == t2 else FAIR}},
        "transition of t2.next",
    ),
    "observation": (
        {"observation": {"o1": lambda t1_next, t2_next: {t1_next & t2_next: 0.8, 1 - (t1_next & t2_next): 0.2}}},
        "observation of o1",
    ),
    "reward": ({"reward": {"both": lambda t1_next, t2_next: float(t1_next and t2_next)}}, "reward both"),
    "initial": ({"initial": {"t2": lambda t1: {t1: 0.75, 1 - t1: 0.25}}}, "initial of t2"),
}


@pytest.mark.example
@pytest.mark.parametrize("kind", TIES)
def test_two_that_interact_become_one_block_and_the_third_stays_alone(kind: str) -> None:
    changes, factor = TIES[kind]
    model = three(**changes)
    certificate = fp.decompose(model)
    assert certificate.blocks == TOGETHER
    assert certificate.decomposes
    (tie,) = certificate.ties
    assert (tie.factor, tie.kind, set(tie.joins)) == (factor, kind, {("t1",), ("t2",)})
    confirm(model, tie)
    assert f"{kind} tie: {factor} joins [" in str(certificate)


@pytest.mark.example
def test_the_reward_of_two_gives_a_mixed_difference_of_what_their_moves_leave_of_it() -> None:
    certificate = fp.decompose(three(**TIES["reward"][0]))
    shown = certificate.ties[0].counterexample
    # E[t1' t2'] over certain starts: 0.9² + 0.1² - 2 · 0.9 · 0.1
    assert abs(shown["mixed_difference"]) == pytest.approx(0.64)


@pytest.mark.example
def test_everything_tied_does_not_decompose() -> None:
    chain = {"t2": lambda t1, t2: keeps(t2) if t1 else FAIR, "t3": lambda t2, t3: keeps(t3) if t2 else FAIR}
    certificate = fp.decompose(three(transition=chain))
    assert certificate.blocks == (("t1", "t2", "t3"),)
    assert not certificate.decomposes
    assert [tie.factor for tie in certificate.ties] == ["transition of t2.next", "transition of t3.next"]


@pytest.mark.example
@pytest.mark.parametrize(
    "changes",
    [
        {"transition": {"t2": fp.table("t1", "t2", values=lambda t1, t2: keeps(t2))}},
        {"observation": {"o1": lambda t1_next, t2_next: {t1_next: 0.8, 1 - t1_next: 0.2}}},
        {"reward": {"sum": lambda t1_next, t2_next, act: 2.0 * t1_next - act * t2_next}},
        {"reward": {"sum": lambda t1, t2_next, t3: t1 + 3.0 * t2_next - t3}},
        {"initial": {"t2": lambda t1: {0: 0.3, 1: 0.7}}},
    ],
    ids=["idle parent", "idle in what is seen", "sum", "sum of three", "idle at the start"],
)
def test_what_ties_nothing(changes: dict) -> None:
    certificate = fp.decompose(three(**changes))
    assert (certificate.blocks, certificate.ties) == (APART, ())


@pytest.mark.example
def test_a_pair_of_separate_readings_ties_nothing_and_a_reward_on_the_pair_does() -> None:
    def pair(t1: int, t2: int) -> dict[tuple[int, int], float]:
        return {(a, b): (0.8 if a == t1 else 0.2) * (0.7 if b == t2 else 0.3) for a in BIT for b in BIT}

    pairs = {"pair": [(a, b) for a in BIT for b in BIT]}
    observation = {"pair": fp.table("t1.next", "t2.next", values=pair)}
    assert fp.decompose(three(observation=observation, values=pairs)).blocks == APART
    model = three(observation=observation, values=pairs, reward={"first": lambda pair: float(pair[0])})
    certificate = fp.decompose(model)
    assert certificate.blocks == TOGETHER
    assert [tie.kind for tie in certificate.ties] == ["reward"]


@pytest.mark.example
def test_rewards_that_cancel_tie_nothing_and_those_that_add_up_tie_with_their_sum() -> None:
    """1[a = b] - 1[a = b] + a: V is what is paid for a. With 3 · 1[a = b] for the first, 2 · 1[a = b] is left."""
    same = np.eye(2)
    rewards = {
        "both": fp.table("a.next", "b.next", values=same),
        "minus": fp.table("b.next", "a.next", values=-same),
        "more": fp.table("a.next", values=[0.0, 1.0]),
    }
    model = coins(rewards)
    found = fp.decompose(model)
    assert found.blocks == (("a",), ("b",))
    assert found.ties == ()
    belief = fp.initial_belief(model)
    assert DecomposedMyopic(model).value(belief, "wait") == pytest.approx(0.5)
    assert JointMyopic(model).decide(fp.JointBelief.initial(model)).value == pytest.approx(0.5)
    tied = coins(rewards | {"both": fp.table("a.next", "b.next", values=3 * same)})
    (tie,) = fp.decompose(tied).ties
    assert (tie.factor, tie.kind) == ("reward both + minus", "reward")
    assert tie.counterexample["mixed_difference"] == pytest.approx(2 * 2 * 0.5 * 0.5)
    assert DecomposedMyopic(tied).value(fp.initial_belief(tied), "wait") == pytest.approx(1.5)


@pytest.mark.example
def test_a_next_value_that_is_always_the_same_ties_nothing() -> None:
    reward = {"both": fp.table("a.next", "b.next", values=[[0.0, 1.0], [5.0, 2.0]])}
    model = coins(reward, {"a": fp.table("a.next", values=[0.0, 1.0])})
    found = fp.decompose(model)
    assert (found.blocks, found.ties) == ((("a",), ("b",)), ())
    assert DecomposedMyopic(model).value(fp.initial_belief(model), "wait") == pytest.approx(3.5)


def coins(reward: dict[str, Any], transition: dict[str, Any] | None = None) -> fp.FactoredPOMDP:
    """Two coins that are turned over with probability a quarter."""
    names = ("a", "b")
    stays = [[0.75, 0.25], [0.25, 0.75]]
    moves = {name: fp.table(name, f"{name}.next", values=stays) for name in names}
    return fp.FactoredPOMDP(
        states=[fp.Variable(name, [0, 1]) for name in names],
        actions=[fp.Variable("do", ["wait"])],
        observations=[],
        transition=moves | (transition or {}),
        observation={},
        reward=reward,
        initial={name: {0: 0.5, 1: 0.5} for name in names},
    )


@pytest.mark.example
def test_a_start_that_multiplies_out_to_a_product_ties_nothing() -> None:
    certain = {"t1": 1, "t2": lambda t1: {t1: 0.75, 1 - t1: 0.25}}
    assert fp.decompose(three(initial=certain)).blocks == APART
    parity = {"t3": lambda t1, t2: t1 ^ t2}
    certificate = fp.decompose(three(initial=parity))
    assert certificate.blocks == (("t1", "t2", "t3"),)
    assert certificate.ties[0].counterexample["kind"] == "belief"


@pytest.mark.example
def test_exclusive_or_with_a_fair_partner_shows_in_two_beliefs_though_every_posterior_is_a_product() -> None:
    transition = {"t1": lambda t1, t2: t1 ^ t2, "t2": lambda: FAIR}
    model = three(transition=transition, observation={"o2": lambda: FAIR})
    (tie,) = fp.decompose(model).ties
    assert tie.kind == "transition"
    assert tie.counterexample["kind"] == "two beliefs"
    confirm(model, tie)


@pytest.mark.example
def test_ties_within_a_group_are_not_reported() -> None:
    grouped = three(**TIES["transition"][0], groups=[["t1", "t2"]])
    certificate = fp.decompose(grouped)
    assert (certificate.blocks, certificate.ties) == (TOGETHER, ())
    assert certificate.decomposes
    outside = fp.decompose(three(**TIES["transition"][0], groups=[["t2", "t3"]]))
    assert outside.blocks == (("t1", "t2", "t3"),)
    assert set(outside.ties[0].joins) == {("t1",), ("t2", "t3")}


@pytest.mark.example
def test_a_reward_names_the_things_that_it_joins_not_the_first_of_their_blocks() -> None:
    model = three(**TIES["transition"][0], reward={"far": lambda t2_next, t3_next: float(t2_next * t3_next)})
    reward = next(tie for tie in fp.decompose(model).ties if tie.kind == "reward")
    assert set(reward.joins) == {("t2",), ("t3",)}
    confirm(model, reward)


@pytest.mark.property
@settings(max_examples=25)
@given(independent_models())
def test_independent_models_decompose(model: fp.FactoredPOMDP) -> None:
    certificate = fp.decompose(model)
    assert all(len(block) == 1 for block in certificate.blocks)
    assert certificate.ties == ()
    assert certificate.decomposes


@pytest.mark.example
def test_the_printed_null_observation_is_named_as_the_reason_why_the_value_does_not_split() -> None:
    stay = np.eye(3)
    views = [{"left": frozenset({0}), "right": frozenset({2})}]
    model = camera_model([stay, stay], views, [np.full(3, 1 / 3)] * 2)
    printed = printed_null(model)
    assert fp.decompose(model).decomposes
    certificate = fp.decompose(model, likelihood=printed)
    assert certificate.blocks == (("target0",), ("target1",))  # posteriors are not harmed
    assert not certificate.decomposes
    assert [tie.factor for tie in certificate.ties] == ["likelihood of seen0", "likelihood of seen1"]
    assert certificate.ties[0].counterexample["sum"] == pytest.approx(0.5)  # two cells outside, 1/2 each
    assert "law of total probability" in certificate.ties[0].because
    alone = camera_model([stay], views, [np.full(3, 1 / 3)])
    assert fp.decompose(alone, likelihood=printed_null(alone)).decomposes  # with one target nothing is to be split
    assert fp.decompose(model, likelihood=dict(model.observation)).ties == ()
