"""What is said while loops are compiled, which happens once on a machine."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

from factored_pomdp.commands.answers import side_console

__all__ = ["compiling_told"]


@contextmanager
def compiling_told() -> Iterator[None]:
    """Say so on standard error when the first loop is compiled; nothing where all are found compiled."""
    from numba.core import event

    class Told(event.Listener):
        """Waits for the first loop."""

        waits = True

        def on_start(self, event: Any) -> None:
            """A loop was not found on disk."""
            if self.waits:
                self.waits = False
                side_console().print("compiling loops, once on this machine …", soft_wrap=True)

        def on_end(self, event: Any) -> None:
            """Its end is not told: the others follow."""

    with event.install_listener("numba:compile", Told()):
        yield
