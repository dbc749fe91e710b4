"""Findings as they gather: each once, and not more than anybody reads."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable
from dataclasses import dataclass, field

from rvmon.diagnostics.diagnostic import Diagnostic, Severity

MOST = 100
"""After so many errors nothing more is looked at; of warnings no more are kept."""


class Enough(Exception):  # noqa: N818 - never leaves this package
    """There are so many findings already that the rest of the file is not looked at."""


@dataclass(slots=True)
class Findings:
    """Findings in the order in which they were made, none twice.

    Attributes:
        found: at most so many errors, and as many warnings.
        more: whether there were more.
    """

    found: list[Diagnostic] = field(default_factory=list)
    more: bool = False
    _seen: set[tuple[object, ...]] = field(default_factory=set)
    _counts: Counter[Severity] = field(default_factory=Counter)

    def add(self, finding: Diagnostic) -> None:
        """Keep a finding, unless the same was made at the same place.

        Raises:
            Enough: there are too many errors.
        """
        place = finding.spans[0].span if finding.spans else None
        key = (finding.code, place and (place.source.name, place.start, place.end))
        if place is not None and key in self._seen:
            return
        if self._counts[finding.severity] >= MOST:
            self.more = True
            if finding.severity is Severity.ERROR:
                raise Enough
            return
        self._seen.add(key)
        self._counts[finding.severity] += 1
        self.found.append(finding)

    def extend(self, findings: Iterable[Diagnostic]) -> None:
        """Keep several."""
        for finding in findings:
            self.add(finding)
