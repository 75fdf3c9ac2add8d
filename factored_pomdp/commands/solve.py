"""``factored-pomdp solve``: bounds on the optimal value, and a policy."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

import typer

from factored_pomdp.commands.answers import (
    COMMAND_LINE,
    AsJson,
    InputError,
    answer,
    checked_output,
    side_console,
    table,
)
from factored_pomdp.commands.model_argument import ModelName, Options, load_model
from factored_pomdp.commands.picture import checked_picture, written_picture
from factored_pomdp.commands.solver_argument import Horizon, Precision, Solver, TimeLimit, solved

__all__ = ["solve"]


def solve(
    model: ModelName,
    option: Options = None,
    solver: Solver = "auto",
    precision: Precision = 1e-3,
    time_limit: TimeLimit = 60.0,
    horizon: Horizon = None,
    out: Annotated[Path | None, typer.Option(metavar="POLICY", help="Where to write the policy (.npz).")] = None,
    picture: Annotated[
        Path | None, typer.Option(metavar="PNG|SVG", help="Draw the value function of a problem with two states.")
    ] = None,
    as_json: AsJson = False,
) -> None:
    """Solve a model: a lower and an upper bound on its value, and a policy; Ctrl-C gives the best so far."""
    from factored_pomdp.provenance import digest, provenance

    if out is not None:
        checked_output("--out", out)
    if picture is not None:
        checked_picture("--picture", picture)
    loaded = load_model(model, option)
    if picture is not None and loaded.joint_states != 2:
        raise InputError(f"--picture: {loaded.name} has {loaded.joint_states:,} states; expected two")
    found = solved(loaded, solver, {"precision": precision, "time_limit": time_limit, "horizon": horizon})
    written = None
    if out is not None and found.policy is None:
        side_console().print(f"nothing written to {out}: {found.solver} makes no policy", style="yellow")
    elif out is not None:
        found.save(out)
        written = str(out)
    drawn = [] if picture is None else _drawn(found, loaded.name, picture)
    content: dict[str, Any] = {
        "solver": found.solver,
        "lower": found.lower,
        "upper": found.upper,
        "gap": found.gap,
        "seconds": found.seconds,
        "horizon": found.horizon,
        "vectors": found.vectors,
        "points": found.points,
        "stopped": found.stopped,
        "lower_is": found.lower_is,
        "notes": found.notes,
        "policy": written,
        "picture": drawn,
        **provenance(COMMAND_LINE.get(), {"model": digest(loaded)}),
    }
    rows = table("", "found", right=["found"])
    for key in ("solver", "lower", "upper", "gap", "seconds", "horizon", "vectors", "points", "stopped", "policy"):
        value = content[key]
        rows.add_row(key, f"{value:,.6g}" if isinstance(value, float) else "none" if value is None else str(value))
    lines = [*(f"note: {note}" for note in found.notes), *(f"{file}: written" for file in drawn)]
    answer(content, [rows, *lines], as_json=as_json)


def _drawn(found: Any, name: str, picture: Path) -> list[str]:
    from factored_pomdp.pictures.vectors import draw_vectors

    try:
        shown = found.two_states()
    except ValueError as problem:
        raise InputError(f"--picture: {problem}") from problem
    ahead = "for ever" if found.horizon is None else f"{found.horizon} steps to go"
    return written_picture("--picture", draw_vectors(shown, f"{name}: {found.solver}, {ahead}"), picture)
