"""``factored-pomdp domains``: what is installed."""

from __future__ import annotations

from factored_pomdp.commands.answers import COMMAND_LINE, AsJson, answer, side_console, table

__all__ = ["domains"]


def domains(as_json: AsJson = False) -> None:
    """List the installed domains; a broken plugin is named with its error."""
    from factored_pomdp import registry
    from factored_pomdp.provenance import provenance

    found = registry.domains()
    listed = [{"name": e.name, "summary": e.summary, "distribution": e.distribution, "error": e.error} for e in found]
    shown = table("domain", "what it is", "from")
    for entry in found:
        shown.add_row(entry.name, entry.summary if entry.error is None else "(broken)", entry.distribution)
        if entry.error is not None:
            warning = f"domain {entry.name} ({entry.distribution}) cannot be loaded: {entry.error}"
            side_console().print(warning, style="yellow", soft_wrap=True)
    answer({"domains": listed, **provenance(COMMAND_LINE.get(), {})}, [shown], as_json=as_json)
