"""``factored-pomdp decompose``: blocks, or what ties them."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import typer

from factored_pomdp.commands.answers import COMMAND_LINE, AsJson, answer, plain
from factored_pomdp.commands.model_argument import ModelName, Options, load_model

if TYPE_CHECKING:
    from factored_pomdp.decomposition import Certificate, Tie

__all__ = ["decompose"]


def decompose(model: ModelName, option: Options = None, as_json: AsJson = False) -> None:
    """Say whether a model falls apart into independent blocks, and if not, what ties it together (exit code 1)."""
    from factored_pomdp import decomposition
    from factored_pomdp.provenance import digest, provenance

    loaded = load_model(model, option)
    certificate = decomposition.decompose(loaded)
    content = {
        "decomposes": certificate.decomposes,
        "known": certificate.known,
        "blocks": certificate.blocks,
        "ties": [_tie(tie) for tie in certificate.ties],
        "speaks_of": certificate.speaks_of,
        **provenance(COMMAND_LINE.get(), {"model": digest(loaded)}),
    }
    answer(content, _lines(certificate), as_json=as_json)
    if not certificate.decomposes:
        raise typer.Exit(1)


def _tie(tie: Tie) -> dict[str, Any]:
    return {
        "factor": tie.factor,
        "kind": tie.kind,
        "joins": tie.joins,
        "counterexample": tie.counterexample,
        "because": tie.because,
    }


def _lines(certificate: Certificate) -> list[str]:
    lines = [str(certificate)]
    for tie in certificate.ties:
        if tie.counterexample is not None:
            lines.append(f"\ncounterexample ({tie.factor}):")
            lines += [f"  {key}: {plain(value)}" for key, value in tie.counterexample.items()]
    return lines
