"""``factored-pomdp solvers``: which installed solver can take a model, and if not, why."""

from __future__ import annotations

from typing import Any

from factored_pomdp.commands.answers import COMMAND_LINE, AsJson, answer, side_console, table
from factored_pomdp.commands.model_argument import ModelName, Options, load_model

__all__ = ["solvers"]


def solvers(model: ModelName, option: Options = None, as_json: AsJson = False) -> None:
    """Ask every installed solver whether it can take a model, and what that would cost."""
    from factored_pomdp import registry
    from factored_pomdp.provenance import digest, provenance

    loaded = load_model(model, option)
    listed: list[dict[str, Any]] = []
    shown = table("solver", "can it", "because", "cost")
    for entry in registry.solvers():
        if entry.error is not None:
            warning = f"solver {entry.name} ({entry.distribution}) cannot be loaded: {entry.error}"
            side_console().print(warning, style="yellow", soft_wrap=True)
            continue
        ability = entry.load().can_solve(loaded)
        listed.append(
            {
                "name": entry.name,
                "can_solve": ability.can,
                "because": ability.because,
                "estimate": ability.estimate,
                "summary": entry.summary,
            }
        )
        shown.add_row(entry.name, "yes" if ability else "no", ability.because, ability.estimate)
    content = {"solvers": listed, **provenance(COMMAND_LINE.get(), {"model": digest(loaded)})}
    answer(content, [shown], as_json=as_json)
