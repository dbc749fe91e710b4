"""The interface of a system under test: it plays a test, and its reports are judged."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from contextlib import AbstractContextManager, nullcontext
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Protocol, TypeVar

from rvmon.cdv.test import Test
from rvmon.coverage import Hit, Hits, illegal
from rvmon.report.scene import Scene
from rvmon.trace.sample import Value
from rvmon.verdicts.report import Report, report_of
from rvmon.verdicts.run_coverage import IllegalHit

if TYPE_CHECKING:
    from rvmon.coverage.monitor import SpecCoverage
    from rvmon.language.checked.specification import CheckedSpec
    from rvmon.session import Spec


Values = Mapping[str, Value]
"""The updates and occurrences at an instant, by name; events are `True`, unknown values `None`."""

Taker = Callable[[int, Values], None]
"""Takes one sample: nanoseconds and values."""


@dataclass(frozen=True, slots=True)
class Run:
    """A system's report of a finished run; the samples went to the observer.

    Attributes:
        end_ns: the instant up to which the run is judged, not before its last sample.
        states: `(t_ns, state)` of the system, at each entry of one, also from itself.
        error: the exception of the code under test, as one text, if it crashed.
        figures: of the run, by name, such as seconds of physics; a campaign adds them up.
        facts: more about the run for its page, as pairs of name and value.
        scene: the film of the run, if the observer asks for it.
    """

    end_ns: int
    states: Sequence[tuple[int, str]] = ()
    error: str | None = None
    figures: Mapping[str, float] = field(default_factory=dict)
    facts: Sequence[tuple[str, str]] = ()
    scene: Scene | None = None

    def __post_init__(self) -> None:
        """See that others can count on it: what is wrong is reported in the test that brings it.

        Raises:
            TypeError: a number is none, or a state is no pair.
        """
        if type(self.end_ns) is not int:
            raise TypeError(f"end_ns is to be an int, not {self.end_ns!r}")
        for name, figure in self.figures.items():
            if not isinstance(figure, int | float):
                raise TypeError(f"figure `{name}` is to be a number, not {figure!r}")
        for entry in self.states:
            if [*map(type, entry)] != [int, str]:
                raise TypeError(f"a state is to be given as (ns, name), not {entry!r}")


class Observer:
    """Told by a system, while it plays, of each sample: `observer(t_ns, values)`.

    Args:
        takers: get each sample.
        code: the context in which code is measured.
        wants_scene: whether a page is going to be made.

    Attributes:
        last_ns: instant of the latest sample that was taken.
        wants_scene: whether the run should come with its scene.
    """

    def __init__(
        self,
        takers: Sequence[Taker],
        *,
        code: AbstractContextManager[object] | None = None,
        wants_scene: bool = False,
    ) -> None:
        self._takers = takers
        self._code = nullcontext() if code is None else code
        self.last_ns = 0
        self.wants_scene = wants_scene

    def __call__(self, t_ns: int, values: Values) -> None:
        """Take one whole sample; each is later than the one before.

        Args:
            t_ns: its instant.
            values: the updates and occurrences; a name that the requirements lack is passed over.
                An event that occurred several times is a tuple of its fields, `({}, {})` without
                any.
        """
        for take in self._takers:
            take(t_ns, values)
        self.last_ns = t_ns

    def code(self) -> AbstractContextManager[object]:
        """The context for the code under test, if `Code.marked` says that only there is measured.

        It can be entered again and again, one at a time.
        """
        return self._code


_Test = TypeVar("_Test", bound=Test, contravariant=True)


class System(Protocol[_Test]):
    """A robot in its world, or in its simulator. One object plays many tests, one after the other.

    The same test must give the same run, whatever was played before. What a test begins outside of
    this process, such as a simulator, is to be begun by `rvmon.execute.command.run`: it ends with
    this process, which is killed if the test takes too long.
    """

    def play(self, test: _Test, observer: Observer, /) -> Run:
        """Play a test from its beginning to its end.

        Args:
            test: all that the run depends on.
            observer: to be called with each sample.
        """
        ...


class Checker:
    """Judges one test after the other: `begin`, `observe` each sample, `finish`.

    Names that a specification does not declare are passed over.

    Args:
        spec: the specification to judge by; `None` judges nothing.
        coverages: collectors for the coverage models of specifications.
    """

    def __init__(self, spec: Spec | None, coverages: Sequence[SpecCoverage] = ()) -> None:
        self._monitor = None if spec is None else spec.monitor()
        self._coverages = coverages
        self._collectors = [coverage.monitor() for coverage in coverages]
        takers: list[tuple[CheckedSpec, Callable[[int, Values], object]]] = [
            (coverage.spec, taker.step_ns)
            for coverage, taker in zip(coverages, self._collectors, strict=True)
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
        for collector in self._collectors:
            collector.reset()

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
        """The hits of the test that was observed up to `end_ns`."""
        hits: dict[str, Mapping[str, Hit]] = {}
        for collector in self._collectors:
            hits |= collector.finish_ns(end_ns)
        return hits

    def illegal(self, hits: Hits) -> list[IllegalHit]:
        """Those of some hits that must not be."""
        return [
            IllegalHit(group.name, item.name, hit.count, hit.first or 0)
            for coverage in self._coverages
            for group, item, hit in illegal(hits, coverage.bin_model)
        ]
