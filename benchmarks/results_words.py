"""How pages of results put numbers: paragraphs, tables, differences, verdicts."""

from __future__ import annotations

import textwrap
from collections.abc import Iterable, Mapping, Sequence

from surveillance_domain.experiments.estimates import Estimate

VERDICTS = {1: "holds", 0: "undecided", -1: "**fails**"}


def fill(text: str) -> str:
    """A paragraph in lines of equal length."""
    return textwrap.fill(" ".join(text.split()), 118, break_long_words=False, break_on_hyphens=False)


def table(heads: Sequence[str], rows: Iterable[Sequence[object]], left: int) -> str:
    """A table; the first ``left`` columns are set flush left, the others, numbers, flush right."""
    lines = [heads, *rows]
    made = ["| " + " | ".join(map(str, line)) + " |" for line in lines]
    made.insert(1, "|" + "---|" * left + "---:|" * (len(heads) - left))
    return "\n".join(made)


def signed(found: Estimate) -> str:
    """A difference and half of its interval."""
    return f"{found.mean:+.1f} ± {found.half_width:.1f}"


def unsigned(found: Estimate) -> str:
    """A mean and half of its interval."""
    return f"{found.mean:.1f} ± {found.half_width:.1f}"


def judged(found: Estimate) -> str:
    """Whether a difference is above zero, with it."""
    return f"{VERDICTS[found.verdict]} ({found.mean:+.1f})"


def judged_at(found: Mapping[int, Estimate]) -> str:
    """For which numbers of targets differences are above zero, for which not, and from where to where they go."""
    told = {
        word: [count for count, one in found.items() if one.verdict == verdict] for verdict, word in VERDICTS.items()
    }
    means = [one.mean for one in found.values()]
    said = "; ".join(f"{word}: m = {spans(counts)}" for word, counts in told.items() if counts)
    if len(found) > 1 and list(found) in told.values():
        said = said.partition(":")[0]
    return f"{said} ({min(means):+.1f} to {max(means):+.1f})"


def words(parts: Iterable[str]) -> str:
    """Words in a row, the last two joined by *and*."""
    *first, last = parts
    return f"{', '.join(first)} and {last}" if first else last


def spans(numbers: Iterable[int]) -> str:
    """Whole numbers that grow, three and more that follow on each other as a span: *1–3, 5 and 6*."""
    runs: list[list[int]] = []
    for number in numbers:
        if runs and number == runs[-1][-1] + 1:
            runs[-1].append(number)
        else:
            runs.append([number])
    parts = ([f"{run[0]}–{run[-1]}"] if len(run) > 2 else map(str, run) for run in runs)
    return words(part for of in parts for part in of)


def made_by(runs: int, full: int, seed: int) -> str:
    """The command that makes so many runs, and how many its full form makes."""
    made, form, more = (" FULL=1", "--full", "") if runs >= full else ("", f"--runs {runs}", f"; FULL=1 makes {full}")
    seeded = f" --seed {seed}" if seed else ""
    return f"Made by `make results{made}` (`python benchmarks/results.py {form}{seeded}`{more})"
