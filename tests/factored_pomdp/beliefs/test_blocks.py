"""Blocks that come and go: targets that enter and leave."""

from __future__ import annotations

import numpy as np
import pytest

import factored_pomdp as fp
from solvers import DecomposedMyopic
from tests.small_cameras import UNSEEN, camera_model

MOVE = np.array([[0.5, 0.5, 0.0], [0.25, 0.5, 0.25], [0.0, 0.5, 0.5]])
VIEWS = [{"left": frozenset({0}), "right": frozenset({2})}, {"low": frozenset({0, 1}), "high": frozenset({1, 2})}]


def model(targets: int) -> fp.FactoredPOMDP:
    return camera_model([MOVE] * targets, VIEWS, [np.array([0.5, 0.25, 0.25])] * targets)


ACTION = {"turn0": "right", "turn1": "high"}


@pytest.mark.example
def test_a_block_more_steps_and_counts_like_the_others() -> None:
    few = fp.initial_belief(model(1))
    more = few.with_block({"target0": "guest", "seen0": "guest.seen"}, [0.0, 3.0, 1.0])
    assert (few.blocks, more.blocks) == ((("target0",),), (("target0",), ("guest",)))
    np.testing.assert_allclose(more.marginal("guest"), [0.0, 0.75, 0.25])
    after = more.predict(ACTION).condition({"seen0": UNSEEN, "guest.seen": 2})
    np.testing.assert_allclose(after.marginal("target0"), [1.0, 0.0, 0.0])
    np.testing.assert_allclose(after.marginal("guest"), [0.0, 0.0, 1.0])
    assert after.block("guest").names == ("guest",)
    solver = DecomposedMyopic(model(1))
    both = solver.value(more, ACTION)
    twin = fp.initial_belief(model(2))
    twin = twin.with_arrays([np.array([[0.5, 0.0], [0.25, 0.75], [0.25, 0.25]])])
    assert both == pytest.approx(DecomposedMyopic(model(2)).value(twin, ACTION))
    assert both > solver.value(few, ACTION)
    assert solver.decide(more).value == pytest.approx(DecomposedMyopic(model(2)).decide(twin).value)


@pytest.mark.example
def test_a_block_less() -> None:
    three = fp.initial_belief(model(3))
    two = three.without_block("target1")
    assert two.blocks == (("target0",), ("target2",))
    assert three.blocks == (("target0",), ("target1",), ("target2",))
    with pytest.raises(ValueError, match="no hidden variable 'target1'"):
        two.marginal("target1")
    after = two.predict(ACTION).condition({"seen2": 1})
    np.testing.assert_allclose(after.marginal("target2"), [0, 1, 0])
    none = two.without_block("target0").without_block("target2")
    assert none.blocks == ()
    assert DecomposedMyopic(model(3)).decide(none.predict(ACTION)).value == 0.0
    again = two.with_block({"target0": "target1", "seen0": "seen1"}, [0.2, 0.3, 0.5])
    np.testing.assert_allclose(again.marginal("target1"), [0.2, 0.3, 0.5])


@pytest.mark.example
def test_even_the_first_of_a_stack_may_go() -> None:
    two = fp.initial_belief(model(2)).without_block("target0")
    solver = DecomposedMyopic(model(2))
    alone = DecomposedMyopic(model(1))
    assert solver.value(two, ACTION) == pytest.approx(alone.value(fp.initial_belief(model(1)), ACTION))


@pytest.mark.example
def test_a_new_block_needs_a_pattern_and_names_of_its_own() -> None:
    belief = fp.initial_belief(model(2))
    with pytest.raises(ValueError, match="target1 is in the belief already"):
        belief.with_block({"target0": "target1", "seen0": "x"}, [1, 0, 0])
    with pytest.raises(ValueError, match="needs observation variables of its own in place of seen0"):
        belief.with_block({"target0": "guest"}, [1, 0, 0])
    with pytest.raises(ValueError, match="none of nobody is in the belief"):
        belief.with_block({"nobody": "guest"}, [1, 0, 0])
    with pytest.raises(ValueError, match=r"no observation variable 'sean0' \(did you mean 'seen0'\?\)"):
        belief.predict(ACTION).condition({"sean0": 1})


@pytest.mark.example
def test_a_new_block_is_given_a_distribution_and_names_that_are_there_and_free() -> None:
    belief = fp.initial_belief(model(2))
    names = {"target0": "guest", "seen0": "guest.seen"}
    for numbers in ([-1, 2, 0], [np.nan, 0.5, 0.5], [0, 0, 0], [np.inf, 0, 0]):
        with pytest.raises(ValueError, match=r"distribution of \[guest\]: expected numbers from 0 on"):
            belief.with_block(names, numbers)
    with pytest.raises(ValueError, match=r"distribution of \[guest\]: shape \(2,\); expected \(3,\)"):
        belief.with_block(names, [0.5, 0.5])
    with pytest.raises(ValueError, match="observation variables of its own in place of seen1"):
        belief.with_block({"target0": "guest", "seen0": "seen1"}, [1, 0, 0])
    with pytest.raises(ValueError, match=r"'sean0' is no name of that block \(did you mean 'seen0'\?\)"):
        belief.with_block({"target0": "guest", "sean0": "guest.seen"}, [1, 0, 0])


@pytest.mark.example
def test_a_block_can_come_back_when_all_have_gone() -> None:
    none = fp.initial_belief(model(1)).without_block("target0")
    back = none.with_block({"target0": "target0"}, [1, 2, 1])
    np.testing.assert_allclose(back.marginal("target0"), [0.25, 0.5, 0.25])
    after = back.predict(ACTION).condition({"seen0": 2})
    np.testing.assert_allclose(after.marginal("target0"), [0, 0, 1])
