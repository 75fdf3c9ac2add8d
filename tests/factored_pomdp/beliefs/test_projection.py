"""Boyen and Koller's projection: exact where nothing is tied; elsewhere it differs, and the belief says so."""

from __future__ import annotations

import numpy as np
import pytest

import factored_pomdp as fp
from factored_pomdp.domains.machine_repair import machine_repair

RUN = {f"machine{k}.hand": "run" for k in (1, 2)}
SEEN = {"machine1.part": "bad part", "machine2.part": "good part"}


@pytest.mark.example
def test_it_is_exact_where_nothing_is_tied() -> None:
    model = machine_repair(2)
    plain, projected = fp.initial_belief(model), fp.initial_belief(model, project=True)
    for _ in range(3):
        plain = plain.predict(RUN).condition(SEEN)
        projected = projected.predict(RUN).condition(SEEN)
    np.testing.assert_allclose(projected.marginal("machine1"), plain.marginal("machine1"), atol=1e-15)
    assert projected.exact
    assert projected.approximations == ()


@pytest.mark.example
def test_it_keeps_tied_things_apart_and_says_so() -> None:
    model = machine_repair(2, coupled=True)
    plain, projected = fp.initial_belief(model), fp.initial_belief(model, project=True)
    gaps = []
    for _ in range(5):
        plain = plain.predict(RUN).condition(SEEN)
        projected = projected.predict(RUN).condition(SEEN)
        one, two = (projected.marginal(name) for name in ("machine1", "machine2"))
        np.testing.assert_allclose(projected.block("machine1").dense().array, np.outer(one, two), atol=1e-15)
        gaps.append(np.abs(projected.marginal("machine2") - plain.marginal("machine2")).max())
    assert max(gaps[:3]) <= 1e-15  # only the third move is told apart by a broken neighbour
    assert gaps[-1] > 1e-4  # what was lost of that shows in the next
    assert plain.exact
    assert not projected.exact
    assert projected.approximations == ("tied things kept apart (Boyen–Koller projection)",)


@pytest.mark.example
def test_a_tied_start_is_projected_at_once() -> None:
    bits = [fp.Variable(name, [0, 1]) for name in "xy"]
    model = fp.FactoredPOMDP(
        states=bits,
        actions=[fp.Variable("wait", ["on"])],
        observations=[],
        transition={"x": lambda x: {x: 0.9, 1 - x: 0.1}, "y": lambda y: {y: 0.9, 1 - y: 0.1}},
        observation={},
        reward={},
        initial={"x": {0: 0.5, 1: 0.5}, "y": lambda x: {x: 1.0} if x else {0: 0.5, 1: 0.5}},
    )
    np.testing.assert_allclose(fp.initial_belief(model).block("x").dense().array, [[0.25, 0.25], [0.0, 0.5]])
    projected = fp.initial_belief(model, project=True)
    np.testing.assert_allclose(projected.block("x").dense().array, np.outer([0.5, 0.5], [0.25, 0.75]))
    assert not projected.exact
