"""``factored-pomdp info``: variables, sizes, factors; one table with value names."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING, Annotated, Any

import typer

from factored_pomdp.commands.answers import COMMAND_LINE, AsJson, answer, table
from factored_pomdp.commands.model_argument import ModelName, Options, load_model

if TYPE_CHECKING:
    from rich.console import RenderableType

    from factored_pomdp.model import FactoredPOMDP
    from factored_pomdp.variables import Variable

__all__ = ["info"]


def info(
    model: ModelName,
    option: Options = None,
    table_name: Annotated[
        str | None,
        typer.Option(
            "--table",
            metavar="NAME",
            help="Print one table: weather.next, an observation, a reward, 'initial weather'.",
        ),
    ] = None,
    as_json: AsJson = False,
) -> None:
    """Show a model's variables, sizes, factors and discount."""
    from factored_pomdp.commands.factor_table import described, found_factor, shown_factor
    from factored_pomdp.provenance import digest, provenance

    loaded = load_model(model, option)
    carried = provenance(COMMAND_LINE.get(), {"model": digest(loaded)})
    content: dict[str, Any] = {
        "name": loaded.name,
        "states": _sizes(loaded.states),
        "actions": _sizes(loaded.actions),
        "observations": _sizes(loaded.observations),
        "joint_states": loaded.joint_states,
        "joint_actions": loaded.joint_actions,
        "joint_observations": loaded.joint_observations,
        "discount": loaded.discount,
        "factors": _factors(loaded),
        "notes": loaded.notes,
    }
    if table_name is None:
        answer({**content, **carried}, _overview(loaded), as_json=as_json)
        return
    found = found_factor(loaded, table_name)
    if as_json:
        answer({**content, "table": described(found), **carried}, (), as_json=True)
    else:
        answer({}, shown_factor(found), as_json=False)


def _sizes(variables: Iterable[Variable]) -> list[dict[str, Any]]:
    return [{"name": variable.name, "size": variable.size} for variable in variables]


def _factors(model: FactoredPOMDP) -> list[dict[str, Any]]:
    kinds = ("initial", "transition", "observation", "reward", "legal")
    return [
        {
            "kind": kind,
            "name": name,
            "scope": factor.names,
            "representation": type(factor).__name__,
            "stored": factor.stored,
        }
        for kind in kinds
        for name, factor in getattr(model, kind).items()
    ]


def _overview(model: FactoredPOMDP) -> list[RenderableType]:
    variables = table("variable", "kind", "values", "size", right=["size"])
    for kind in ("states", "actions", "observations"):
        for variable in getattr(model, kind):
            variables.add_row(variable.name, kind.removesuffix("s"), _values(variable), f"{variable.size:,}")
    factors = table("factor", "kind", "over", "held as", "numbers", right=["numbers"])
    for entry in _factors(model):
        over, held = ", ".join(entry["scope"]) or "nothing", entry["representation"]
        factors.add_row(entry["name"], entry["kind"], over, held, f"{entry['stored']:,}")
    counts = (
        f"{model.joint_states:,} joint states, {model.joint_actions:,} joint actions, "
        f"{model.joint_observations:,} joint observations, discount {model.discount:g}"
    )
    return [f"{model.name}: {counts}", variables, factors, *(f"note: {note}" for note in model.notes)]


def _values(variable: Variable, most: int = 6) -> str:
    shown = [str(value) for value in variable.values[:most]]
    return ", ".join(shown) + (", …" if variable.size > most else "")
