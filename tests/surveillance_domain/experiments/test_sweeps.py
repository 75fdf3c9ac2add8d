"""Sweeps that are resumed, and sweeps on a cluster: nothing is done twice, and what comes out is the same."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path

import pytest

from surveillance_domain.experiments.cluster import ClusterError, run_on_cluster
from surveillance_domain.experiments.jobs import blocks, run_jobs
from surveillance_domain.experiments.kept_runs import KeptRuns
from surveillance_domain.experiments.setup import Case, Setup

CASE = Case(Setup("tiny", 2), "pomdp", "grid", 12, 3)
COMPARE = ["surveillance", "compare", "tiny", "--targets", "1", "--controllers", "pomdp,sys", "--steps", "20"]


def command(*arguments: str) -> list[str]:
    """A console script of this environment."""
    script = "import sys; from surveillance_domain.commands import main; main(sys.argv[1:])"
    return [sys.executable, "-c", script, *arguments]


@pytest.mark.example
def test_kept_runs_come_back_and_are_not_missing(tmp_path: Path) -> None:
    done = run_jobs(blocks(CASE, range(3))).runs[CASE]
    kept = KeptRuns(tmp_path / "runs.jsonl")
    run_jobs(blocks(CASE, [0, 2]), tell=kept.keep)
    again = KeptRuns(tmp_path / "runs.jsonl")
    assert again.missing(CASE, range(4)) == [1, 3]
    assert {n: run.percent_obs for n, run in again.of(CASE).items()} == {n: done[n].percent_obs for n in (0, 2)}
    other = Case(Setup("tiny", 2, detection_probability=0.5), "pomdp", "grid", 12, 3)
    assert again.missing(other, range(2)) == [0, 1]


@pytest.mark.example
def test_a_torn_last_line_is_done_again_and_any_other_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "runs.jsonl"
    run_jobs(blocks(CASE, range(2)), tell=KeptRuns(path).keep)
    whole = path.read_text()
    path.write_text(whole[:-40])
    kept = KeptRuns(path)
    assert kept.missing(CASE, range(2)) == [1]
    run_jobs(blocks(CASE, [1]), tell=kept.keep)
    assert KeptRuns(path).missing(CASE, range(2)) == []
    path.write_text(whole.rstrip("\n"))
    run_jobs(blocks(CASE, [2]), tell=KeptRuns(path).keep)
    assert KeptRuns(path).missing(CASE, range(3)) == []
    first, second = whole.splitlines(keepends=True)
    path.write_text(first + second[:-40] + "\n" + second)
    with pytest.raises(ValueError, match=r"runs\.jsonl, line 2: no run"):
        KeptRuns(path)


@pytest.mark.end_to_end
def test_a_sweep_that_is_killed_goes_on_where_it_was(tmp_path: Path) -> None:
    arguments = [*COMPARE[1:], "--runs", "20", "--workers", "1", "--json"]
    whole = subprocess.run(command(*arguments, "--out", str(tmp_path / "whole")), capture_output=True, check=True)
    halved = command(*arguments, "--out", str(tmp_path / "halved"))
    process = subprocess.Popen(halved, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    path = tmp_path / "halved" / "runs.jsonl"
    until = time.monotonic() + 60
    while not (path.is_file() and path.stat().st_size > 2000) and time.monotonic() < until:
        time.sleep(0.005)
    process.send_signal(signal.SIGKILL)
    process.wait()
    before = path.read_text().splitlines()
    assert 0 < len(before) < 40
    again = subprocess.run(halved, capture_output=True, check=True)
    assert b"of 40 runs are kept from before" in again.stderr
    assert b"runs are kept from before" not in whole.stderr
    after = path.read_text().splitlines()
    assert after[: len(before) - 1] == before[:-1]
    runs = [(line["key"], line["run"]) for line in map(json.loads, filter(_is_whole, after))]
    assert len(runs) == len(set(runs)) == 40
    first, second = (json.loads(done.stdout)["rows"] for done in (whole, again))
    assert first == second


def _is_whole(line: str) -> bool:
    return line.endswith("}")


@pytest.fixture
def cluster(tmp_path: Path) -> Iterator[tuple[str, list[subprocess.Popen[bytes]]]]:
    """A scheduler and two workers, processes of their own, on loopback."""
    told = tmp_path / "scheduler.json"
    environment = {**os.environ, "DASK_DISTRIBUTED__WORKER__DAEMON": "False"}
    quiet = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL, "env": environment}
    dask = [sys.executable, "-m", "dask"]
    address = ["--host", "127.0.0.1", "--port", "0", "--no-dashboard"]
    started = [subprocess.Popen([*dask, "scheduler", *address, "--scheduler-file", str(told)], **quiet)]
    until = time.monotonic() + 60
    while not told.is_file() and time.monotonic() < until:
        time.sleep(0.05)
    worker = [*dask, "worker", "--scheduler-file", str(told), "--nthreads", "1", "--no-nanny", "--no-dashboard"]
    started += [subprocess.Popen([*worker, "--local-directory", str(tmp_path)], **quiet) for _ in range(2)]
    try:
        yield json.loads(told.read_text())["address"], started[1:]
    finally:
        for process in started:
            process.kill()
            process.wait()


def _await_workers(address: str, number: int) -> None:
    from distributed import Client

    with Client(address, timeout=30, set_as_default=False) as client:
        client.wait_for_workers(number, timeout=60)


@pytest.mark.end_to_end
@pytest.mark.filterwarnings("ignore")
def test_a_cluster_that_loses_a_worker_gives_what_one_process_gives(cluster) -> None:
    address, workers = cluster
    _await_workers(address, 2)
    case = Case(Setup("tiny", 2), "pomdp", "grid", 40, 3)
    jobs = blocks(case, range(16), size=2)
    killed = []

    def kill_one(batch: object) -> None:
        if not killed:
            workers[0].kill()
            killed.append(workers[0].wait())

    outcome = run_on_cluster(jobs, address, kill_one)
    assert killed == [-signal.SIGKILL]
    assert not outcome.interrupted
    here = run_jobs(jobs).runs[case]
    there = outcome.runs[case]
    assert {n: run.percent_obs for n, run in there.items()} == {n: run.percent_obs for n, run in here.items()}


@pytest.mark.end_to_end
@pytest.mark.filterwarnings("ignore")
def test_no_scheduler_is_one_message(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("surveillance_domain.experiments.cluster._CONNECT_S", 1.0)
    with pytest.raises(ClusterError, match=r"no scheduler at tcp://127\.0\.0\.1:1"):
        run_on_cluster(blocks(CASE, range(1)), "tcp://127.0.0.1:1")


@pytest.mark.example
@pytest.mark.parametrize("address", ["nonsense", "tcp://", "tcp://host", "http//x:1", "http://127.0.0.1:80"])
def test_what_is_no_address_is_refused_before_anybody_is_asked(address: str) -> None:
    with pytest.raises(ClusterError, match="no address of a scheduler: found"):
        run_on_cluster(blocks(CASE, range(1)), address)
