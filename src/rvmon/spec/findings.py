"""Findings as they gather: each once, and not more than anybody reads."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field

from rvmon.diagnostics.diagnostic import Diagnostic

MOST = 100
"""After so many findings nothing more is looked at."""


class Enough(Exception):  # noqa: N818 - never leaves this package
    """There are so many findings already that the rest of the file is not looked at."""


@dataclass(slots=True)
class Findings:
    """Findings in the order in which they were made, none twice."""

    found: list[Diagnostic] = field(default_factory=list)
    _seen: set[tuple[object, ...]] = field(default_factory=set)

    def add(self, finding: Diagnostic) -> None:
        """Keep a finding, unless the same was made at the same place.

        Raises:
            Enough: there are too many.
        """
        place = finding.spans[0].span if finding.spans else None
        key = (finding.code, place and (place.source.name, place.start, place.end))
        if place is not None and key in self._seen:
            return
        self._seen.add(key)
        if len(self.found) >= MOST:
            raise Enough
        self.found.append(finding)

    def extend(self, findings: Iterable[Diagnostic]) -> None:
        """Keep several."""
        for finding in findings:
            self.add(finding)
