"""Seconds that the tests of each folder took, shown at the end of a run."""

from collections import Counter
from pathlib import PurePosixPath

import pytest

_DEPTH = 3


def _folder(path: str) -> str:
    """What a test's seconds count for: the folder of its file, or the package of its doctest."""
    parts = PurePosixPath(path).parent.parts
    return "/".join(parts[:2] if parts[0] == "src" else parts[:_DEPTH])


class Seconds:
    """A plugin that adds up what the tests of each folder take, in whatever process they run."""

    def __init__(self) -> None:
        self._seconds: Counter[str] = Counter()
        self._tests: Counter[str] = Counter()

    def pytest_runtest_logreport(self, report: pytest.TestReport) -> None:
        """Count a test's set-up, call or tear-down."""
        folder = _folder(report.nodeid.partition("::")[0])
        self._seconds[folder] += report.duration
        self._tests[folder] += report.when == "call"

    def pytest_terminal_summary(self, terminalreporter: pytest.TerminalReporter) -> None:
        """Show the sums of a run of several folders, the greatest first."""
        if len(self._seconds) < 2:
            return
        terminalreporter.section("seconds per folder")
        terminalreporter.line(f"{'folder':<32}{'tests':>8}{'seconds':>9}")
        for folder, seconds in self._seconds.most_common():
            terminalreporter.line(f"{folder:<32}{self._tests[folder]:>8}{seconds:>9.1f}")
