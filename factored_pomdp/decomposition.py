"""Does a model decompose, and if not, what ties it together.

The certificate speaks of belief and one-step value for a given action: then the posterior is a product over blocks
(eq:belfact1) and the value a sum (eq:policy3). Optimal plans over several steps do not decompose.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from factored_pomdp.counterexamples import counterexample_of
from factored_pomdp.factors import Factor
from factored_pomdp.factors.sparse import unflatten
from factored_pomdp.model import FactoredPOMDP
from factored_pomdp.structure import Structure, structure_of

__all__ = ["Certificate", "Tie", "decompose"]

_SPEAKS_OF = "belief and one-step value for a given action; optimal plans over several steps do not decompose"


@dataclass(frozen=True)
class Tie:
    """A factor that keeps hidden variables together.

    Attributes
    ----------
    factor : str
        Such as ``transition of b.next``.
    kind : str
        ``initial``, ``transition``, ``observation``, ``reward`` or ``terminal``.
    joins : tuple of tuples of str
        The things that it ties, each named by its variables.
    counterexample : dict or None
        Numbers that show it: a belief, posterior or value that is not what independent parts would give. ``None`` if
        none was asked for, or none found (``because`` then says so).
    because : str
    """

    factor: str
    kind: str
    joins: tuple[tuple[str, ...], ...]
    counterexample: Mapping[str, Any] | None
    because: str = ""


@dataclass(frozen=True)
class Certificate:
    """The answer of `decompose`.

    Attributes
    ----------
    known : tuple of str
        State variables whose value the agent can tell after every step.
    blocks : tuple of tuples of str
        Hidden variables that belong together; belief and one-step value fall apart between blocks.
    ties : tuple of Tie
        What holds a block of several things together.
    speaks_of : str
        What the certificate is about, and what not.
    """

    known: tuple[str, ...]
    blocks: tuple[tuple[str, ...], ...]
    ties: tuple[Tie, ...]
    structure: Structure = field(repr=False)
    value_splits: bool = True
    speaks_of: str = _SPEAKS_OF

    @property
    def decomposes(self) -> bool:
        """Whether there are several blocks, or nothing to take apart; and the value is the sum over them."""
        return self.value_splits and (len(self.blocks) > 1 or len(self.structure.things) <= 1)

    def __str__(self) -> str:
        lines = [f"decomposes: {'yes' if self.decomposes else 'no'} ({self.speaks_of})"]
        lines.append(f"known: {', '.join(self.known) or 'nothing'}")
        lines += [f"block {n}: {', '.join(block)}" for n, block in enumerate(self.blocks, 1)]
        for tie in self.ties:
            joined = " with ".join(f"[{', '.join(thing)}]" for thing in tie.joins)
            what = f"{tie.kind} tie" if tie.factor == tie.kind else f"{tie.kind} tie: {tie.factor}"
            lines.append(f"{what} joins {joined}{'; ' + tie.because if tie.because else ''}")
        return "\n".join(lines)


def decompose(
    model: FactoredPOMDP, *, likelihood: Mapping[str, Factor] | None = None, counterexamples: bool = True
) -> Certificate:
    """Find known variables, independent blocks, and what ties blocks together.

    Parameters
    ----------
    likelihood : mapping, optional
        Unnormalised tables used in place of observation distributions (as in `solvers.JointMyopic`). One that does not
        sum to one is named as the reason why the value does not split; beliefs are not harmed.
    counterexamples : bool
        Whether to work one out for every tie.

    Notes
    -----
    A parent without numeric influence ties nothing, nor does a likelihood that is a product, a reward that is a sum, or
    an initial belief that multiplies out to a product. Terminal states count as an observation, as the belief is given
    that the episode goes on.
    """
    structure = structure_of(model)
    ties = []
    for join in structure.joins:
        found = counterexample_of(structure, join) if counterexamples else None
        because = "" if found is not None or not counterexamples else "structural; no numeric counterexample was found"
        joins = tuple(structure.things[number] for number in join.things)
        ties.append(Tie(join.factor, join.kind, joins, found, because))
    odd = [_not_a_distribution(structure, name, table) for name, table in (likelihood or {}).items()]
    ties += [tie for tie in odd if tie is not None]
    splits = not any(tie is not None for tie in odd) or len(structure.blocks) < 2
    blocks = tuple(block.names for block in structure.blocks)
    return Certificate(structure.known, blocks, tuple(ties), structure, splits)


def _not_a_distribution(structure: Structure, name: str, table: Factor) -> Tie | None:
    child = structure.model.variable(name)
    parents = tuple(variable for variable in table.scope if variable != child)
    sums = table.marginalise(child).array_over(parents).ravel()
    worst = int(np.abs(sums - 1).argmax())
    if abs(sums[worst] - 1) <= 1e-9:
        return None
    index = unflatten(np.array([worst]), parents)[0]
    at = {variable.name: variable.values[int(i)] for variable, i in zip(parents, index, strict=True)}
    because = (
        f"the likelihood of {name} sums to {sums[worst]:.6g} at {at}, so the other blocks' observations no longer sum "
        "away (law of total probability) and the value does not split; posteriors are not harmed"
    )
    return Tie(f"likelihood of {name}", "observation", structure.things, {"at": at, "sum": float(sums[worst])}, because)
