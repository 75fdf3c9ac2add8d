"""Round trip through pgmpy; its variable elimination as an oracle; d-separation as a second opinion on `decompose`."""

from __future__ import annotations

import itertools
import warnings

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from scipy import sparse

import factored_pomdp as fp
from factored_pomdp.factors import NoisyOr
from factored_pomdp.files.pgmpy_adapter import Roles, from_pgmpy, roles_of, to_pgmpy
from tests.strategies import independent_models, random_models

with warnings.catch_warnings():
    warnings.simplefilter("ignore")
    from pgmpy.inference import VariableElimination

pytestmark = pytest.mark.filterwarnings("ignore::DeprecationWarning", "ignore::FutureWarning")


@pytest.mark.property
@settings(max_examples=10)
@given(random_models(most_states=3))
def test_round_trip_keeps_every_number(model: fp.FactoredPOMDP) -> None:
    back = from_pgmpy(to_pgmpy(model), roles_of(model), model.reward, model.discount, model.declared_known)
    assert back.states == model.states
    assert back.actions == model.actions
    assert back.observations == model.observations
    for kind in ("initial", "transition", "observation", "reward"):
        for name, factor in getattr(model, kind).items():
            other = getattr(back, kind)[name]
            np.testing.assert_allclose(other.array_over(factor.scope), factor.dense().array, atol=1e-12)


@pytest.mark.property
@settings(max_examples=12)
@given(random_models(most_states=3), st.integers(0, 2**32 - 1))
def test_belief_update_is_what_variable_elimination_gives(model: fp.FactoredPOMDP, seed: int) -> None:
    rng = np.random.default_rng(seed)
    simulation = fp.Simulation(model)
    action = {variable.name: variable.values[int(rng.integers(variable.size))] for variable in model.actions}
    _, seen, _ = simulation.step(simulation.start(rng), action, rng)
    after = [variable.next.name for variable in model.states]
    oracle = VariableElimination(to_pgmpy(model)).query(after, evidence={**action, **seen}, show_progress=False)
    posterior = fp.JointBelief.initial(model).predict(action).condition(seen)
    order = [model.variable(name.removesuffix(".next")) for name in oracle.variables]
    np.testing.assert_allclose(posterior.table.array_over(order), oracle.values, atol=1e-9)
    fixed = to_pgmpy(model, action=action)
    again = VariableElimination(fixed).query(after, evidence=seen, show_progress=False)
    order = [model.variable(name.removesuffix(".next")) for name in again.variables]
    np.testing.assert_allclose(posterior.table.array_over(order), again.values, atol=1e-9)


def connected(model: fp.FactoredPOMDP, known: tuple[str, ...], one: tuple[str, ...], two: tuple[str, ...]) -> bool:
    """Whether two sets of state variables can tell of one another, given what is known, done and seen."""
    network = to_pgmpy(model)
    given = [variable.name for variable in (*model.actions, *model.observations)]
    given += [name for known_name in known for name in (known_name, f"{known_name}.next")]
    slices = [[name for own in names for name in (own, f"{own}.next")] for names in (one, two)]
    return any(network.is_dconnected(a, b, observed=given) for a, b in itertools.product(*slices))


@pytest.mark.property
@settings(max_examples=15)
@given(independent_models())
def test_blocks_of_an_untied_model_are_d_separated(model: fp.FactoredPOMDP) -> None:
    certificate = fp.decompose(model)
    for one, two in itertools.combinations(certificate.blocks, 2):
        assert not connected(model, certificate.known, one, two)


@pytest.mark.property
@settings(max_examples=40)
@given(random_models(ties=("initial", "transition", "observation")))
def test_what_is_d_separated_is_not_tied(model: fp.FactoredPOMDP) -> None:
    certificate = fp.decompose(model, counterexamples=False)
    assume(not any(tie.kind == "reward" for tie in certificate.ties))
    for block in certificate.blocks:
        reached, waiting = {block[0]}, [block[0]]
        while waiting:
            name = waiting.pop()
            fresh = {other for other in set(block) - reached if connected(model, certificate.known, (name,), (other,))}
            reached |= fresh
            waiting += fresh
        assert reached == set(block)


@pytest.mark.example
def test_machines_in_a_row_are_connected_and_apart_they_are_not() -> None:
    apart, row = (fp.domain("machine-repair", machines=2, coupled=coupled) for coupled in (False, True))
    assert not connected(apart, (), ("machine1",), ("machine2",))
    assert connected(row, (), ("machine1",), ("machine2",))


@pytest.mark.example
def test_tiger_by_hand() -> None:
    tiger = fp.domain("tiger")
    infer = VariableElimination(to_pgmpy(tiger, action={"act": "listen"}))
    found = infer.query(["tiger.next"], evidence={"heard": "left"}, show_progress=False)
    assert found.get_value(**{"tiger.next": "left"}) == pytest.approx(0.85)
    sure = VariableElimination(to_pgmpy(tiger, {"act": "listen"}, known={"tiger": "right"}))
    found = sure.query(["heard"], show_progress=False)
    assert found.get_value(heard="right") == pytest.approx(0.85)


@pytest.mark.example
def test_a_noisy_or_of_many_causes_is_refused_with_its_size() -> None:
    bits, seen = [fp.Variable(f"bit{k}", [0, 1]) for k in range(30)], fp.Variable("seen", ["no", "yes"])
    emission = sparse.csr_array([[0.0, 1.0]])
    causes = [fp.Cause(bit.next, np.array([[0.0], [0.5]]), emission) for bit in bits]
    model = fp.FactoredPOMDP(
        states=bits,
        actions=[fp.Variable("act", ["wait"])],
        observations=[seen],
        transition={bit.name: fp.table(bit.next, values=[0.5, 0.5]) for bit in bits},
        observation={"seen": NoisyOr((), seen, "no", causes)},
        reward=0.0,
        initial={bit.name: 0 for bit in bits},
    )
    with pytest.raises(fp.TooLarge, match=r"seen: a table over .* would hold 2,147,483,648 numbers"):
        to_pgmpy(model)


@pytest.mark.example
def test_wrong_roles_are_all_said_at_once() -> None:
    network = to_pgmpy(fp.domain("tiger"))
    roles = Roles({"tiger": "tiger.nxt"}, ("act", "tiger"), ())
    with pytest.raises(fp.ModelError) as raised:
        from_pgmpy(network, roles, 0.0)
    said = str(raised.value)
    assert "role of 'tiger.nxt': found no such node" in said
    assert "did you mean 'tiger.next'?" in said
    assert "role of 'tiger': found 2 roles" in said
    assert "node 'heard': found no role" in said
    with pytest.raises(fp.ModelError, match="the same values in both slices"):
        from_pgmpy(network, Roles({"tiger": "act"}, ("tiger.next",), ("heard",)), 0.0)
