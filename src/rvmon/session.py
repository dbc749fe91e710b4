"""The facade: monitor a stream with a specification, evaluate a recording."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from functools import cached_property, lru_cache, partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

from rvmon.errors import UnknownNameError
from rvmon.readers.gaps import gaps_of
from rvmon.trace.schema import Schema
from rvmon.trace.time import ticks_of_seconds

if TYPE_CHECKING:
    from rvmon.codegen.plan import Plan
    from rvmon.diagnostics.diagnostic import Diagnostic
    from rvmon.monitor import CompiledSpec, Monitor
    from rvmon.monitor.measured import Margins
    from rvmon.monitor.robustness import RobustnessMonitor
    from rvmon.readers.gaps import Gaps
    from rvmon.spec.checked import CheckedSpec, Requirement
    from rvmon.trace.sample import Recording
    from rvmon.verdict.report import Report


class Spec:
    """A specification that is in order; made by `rvmon.load` or `rvmon.loads`.

    It is compiled when the first monitor is asked for, once.

    Attributes:
        checked: names, types, units and formulas, as all engines read them.
        warnings: what the compiler thinks worth a look; errors would have been raised.
    """

    def __init__(self, checked: CheckedSpec, warnings: Sequence[Diagnostic] = ()) -> None:
        self.checked = checked
        self.warnings = tuple(warnings)

    def __repr__(self) -> str:
        return f"<Spec {self.checked.name}: {', '.join(self.checked.requirements)}>"

    @property
    def requirements(self) -> Mapping[str, Requirement]:
        """The requirements by id, in order of the file."""
        return self.checked.requirements

    @cached_property
    def schema(self) -> Schema:
        """The declared signals and events with the kinds of their values."""
        return Schema(
            {name: signal.type.kind for name, signal in self.checked.signals.items()},
            {
                name: {field: type_.kind for field, type_ in event.fields.items()}
                for name, event in self.checked.events.items()
            },
            self.checked.ignoring,
        )

    @cached_property
    def _compiled(self) -> CompiledSpec:
        from rvmon.monitor import compile_spec

        return compile_spec(self.checked)

    def plan(self, *, only: Iterable[str] | None = None) -> Plan:
        """What `rvmon.codegen` makes Python and C of that run without rvmon.

        Args:
            only: ids of the requirements; default all.

        Raises:
            UnknownNameError: there is no such requirement.
            RvmonError: one of them is beyond generated code; which and why is said.
        """
        from rvmon.monitor.planned import plan_alone

        return plan_alone(self._compiled, only)

    def monitor(
        self,
        *,
        only: Iterable[str] | None = None,
        engine: str = "auto",
        settle: str = "now",
        sources: Iterable[str] | None = None,
    ) -> Monitor:
        """Make an online monitor of all requirements.

        Args:
            only: ids of the requirements to judge; default all.
            engine: `auto` or the name of one; `c` compiles the requirements with the C compiler
                that is installed, and gives records without reasons, a report without input health.
            settle: `now` judges each sample at once; `next` merges samples with equal stamps and
                judges each when the next stamp settles it.
            sources: the signals and events that can arrive; the others are unknown throughout.

        Raises:
            UnknownNameError: `only`, `engine`, `settle` or `sources` names what does not exist.
        """
        from rvmon.monitor import build_monitor

        given, chosen = self._sources(sources), self._chosen(only)
        return build_monitor(
            self._compiled, only=chosen, engine=engine, settle=settle, sources=given
        )

    def _sources(self, sources: Iterable[str] | None) -> frozenset[str] | None:
        """The names that can arrive, all of which are declared."""
        given = None if sources is None else frozenset(sources)
        declared = [*self.schema.signals, *self.schema.events]
        unknown = sorted((given or frozenset()).difference(declared))
        if unknown:
            known = ", ".join(declared)
            raise UnknownNameError(f"no signal or event named `{unknown[0]}`: there are {known}")
        return given

    def _chosen(self, only: Iterable[str] | None) -> tuple[str, ...] | None:
        """The ids that were asked for, all of which there are."""
        chosen = None if only is None else tuple(only)
        for name in chosen or ():
            if name not in self.requirements:
                known = ", ".join(self.requirements)
                raise UnknownNameError(f"no requirement `{name}`: there are {known}")
        return chosen

    def restore(self, data: bytes) -> Monitor:
        """Make the monitor that a snapshot was taken of; it goes on as that would have.

        Args:
            data: from `Monitor.snapshot`.

        Raises:
            SnapshotError: the bytes are no snapshot, are damaged, or come from another
                specification or another version of rvmon.
        """
        from rvmon.monitor.snapshot import restore

        return restore(self._compiled, data)

    def evaluate(
        self,
        trace: Any,
        *,
        time: str = "t",
        engine: str = "auto",
        only: Iterable[str] | None = None,
        until: float | None = None,
        sources: Iterable[str] | None = None,
        nan: str = "unknown",
        no_update: Any = None,
    ) -> Report:
        r"""Judge a finished trace; the same content gives the same records, whatever holds it.

        Args:
            trace: a path (`.csv`, `.jsonl`, `.parquet`), a table (arrays or lists by name, an
                Arrow table, a data frame), a `Recording`, or an iterable of `(t, values)` with t
                in seconds.
            time: the time column of a table, no signal; if its name ends in `_ns`, integer ticks.
            engine: `auto` or the name of one; `c` compiles the requirements with the C compiler
                that is installed, and gives records without reasons.
            only: ids of the requirements to judge; default all.
            until: the end of the trace in seconds, if it ended after its last sample.
            sources: the signals and events that can arrive, the others are unknown throughout;
                default the columns that there are, of JSON lines and pairs all that is declared.
            nan: what NaN says: `unknown`, or `no update`, as in a merge of topics.
            no_update: a further value that stands for no update; in tables `None`, nulls and masked
                values do anyway.

        Raises:
            TraceError: the trace cannot be read; place and cause are named.
            UnknownNameError: `only`, `engine`, `sources` or `nan` names what does not exist.

        >>> from rvmon import loads
        >>> spec = loads("spec s\nsignal x : real\nrequirement R1\n  always x < 3\n")
        >>> merged = {"t": [0, 1, 2], "x": [1.0, float("nan"), 2.0]}
        >>> [spec.evaluate(merged, nan=nan).verdicts["R1"] for nan in ("unknown", "no update")]
        [<Verdict.INCONCLUSIVE: 'I'>, <Verdict.PASS: 'P'>]
        """
        _expect_engine(engine)
        chosen = self._chosen(only)
        end = None if until is None else ticks_of_seconds(until)
        if chosen == () and engine == "c":
            engine = "auto"  # nothing to compile
        gaps, given = gaps_of(nan, no_update), self._sources(sources)
        if given is None:
            report = self._by_columns(trace, time, gaps, engine, chosen, until)
            if report is not None:
                return report
        recording = self.recording(trace, time=time, nan=nan, no_update=no_update)
        if given is None and recording.names is not None:
            given = frozenset(recording.names) & {*self.schema.signals, *self.schema.events}
        if end is None:
            end = recording.end
        if engine == "c":
            from rvmon.monitor.batch_c import evaluate_recording

            return evaluate_recording(
                self._compiled, recording, sources=given, only=chosen, until=end
            )
        monitor = self.monitor(only=chosen, engine=engine, sources=given)
        for sample in recording:
            monitor.step_ns(sample.t, sample.values)
        report = monitor.finish_ns(end)
        rows = getattr(recording, "rows", None)
        return report if rows is None else replace(report, health=rows.told(report.health))

    def _by_columns(
        self,
        trace: Any,
        time: str,
        gaps: Gaps,
        engine: str,
        only: tuple[str, ...] | None,
        until: float | None,
    ) -> Report | None:
        """Judge a trace by its columns; `None` if it has none, or each row has to be looked at."""
        if isinstance(trace, str | Path):
            if gaps:
                return None
            return self.evaluate_file(trace, engine=engine, only=only, until=until)
        from rvmon.readers.tables import columns_by_name

        columns = columns_by_name(trace)
        if columns is None:
            return None
        from rvmon.monitor.batch_table import evaluate_table

        return evaluate_table(
            self._compiled,
            self.schema,
            columns,
            time,
            gaps,
            only=only,
            engine=engine,
            until=None if until is None else ticks_of_seconds(until),
        )

    def evaluate_many(
        self,
        traces: Iterable[Any],
        *,
        time: str = "t",
        engine: str = "auto",
        only: Iterable[str] | None = None,
        jobs: int = 1,
    ) -> Iterator[Report]:
        r"""Judge many traces, in their order; the specification is compiled once per process.

        Args:
            traces: each as for `evaluate`; with several jobs, what can be pickled: paths, columns.
            time: the time column of columns; if its name ends in `_ns`, integer ticks.
            engine: `auto` or the name of one.
            only: ids of the requirements to judge; default all.
            jobs: processes; 1 judges in this one.

        Raises:
            TraceError: a trace cannot be read; the reports before it have been given out.

        >>> from rvmon import loads
        >>> spec = loads("spec s\nsignal p : bool\nrequirement R1\n  always p\n")
        >>> runs = [[(0, {"p": True})], [(0, {"p": False})]]
        >>> [report.verdicts["R1"].value for report in spec.evaluate_many(runs)]
        ['P', 'F']
        """
        chosen = None if only is None else tuple(only)
        if jobs < 2:
            return (self.evaluate(trace, time=time, engine=engine, only=chosen) for trace in traces)
        return self._evaluate_elsewhere(traces, time, engine, chosen, jobs)

    def _evaluate_elsewhere(
        self, traces: Iterable[Any], time: str, engine: str, only: tuple[str, ...] | None, jobs: int
    ) -> Iterator[Report]:
        import pickle
        from concurrent.futures import ProcessPoolExecutor

        judge = partial(_evaluate_here, pickle.dumps(self.checked), time, engine, only)
        with ProcessPoolExecutor(jobs) as pool:
            yield from pool.map(judge, traces)

    def evaluate_file(
        self,
        path: str | Path,
        *,
        engine: str = "auto",
        only: Iterable[str] | None = None,
        until: float | None = None,
        cut: bool = False,
        ignored: Counter[str] | None = None,
    ) -> Report | None:
        """Judge a file by its columns, a block at a time; see `evaluate`.

        Args:
            path: as `evaluate` takes it; so are the others.
            engine: `auto` or the name of one.
            only: ids of the requirements.
            until: the end of the trace in seconds.
            cut: whether rows behind that end are left out, too.
            ignored: names of JSON lines that are not declared are counted here.

        Returns:
            `None` where rows have to be read and judged one by one.
        """
        from rvmon.monitor.batch_file import evaluate_file

        _expect_engine(engine)
        return evaluate_file(
            self._compiled,
            self.schema,
            path,
            only=None if only is None else tuple(only),
            engine=engine,
            until=None if until is None else ticks_of_seconds(until),
            cut=cut,
            ignored=Counter() if ignored is None else ignored,
        )

    def robustness(
        self,
        trace: Any,
        *,
        time: str = "t",
        only: Iterable[str] | None = None,
        until: float | None = None,
        streams: bool = True,
    ) -> Margins:
        """By how much a finished trace meets each requirement, or fails to, in base units.

        Comparisons of numbers count by the distance of their sides, other propositions as infinite;
        unknown input and what would come after the end may be anything. Where the least value of an
        attempt is above 0 it has passed, where the greatest is below 0 it has failed.

        Args:
            trace: as `evaluate` takes it.
            time: the time column of columns.
            only: ids of the requirements; default all.
            until: the end of the trace in seconds, if it ended after its last sample.
            streams: whether to give a figure per sample, too; they are kept in memory.

        Returns:
            The figures of the attempts by requirement and number, and as streams.

        Raises:
            TraceError: the trace cannot be read.
            UnknownNameError: `only` names what does not exist.

        Source: SEMANTICS 5; Donze and Maler 2010.
        """
        from rvmon.monitor.robustness import margins_of

        chosen = self._chosen(only)
        recording = self.recording(trace, time=time)
        return margins_of(
            self._compiled,
            recording,
            only=chosen,
            sources=recording.names,
            end=recording.end if until is None else ticks_of_seconds(until),
            streams=streams,
        )

    def robustness_monitor(
        self,
        *,
        only: Iterable[str] | None = None,
        settle: str = "now",
        sources: Iterable[str] | None = None,
        streams: bool = False,
    ) -> RobustnessMonitor:
        """Make an online monitor that gives figures of robustness; see `robustness`.

        Args:
            only: as for `monitor`; so are `settle` and `sources`.
            settle: when a sample is taken for complete.
            sources: the names that can arrive.
            streams: whether to give a figure per sample as well as per attempt.

        Raises:
            UnknownNameError: `only`, `settle` or `sources` names what does not exist.
        """
        from rvmon.monitor.robustness import RobustnessMonitor

        given, chosen = self._sources(sources), self._chosen(only)
        return RobustnessMonitor(
            self._compiled, only=chosen, settle=settle, sources=given, streams=streams
        )

    def recording(
        self, trace: Any, *, time: str = "t", nan: str = "unknown", no_update: Any = None
    ) -> Recording:
        """Whatever `evaluate` takes as a trace, as a recording; so are the arguments.

        Raises:
            TraceError: the trace cannot be read.
            UnknownNameError: there is no such reading of NaN.
        """
        from rvmon.readers.any_trace import recording_of

        ordered = self.checked.max_delay is None
        gaps = gaps_of(nan, no_update)
        return recording_of(trace, self.schema, time=time, ordered=ordered, gaps=gaps)


def _expect_engine(name: str) -> None:
    from rvmon.monitor.compiled import ALL_ENGINES, expect_engine

    expect_engine(name, ALL_ENGINES)


def _evaluate_here(
    checked: bytes, time: str, engine: str, only: tuple[str, ...] | None, trace: Any
) -> Report:
    return _spec_of(checked).evaluate(trace, time=time, engine=engine, only=only)


@lru_cache(maxsize=1)
def _spec_of(checked: bytes) -> Spec:
    """The specification that another process sent; a worker compiles it for its first trace."""
    import pickle

    return Spec(pickle.loads(checked))  # noqa: S301 - from the process that began this one
