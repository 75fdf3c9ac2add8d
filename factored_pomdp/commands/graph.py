"""``factored-pomdp graph``: a picture of who depends on whom."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from factored_pomdp.commands.answers import COMMAND_LINE, AsJson, answer
from factored_pomdp.commands.model_argument import ModelName, Options, load_model
from factored_pomdp.commands.picture import checked_picture, written_picture

__all__ = ["graph"]


def graph(
    model: ModelName,
    out: Annotated[Path, typer.Option(metavar="PNG|SVG", help="Where to draw it; written as both.")],
    option: Options = None,
    as_json: AsJson = False,
) -> None:
    """Draw a model's graph over two slices: what is known, blocks of one shape in a plate, ties in orange."""
    from factored_pomdp.pictures.graph import draw_graph
    from factored_pomdp.provenance import digest, provenance

    checked_picture("--out", out)
    loaded = load_model(model, option)
    files = written_picture("--out", draw_graph(loaded), out)
    carried = provenance(COMMAND_LINE.get(), {"model": digest(loaded)})
    answer({"written": files, **carried}, [f"{file}: written" for file in files], as_json=as_json)
