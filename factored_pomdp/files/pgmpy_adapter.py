"""To pgmpy and back: the only module that imports it.

A model becomes its two-slice network, unrolled by hand: current states, actions, next states and observations are plain
nodes of a Bayesian network (``x`` and ``x.next``). pgmpy's own ``DBNInference`` is not used: it gives wrong answers.
Importing pgmpy takes seconds, so it happens inside the functions.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from factored_pomdp.errors import Fault, ModelError, TooLarge, did_you_mean
from factored_pomdp.factors import DenseFactor, DeterministicFactor, Factor
from factored_pomdp.model import FactoredPOMDP
from factored_pomdp.specification import Specification
from factored_pomdp.variables import Value, Variable

__all__ = ["Roles", "from_pgmpy", "roles_of", "to_pgmpy"]

_MOST_ENTRIES = 10_000_000


@dataclass(frozen=True)
class Roles:
    """What the nodes of a two-slice network stand for.

    Attributes
    ----------
    states : mapping of str to str
        Node of each current state variable to the node of its next-slice twin.
    actions, observations : tuples of str
    """

    states: Mapping[str, str]
    actions: tuple[str, ...]
    observations: tuple[str, ...]


def roles_of(model: FactoredPOMDP) -> Roles:
    """The roles of the nodes that `to_pgmpy` makes."""
    return Roles(
        {variable.name: variable.next.name for variable in model.states},
        tuple(variable.name for variable in model.actions),
        tuple(variable.name for variable in model.observations),
    )


def to_pgmpy(
    model: FactoredPOMDP, action: Mapping[str, Value] | None = None, known: Mapping[str, Value] | None = None
) -> Any:
    """The two-slice network of a model, as a ``pgmpy.models.DiscreteBayesianNetwork``.

    Parameters
    ----------
    action : mapping, optional
        Values of action variables: these lose their node. The others become roots with a uniform prior.
    known : mapping, optional
        Certain values of current state variables, in place of their initial distributions.

    Raises
    ------
    TooLarge
        With the size, where a table cannot be laid out in full (a noisy-or of many causes).

    Notes
    -----
    Rewards have no place in the network.
    """
    from pgmpy.models import DiscreteBayesianNetwork

    fixed, certain = dict(action or {}), dict(known or {})
    for name, value in (*fixed.items(), *certain.items()):
        model.variable(name).index(value)
    nodes: dict[Variable, Factor] = {}
    for variable in model.states:
        nodes[variable] = model.initial[variable.name]
        if variable.name in certain:
            nodes[variable] = DeterministicFactor((), variable, variable.index(certain[variable.name]))
    for variable in model.actions:
        if variable.name not in fixed:
            nodes[variable] = DenseFactor([variable], np.full(variable.size, 1 / variable.size))
    nodes |= {variable.next: model.transition[variable.name].condition(fixed) for variable in model.states}
    nodes |= {variable: model.observation[variable.name].condition(fixed) for variable in model.observations}
    network = DiscreteBayesianNetwork()
    network.add_nodes_from([variable.name for variable in nodes])
    for child, factor in nodes.items():
        network.add_edges_from([(parent.name, child.name) for parent in factor.scope if parent != child])
    network.add_cpds(*(_table(factor, child) for child, factor in nodes.items()))
    return network


def from_pgmpy(
    network: Any,
    roles: Roles,
    reward: Mapping[str, Specification] | Specification,
    discount: float = 1.0,
    known: Iterable[str] = (),
    name: str = "network",
) -> FactoredPOMDP:
    """A model from a two-slice network.

    Parameters
    ----------
    network : pgmpy.models.DiscreteBayesianNetwork
        With a table for every node; the tables of action nodes are not used.
    roles : Roles
        Every node has one.
    reward : mapping or specification
        As for `FactoredPOMDP`; next states are called ``x.next`` whatever their node is called.

    Raises
    ------
    ModelError
        With everything that is wrong with the network, the roles or the model.
    """
    faults = _role_faults(network, roles)
    if faults:
        raise ModelError(faults)
    called = {node: node for node in (*roles.states, *roles.actions, *roles.observations)}
    called |= {after: f"{now}.next" for now, after in roles.states.items()}
    tables = {node: network.get_cpds(node) for node in called}
    variables = {node: Variable(called[node], tables[node].state_names[node]) for node in called}
    for now, after in roles.states.items():
        if variables[now].values != variables[after].values:
            found = f"values {list(variables[now].values)} and {list(variables[after].values)}"
            faults.append(Fault(f"states {now}, {after}", found, "the same values in both slices"))
    if faults:
        raise ModelError(faults)

    def factor(node: str) -> DenseFactor:
        table = tables[node].to_factor()
        order = [variables[other] for other in table.variables]
        found = DenseFactor(order, table.values)
        parents = [variable for variable in order if variable != variables[node]]
        return DenseFactor([*parents, variables[node]], found.array_over([*parents, variables[node]]))

    return FactoredPOMDP(
        name=name,
        states=[variables[node] for node in roles.states],
        actions=[variables[node] for node in roles.actions],
        observations=[variables[node] for node in roles.observations],
        transition={now: factor(after) for now, after in roles.states.items()},
        observation={node: factor(node) for node in roles.observations},
        initial={now: factor(now) for now in roles.states},
        reward=reward,
        discount=discount,
        known=known,
    )


def _table(factor: Factor, child: Variable) -> Any:
    from pgmpy.factors.discrete import TabularCPD

    if factor.size > _MOST_ENTRIES:
        sizes = " × ".join(f"{variable.name} ({variable.size})" for variable in factor.scope)
        raise TooLarge(f"{child.name}: a table over {sizes} would hold {factor.size:,} numbers, not {_MOST_ENTRIES:,}")
    parents = [variable for variable in factor.scope if variable != child]
    values = factor.array_over([child, *parents]).reshape(child.size, -1)
    return TabularCPD(
        child.name,
        child.size,
        values,
        evidence=[parent.name for parent in parents] or None,
        evidence_card=[parent.size for parent in parents] or None,
        state_names={variable.name: list(variable.values) for variable in factor.scope},
    )


def _role_faults(network: Any, roles: Roles) -> list[Fault]:
    faults = []
    nodes = list(network.nodes())
    named = [*roles.states, *roles.states.values(), *roles.actions, *roles.observations]
    for node in dict.fromkeys(named):
        if node not in nodes:
            faults.append(
                Fault(f"role of {node!r}", "no such node", f"a node of the network{did_you_mean(node, nodes)}")
            )
        elif network.get_cpds(node) is None:
            faults.append(Fault(f"node {node!r}", "no table", "a table for every node"))
        if named.count(node) > 1:
            faults.append(Fault(f"role of {node!r}", f"{named.count(node)} roles", "one role"))
    for node in nodes:
        if node not in named:
            faults.append(Fault(f"node {node!r}", "no role", "state, next state, action or observation"))
    return faults
