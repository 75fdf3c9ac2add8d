"""What the figures were measured on: a ratio to numpy is a ratio to the BLAS kernel that numpy chose."""

from __future__ import annotations

import ctypes
import os
import platform
from pathlib import Path
from typing import Any

import numba
import numpy as np
import scipy

__all__ = ["machine", "peak_bytes"]


def machine() -> dict[str, Any]:
    """Processor, versions, BLAS kernel and threads."""
    kernel, threads = _openblas()
    return {
        "processor": _processor(),
        "cores": os.cpu_count(),
        "load": round(os.getloadavg()[0], 1) if hasattr(os, "getloadavg") else None,
        "python": platform.python_version(),
        "numpy": np.__version__,
        "scipy": scipy.__version__,
        "numba": numba.__version__,
        "blas": np.show_config(mode="dicts")["Build Dependencies"]["blas"]["name"],
        "blas_kernel": kernel,
        "blas_threads": threads,
        "OPENBLAS_CORETYPE": os.environ.get("OPENBLAS_CORETYPE"),
    }


def peak_bytes() -> int:
    """Most memory that this process has held; getrusage would count what its parent held when it was forked."""
    status = Path("/proc/self/status").read_text(encoding="utf-8")
    held = next(line for line in status.splitlines() if line.startswith("VmHWM:"))
    return 1024 * int(held.split()[1])


def _processor() -> str:
    try:
        lines = Path("/proc/cpuinfo").read_text().splitlines()
    except OSError:
        return platform.processor() or platform.machine()
    return next((line.split(":", 1)[1].strip() for line in lines if line.startswith("model name")), platform.machine())


def _openblas() -> tuple[str | None, int | None]:
    """Kernel and threads of the OpenBLAS that numpy's wheels carry; ``None`` where numpy uses another library."""
    folder = Path(np.__file__).parent
    for path in [*folder.parent.glob("numpy.libs/*openblas*"), *folder.glob(".dylibs/*openblas*")]:
        library = ctypes.CDLL(str(path))
        for ending in ("64_", ""):
            try:
                name = getattr(library, f"scipy_openblas_get_corename{ending}")
                threads = getattr(library, f"scipy_openblas_get_num_threads{ending}")
            except AttributeError:
                continue
            name.restype = ctypes.c_char_p
            return name().decode(), int(threads())
    return None, None
