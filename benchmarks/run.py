"""``make bench``: how fast, how it grows, and beside what else could have been used.

``python -m benchmarks.run`` runs every benchmark and prints its table; ``--only NAME`` one of them, ``--quick`` smaller
sizes, ``--json`` one object on standard output. Exit code 1: an aim was missed.
"""

from __future__ import annotations

import argparse
import json
import shlex
import sys
from collections.abc import Callable, Sequence
from dataclasses import asdict
from importlib import import_module
from typing import Any

from benchmarks.report import Report

__all__ = ["BENCHMARKS", "main", "show"]

BENCHMARKS = (
    "growth", "rivals", "exponential", "elimination", "large_map", "planners", "exact", "detection", "control_step",
)  # fmt: skip
_WIDTH = 160
"""Columns of text where the output goes to a file."""
_CAVEAT = "numpy's own speed depends on its BLAS kernel: set OPENBLAS_CORETYPE to compare with another one"


def main(arguments: Sequence[str] | None = None) -> int:
    """Run what was asked for; 0 if all aims were met."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.run", description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--quick", action="store_true", help="smaller sizes and fewer repeats")
    parser.add_argument("--json", action="store_true", help="one JSON object on standard output")
    parser.add_argument("--only", choices=BENCHMARKS, metavar="NAME", help=f"one of {', '.join(BENCHMARKS)}")
    parser.add_argument("--seed", type=int, default=0)
    chosen = parser.parse_args(arguments)
    from benchmarks.machine import machine
    from factored_pomdp.provenance import provenance

    measured_on = machine()
    reports: dict[str, Report] = {}
    for name in [chosen.only] if chosen.only else BENCHMARKS:
        print(f"{name} ...", file=sys.stderr, flush=True)
        benchmark: Callable[[bool, int], Report] = getattr(import_module(f"benchmarks.{name}"), name)
        reports[name] = benchmark(chosen.quick, chosen.seed)
        if not chosen.json:
            show(reports[name])
    aims = [{**asdict(aim), "met": aim.met} for report in reports.values() for aim in report.aims]
    if chosen.json:
        typed = list(arguments) if arguments is not None else sys.argv[1:]
        answer: dict[str, Any] = provenance(shlex.join(["python -m benchmarks.run", *typed]), {}, chosen.seed)
        answer |= {"machine": measured_on, "quick": chosen.quick, "aims": aims}
        print(json.dumps(answer | {name: report.figures for name, report in reports.items()}))
    else:
        print(", ".join(f"{key} {value}" for key, value in measured_on.items() if value is not None))
        print(_CAVEAT)
    return 0 if all(aim["met"] for aim in aims) else 1


def show(report: Report) -> None:
    """Print a benchmark's table, notes and aims."""
    from rich.console import Console
    from rich.table import Table

    console = Console(soft_wrap=True, width=None if sys.stdout.isatty() else _WIDTH)
    table = Table(*report.columns, title=report.title, title_justify="left")
    for row in report.rows:
        table.add_row(*row)
    console.print(table)
    for note in report.notes:
        console.print(note, highlight=False)
    for aim in report.aims:
        side, verdict = ("≥" if aim.at_least else "≤"), ("met" if aim.met else "NOT MET")
        console.print(f"{aim.name}: {aim.figure:,.3g} (aim {side} {aim.limit:,g}): {verdict}", highlight=False)
    console.print()


if __name__ == "__main__":
    sys.exit(main())
