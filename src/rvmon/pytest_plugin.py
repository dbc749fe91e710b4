"""The pytest plugin: a fixture that judges what a test does, and `.rv` files as tests.

pytest loads it wherever rvmon is installed, so all else of rvmon is imported only when it is used.
"""

from __future__ import annotations

from collections import Counter, defaultdict
from collections.abc import Callable, Generator, Iterable, Iterator, Mapping
from os.path import relpath
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

import pytest

if TYPE_CHECKING:
    from rvmon.monitor.monitor import Monitor
    from rvmon.session import Spec
    from rvmon.verdicts import Verdict
    from rvmon.verdicts.report import Report

_PROPERTY = "rv:"
"""Prefix of the test properties that hold verdicts; JUnit XML contains them as well."""

_RECORDINGS = "rv_recordings"

_T = TypeVar("_T")

_judges: pytest.StashKey[list[Judge]] = pytest.StashKey()


class RequirementError(AssertionError):
    """A requirement does not have the wanted verdict; the message says why."""


class Judge:
    """Judges the actions of a test against a specification; returned by the fixture `rv`.

    Args:
        spec: the requirements.
        strict: whether I and NT are failures as well.
        expect: expected verdicts by requirement; any other verdict is then a failure.
        only: ids of the requirements to judge; default all.
    """

    def __init__(
        self,
        spec: Spec,
        *,
        strict: bool = False,
        expect: Mapping[str, str] | None = None,
        only: Iterable[str] | None = None,
    ) -> None:
        from rvmon.errors import UnknownNameError

        self.spec = spec
        self.only = None if only is None else tuple(only)
        self._strict = strict
        self._expect = dict(expect or {})
        for name, wanted in self._expect.items():
            if name not in spec.requirements:
                there = ", ".join(spec.requirements)
                raise UnknownNameError(f"no requirement `{name}`: there are {there}")
            if wanted not in ("P", "F", "NT", "I"):
                raise UnknownNameError(f"{name}: no verdict {wanted!r}: P, F, NT, I")
        self._monitor: Monitor | None = None
        self._reports: list[Report] = []

    @property
    def monitor(self) -> Monitor:
        """An online monitor for the test; its run ends with the test."""
        if self._monitor is None:
            self._monitor = self.spec.monitor(only=self.only)
        return self._monitor

    def step(self, t: float, values: Mapping[str, Any]) -> None:
        """Judge a sample; see `Monitor.step`."""
        __tracebackhide__ = True
        _without_frames(lambda: self.monitor.step(t, values))

    def check(self, trace: Any, **reading: Any) -> Report:
        """Judge a finished trace; see `Spec.evaluate`. A failure makes the test fail at its end."""
        __tracebackhide__ = True
        report = _without_frames(lambda: self.spec.evaluate(trace, only=self.only, **reading))
        self._reports.append(report)
        return report

    def finish(self) -> list[Report]:
        """End the run and return all reports of the test; to be called once."""
        # A judge that was never used gets the report of an empty run, which fails if strict.
        if self._monitor is not None or not self._reports:
            self._reports.append(self.monitor.finish())
            self._monitor = None
        reports, self._reports = self._reports, []
        return reports

    def wrong(self, report: Report) -> list[str]:
        """The requirements that do not have the wanted verdict."""
        return [
            name for name, verdict in report.verdicts.items() if not self._is_wanted(name, verdict)
        ]

    def _is_wanted(self, name: str, verdict: Verdict) -> bool:
        if name in self._expect:
            return verdict == self._expect[name]
        return verdict == "P" or (verdict != "F" and not self._strict)


@pytest.fixture
def rv(request: pytest.FixtureRequest) -> Any:
    """Judge what a test does: `rv("base.rv")` or `rv(spec)` returns a `Judge`.

    If a requirement failed, the test fails at its end, with an explanation. A path is relative to
    the folder of the test, or else to the folder where pytest was started.
    """
    from rvmon.session import Spec, load

    judges = request.node.stash.setdefault(_judges, [])

    def judge(spec: str | Path | Spec, **wanted: Any) -> Judge:
        __tracebackhide__ = True

        def made() -> Judge:
            if isinstance(spec, Spec):
                return Judge(spec, **wanted)
            local = request.path.parent / spec
            return Judge(load(local if local.exists() else spec), **wanted)

        found = _without_frames(made)
        judges.append(found)
        return found

    return judge


def _without_frames(call: Callable[[], _T]) -> _T:
    """The result of a call; an `RvmonError` is raised without the stack frames of rvmon."""
    from rvmon.errors import RvmonError

    __tracebackhide__ = True
    try:
        return call()
    except RvmonError as error:
        raise error.with_traceback(None) from None


