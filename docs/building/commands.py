"""The reference of a command, read off the program itself."""

from __future__ import annotations

from typing import Any
from unittest import mock

import typer
from typer.cli import get_docs_for_click

__all__ = ["command_reference", "group_of"]


def group_of(program: str) -> Any:
    """The group of subcommands behind an installed program: what its typer application holds when it is started."""
    from importlib.metadata import entry_points

    (script,) = entry_points(group="console_scripts", name=program)
    started: list[typer.Typer] = []
    with mock.patch.object(typer.Typer, "__call__", lambda application, **_: started.append(application)):
        script.load()([])
    return typer.main.get_command(started[0])


def command_reference(program: str) -> str:
    """Markdown: every subcommand with what it does, its usage, its arguments and its options."""
    group = group_of(program)
    context = group.make_context(program, [], resilient_parsing=True)
    commands = (group.get_command(context, name) for name in group.list_commands(context))
    described = (get_docs_for_click(obj=one, ctx=context, indent=1, call_prefix=program) for one in commands)
    return "\n\n".join([group.help, *described])
