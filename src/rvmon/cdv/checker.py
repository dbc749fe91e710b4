"""Samples go to a monitor while a test is played, and to what gathers coverage."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import TYPE_CHECKING

from rvmon.cdv.system import Values
from rvmon.coverage.hits import Hit, Hits, illegal
from rvmon.verdict.covered import IllegalHit
from rvmon.verdict.report import Report, report_of

if TYPE_CHECKING:
    from rvmon.coverage.monitor import SpecCoverage
    from rvmon.session import Spec
    from rvmon.spec.checked.specification import CheckedSpec


class Checker:
    """Judges one test after the other: `begin`, `observe` each sample, `finish`.

    Names that a specification does not declare are passed over.

    Args:
        spec: what to judge by; `None` judges nothing.
        coverages: what is gathered of the coverage models of specifications.
    """

    def __init__(self, spec: Spec | None, coverages: Sequence[SpecCoverage] = ()) -> None:
        self._monitor = None if spec is None else spec.monitor()
        self._coverages = coverages
        self._collectors = [one.monitor() for one in coverages]
        takers: list[tuple[CheckedSpec, Callable[[int, Values], object]]] = [
            (one.spec, taker.step_ns)
            for one, taker in zip(coverages, self._collectors, strict=True)
        ]
        if spec is not None and self._monitor is not None:
            takers.append((spec.checked, self._monitor.step_ns))
        self._takers = [
            (frozenset((*checked.signals, *checked.events)), take) for checked, take in takers
        ]

    def begin(self) -> None:
        """Forget the last test."""
        if self._monitor is not None:
            self._monitor.reset()
        for one in self._collectors:
            one.reset()

    def observe(self, t_ns: int, values: Values) -> None:
        """Take one whole sample."""
        for names, take in self._takers:
            known = {name: value for name, value in values.items() if name in names}
            if known:
                take(t_ns, known)

    def finish(self, end_ns: int) -> Report:
        """The verdicts on a test that was observed up to `end_ns`."""
        if self._monitor is None:
            return report_of((), ())
        return self._monitor.finish_ns(end_ns)

    def hits(self, end_ns: int) -> Hits:
        """What a test hit that was observed up to `end_ns`."""
        hits: dict[str, Mapping[str, Hit]] = {}
        for one in self._collectors:
            hits |= one.finish_ns(end_ns)
        return hits

    def illegal(self, hits: Hits) -> list[IllegalHit]:
        """What of these hits must not be."""
        return [
            IllegalHit(group.name, item.name, hit.count, hit.first or 0)
            for one in self._coverages
            for group, item, hit in illegal(hits, one.bin_model)
        ]
