"""Count the hits of coverpoints, crosses, requirements and cover goals, with runs of the core.

These runs are separate from those of monitors and never affect verdicts.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from functools import cached_property
from itertools import product
from struct import iter_unpack
from typing import TYPE_CHECKING, Any

from rvmon import native
from rvmon.core.pack import pack
from rvmon.coverage import Group, Hit, Hits, Item, Model, Subject, combination, model_of
from rvmon.language.checked.classify import is_pulse
from rvmon.language.checked.formula import Formula
from rvmon.language.checked.properties import BinKind, Cross
from rvmon.language.checked.specification import CheckedSpec
from rvmon.language.print import format_formula
from rvmon.logic.formula import Factory
from rvmon.logic.plan import Plan, Watch, WatchGroup, plan_of_watches
from rvmon.logic.state_formula import FALSE
from rvmon.logic.three_valued import Reader
from rvmon.monitor.compiled_spec import CompiledSpec, Kept
from rvmon.monitor.evaluate import RecordingRun
from rvmon.monitor.feed import refuse_settle
from rvmon.monitor.monitor import Monitor
from rvmon.monitor.packed_plan import PlannedCore, planned_as
from rvmon.monitor.snapshot import Options
from rvmon.recordings.source import Source
from rvmon.trace.sample import Recording, Sample
from rvmon.trace.time import ticks_of_seconds
from rvmon.verdicts.report import Report, report_of

if TYPE_CHECKING:
    from rvmon.coverage.requirements import WatchedRequirements
    from rvmon.recordings.batch import Batch


class Bins:
    """The coverpoints and crosses of a specification, compiled for any number of runs."""

    def __init__(self, spec: CheckedSpec) -> None:
        self.spec = spec
        self.groups = [*bin_groups(spec)]

    @cached_property
    def planned(self) -> PlannedCore:
        """The packed plan.

        Raises:
            RvmonError: a formula exceeds the limits of the core.
        """
        return planned_as(self.spec, (), Kept(pack(self.plan).data))

    @cached_property
    def plan(self) -> Plan:
        """The plan, with a watch for each bin and for each occasion at which bins are sampled."""
        points, crosses = self.spec.coverpoints, self.spec.crosses
        reader = Reader(Factory(), self.spec.period)
        watches: list[Watch] = []

        def watch(formula: Formula) -> int:
            # A bin whose formula is unborn is not hit.
            watches.append(Watch(reader.four(formula).read(FALSE), is_pulse(formula)))
            return len(watches) - 1

        axes = {
            # Arguments are evaluated in order: the start is read before the bins add their watches.
            name: range(len(watches), 1 + [watch(bin_.formula) for bin_ in point.bins][-1])
            for name, point in points.items()
        }
        sampled: list[tuple[tuple[str, ...], Formula | None]]
        sampled = [((name,), point.upon) for name, point in points.items()]
        sampled += [(cross.points, cross.upon) for cross in crosses.values()]
        groups = [
            WatchGroup(tuple(axes[name] for name in names), None if upon is None else watch(upon))
            for names, upon in sampled
        ]
        return plan_of_watches(self.spec, watches, groups)

    def hits(self, counted: bytes) -> Hits:
        """The hits of a run, from the counters of the core: pairs of count and first instant."""
        numbers = iter_unpack("=qq", counted)
        hits: dict[str, dict[str, Hit]] = {}
        for group in self.groups:
            for item, (count, first) in zip(group.items, numbers, strict=False):
                if count:
                    hits.setdefault(group.name, {})[item] = Hit(count, first)
        return hits


def bin_groups(spec: CheckedSpec) -> Iterator[Group]:
    """The coverpoints and crosses of a specification as groups of a model."""
    for point in spec.coverpoints.values():
        items = {
            bin_.name: Item(bin_.name, bin_.kind, point.goal, format_formula(bin_.formula))
            for bin_ in point.bins
        }
        yield Group(point.name, Subject.COVERPOINT, items, point.weight)
    for cross in spec.crosses.values():
        yield _of_cross(cross, spec)


def _of_cross(cross: Cross, spec: CheckedSpec) -> Group:
    """The group of a cross; a combination with an ignored or illegal bin is ignored.

    An illegal bin is reported by its coverpoint.
    """
    points = [spec.coverpoints[name] for name in cross.points]
    items = {}
    for bins in product(*(point.bins for point in points)):
        names = tuple(bin_.name for bin_ in bins)
        kind = BinKind.GOAL
        if names in cross.illegal:
            kind = BinKind.ILLEGAL
        elif names in cross.ignored or any(bin_.kind is not BinKind.GOAL for bin_ in bins):
            kind = BinKind.IGNORE
        name = combination(names)
        items[name] = Item(name, kind, cross.goal)
    axes = {point.name: tuple(bin_.name for bin_ in point.bins) for point in points}
    return Group(cross.name, Subject.CROSS, items, cross.weight, axes)


class _CoverageRun(Monitor):
    """A monitor that takes samples as usual, but whose report is empty."""

    def _reported(self, end: int | None) -> Report:
        return report_of((), (), end=end)


class SpecCoverage:
    """The coverage model of a specification, compiled for any number of runs."""

    def __init__(self, compiled: CompiledSpec) -> None:
        self.spec = compiled.checked
        self._compiled = compiled

    def __reduce__(self) -> tuple[type[SpecCoverage], tuple[CompiledSpec]]:
        # Only the specification is pickled; the other process compiles it again.
        return SpecCoverage, (self._compiled,)

    @cached_property
    def bins(self) -> Bins:
        """Its coverpoints and crosses."""
        return Bins(self.spec)

    @cached_property
    def requirements(self) -> WatchedRequirements:
        """Its requirements and cover goals."""
        # Imported here, as a run that does not write a database needs only the bins.
        from rvmon.coverage.requirements import WatchedRequirements

        return WatchedRequirements(self._compiled)

    @cached_property
    def bin_model(self) -> Model:
        """The model of coverpoints and crosses only."""
        return model_of(self.bins.groups)

    @cached_property
    def model(self) -> Model:
        """The model of coverpoints, crosses, requirements and cover goals."""
        return model_of([*self.bins.groups, *self.requirements.groups])

    def monitor(
        self,
        *,
        settle: str = "now",
        sources: frozenset[str] | None = None,
        requirements: bool = True,
    ) -> CoverageMonitor:
        """A monitor of the coverage of one run, sample by sample.

        Args:
            settle: `now` or `next`, as for `rvmon.session.Spec.monitor`.
            sources: the names that can arrive; `None`: all.
            requirements: whether to include requirements and cover goals. That costs more than
                judging them, as each is also judged without each of its operands.

        Raises:
            UnknownNameError: `settle` is neither `now` nor `next`.
        """
        return CoverageMonitor(self, Options(settle, sources, None), requirements=requirements)

    def of(
        self, recording: Recording, end: int | None = None, *, requirements: bool = True
    ) -> Hits:
        r"""The hits of a recording.

        Args:
            recording: read to its end.
            end: the end of the trace in ticks, before or after its own; later samples are ignored.
            requirements: as for `monitor`.

        >>> from rvmon import loads
        >>> spec = loads("signal x : real\ncoverpoint size = x {low: [0, 1), high: [1, inf)}\n")
        >>> hits = spec.coverage({"t": [0, 1, 2], "x": [0.5, 3.0, 0.2]})
        >>> {item: hit.count for item, hit in hits["size"].items()}
        {'low': 2, 'high': 1}
        """
        source = Source(recording, end, is_cut=True)
        run = self.run(source, requirements=requirements)
        for piece in source.pieces():
            run.take(piece)
        return run.finish()

    def run(self, source: Source, *, requirements: bool = True) -> CoverageRun:
        """A run that takes the pieces of a recording; `requirements` is as for `monitor`."""
        return CoverageRun(self, source, requirements=requirements)

    def planned(self, *, requirements: bool) -> Mapping[CompiledSpec, PlannedCore]:
        """The plans of the runs, the bins last.

        The first is the strictest in validating samples, so that a sample which it accepts is
        accepted by all.
        """
        plans = dict(self.requirements.planned) if requirements else {}
        if self.bins.groups:
            plans[CompiledSpec(self.spec)] = self.bins.planned
        return plans

    def hits(self, runs: Sequence[native.Monitor], *, requirements: bool) -> Hits:
        """The hits of runs: of bins so far, of requirements if the runs are finished."""
        hits = dict(self.bins.hits(runs[-1].hits())) if self.bins.groups else {}
        if requirements:
            own = runs[: len(self.requirements.planned)]
            hits |= {name: items for name, items in self.requirements.hits(own) if items}
        return hits


class CoverageRun:
    """Measures the coverage of a recording, piece by piece; made by `SpecCoverage.run`."""

    def __init__(self, model: SpecCoverage, source: Source, *, requirements: bool) -> None:
        self._model = model
        self._requirements = requirements
        plans = model.planned(requirements=requirements).values()
        self._runs = [RecordingRun(model.spec, core, source, finds=False) for core in plans]

    def take(self, piece: Batch | Sample) -> None:
        """Take the next piece of the source, which yields none after its end."""
        for run in self._runs:
            run.take(piece)

    def finish(self) -> Hits:
        """End the run at the end of the recording, and return all hits."""
        for run in self._runs:
            run.finish()
        cores = [run.core for run in self._runs]
        return self._model.hits(cores, requirements=self._requirements)


class CoverageMonitor:
    """Measures the coverage of a stream of samples; made by `SpecCoverage.monitor`.

    Times and errors are as for `rvmon.Monitor`: seconds, or ticks in the methods that end
    in `_ns`.
    """

    def __init__(self, model: SpecCoverage, options: Options, *, requirements: bool) -> None:
        # Checked here, as there may be nothing to watch, and so no run that would check it.
        refuse_settle(options.settle)
        self._model = model
        self._requirements = requirements
        self._runs = [
            _CoverageRun(planned, compiled, options)
            for compiled, planned in model.planned(requirements=requirements).items()
        ]

    def step(self, t: float, values: Mapping[str, Any]) -> None:
        """Take one sample (seconds); see `step_ns`."""
        for run in self._runs:
            run.step(t, values)

    def step_ns(self, t_ns: int, values: Mapping[str, Any]) -> None:
        """Take one sample, as a monitor does."""
        for run in self._runs:
            run.step_ns(t_ns, values)

    def advance(self, t: float) -> None:
        """State that no sample before `t` (seconds) will come."""
        self.advance_ns(ticks_of_seconds(t))

    def advance_ns(self, t_ns: int) -> None:
        """State that no sample before `t_ns` will come."""
        for run in self._runs:
            run.advance_ns(t_ns)

    def reset(self) -> None:
        """Discard the run; the next sample starts another."""
        for run in self._runs:
            run.reset()

    @property
    def hits(self) -> Hits:
        """The hits of bins and combinations so far; those of requirements are known at the end."""
        return self._model.hits([run.core for run in self._runs], requirements=False)

    def finish(self, t: float | None = None) -> Hits:
        """End the run at `t` seconds, if that is later than everything so far; see `finish_ns`."""
        return self.finish_ns(None if t is None else ticks_of_seconds(t))

    def finish_ns(self, t_ns: int | None = None) -> Hits:
        """End the run, at `t_ns` if that is later than everything so far, and return all hits."""
        for run in self._runs:
            run.finish_ns(t_ns)
        cores = [run.core for run in self._runs]
        return self._model.hits(cores, requirements=self._requirements)
