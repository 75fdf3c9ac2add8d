"""Runs on a Dask cluster, when one machine is not enough; what comes out is the same.

Workers need this package in the same version, and site files at the same paths. A job whose worker is lost is done
again by another.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from importlib.metadata import version
from typing import Any

from surveillance_domain.experiments.jobs import Finished, Job, Outcome, do_job, side_by_side

__all__ = ["ClusterError", "run_on_cluster"]

_CONNECT_S = 10.0
_ADDRESS = r"((tcp|tls|wss?|ucx)://)?(\[[0-9a-fA-F:]+\]|[^:/\s]+):\d+"


class ClusterError(RuntimeError):
    """The cluster cannot be used; the message says why."""


def run_on_cluster(
    jobs: Sequence[Job], address: str, tell: Callable[[Sequence[Finished]], None] | None = None
) -> Outcome:
    """Do the jobs on the workers of a scheduler.

    Parameters
    ----------
    address : str
        Such as ``tcp://10.0.0.1:8786``.
    tell : callable, optional
        Told of finished runs as they come in, in any order.

    Raises
    ------
    ClusterError
        If there is no scheduler, no worker, another version, or a job that failed.
    """
    try:
        from distributed import Client, as_completed
    except ModuleNotFoundError:
        raise ClusterError("a cluster needs Dask: pip install 'factored-pomdp[cluster]'") from None
    if not re.fullmatch(_ADDRESS, address):
        raise ClusterError(f"no address of a scheduler: found {address!r}, expected such as tcp://10.0.0.1:8786")
    try:
        client = Client(address, timeout=_CONNECT_S, set_as_default=False)
    except (OSError, ValueError, TimeoutError) as problem:
        raise ClusterError(f"no scheduler at {address}: {problem or type(problem).__name__}") from None
    found: dict[Any, Any] = {job.case: {} for job in jobs}
    with client, client.as_current():
        _refuse_other_versions(client, address)
        futures = client.map(do_job, side_by_side(jobs), pure=False, retries=2)
        try:
            for future in as_completed(futures):
                try:
                    batch = future.result()
                except Exception as problem:
                    raise ClusterError(f"a job failed on {address}: {problem}") from problem
                for one in batch:
                    found[one.case][one.number] = one.run
                if tell is not None:
                    tell(batch)
                future.release()
        except KeyboardInterrupt:
            return Outcome(found, interrupted=True)
        finally:
            client.cancel(futures)
    return Outcome(found)


def _refuse_other_versions(client: Any, address: str) -> None:
    try:
        versions = set(client.run(_version).values())
    except Exception as problem:
        raise ClusterError(f"the workers of {address} cannot run factored-pomdp: {problem}") from None
    if not versions:
        raise ClusterError(f"the scheduler at {address} has no workers: start some with `dask worker {address}`")
    if versions != {_version()}:
        raise ClusterError(f"workers of {address} have version {', '.join(sorted(versions))}; here it is {_version()}")


def _version() -> str:
    return version("factored-pomdp")
