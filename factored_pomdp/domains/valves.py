"""Two valves on one pipe, and one gauge: a model that does not decompose until its tie is removed.

The gauge falls if any valve leaks. After it fell, to learn that the inlet is tight makes it likely that the outlet
leaks: what is believed of one is no longer independent of what is believed of the other ("explaining away"). With
``tie=false`` each valve has its own gauge, and the same problem falls into two.
"""

from __future__ import annotations

from factored_pomdp.model import FactoredPOMDP
from factored_pomdp.specification import Table, table
from factored_pomdp.variables import Variable

__all__ = ["valves"]

_NAMES = ("inlet", "outlet")


def valves(tie: bool = True, accuracy: float = 1.0, discount: float = 0.95) -> FactoredPOMDP:
    """Two valves that may leak, on one gauge (tied) or on one each (not tied).

    Parameters
    ----------
    tie : bool
        Whether both valves are read from one gauge.
    accuracy : float
        Probability that a gauge is right.
    discount : float
    """
    if not 0.5 <= accuracy <= 1:
        raise ValueError(f"accuracy={accuracy}: expected a number from 0.5 to 1")

    def wear(name: str) -> Table:
        def after(condition: str, mend: str) -> dict[str, float]:
            return (
                {"tight": 1.0}
                if mend == name
                else {"tight": 0.9, "leaks": 0.1}
                if condition == "tight"
                else {"leaks": 1.0}
            )

        return table(name, "mend", f"{name}.next", values=after)

    def read(*conditions: str) -> dict[str, float]:
        falls = accuracy if "leaks" in conditions else 1 - accuracy
        return {"falls": falls, "steady": 1 - falls}

    watched = {"gauge": _NAMES} if tie else {f"{name}.gauge": (name,) for name in _NAMES}
    return FactoredPOMDP(
        name="valves",
        states=[Variable(name, ["tight", "leaks"]) for name in _NAMES],
        actions=[Variable("mend", ["nothing", *_NAMES])],
        observations=[Variable(gauge, ["steady", "falls"]) for gauge in watched],
        transition={name: wear(name) for name in _NAMES},
        observation={
            gauge: table(*(f"{name}.next" for name in names), gauge, values=read) for gauge, names in watched.items()
        },
        reward={
            **{f"{name}.loss": table(name, values={"tight": 0.0, "leaks": -1.0}) for name in _NAMES},
            "work": table("mend", values={"nothing": 0.0, "inlet": -2.0, "outlet": -2.0}),
        },
        initial={name: {"tight": 0.5, "leaks": 0.5} for name in _NAMES},
        discount=discount,
    )
