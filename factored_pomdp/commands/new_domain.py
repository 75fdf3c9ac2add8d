"""``factored-pomdp new-domain``: a plugin to start from."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from factored_pomdp.commands.answers import COMMAND_LINE, AsJson, InputError, answer

__all__ = ["new_domain"]


def new_domain(
    name: Annotated[str, typer.Argument(metavar="NAME", help="Of the domain and its distribution, such as my-domain.")],
    into: Annotated[Path, typer.Option(metavar="DIR", help="The folder to make it in.")] = Path(),
    as_json: AsJson = False,
) -> None:
    """Write a working distribution with a small domain: module, entry point, test, README."""
    from factored_pomdp import scaffold
    from factored_pomdp.provenance import provenance

    wrong = scaffold.wrong_with(name)
    if not into.is_dir():
        wrong.append(f"--into {into}: there is no such folder")
    if wrong:
        raise InputError("; ".join(wrong))
    try:
        files = scaffold.new_distribution(name, into)
    except FileExistsError as problem:
        raise InputError(f"{problem}; expected a name that is free in {into}") from problem
    except OSError as problem:
        raise InputError(f"--into {into}: {problem.strerror or problem}") from problem
    folder = into / name
    lines = [f"{folder}: written", *(f"  {file.relative_to(folder)}" for file in files)]
    lines.append(f"Next: pip install -e {folder}, then factored-pomdp info {name}")
    listed = [str(file) for file in files]
    answer({"written": str(folder), "files": listed, **provenance(COMMAND_LINE.get(), {})}, lines, as_json=as_json)
