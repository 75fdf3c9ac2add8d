"""``factored-pomdp convert``: between the formats of model files."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from factored_pomdp.commands.answers import COMMAND_LINE, AsJson, InputError, answer, side_console
from factored_pomdp.commands.model_argument import ModelName, Options, load_model

__all__ = ["convert"]


def convert(
    model: ModelName,
    out: Annotated[Path, typer.Argument(metavar="OUT", help="The file to write, ending with .pomdp or .pomdpx.")],
    option: Options = None,
    as_json: AsJson = False,
) -> None:
    """Write a model to a .pomdpx file (which keeps variables and factors) or a .pomdp file (flat)."""
    from factored_pomdp.errors import TooLarge
    from factored_pomdp.files import ENDINGS, save
    from factored_pomdp.provenance import digest, provenance

    if out.suffix.lower() not in ENDINGS:
        raise InputError(f"{out}: expected a name that ends with {' or '.join(ENDINGS)}")
    loaded = load_model(model, option)
    for note in loaded.notes:
        side_console().print(f"note: {note}", style="yellow", soft_wrap=True)
    try:
        save(loaded, out)
    except TooLarge:
        raise
    except OSError as problem:
        raise InputError(f"{out}: {problem.strerror or problem}") from problem
    except ValueError as problem:
        raise InputError(str(problem)) from problem
    carried = provenance(COMMAND_LINE.get(), {"model": digest(loaded)})
    answer({"written": str(out), **carried}, [f"{out}: written"], as_json=as_json)
