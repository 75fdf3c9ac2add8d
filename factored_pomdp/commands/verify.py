"""``factored-pomdp verify``: the exponential joint solver against the linear decomposition."""

from __future__ import annotations

import dataclasses
from typing import TYPE_CHECKING, Annotated, Any

import typer

from factored_pomdp.commands.answers import (
    COMMAND_LINE,
    INTERRUPTED,
    AsJson,
    InputError,
    answer,
    plain,
    side_console,
    table,
)
from factored_pomdp.commands.compiling import compiling_told
from factored_pomdp.commands.model_argument import ModelName, Options, load_model

if TYPE_CHECKING:
    from rich.console import RenderableType

    from factored_pomdp.model import FactoredPOMDP
    from factored_pomdp.verification import Verification

__all__ = ["verify"]


def verify(
    model: ModelName,
    option: Options = None,
    beliefs: Annotated[int, typer.Option(min=0, help="Random product beliefs to compare on.")] = 100,
    steps: Annotated[int, typer.Option(min=0, help="Length of a simulated run that carries both beliefs.")] = 0,
    runs: Annotated[int, typer.Option(min=1, help="How many such runs (where --steps is given).")] = 1,
    seed: Annotated[int, typer.Option(min=0, help="Of everything that is drawn at random.")] = 0,
    sparse: Annotated[bool, typer.Option("--sparse", help="Hold only the joint states that have mass.")] = False,
    as_json: AsJson = False,
) -> None:
    """Compare values, chosen actions and posteriors by brute force over joint states; a difference exits 1."""
    if beliefs == 0 and steps == 0:
        raise InputError("nothing to compare: give --beliefs or --steps a number above 0")
    import numpy as np
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn

    from factored_pomdp.errors import TooLarge
    from factored_pomdp.provenance import digest, provenance
    from factored_pomdp.verification import Verification, verifications

    loaded = load_model(model, option)
    carried = provenance(COMMAND_LINE.get(), {"model": digest(loaded)}, seed)
    found, interrupted = Verification(), False
    columns = (TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn(), TimeRemainingColumn())
    side = side_console()
    shown = Progress(*columns, console=side, transient=True, disable=not side.is_terminal)
    with compiling_told(), shown as progress:
        task = progress.add_task("comparing", total=beliefs + runs * steps)
        try:
            rng = np.random.default_rng(seed)
            for found in verifications(loaded, beliefs, steps, rng, runs=runs, sparse=sparse):
                progress.update(task, completed=found.beliefs + found.steps)
        except TooLarge as refusal:
            raise TooLarge(f"{refusal}{_way_out(loaded, sparse)}") from refusal
        except KeyboardInterrupt:
            interrupted = True
    content = {**dataclasses.asdict(found), "holds": found.holds, "interrupted": interrupted, **carried}
    answer(content, _shown(found, interrupted), as_json=as_json)
    if interrupted:
        raise typer.Exit(INTERRUPTED)
    if not found.holds:
        raise typer.Exit(1)


def _way_out(model: FactoredPOMDP, sparse: bool) -> str:
    from factored_pomdp import registry

    possible = not sparse and registry.solver("myopic-joint").can_solve(model, sparse=True)
    return "; with --sparse it can be done" if possible else ""


def _shown(found: Verification, interrupted: bool) -> list[RenderableType]:
    rows = table("compared", "found", right=["found"])
    rows.add_row("random beliefs", f"{found.beliefs:,}")
    rows.add_row("steps of simulated runs", f"{found.steps:,}")
    rows.add_row("largest difference of values", f"{found.max_value_difference:.3g}")
    rows.add_row("largest difference of beliefs", f"{found.max_belief_difference:.3g}")
    rows.add_row("decisions worth the joint optimum", f"{found.actions_agree:.2%}")
    rows.add_row("joint solver, seconds", f"{found.joint_seconds:.3f}")
    rows.add_row("decomposition, seconds", f"{found.decomposed_seconds:.3f}")
    verdict = "No difference above rounding." if found.holds else "They differ."
    shown: list[RenderableType] = [rows, ("Interrupted; so far: " if interrupted else "") + verdict]
    if found.first_difference is not None:
        shown.append("First difference:")
        shown += [f"  {key}: {plain(value)}" for key, value in _whole(found).items()]
    return shown


def _whole(found: Verification) -> dict[str, Any]:
    return dataclasses.asdict(found.first_difference) if found.first_difference is not None else {}
