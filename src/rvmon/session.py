"""The facade: load a specification, monitor a stream, evaluate a recording."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from copy import copy
from functools import cached_property, partial
from pathlib import Path
from typing import TYPE_CHECKING, Any, Unpack

from rvmon.errors import SpecError
from rvmon.language.checked.names_read import requirement_ids, source_names
from rvmon.recordings import FORMATS
from rvmon.texts import cannot_read, text_of_file
from rvmon.trace.time import ticks_of_seconds
from rvmon.verdicts.attempt import Attempt
from rvmon.verdicts.report import Report

if TYPE_CHECKING:
    from rvmon.analysis.subformulas import Looking
    from rvmon.coverage import Hits
    from rvmon.coverage.monitor import SpecCoverage
    from rvmon.diagnostics import Diagnostic
    from rvmon.language.checked.specification import CheckedSpec, Requirement
    from rvmon.monitor.compiled_spec import CompiledSpec
    from rvmon.monitor.monitor import Monitor
    from rvmon.monitor.packed_plan import PlannedCore
    from rvmon.monitor.robustness import Margins, RobustnessMonitor
    from rvmon.recordings.source import Reading, ReadingArguments, SchemaArguments, Source
    from rvmon.trace.sample import Recording


class Spec:
    """A checked specification, returned by `rvmon.load` and `rvmon.loads`.

    It is compiled for the core once, when the first monitor is made.

    Attributes:
        checked: names, types, units and formulas after checking.
        warnings: the warnings of the compiler; errors raise `SpecError` instead.
        schema: the declared names with their types and their names in recordings.
    """

    def __init__(self, checked: CheckedSpec, warnings: Sequence[Diagnostic] = ()) -> None:
        self.checked = checked
        self.warnings = tuple(warnings)
        self.schema = checked.schema

    def __repr__(self) -> str:
        return f"<Spec {self.checked.name}: {', '.join(self.checked.requirements)}>"

    def _repr_html_(self) -> str:
        from rvmon.report import notebook

        return notebook.spec_html(self.checked)

    @property
    def requirements(self) -> Mapping[str, Requirement]:
        """The requirements by id, in the order of the file."""
        return self.checked.requirements

    def reading(self, **options: Unpack[SchemaArguments]) -> Spec:
        r"""This specification for recordings with other names, stamps or conventions.

        Args:
            **options: `time`: the column of stamps and its unit as `COLUMN` or `COLUMN:UNIT`, with
                `s`, `ms`, `us`, `ns`, or `iso` for ISO 8601. Without a unit: nanoseconds if the
                name ends in `_ns`, else seconds. Default: seconds in `t`, or nanoseconds in `t_ns`.
                `columns`: the column of each declared name or payload field `event.field`; for
                messages `TOPIC.FIELD`. `nan`: the meaning of NaN: `unknown` (default) or `no
                update`, which suits tables merged from several topics. `no_update`: a further value
                that means no update; in tables, `None`, nulls and masked values always do.
                `binding`: a TOML file that maps topics and fields of messages (bags, MCAP) to
                declared names. `clock`: the stamps of messages unless the binding names others:
                `log`, the time of recording (default), or `header`.

        Raises:
            UnknownNameError: a name in `columns` is not declared, or `nan` or `clock` has another
                value.
            RvmonError: `columns` names a column twice, or the binding has errors.

        >>> from rvmon import loads
        >>> spec = loads("spec s\nsignal p : bool\nrequirement R1\n  always p\n")
        >>> spec = spec.reading(time="stamp:ms", columns={"p": "Is P"})
        >>> spec.evaluate({"stamp": [0, 20], "Is P": [True, True]}).end
        20000000
        """
        from rvmon.recordings.binding import reading_schema

        other = copy(self)
        other.schema = reading_schema(self.checked, self.schema, **options)
        return other

    @cached_property
    def _compiled(self) -> CompiledSpec:
        from rvmon.monitor.compiled_spec import CompiledSpec

        return CompiledSpec(self.checked, is_kept=True)

    @cached_property
    def looking(self) -> Looking:
        """The plans for searching recordings, shared by all recordings."""
        from rvmon.analysis.subformulas import Looking

        return Looking(self.checked)

    def monitor(
        self,
        *,
        only: Iterable[str] | None = None,
        settle: str = "now",
        sources: Iterable[str] | None = None,
        keep: int | None = None,
    ) -> Monitor:
        """Create an online monitor.

        Args:
            only: ids of the requirements to evaluate; default all.
            settle: `now` evaluates each sample at once; `next` merges samples with equal stamps
                and evaluates them when the next stamp arrives.
            sources: the signals and events that can arrive; all others stay unknown.
            keep: for runs of weeks, the number of newest records kept per requirement and verdict,
                so that many passes displace no failure. Verdicts and counts stay exact, and the
                report contains the number of dropped records. Default: all.

        Raises:
            UnknownNameError: a name in `only` or `sources`, or `settle`, does not exist.
            RvmonError: the core cannot evaluate a requirement, or `keep` is not a count.
        """
        from rvmon.monitor.monitor import build_monitor

        chosen = source_names(self.checked, sources)
        return build_monitor(self._compiled, only=only, settle=settle, sources=chosen, keep=keep)

    def restore(self, data: bytes) -> Monitor:
        """Create a monitor from a snapshot; it continues exactly as the original would have.

        Args:
            data: from `Monitor.snapshot`.

        Raises:
            SnapshotError: the bytes are damaged, or from another specification or rvmon.
        """
        from rvmon.monitor.monitor import restore

        return restore(self._compiled, data)

    def evaluate(
        self,
        trace: Any,
        *,
        only: Iterable[str] | None = None,
        until: float | None = None,
        **reading: Unpack[ReadingArguments],
    ) -> Report:
        r"""Evaluate a finished trace; the same content gives the same records in any format.

        Args:
            trace: a path or address (`.csv`, `.jsonl`, `.parquet`, bags, `.mcap`; text also
                compressed), a table (arrays or lists by name, an Arrow table, a data frame), a list
                of paths or tables that together are one recording, a `Recording`, or an iterable of
                `(t, values)` with t in seconds.
            only: ids of the requirements to evaluate; default all.
            until: the end of the trace in seconds, if it ended after its last sample.
            **reading: `time`, `columns`, `nan`, `no_update`, `binding`, `clock`: see `reading`.
                `sources`: the signals and events that can arrive; all others stay unknown. Default:
                the columns or topics of the trace; for JSON lines and pairs, all declared names.
                `allow_missing`: whether a trace in columns or topics may lack names that the
                requirements read, or which names; requirements that read missing names are
                inconclusive. With `sources`, missing names are always allowed.

        Raises:
            MissingNameError: a trace in columns lacks a name that a requirement reads.
            TraceError: the trace cannot be read; the message names place and cause.
            UnknownNameError: a name in an argument does not exist.

        >>> from rvmon import loads
        >>> spec = loads("spec s\nsignal x : real\nrequirement R1\n  always x < 3\n")
        >>> merged = {"t": [0, 1, 2], "x": [1.0, float("nan"), 2.0]}
        >>> [spec.evaluate(merged, nan=nan).verdicts["R1"] for nan in ("unknown", "no update")]
        [<Verdict.INCONCLUSIVE: 'I'>, <Verdict.PASS: 'P'>]
        """
        from rvmon.monitor.evaluate import evaluate_trace

        given, chosen = self._reading(**reading), requirement_ids(self.checked, only)
        end = None if until is None else ticks_of_seconds(until)
        return evaluate_trace(self._compiled, trace, given, only=chosen, until=end)

    def judge(
        self,
        source: Source,
        *,
        only: Iterable[str] | None = None,
        decided: Callable[[Sequence[Attempt]], object] = len,
        robustness: bool = False,
    ) -> Report:
        """Evaluate a recording that is already open; `evaluate` takes a path.

        Args:
            source: the recording.
            only: as for `evaluate`; so are the errors.
            decided: if the recording breaks off with an error, called once or several times with
                the attempts decided before it.
            robustness: whether to compute the robustness of each attempt.
        """
        if robustness:
            from rvmon.monitor.evaluate_robustness import judge_and_measure as judge
        else:
            from rvmon.monitor.evaluate import judge_source as judge

        return judge(self._compiled, source, requirement_ids(self.checked, only), decided)

    def _reading(
        self,
        *,
        sources: Iterable[str] | None = None,
        allow_missing: bool | Iterable[str] = False,
        **schema: Unpack[SchemaArguments],
    ) -> Reading:
        from rvmon.recordings.source import Reading

        allowed = allow_missing if isinstance(allow_missing, bool) else tuple(allow_missing)
        read_as = (self.reading(**schema) if schema else self).schema
        return Reading(read_as, source_names(self.checked, sources), allowed)

    def evaluate_many(
        self,
        traces: Iterable[Any],
        *,
        only: Iterable[str] | None = None,
        jobs: int = 1,
        **reading: Unpack[ReadingArguments],
    ) -> Iterator[Report]:
        r"""Evaluate many traces; reports come in the order of the traces.

        The specification is compiled once per process.

        Args:
            traces: each as for `evaluate`; with several jobs, only traces that can be pickled, such
                as paths and columns.
            only: as for `evaluate`.
            jobs: the number of processes; 1 evaluates in the calling process.
            **reading: as for `evaluate`; so are the errors.

        Raises:
            TraceError: a trace cannot be read; the reports of earlier traces were yielded before.
            WorkerLostError: a process was killed from outside; likewise.

        >>> from rvmon import loads
        >>> spec = loads("spec s\nsignal p : bool\nrequirement R1\n  always p\n")
        >>> runs = [[(0, {"p": True})], [(0, {"p": False})]]
        >>> [report.verdicts["R1"].value for report in spec.evaluate_many(runs)]
        ['P', 'F']
        """
        from rvmon.execute.parallel import execute
        from rvmon.monitor.evaluate import evaluate_apart
        from rvmon.monitor.records import give_plan

        given, chosen = self._reading(**reading), requirement_ids(self.checked, only)
        prepare = partial(partial, evaluate_apart, self._compiled, reading=given, only=chosen)
        reports = execute(traces, prepare, jobs=jobs, what="trace")
        return (give_plan(report, self.planned(chosen)) for report in reports)

    def planned(self, only: Iterable[str] | None = None) -> PlannedCore:
        """The packed plan of some requirements, with its tables; built once and cached."""
        from rvmon.monitor.packed_plan import planned_core

        return planned_core(self._compiled, requirement_ids(self.checked, only))

    def robustness(
        self,
        trace: Any,
        *,
        only: Iterable[str] | None = None,
        until: float | None = None,
        streams: bool = True,
        **reading: Unpack[ReadingArguments],
    ) -> Margins:
        """The robustness of each requirement on a finished trace, in base units.

        The robustness of a comparison is the distance of its sides; that of other propositions is
        infinite. As unknown input and values after the end can be anything, the result is an
        interval from `low` to `high`. `low > 0`: passed; `high < 0`: failed.

        Args:
            trace: as for `evaluate`; so are `reading` and the errors.
            only: see `evaluate`.
            until: see `evaluate`.
            streams: whether to compute, and keep in memory, the robustness at each sample as well.

        Source: SEMANTICS 5; Donze and Maler 2010.
        """
        from rvmon.monitor.evaluate_robustness import margins_of

        given, chosen = self._reading(**reading), requirement_ids(self.checked, only)
        end = None if until is None else ticks_of_seconds(until)
        return margins_of(self._compiled, trace, given, only=chosen, until=end, streams=streams)

    def robustness_monitor(
        self,
        *,
        only: Iterable[str] | None = None,
        settle: str = "now",
        sources: Iterable[str] | None = None,
        streams: bool = False,
    ) -> RobustnessMonitor:
        """Create an online monitor of robustness; see `robustness`.

        Args:
            only: as for `monitor`; so are `settle` and `sources`.
            settle: see `monitor`.
            sources: see `monitor`.
            streams: whether to compute the robustness at each sample as well.

        Raises:
            UnknownNameError: a name in `only` or `sources`, or `settle`, does not exist.
        """
        from rvmon.monitor.robustness import RobustnessMonitor

        only, names = requirement_ids(self.checked, only), source_names(self.checked, sources)
        return RobustnessMonitor(self._compiled, only, settle, names, streams=streams)

    @cached_property
    def coverage_model(self) -> SpecCoverage:
        """The coverage model: bins, combinations, cover goals, and the outcomes of requirements."""
        from rvmon.coverage.monitor import SpecCoverage

        return SpecCoverage(self._compiled)

    def coverage(self, trace: Any, **reading: Unpack[ReadingArguments]) -> Hits:
        """The coverage of a trace, as hits by group and item; arguments as for `evaluate`."""
        return self.coverage_model.of(self.recording(trace, **reading))

    def recording(self, trace: Any, **reading: Unpack[ReadingArguments]) -> Recording:
        """Open a trace for reading as `evaluate` does; by default any name may be missing."""
        from rvmon.monitor.evaluate import open_trace

        reading.setdefault("allow_missing", True)
        return open_trace(self.checked, trace, self._reading(**reading), only=None)


def load(
    path: str | Path, *, name: str | None = None, const: Mapping[str, str] | None = None
) -> Spec:
    """Load a specification file.

    Args:
        path: a `.rv` file, UTF-8.
        name: its name in messages; default its path.
        const: constants to override, by name, as text of the language (`{"T": "2 s"}`).

    Raises:
        SpecError: the file cannot be read or has errors; contains all diagnostics, rendered.
    """
    path = Path(path)
    what = "a folder" if path.is_dir() else "a recording by its name"
    if path.suffix != ".rv" and (path.is_dir() or path.suffix.lower() in FORMATS):
        raise SpecError((), f"error: {path}: {what}; a specification (.rv) is expected here")
    try:
        text = text_of_file(path)
    except (OSError, UnicodeDecodeError) as error:
        raise SpecError((), f"error: {cannot_read(path, error)}") from None
    return _compile(text, str(path) if name is None else name, const, path.parent)


def loads(text: str, *, name: str = "<string>", const: Mapping[str, str] | None = None) -> Spec:
    """Load a specification from its text.

    Args:
        text: the specification.
        name: its name in messages.
        const: constants to override, by name, as text of the language.

    Raises:
        SpecError: the text has errors; contains all diagnostics, rendered.
    """
    return _compile(text, name, const, None)


def _compile(text: str, name: str, const: Mapping[str, str] | None, directory: Path | None) -> Spec:
    from rvmon.language.compiled_cache import compile_cached

    return Spec(*compile_cached(text, name=name, constants=const, directory=directory))


def _report_html(report: Report) -> str:
    from rvmon.report import notebook

    return notebook.report_html(report)


def _attempt_html(attempt: Attempt) -> str:
    from rvmon.report import notebook

    return notebook.attempt_html(attempt)


# `verdicts` must not import `report`, so the HTML for notebooks is attached here.
Report._repr_html_ = _report_html
Attempt._repr_html_ = _attempt_html
