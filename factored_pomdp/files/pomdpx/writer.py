"""Writes SARSOP's ``.pomdpx`` format; numbers are written so that reading gives them back exactly."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path
from xml.sax.saxutils import escape, quoteattr

import numpy as np

from factored_pomdp.factors import DenseFactor, Factor, NoisyOr
from factored_pomdp.files.names import BLANKS, counted, words
from factored_pomdp.files.pomdpx.variables import LETTERS, whole
from factored_pomdp.files.text import write_text
from factored_pomdp.model import FactoredPOMDP
from factored_pomdp.variables import Variable

__all__ = ["write_pomdpx"]

_WHOLE_FROM = 0.4
"""Share of numbers that are not zero from which on a table is written as one entry."""

_DENSE_BELOW = 5_000_000

_HEAD = """<?xml version="1.0" encoding="UTF-8"?>
<pomdpx version="1.0" id={id} xmlns:xsi="http://www.w3.org/2001/XMLSchema-instance"
        xsi:noNamespaceSchemaLocation="pomdpx.xsd">
  <Description>{description}</Description>
  <Discount>{discount!r}</Discount>
"""


def write_pomdpx(model: FactoredPOMDP, path: Path) -> None:
    """Write a model with its variables and factors as they are.

    Raises
    ------
    ValueError
        Where the model has terminal states, or says which actions are legal.
    TooLarge
        Where a noisy-or has to be laid out that does not fit.
    """
    if model.legal:
        raise ValueError(f"{model.name}: a file cannot say which actions are legal ({', '.join(model.legal)})")
    if model.terminal is not None:
        raise ValueError(f"{model.name}: a .pomdpx file cannot say which states are terminal; a .pomdp file shows them")
    write_text(path, _Writer(model).parts())


class _Writer:
    """Words for all names, and the parts of the file."""

    def __init__(self, model: FactoredPOMDP) -> None:
        self.model = model
        others = [variable.name for variable in (*model.actions, *model.observations)]
        stems = words((variable.name for variable in model.states), blank=BLANKS)
        pairs = [f"{stem}_{slice_}" for stem in stems for slice_ in "01"]
        made = words([*pairs, *others], reserved=["null"], blank=BLANKS)
        names = [name for v in model.states for name in (v.name, v.next.name)] + others
        self.names = dict(zip(names, made, strict=True))
        self.rewards = dict(zip(model.reward, _unequal(model.reward), strict=True))
        self.values: dict[str, np.ndarray] = {}
        for variable in (*model.states, *model.actions, *model.observations):
            listed = np.array(words(variable.values, reserved=["*", "-"], blank=BLANKS), dtype=object)
            self.values[variable.name] = self.values[f"{variable.name}.next"] = listed

    def parts(self) -> Iterator[str]:
        model = self.model
        yield _HEAD.format(
            id=quoteattr(whole(model.name) or "model"),
            description=escape(f"{len(model.states)} state variables, {model.joint_states:,} joint states"),
            discount=float(model.discount),
        )
        yield from self._variables()
        yield "  <InitialStateBelief>\n"
        for state in model.states:
            yield from self._function(model.initial[state.name], state)
        yield "  </InitialStateBelief>\n  <StateTransitionFunction>\n"
        for state in model.states:
            yield from self._function(model.transition[state.name], state.next)
        yield "  </StateTransitionFunction>\n"
        if model.observations:
            yield "  <ObsFunction>\n"
            for seen in model.observations:
                yield from self._function(model.observation[seen.name], seen)
            yield "  </ObsFunction>\n"
        if model.reward:
            yield "  <RewardFunction>\n"
            for name, factor in model.reward.items():
                yield from self._function(factor, None, self.rewards[name])
            yield "  </RewardFunction>\n"
        yield "</pomdpx>\n"

    def _variables(self) -> Iterator[str]:
        yield "  <Variable>\n"
        for state in self.model.states:
            before, after = self.names[state.name], self.names[state.next.name]
            observed = "true" if state.name in self.model.declared_known else "false"
            attributes = f'vnamePrev={quoteattr(before)} vnameCurr={quoteattr(after)} fullyObs="{observed}"'
            yield self._variable("StateVar", attributes, state)
        for tag, variables in (("ActionVar", self.model.actions), ("ObsVar", self.model.observations)):
            for variable in variables:
                yield self._variable(tag, f"vname={quoteattr(self.names[variable.name])}", variable)
        for name in self.rewards.values():
            yield f"    <RewardVar vname={quoteattr(name)}/>\n"
        yield "  </Variable>\n"

    def _variable(self, tag: str, attributes: str, variable: Variable) -> str:
        if variable.size > 1 and counted(variable.values, LETTERS[tag]):
            values = f"<NumValues>{variable.size}</NumValues>"
        else:
            values = f"<ValueEnum>{escape(' '.join(self.values[variable.name]))}</ValueEnum>"
        return f"    <{tag} {attributes}>\n      {values}\n    </{tag}>\n"

    def _function(self, factor: Factor, child: Variable | None, name: str = "") -> Iterator[str]:
        parents = [variable for variable in factor.scope if variable != child]
        about = escape(name if child is None else self.names[child.name])
        no_parent = not parents and not (child is not None and child in self.model.states)
        listed = [self.model.actions[0]] if no_parent else parents
        tag = "Func" if child is None else "CondProb"
        yield f"    <{tag}>\n      <Var>{about}</Var>\n"
        yield f"      <Parent>{escape(' '.join(self.names[v.name] for v in listed)) or 'null'}</Parent>\n"
        yield '      <Parameter type="TBL">\n'
        yield from self._entries(factor, [*parents, *([] if child is None else [child])], no_parent, child is None)
        yield f"      </Parameter>\n    </{tag}>\n"

    def _entries(self, factor: Factor, scope: Sequence[Variable], star: bool, reward: bool) -> Iterator[str]:
        table = "ValueTable" if reward else "ProbTable"
        begin = ["*"] if star else []
        dense = factor.dense() if isinstance(factor, NoisyOr) and factor.size <= _DENSE_BELOW else factor
        if isinstance(dense, DenseFactor):
            array = dense.array_over(scope)
            if np.count_nonzero(array) >= _WHOLE_FROM * array.size or not scope:
                rows = array.reshape(-1, array.shape[-1] if scope else 1).tolist()
                numbers = "\n".join("          " + " ".join(map(repr, row)) for row in rows)
                yield f"        <Entry>\n          <Instance>{' '.join([*begin, *('-' for _ in scope)])}</Instance>\n"
                yield f"          <{table}>\n{numbers}\n          </{table}>\n        </Entry>\n"
                return
        sparse = dense.sparse()
        coordinates = sparse.coordinates[:, [sparse.scope.index(variable) for variable in scope]]
        order = np.lexsort(coordinates.T[::-1])
        columns = [self.values[variable.name][coordinates[order, axis]].tolist() for axis, variable in enumerate(scope)]
        for *places, number in zip(*columns, sparse.numbers[order].tolist(), strict=True):
            instance = escape(" ".join([*begin, *places]))
            yield f"        <Entry><Instance>{instance}</Instance><{table}>{number!r}</{table}></Entry>\n"


def _unequal(names: Sequence[str] | dict[str, Factor]) -> list[str]:
    """Names with single blanks, no two equal."""
    made: dict[str, None] = {}
    for name in names:
        single = whole(name) or "reward"
        while single in made:
            single += "_"
        made[single] = None
    return list(made)
