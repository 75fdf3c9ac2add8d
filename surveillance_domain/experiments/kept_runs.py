"""Finished runs on disk: one line of JSON each, keyed by everything that a run depends on.

A sweep that was killed goes on from here: what stands in the file is not simulated again. Lines are written whole, and
a last line that was torn by a kill is taken off.
"""

from __future__ import annotations

import hashlib
import json
import os
from collections.abc import Iterable, Sequence
from dataclasses import asdict
from importlib.metadata import version
from pathlib import Path

from surveillance_domain.experiments.jobs import Finished
from surveillance_domain.experiments.runs import Run
from surveillance_domain.experiments.setup import Case, site_of

__all__ = ["KeptRuns"]


class KeptRuns:
    """The runs in a file, which is made when the first one is kept.

    Parameters
    ----------
    path : Path

    Raises
    ------
    ValueError
        Where a line that is not the last one is no run; it names file and line.
    """

    def __init__(self, path: Path) -> None:
        self._path = path
        self._runs: dict[str, dict[int, Run]] = {}
        self._keys: dict[Case, str] = {}
        if path.is_file():
            self._read()

    def of(self, case: Case) -> dict[int, Run]:
        """Runs of a case that are there, by number."""
        return dict(self._runs.get(self._key(case), {}))

    def missing(self, case: Case, numbers: Iterable[int]) -> list[int]:
        """Which of some runs are not there."""
        found = self._runs.get(self._key(case), {})
        return [number for number in numbers if number not in found]

    def keep(self, batch: Sequence[Finished]) -> None:
        """Add runs; they are on disk when this comes back."""
        lines = []
        for one in batch:
            key = self._key(one.case)
            self._runs.setdefault(key, {})[one.number] = one.run
            told = {"key": key, "case": asdict(one.case), "run": one.number, **asdict(one.run)}
            lines.append(json.dumps(told, ensure_ascii=False) + "\n")
        with self._path.open("a", encoding="utf-8") as file:
            file.write("".join(lines))
            file.flush()
            os.fsync(file.fileno())

    def _read(self) -> None:
        content = self._path.read_bytes()
        lines = content.splitlines(keepends=True)
        for number, line in enumerate(lines, 1):
            try:
                told = json.loads(line)
                run = Run(told["percent_obs"], tuple(told["decision_ms"]), told["restarts"])
                self._runs.setdefault(told["key"], {})[told["run"]] = run
            except (ValueError, KeyError, TypeError):
                if number < len(lines):
                    raise ValueError(
                        f"{self._path}, line {number}: no run; remove the line, or the file to begin anew"
                    ) from None
                os.truncate(self._path, len(content) - len(line))
                return
        if content and not content.endswith(b"\n"):
            with self._path.open("ab") as file:
                file.write(b"\n")

    def _key(self, case: Case) -> str:
        """Digest of the case, of its site file's content, and of the program's version."""
        if case not in self._keys:
            told = asdict(case)
            told["setup"]["site"] = site_of(case.setup).digest
            told["version"] = version("factored-pomdp")
            self._keys[case] = hashlib.sha256(json.dumps(told, sort_keys=True).encode()).hexdigest()[:32]
        return self._keys[case]
