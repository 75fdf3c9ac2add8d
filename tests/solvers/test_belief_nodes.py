"""Nodes of the point-based search: what follows a belief is Bayes' rule, and every belief stands there once."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings

import factored_pomdp as fp
from solvers.belief_nodes import insert_all
from solvers.blind import blind_stages
from solvers.flat import FlatModel, flatten
from solvers.point_based_kernels import run_trials
from solvers.search_state import Search, new_count, new_search
from solvers.upper_bounds import informed_vectors
from tests.solvers.small_models import small_models


def _searched(flat: FlatModel, work: int = 20_000) -> Search:
    search = new_search(flat, informed_vectors(flat), blind_stages(flat, None)[0])
    run_trials(flat.tables, search, np.count_nonzero(flat.initial), 1e-6, 0.5, work, new_count())
    return search


def _belief(flat: FlatModel, search: Search, number: int) -> np.ndarray:
    node, belief = search.nodes[number], np.zeros(flat.size)
    entries = search.entries[node["start"] :][: node["length"]]
    belief[entries["state"]] = entries["chance"]
    return belief


@pytest.mark.property
@settings(max_examples=25)
@given(small_models(discount=0.8))
def test_what_follows_a_belief_is_its_posterior(model: fp.FactoredPOMDP) -> None:
    flat = flatten(model)
    search = _searched(flat)
    np.testing.assert_allclose(_belief(flat, search, 0), flat.initial, atol=1e-15)
    seen = 0
    for number in range(min(int(search.used["nodes"][0]), 30)):
        belief = _belief(flat, search, number)
        for action, choice in enumerate(search.choices[number]):
            assert choice["reward"] == pytest.approx(flat.reward[action] @ belief, abs=1e-12)
            if choice["edge"] < 0:
                continue
            seen += 1
            joint = (belief @ flat.transition[action])[:, None] * flat.observation[action].toarray()
            edges = search.edges[choice["edge"] :][: choice["edges"]]
            assert sorted(edges["column"]) == np.flatnonzero(joint.sum(axis=0)).tolist()
            for edge in edges:
                after = joint[:, edge["column"]]
                assert edge["chance"] == pytest.approx(after.sum(), abs=1e-12)
                np.testing.assert_allclose(_belief(flat, search, edge["child"]), after / after.sum(), atol=1e-11)
    assert seen > 0


@pytest.mark.example
def test_every_belief_is_one_node_and_is_found_again() -> None:
    flat = flatten(fp.domain("tiger"))
    search = _searched(flat)
    used = search.nodes[: search.used["nodes"][0]]
    heads = np.sort([_belief(flat, search, number)[0] for number in range(len(used))])
    assert len(heads) > 10
    assert np.diff(heads).min() > 1e-12  # left then right leads back to the start, but for rounding
    larger = np.full(4 * len(search.table), -1)
    insert_all(used, search.entries, larger)
    assert sorted(larger[larger >= 0]) == list(range(len(used)))
