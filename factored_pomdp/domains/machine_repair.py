"""Machine repair: machines wear out unseen, each with a mechanic who may look after it; each earns while it runs.

A factored cousin of the machine-maintenance problem of Smallwood and Sondik, "The optimal control of partially
observable Markov processes over a finite horizon", Operations Research 21 (1973). ``coupled`` puts the machines in a
row where a broken neighbour wears its neighbour out: then nothing decomposes.
"""

from __future__ import annotations

from factored_pomdp.model import FactoredPOMDP
from factored_pomdp.specification import table
from factored_pomdp.variables import Variable

__all__ = ["machine_repair"]

_CONDITIONS = ("good", "worn", "broken")
_EARNS = {"good": 1.0, "worn": 0.6, "broken": 0.0}
_WEAR = {"good": {"good": 0.9, "worn": 0.1}, "worn": {"worn": 0.8, "broken": 0.2}, "broken": {"broken": 1.0}}
_PART_IS_GOOD = {"good": 0.95, "worn": 0.6, "broken": 0.1}

_MOST_MACHINES = 10_000


def machine_repair(machines: int = 3, coupled: bool = False, discount: float = 0.95) -> FactoredPOMDP:
    """A network of machines to repair.

    Parameters
    ----------
    machines : int
        From 1 to 10,000.
    coupled : bool
        Whether a broken machine wears out the next one faster.
    discount : float
    """
    if not 1 <= machines <= _MOST_MACHINES:
        raise ValueError(f"machines={machines}: expected 1 to {_MOST_MACHINES:,}")
    names = [f"machine{number}" for number in range(1, machines + 1)]
    hands = {name: f"{name}.hand" for name in names}
    parts = {name: f"{name}.part" for name in names}

    def wear(condition: str, hand: str, before: str = "good") -> dict[str, float]:
        if hand == "repair":
            return {"good": 1.0}
        if before == "broken" and condition != "broken":
            return {condition: 0.5, _CONDITIONS[_CONDITIONS.index(condition) + 1]: 0.5}
        return _WEAR[condition]

    def inspect(condition: str, hand: str) -> dict[str, float]:
        good = _PART_IS_GOOD[condition]
        return {"nothing": 1.0} if hand == "repair" else {"good part": good, "bad part": 1 - good}

    def earn(condition: str, hand: str) -> float:
        return -2.0 if hand == "repair" else _EARNS[condition]

    def parents(position: int) -> list[str]:
        own = [names[position], hands[names[position]]]
        return [*own, names[position - 1]] if coupled and position else own

    return FactoredPOMDP(
        name="machine-repair",
        states=[Variable(name, _CONDITIONS) for name in names],
        actions=[Variable(hands[name], ["run", "repair"]) for name in names],
        observations=[Variable(parts[name], ["good part", "bad part", "nothing"]) for name in names],
        transition={name: table(*parents(k), f"{name}.next", values=wear) for k, name in enumerate(names)},
        observation={parts[n]: table(f"{n}.next", hands[n], parts[n], values=inspect) for n in names},
        reward={f"{name}.earns": table(name, hands[name], values=earn) for name in names},
        initial={name: {"good": 1.0} for name in names},
        discount=discount,
    )
