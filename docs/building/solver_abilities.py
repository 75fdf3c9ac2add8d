"""What the installed solvers say of themselves, and of a model: `factored-pomdp solvers MODEL` as a table."""

from __future__ import annotations

import re

from factored_pomdp.registry import domain, solvers

__all__ = ["solver_abilities", "solver_list"]

_HUGE = re.compile(r"\d{1,3}(,\d{3}){4,}|\d(\.\d+)?e\+\d+")


def solver_list() -> str:
    """Markdown table of the installed solvers, each with its summary."""
    rows = [f"| [`{entry.name}`](#{entry.name}) | {entry.summary} |" for entry in solvers()]
    return "\n".join(["| solver | in its own words |", "|---|---|", *rows])


def solver_abilities(name: str, *options: str) -> str:
    """Markdown table of what every installed solver says of a domain's model.

    Parameters
    ----------
    name : str
        Of the domain.
    options : str
        Of the domain, each as ``key=value``.
    """
    model = domain(name, **dict(option.split("=", 1) for option in options))
    rows = []
    for entry in solvers():
        ability = entry.load().can_solve(model)
        told = f"{ability.because} | {ability.estimate}"
        rows.append(f"| `{entry.name}` | {'yes' if ability else 'no'} | {_HUGE.sub(_rounded, told)} |")
    return "\n".join(["| solver | can it | because | cost |", "|---|---|---|---|", *rows])


def _rounded(number: re.Match[str]) -> str:
    mantissa, exponent = f"{float(number[0].replace(',', '')):.1e}".split("e+")
    return f"{mantissa} · 10<sup>{int(exponent)}</sup>"
