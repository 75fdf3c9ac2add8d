"""The main job in a few minutes: ``python -m surveillance_domain.commands.demo --out out/demo``.

Verifies the decomposition against brute force on the site tiny, compares all controllers on the hall, lets the paper's
controller run on a real-map site (a ROS map_server file), and leaves pictures and tables with a page that shows them.
"""

from __future__ import annotations

import argparse
import dataclasses
import os
import shlex
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from factored_pomdp.commands.answers import COMMAND_LINE, INTERRUPTED, InputError, side_console

if TYPE_CHECKING:
    from factored_pomdp.verification import Verification

__all__ = ["EXAMPLE", "demo", "main"]

EXAMPLE = Path(__file__).parents[2] / "examples" / "office" / "office.toml"


@dataclasses.dataclass(frozen=True)
class Size:
    """How much the demonstration does."""

    beliefs: int = 20
    runs: int = 12
    targets: tuple[int, ...] = (1, 5, 10, 20)
    steps: int = 100
    office_runs: int = 5
    seed: int = 0


def main(arguments: Sequence[str] | None = None) -> None:
    """Run from the command line; raises ``SystemExit`` with 0, 1 (verification failed), 2 (wrong input) or 130."""
    parser = argparse.ArgumentParser(prog="python -m surveillance_domain.commands.demo", description=__doc__)
    parser.add_argument("--out", type=Path, default=Path("out/demo"), help="folder for everything that is made")
    parser.add_argument("--workers", type=int, help="processes; default: as many as there are processors")
    parser.add_argument("--small", action="store_true", help="a few seconds' worth, to see that all is in place")
    given = parser.parse_args(arguments)
    words = sys.argv[1:] if arguments is None else arguments
    token = COMMAND_LINE.set(shlex.join(["python", "-m", "surveillance_domain.commands.demo", *words]))
    size = Size(beliefs=2, runs=2, targets=(1, 2), steps=10, office_runs=1) if given.small else Size()
    try:
        holds = demo(given.out, size, given.workers)
    except InputError as problem:
        side_console().print(str(problem), style="bold red", soft_wrap=True)
        raise SystemExit(2) from None
    except KeyboardInterrupt:
        side_console().print(f"Interrupted. What was finished stands in {given.out}")
        raise SystemExit(INTERRUPTED) from None
    finally:
        COMMAND_LINE.reset(token)
    raise SystemExit(0 if holds else 1)


def demo(out: Path, size: Size, workers: int | None = None) -> bool:
    """Do it all, and say whether the decomposition was verified.

    Raises
    ------
    InputError
        If the folder cannot be written, or the example site is not there.
    KeyboardInterrupt
        Parts that were finished stand in the folder.
    """
    from surveillance_domain.commands.demo_page import write_page
    from surveillance_domain.commands.folder import ready_folder
    from surveillance_domain.commands.options import processors

    if not EXAMPLE.exists():
        raise InputError(
            f"no example site at {EXAMPLE}: the demonstration needs the folder examples/ of the repository, which an "
            "installed package does not hold; run it in a clone"
        )
    ready_folder(out)
    workers = workers or processors()
    console = side_console()
    console.print(
        f"1 of 4  Verify: brute force against the decomposition, site tiny, 2 targets, {size.beliefs} beliefs"
    )
    verified = _verify(out / "verify", size)
    verdict = "no difference above rounding" if verified.holds else "THEY DIFFER"
    console.print(
        f"        {verdict}: values within {verified.max_value_difference:.1e}, beliefs within "
        f"{verified.max_belief_difference:.1e}; {verified.joint_seconds:.1f} s by brute force, "
        f"{verified.decomposed_seconds:.3f} s decomposed"
    )
    console.print(f"2 of 4  Compare: all controllers on the hall, {size.runs} runs each")
    hall = _compare(out / "hall", size, workers)
    console.print(f"3 of 4  Simulate: controller P on a real map, {EXAMPLE.stem}, with an animation")
    office = _simulate(out / "office", size, workers)
    console.print("4 of 4  Draw what the cameras cover")
    _coverage(out / "coverage")
    page = write_page(out, verified, hall, office)
    console.print(f"Done. Everything is in {out}; begin with {page}")
    return verified.holds


def _verify(out: Path, size: Size) -> Verification:
    import numpy as np

    from factored_pomdp.provenance import digest, provenance
    from factored_pomdp.registry import domain
    from factored_pomdp.verification import Verification, verifications
    from surveillance_domain.commands.folder import PROVENANCE, ready_folder, whole_folder, write_json
    from surveillance_domain.commands.progress import progress_bar

    model = domain("surveillance", site="tiny", targets=2)
    found = Verification()
    with progress_bar("verifying", size.beliefs) as advance:
        for so_far in verifications(model, size.beliefs, 0, np.random.default_rng(size.seed)):
            found = so_far
            advance(1)
    carried = provenance(COMMAND_LINE.get(), {"model": digest(model)}, size.seed)
    with whole_folder(ready_folder(out)) as folder:
        write_json(folder / "result.json", {**dataclasses.asdict(found), "holds": found.holds, **carried})
        write_json(folder / PROVENANCE, carried)
    return found


def _compare(out: Path, size: Size, workers: int) -> dict[str, Any]:
    from surveillance_domain.commands.compare import compared
    from surveillance_domain.commands.comparison_answer import comparison_content, comparison_tables, write_comparison
    from surveillance_domain.commands.folder import ready_folder
    from surveillance_domain.control.factory import COMPARED
    from surveillance_domain.experiments.comparison import Plan
    from surveillance_domain.experiments.setup import Setup, check_setup

    site = check_setup(Setup("hall", 1), COMPARED)
    setups = tuple(Setup("hall", count) for count in size.targets)
    plan = Plan(setups, COMPARED, "grid", size.steps, size.seed)
    outcome = compared(plan, size.runs, workers)
    names, inputs = {"hall": site.name}, {site.name: f"sha256:{site.digest}"}
    content = comparison_content(plan, size.runs, outcome, names, COMMAND_LINE.get(), inputs)
    write_comparison(ready_folder(out), plan, outcome, names, content)
    if outcome.interrupted:
        raise KeyboardInterrupt
    for part in comparison_tables(plan, outcome, names):
        side_console().print(part)
    return content


def _simulate(out: Path, size: Size, workers: int) -> dict[str, Any]:
    from surveillance_domain.commands.folder import ready_folder
    from surveillance_domain.commands.simulate import simulated
    from surveillance_domain.experiments.setup import Case, Setup

    case = Case(Setup(os.path.relpath(EXAMPLE), 5), "pomdp", "continuous", size.steps, size.seed)
    content, interrupted = simulated(case, size.office_runs, ready_folder(out), workers)
    if interrupted:
        raise KeyboardInterrupt
    return content


def _coverage(out: Path) -> None:
    from factored_pomdp.provenance import provenance
    from surveillance_domain.commands.folder import PROVENANCE, ready_folder, whole_folder, write_json
    from surveillance_domain.model.views import build_views
    from surveillance_domain.pictures.coverage import draw_coverage
    from surveillance_domain.pictures.style import save_figure
    from surveillance_domain.site.load import load_site

    inputs = {}
    with whole_folder(ready_folder(out)) as folder:
        for name in ("hall", EXAMPLE):
            site = load_site(name)
            save_figure(draw_coverage(site, build_views(site)), folder / f"{site.name}.png")
            inputs[site.name] = f"sha256:{site.digest}"
        write_json(folder / PROVENANCE, provenance(COMMAND_LINE.get(), inputs))


if __name__ == "__main__":
    main()
