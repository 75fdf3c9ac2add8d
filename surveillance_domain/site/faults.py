"""What is wrong with a site, and the one error that says all of it."""

from __future__ import annotations

from dataclasses import dataclass

__all__ = ["Fault", "SiteError"]


@dataclass(frozen=True)
class Fault:
    """One thing that is wrong.

    Attributes
    ----------
    where : str
        Key path in the site file, such as ``cameras[1].presets[0].pan``; empty for the file as a whole.
    found : str
        What stands there.
    expected : str
        What would be right.
    """

    where: str
    found: str
    expected: str

    def __str__(self) -> str:
        place = f"{self.where}: " if self.where else ""
        return f"{place}found {self.found}; expected {self.expected}"


class SiteError(ValueError):
    """A site that cannot be used; ``faults`` holds everything that is wrong with it, ``source`` the file or name."""

    def __init__(self, source: str, faults: tuple[Fault, ...]) -> None:
        self.source = source
        self.faults = faults
        super().__init__(source, faults)

    def __str__(self) -> str:
        if len(self.faults) == 1:
            return f"{self.source}: {self.faults[0]}"
        lines = [f"{self.source}: {len(self.faults)} faults"]
        return "\n".join(lines + [f"  - {fault}" for fault in self.faults])
