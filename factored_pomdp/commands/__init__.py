"""The ``factored-pomdp`` command: one file a subcommand; nothing heavy is loaded before a subcommand runs."""

from __future__ import annotations

import shlex
import sys
from collections.abc import Sequence

__all__ = ["main"]


def main(arguments: Sequence[str] | None = None) -> None:
    """Run the command; raises ``SystemExit`` with 0 (done), 1 (the answer is no), 2 (wrong input) or 130 (Ctrl-C)."""
    import typer

    from factored_pomdp.commands import answers
    from factored_pomdp.commands.convert import convert
    from factored_pomdp.commands.decompose import decompose
    from factored_pomdp.commands.domains import domains
    from factored_pomdp.commands.graph import graph
    from factored_pomdp.commands.info import info
    from factored_pomdp.commands.new_domain import new_domain
    from factored_pomdp.commands.simulate import simulate
    from factored_pomdp.commands.solve import solve
    from factored_pomdp.commands.solvers import solvers
    from factored_pomdp.commands.verify import verify

    application = typer.Typer(
        name="factored-pomdp",
        help="Factored POMDPs: look at a model, ask whether it decomposes, check the answer against brute force.",
        no_args_is_help=True,
        add_completion=False,
        pretty_exceptions_enable=False,
        context_settings={"help_option_names": ["-h", "--help"]},
    )
    for command in (domains, info, decompose, verify, graph, solvers, solve, simulate, convert, new_domain):
        application.command()(answers.guarded(command))
    given = list(sys.argv[1:] if arguments is None else arguments)
    token = answers.COMMAND_LINE.set(shlex.join(["factored-pomdp", *given]))
    try:
        application(args=given, prog_name="factored-pomdp")
    finally:
        answers.COMMAND_LINE.reset(token)