@pytest.hookimpl(wrapper=True)
def pytest_runtest_call(item: pytest.Item) -> Generator[None]:
    """Judge what a test did, unless the test itself failed."""
    __tracebackhide__ = True
    yield
    _conclude(item, item.stash.get(_judges, []))


def _conclude(item: pytest.Item, judges: list[Judge]) -> None:
    __tracebackhide__ = True  # the message says all; the source lines here would not help
    texts = []
    for judge in judges:
        for report in judge.finish():
            for name, verdict in report.verdicts.items():
                item.user_properties.append((_PROPERTY + name, verdict.value))
            if wrong := judge.wrong(report):
                texts.append(_explained(report, judge.spec, wrong))
    if texts:
        raise RequirementError("\n".join(texts))


def _explained(report: Report, spec: Spec, wrong: list[str]) -> str:
    """An explanation of the requirements in `wrong`, as text."""
    from rvmon.report.printer import text_of
    from rvmon.report.run_text import print_report

    text = text_of(lambda printer: print_report(report, spec.checked, printer))
    return f"not as expected: {', '.join(wrong)}\n{text.strip()}"


def pytest_addoption(parser: pytest.Parser) -> None:
    """Declare the setting `rv_recordings`."""
    parser.addini(
        _RECORDINGS,
        "recordings with which .rv files are tested, as patterns from the root: *.csv, bags/*",
        type="linelist",
        default=[],
    )


def pytest_collect_file(file_path: Path, parent: pytest.Collector) -> pytest.Collector | None:
    """Collect `.rv` files as test files if `rv_recordings` is set."""
    if file_path.suffix == ".rv" and parent.config.getini(_RECORDINGS):
        collected: pytest.Collector = SpecFile.from_parent(parent, path=file_path)
        return collected
    return None


class SpecFile(pytest.File):
    """A specification as a test file, with a test per recording and requirement."""

    def collect(self) -> Iterator[RequirementItem]:
        """Yield the tests."""
        from rvmon.errors import RvmonError
        from rvmon.recordings.places import found_recordings
        from rvmon.session import load

        root = self.config.rootpath
        patterns = [str(root / pattern) for pattern in self.config.getini(_RECORDINGS)]
        try:
            spec = load(self.path)
            found = sorted({Path(path) for path in found_recordings(patterns)})
        except RvmonError as error:
            raise self.CollectError(str(error)) from None
        for recording in found:
            for name in spec.requirements:
                shown = f"{relpath(recording, root)}::{name}"
                yield RequirementItem.from_parent(
                    self, name=shown, judge=Judge(spec, only=[name]), recording=recording
                )


class RequirementItem(pytest.Item):
    """The test of a requirement on a recording."""

    def __init__(self, *, judge: Judge, recording: Path, **options: Any) -> None:
        super().__init__(**options)
        self._judge = judge
        self._recording = recording

    def runtest(self) -> None:
        """Judge the requirement on the recording."""
        self._judge.check(self._recording)
        _conclude(self, [self._judge])

    def repr_failure(self, excinfo: pytest.ExceptionInfo[BaseException], style: Any = None) -> str:
        """The explanation without a traceback."""
        from rvmon.errors import RvmonError

        if isinstance(excinfo.value, RequirementError | RvmonError):
            return str(excinfo.value)
        return str(super().repr_failure(excinfo, style))

    def reportinfo(self) -> tuple[Path, int, str]:
        """The place of the test."""
        return self.path, 0, self.name


def pytest_terminal_summary(terminalreporter: pytest.TerminalReporter) -> None:
    """Print a table of all verdicts; with pytest-xdist, of all its processes."""
    counts: dict[str, Counter[str]] = defaultdict(Counter)
    for category in ("passed", "failed"):
        for report in terminalreporter.getreports(category):
            for name, verdict in getattr(report, "user_properties", ()):
                if name.startswith(_PROPERTY) and getattr(report, "when", "") == "call":
                    counts[name.removeprefix(_PROPERTY)][verdict] += 1
    if not counts:
        return
    terminalreporter.section("requirements")
    width = max(map(len, counts))
    terminalreporter.line(f"{'':<{width}}{'P':>7}{'F':>7}{'NT':>7}{'I':>7}")
    for name in sorted(counts):
        row = "".join(f"{counts[name][verdict] or '':>7}" for verdict in ("P", "F", "NT", "I"))
        terminalreporter.line(f"{name:<{width}}{row}", red=bool(counts[name]["F"]))
