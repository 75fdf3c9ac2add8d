"""Make the pages of results anew: results.md, results-sensitivity.md and results-people.md.

``python benchmarks/results.py`` is the quick form, minutes of work, and leaves them in out/results/quick; ``--full``
makes the published ones, in docs. All runs stand in CSV files in the folder figures beside the pages; pages and figures
are made from those alone, so ``--only pages`` writes the published ones again without simulating. Finished runs are
kept in out/results: what was interrupted goes on from there. Remove that folder after a change of the program that
changes runs.
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

import results_myopia_text
import results_pictures_text
from results_figures import draw_figures
from results_people import PEOPLE, SCENES, learn_and_watch, missing
from results_people_figures import draw_people
from results_people_text import page as people_page
from results_people_text import read_people
from results_plan import Extent, comparison, rows
from results_runs import simulated
from results_sensitivity import SENSITIVITY, read_slices, variants
from results_sensitivity import rows as sensitivity_rows
from results_sensitivity_figures import draw_sensitivity
from results_sensitivity_text import FULL_RUNS as FEW_RUNS
from results_sensitivity_text import page as sensitivity_page
from results_table import RUNS, Key, Results, write_rows, write_text
from results_text import FULL_RUNS, page

from surveillance_domain.commands.options import processors
from surveillance_domain.experiments.kept_runs import KeptRuns

QUICK_RUNS = 4
PROJECT = Path(__file__).parents[1]
DOCS, QUICK = PROJECT / "docs", PROJECT / "out" / "results" / "quick"
TRAJECTORIES = PROJECT.parent / "shared" / "data" / "trajectories"
EXTENT = Extent()
SECTIONS = (results_myopia_text.section, results_pictures_text.section)
"""Of others, at the end of docs/results.md; empty where their data is not there."""


def main() -> None:
    """Simulate, and write the pages."""
    given = _arguments()
    out = given.out or (DOCS if given.full or given.only == "pages" else QUICK)
    figures = out / "figures"
    for folder in (figures, given.work):
        folder.mkdir(parents=True, exist_ok=True)
    runs = given.runs or (FULL_RUNS if given.full else QUICK_RUNS)
    kept = KeptRuns(given.work / "runs.jsonl")
    if given.only in (None, "comparison"):
        cases = list(comparison(EXTENT, given.seed, runs, min(runs, FEW_RUNS)))
        found = rows(simulated(cases, given.workers, kept))
        write_rows(figures / RUNS, [*Key._fields, "percent", "restarts"], found)
    if given.only in (None, "sensitivity"):
        made = list(variants(EXTENT, given.work, given.seed, min(runs, FEW_RUNS)))
        done = simulated([wanted for _, wanted in made], given.workers, kept)
        names = {case: changed for changed, (case, _) in made}
        heads = ["parameter", "value", *Key._fields, "percent", "restarts"]
        write_rows(figures / SENSITIVITY, heads, sensitivity_rows(names, done))
    if given.only in (None, "people"):
        absent = missing(SCENES, TRAJECTORIES)
        if absent:
            print(f"No {' or '.join(map(str, absent))}: recorded people stay as they are", file=sys.stderr)
        else:
            learn_and_watch(SCENES, TRAJECTORIES, figures, given.seed, None if given.full else runs)
    _write_pages(out, figures)


def _write_pages(out: Path, figures: Path) -> None:
    """Every page whose data is there."""
    if (figures / RUNS).exists():
        results = Results.read(figures / RUNS)
        draw_figures(results, figures)
        sections = [section(figures) for section in SECTIONS]
        write_text(out / "results.md", "\n".join([page(results), *filter(None, sections)]))
        if (figures / SENSITIVITY).exists():
            slices = read_slices(figures, results)
            draw_sensitivity(results, slices, figures)
            write_text(out / "results-sensitivity.md", sensitivity_page(results, slices))
    if (figures / PEOPLE).exists():
        people = read_people(figures)
        draw_people(people, SCENES, figures)
        write_text(out / "results-people.md", people_page(people, SCENES))
    print(f"Written: the pages in {out} and the figures in {figures}")


def _arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--full", action="store_true", help=f"{FULL_RUNS} runs a point instead of {QUICK_RUNS}")
    parser.add_argument("--runs", type=int, help="another number of runs")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--workers", type=int, default=processors())
    parser.add_argument(
        "--out", type=Path, help="folder for the pages and figures/: docs with --full, else out/results/quick"
    )
    parser.add_argument("--work", type=Path, default=PROJECT / "out" / "results", help="folder for finished runs")
    parser.add_argument(
        "--only", choices=("comparison", "sensitivity", "people", "pages"), help="one part, the rest as it stands"
    )
    return parser.parse_args()


if __name__ == "__main__":
    main()
