"""What is found beside verdicts while the samples of a recording go by."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from rvmon.cli.options import asked_ids, constants_of
from rvmon.cli.reading import allowed_names, opened, reading_spec
from rvmon.readers.recording import FileRecording, can_be_read_again
from rvmon.session import Spec, load
from rvmon.trace.sample import Sample
from rvmon.verdict.covered import IllegalHit

if TYPE_CHECKING:
    import argparse

    from rvmon.coverage.hits import Hits
    from rvmon.coverage.monitor import CoverageMonitor
    from rvmon.verdict.report import Report


@dataclass(frozen=True, slots=True)
class Options:
    """How to judge.

    Attributes:
        only: ids of the requirements, or `None` for all.
        until: the instant in seconds to which recordings are judged; default their last sample.
        strict_columns: whether missing and undeclared columns are errors.
        robustness: whether to find the robustness of each attempt as well.
        allow_missing: the names that recordings in columns may lack; `True`: all.
        coverage: whether all that the coverage model has is watched; default: coverpoints and
            crosses alone.
        explains: whether anybody is told why there is no attempt, and what came late.
    """

    only: tuple[str, ...] | None = None
    until: float | None = None
    strict_columns: bool = False
    robustness: bool = False
    allow_missing: bool | tuple[str, ...] = False
    coverage: bool = False
    explains: bool = True


def spec_and_options(
    arguments: argparse.Namespace, name: str | None = None
) -> tuple[Spec, Options]:
    """What judges, and how.

    Args:
        arguments: those of `rvmon run`.
        name: what messages call the specification; default its path.
    """
    loaded = load(arguments.spec, name=name, const=constants_of(arguments.const))
    spec = reading_spec(loaded, arguments)
    return spec, Options(
        asked_ids(arguments, spec),
        arguments.until,
        arguments.strict_columns,
        arguments.robustness,
        allowed_names(arguments.allow_missing),
        arguments.coverage is not None,
        not _shows_counts_alone(arguments),
    )


def _shows_counts_alone(arguments: argparse.Namespace) -> bool:
    """Whether all that is shown of reports is how many verdicts there are."""
    asked = vars(arguments)  # evidence that is evaluated again has none of these
    is_kept = any(asked.get(name) for name in ("out", "report", "junit", "mcap", "evidence"))
    return bool(asked.get("quiet") and asked.get("format") == "text" and not is_kept)


class Beside:
    """Finds coverage on one recording: when it was judged it is read once more, if it can be.

    Args:
        spec: may have coverpoints.
        options: say what is asked for.
        trace: the path of the recording.
        names: that have a source; `None`: all.
        end: the instant to which the recording is judged, ticks; default its last sample.

    Attributes:
        hits: what was hit of the coverage model, if all of it was asked for.
    """

    def __init__(
        self,
        spec: Spec,
        options: Options,
        trace: str,
        names: frozenset[str] | None,
        end: int | None,
    ) -> None:
        self.hits: Hits = {}
        self._spec = spec
        self._options = options
        self._trace = trace
        self._end = end
        self._coverage: CoverageMonitor | None = None
        self._is_asked = bool(options.coverage or spec.checked.coverpoints)
        if self._is_asked and not can_be_read_again(trace):
            self._coverage = spec.coverage_model.monitor(
                sources=names, requirements=options.coverage
            )

    @property
    def is_idle(self) -> bool:
        """Whether there is nothing to find while samples go by."""
        return self._coverage is None

    def reading(self, recording: FileRecording) -> Iterator[Sample]:
        """The samples of a recording: each is seen here once it was judged."""
        for sample in recording:
            yield sample
            if self._coverage is not None and (self._end is None or sample.t <= self._end):
                self._coverage.step_ns(sample.t, sample.values)

    def finished(self, report: Report) -> Report:
        """The report with what was found, when all samples went by."""
        if not self._is_asked:
            return report
        from rvmon.coverage.hits import covered_groups, illegal

        if self._coverage is not None:
            found = self._coverage.finish_ns(self._end)
        else:
            again, asked = opened(self._spec, self._trace), self._options.coverage
            found = self._spec.coverage_model.of(again, self._end, requirements=asked)
        if self._options.coverage:
            self.hits = found
        model = self._spec.coverage_model.bin_model
        wrong = tuple(
            IllegalHit(group.name, item.name, hit.count, hit.first or 0)
            for group, item, hit in illegal(found, model)
        )
        return replace(report, illegal=wrong, coverage=covered_groups(found, model))
