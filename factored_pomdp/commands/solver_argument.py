"""SOLVER and its limits on the command line, and the progress line of whoever solves."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING, Annotated, Any

import typer

from factored_pomdp.commands.answers import InputError, Refused, side_console
from factored_pomdp.commands.compiling import compiling_told

if TYPE_CHECKING:
    from factored_pomdp.model import FactoredPOMDP

__all__ = ["Horizon", "Precision", "Solver", "TimeLimit", "progress_line", "solved", "solver_named"]

Solver = Annotated[str, typer.Option("--solver", metavar="NAME", help="An installed solver (see `solvers MODEL`).")]
Precision = Annotated[float, typer.Option(help="Gap between the bounds at which to stop.")]
TimeLimit = Annotated[float, typer.Option(metavar="SECONDS", help="Stop by then, with the best so far.")]
Horizon = Annotated[int | None, typer.Option(min=1, help="Steps to plan for; for ever if left out.")]


def solver_named(name: str) -> Any:
    """The class of an installed solver; `InputError` with a suggestion if there is none."""
    from factored_pomdp import registry

    try:
        return registry.solver(name)
    except ValueError as problem:
        raise InputError(str(problem)) from problem


def solved(model: FactoredPOMDP, name: str, limits: dict[str, Any]) -> Any:
    """What a solver makes of a model: its solution.

    Raises
    ------
    InputError
        Where the solver only chooses step by step, or something is left out that it needs.
    Refused
        Where it cannot take the model.
    TooLarge
    """
    from factored_pomdp.errors import TooLarge

    kind = solver_named(name)
    if not hasattr(kind, "solve"):
        raise InputError(f"{name} chooses step by step and gives no bounds; `simulate --policy {name}` runs it")
    ability = kind.can_solve(model)
    if not ability:
        raise Refused(f"{name} cannot take {model.name}: {ability.because}; {ability.estimate}")
    try:
        with compiling_told(), progress_line() as tell:
            return kind(model).solve(kind.limits(**limits, progress=tell))
    except TooLarge:
        raise
    except ValueError as problem:
        raise InputError(str(problem)) from problem


@contextmanager
def progress_line() -> Iterator[Callable[[Any], None]]:
    """Show a solver's bounds on standard error while it runs."""
    from rich.progress import Progress, SpinnerColumn, TextColumn

    side = side_console()
    columns = (SpinnerColumn(), TextColumn("{task.description}"))
    with Progress(*columns, console=side, transient=True, disable=not side.is_terminal) as shown:
        task = shown.add_task("solving …")

        def tell(now: Any) -> None:
            shown.update(
                task,
                description=(
                    f"[{now.lower:.6g}, {now.upper:.6g}]  gap {now.gap:.3g}  {now.vectors:,} vectors  "
                    f"{now.points:,} points  {now.seconds:.1f} s"
                ),
            )

        yield tell
