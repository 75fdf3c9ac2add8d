"""``factored-pomdp simulate``: what a policy earns."""

from __future__ import annotations

import contextlib
import math
import os
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, TextIO

import typer

from factored_pomdp.commands.answers import (
    COMMAND_LINE,
    INTERRUPTED,
    AsJson,
    InputError,
    answer,
    checked_output,
    side_console,
    table,
)
from factored_pomdp.commands.compiling import compiling_told
from factored_pomdp.commands.model_argument import ModelName, Options, load_model
from factored_pomdp.commands.solver_argument import Precision, TimeLimit, solved, solver_named

if TYPE_CHECKING:
    from factored_pomdp.model import FactoredPOMDP

__all__ = ["simulate"]


def simulate(
    model: ModelName,
    policy: Annotated[str, typer.Option(help="A file that `solve --out` wrote, or the name of a solver.")],
    option: Options = None,
    runs: Annotated[int, typer.Option(min=2, help="Number of runs.")] = 1000,
    steps: Annotated[
        int | None, typer.Option(min=1, help="Of each run; where left out, the policy's horizon, or as many as matter.")
    ] = None,
    seed: Annotated[int, typer.Option(min=0, help="Of everything that is drawn at random.")] = 0,
    trace: Annotated[
        Path | None, typer.Option(metavar="FILE", help="Write a line of JSON for every step of every run.")
    ] = None,
    precision: Precision = 1e-3,
    time_limit: TimeLimit = 60.0,
    as_json: AsJson = False,
) -> None:
    """Simulate a policy: mean discounted return with its 95 % interval, and the error of ending runs early."""
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn

    from factored_pomdp.episodes import Returns, episodes, steps_that_matter
    from factored_pomdp.provenance import digest, provenance

    loaded = load_model(model, option)
    if trace is not None:
        checked_output("--trace", trace)
    side = side_console()
    kept = _kept_policy(loaded, policy)
    planned = kept.horizon if kept is not None else None
    length = steps or planned or (steps_that_matter(loaded) if loaded.discount < 1 else None)
    if length is None:
        raise InputError(f"{loaded.name} has discount 1: give --steps")
    if planned is not None and planned != length:
        told = f"{policy} plans for {planned:,} steps, and runs have {length:,}: its bounds are not about these runs"
        side.print(told, style="yellow", soft_wrap=True)
    horizon = length if loaded.discount >= 1 else None
    limits = {"precision": precision, "time_limit": time_limit, "horizon": horizon}
    actor = kept if kept is not None else _actor(loaded, policy, limits)
    carried = provenance(COMMAND_LINE.get(), {"model": digest(loaded)}, seed)
    returns, interrupted = Returns(loaded, length), False
    columns = (TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn(), TimeRemainingColumn())
    shown = Progress(*columns, console=side, transient=True, disable=not side.is_terminal)
    with compiling_told(), _written(trace) as lines, shown:
        task = shown.add_task("simulating", total=runs)
        try:
            for total in episodes(loaded, actor, runs, length, seed, lines):
                returns.add(total)
                shown.update(task, completed=len(returns))
        except KeyboardInterrupt:
            interrupted = True
    if len(returns) < 2:
        raise KeyboardInterrupt
    low, high = returns.interval(0.95)
    left_out = returns.truncation_error
    content = {
        "mean": returns.mean,
        "ci95": [low, high],
        "runs": len(returns),
        "steps": length,
        "cut": returns.cut,
        "truncation_error": left_out if math.isfinite(left_out) else None,
        "policy": policy,
        "interrupted": interrupted,
        **carried,
    }
    rows = table("", "found", right=["found"])
    rows.add_row("mean discounted return", f"{returns.mean:.6g}")
    rows.add_row("95 % interval", f"[{low:.6g}, {high:.6g}]")
    rows.add_row("runs of steps", f"{len(returns):,} of {length:,}")
    if loaded.terminal is not None:
        rows.add_row("cut before the episode ended", f"{returns.cut:,}")
    bound = f"{left_out:.3g}" if math.isfinite(left_out) else "no bound at discount 1"
    rows.add_row("left out by cutting, at the most", bound)
    answer(content, [rows], as_json=as_json)
    if interrupted:
        raise typer.Exit(INTERRUPTED)


def _kept_policy(model: FactoredPOMDP, name: str) -> Any | None:
    """A policy from a file; ``None`` where a solver is named."""
    if not (os.path.sep in name or Path(name).suffix or Path(name).is_file()):
        return None
    try:
        return solver_named("auto").load_policy(Path(name), model)
    except ValueError as problem:
        raise InputError(str(problem)) from problem


def _actor(model: FactoredPOMDP, name: str, limits: dict[str, Any]) -> Any:
    """Whoever chooses: a solver that chooses step by step, or what a solver makes."""
    kind = solver_named(name)
    if hasattr(kind, "solve"):
        return solved(model, name, limits).policy or solver_named("myopic")(model)
    try:
        return kind(model)
    except ValueError as problem:
        raise InputError(f"{name}: {problem}") from problem


@contextlib.contextmanager
def _written(path: Path | None) -> Iterator[TextIO | None]:
    """A file that is there in full or not at all; nothing without a path."""
    if path is None:
        yield None
        return
    beside = path.with_name(path.name + ".part")
    try:
        with beside.open("w", encoding="utf-8") as lines:
            yield lines
        os.replace(beside, path)
    finally:
        beside.unlink(missing_ok=True)
