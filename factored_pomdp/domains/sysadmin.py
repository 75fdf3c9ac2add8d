"""SysAdmin: computers in a ring, each of which is the more likely to crash if the one before it is down.

Source: Guestrin, Koller, Parr, Venkataraman, "Efficient solution algorithms for factored MDPs", JAIR 19 (2003), whose
probabilities these are: a computer that runs goes on with probability 0.95, one that is down comes back by itself with
0.0475, both are halved where the computer before it is down; one that is rebooted runs for certain. There everything
is seen; here each computer answers a ping, wrongly at times, as in the planning competition of 2011.
"""

from __future__ import annotations

from factored_pomdp.model import FactoredPOMDP
from factored_pomdp.specification import Table, table
from factored_pomdp.variables import Variable

__all__ = ["sysadmin"]

_RUNS_NEXT = {
    ("up", "up"): 0.95,
    ("up", "down"): 0.475,
    ("down", "up"): 0.0475,
    ("down", "down"): 0.0238,
}

_MOST_MACHINES = 500


def sysadmin(
    machines: int = 4, accuracy: float = 0.95, reboot_cost: float = 0.0, discount: float = 0.95
) -> FactoredPOMDP:
    """A ring of computers, one of which may be rebooted in each step.

    Parameters
    ----------
    machines : int
        From 2 to 500.
    accuracy : float
        Probability that the answer to a ping is right; 1 shows everything.
    reboot_cost : float
        What a reboot costs; a computer that runs earns 1 a step.
    discount : float
    """
    wrong = [] if 2 <= machines <= _MOST_MACHINES else [f"machines={machines}: expected 2 to {_MOST_MACHINES:,}"]
    wrong += [f"accuracy={accuracy}: expected a number from 0.5 to 1"] if not 0.5 <= accuracy <= 1 else []
    if wrong:
        raise ValueError("; ".join(wrong))
    names = [f"machine{number}" for number in range(1, machines + 1)]

    def run(name: str, before: str) -> Table:
        def after(own: str, other: str, reboot: str) -> dict[str, float]:
            up = 1.0 if reboot == name else _RUNS_NEXT[own, other]
            return {"up": up, "down": 1 - up}

        return table(name, before, "reboot", f"{name}.next", values=after)

    def ping(own: str) -> dict[str, float]:
        return {own: accuracy, "down" if own == "up" else "up": 1 - accuracy}

    return FactoredPOMDP(
        name="sysadmin",
        states=[Variable(name, ["up", "down"]) for name in names],
        actions=[Variable("reboot", ["none", *names])],
        observations=[Variable(f"{name}.ping", ["up", "down"]) for name in names],
        transition={name: run(name, names[position - 1]) for position, name in enumerate(names)},
        observation={f"{name}.ping": table(f"{name}.next", f"{name}.ping", values=ping) for name in names},
        reward={
            **{f"{name}.runs": table(name, values={"up": 1.0, "down": 0.0}) for name in names},
            "reboot": lambda reboot: 0.0 if reboot == "none" else -reboot_cost,
        },
        initial={name: "up" for name in names},
        discount=discount,
    )
