"""The ``surveillance`` command: one file a subcommand; nothing heavy is loaded before a subcommand runs."""

from __future__ import annotations

import shlex
import sys
from collections.abc import Sequence

__all__ = ["main"]


def main(arguments: Sequence[str] | None = None) -> None:
    """Run the command; raises ``SystemExit`` with 0 (done), 1 (no), 2 (wrong input) or 130 (Ctrl-C)."""
    import typer

    from factored_pomdp.commands.answers import COMMAND_LINE, guarded
    from surveillance_domain.commands.add_preset import add_preset
    from surveillance_domain.commands.calibrate import calibrate
    from surveillance_domain.commands.compare import compare
    from surveillance_domain.commands.coverage import coverage
    from surveillance_domain.commands.doctor import doctor
    from surveillance_domain.commands.emulate import emulate
    from surveillance_domain.commands.hold import hold
    from surveillance_domain.commands.learn import learn
    from surveillance_domain.commands.park import park
    from surveillance_domain.commands.replay import replay
    from surveillance_domain.commands.replay_run import replay_run
    from surveillance_domain.commands.report import report
    from surveillance_domain.commands.run import run
    from surveillance_domain.commands.simulate import simulate

    application = typer.Typer(
        name="surveillance",
        help="Pan/tilt/zoom cameras that watch moving targets: simulate, compare controllers, see what is covered.",
        no_args_is_help=True,
        add_completion=False,
        pretty_exceptions_enable=False,
        context_settings={"help_option_names": ["-h", "--help"]},
    )
    for command in (
        simulate,
        compare,
        coverage,
        learn,
        replay,
        run,
        emulate,
        calibrate,
        add_preset,
        doctor,
        hold,
        park,
        report,
        replay_run,
    ):
        application.command()(guarded(command))
    given = list(sys.argv[1:] if arguments is None else arguments)
    token = COMMAND_LINE.set(shlex.join(["surveillance", *given]))
    try:
        application(args=given, prog_name="surveillance")
    finally:
        COMMAND_LINE.reset(token)
