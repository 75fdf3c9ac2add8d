"""Weather in several towns: each has its own, seen through a forecast, and an umbrella helps where one is carried."""

from __future__ import annotations

import factored_pomdp as fp

__all__ = ["weather"]


def weather(towns: int = 2, accuracy: float = 0.8) -> fp.FactoredPOMDP:
    """Towns whose weather is forecast, not seen.

    Parameters
    ----------
    towns : int
        At least one.
    accuracy : float
        Probability that a forecast is right.
    """
    if towns < 1:
        raise ValueError(f"towns={towns}: expected at least 1")
    names = [f"town{number}" for number in range(1, towns + 1)]

    def change(sky: str) -> dict[str, float]:
        return {"sun": 0.8, "rain": 0.2} if sky == "sun" else {"sun": 0.4, "rain": 0.6}

    def forecast(sky: str) -> dict[str, float]:
        return {sky: accuracy, "rain" if sky == "sun" else "sun": 1 - accuracy}

    def comfort(sky: str, carried: str) -> float:
        return -0.2 if carried == "umbrella" else -1.0 * (sky == "rain")

    return fp.FactoredPOMDP(
        name="weather",
        states=[fp.Variable(name, ["sun", "rain"]) for name in names],
        actions=[fp.Variable(f"{name}.carry", ["umbrella", "nothing"]) for name in names],
        observations=[fp.Variable(f"{name}.forecast", ["sun", "rain"]) for name in names],
        transition={name: fp.table(name, f"{name}.next", values=change) for name in names},
        observation={
            f"{name}.forecast": fp.table(f"{name}.next", f"{name}.forecast", values=forecast) for name in names
        },
        reward={f"{name}.comfort": fp.table(f"{name}.next", f"{name}.carry", values=comfort) for name in names},
        initial={name: {"sun": 0.5, "rain": 0.5} for name in names},
        discount=0.9,
    )
