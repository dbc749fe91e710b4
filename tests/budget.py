"""Seconds that the tests of each folder may take in all; the end of a run shows what they took."""

from collections import Counter
from pathlib import PurePosixPath

import pytest

BUDGETS = {
    "src/handover": 2,
    "src/rvmon": 20,
    "tests": 10,
    "tests/benchmarks": 25,
    "tests/docs": 30,
    "tests/examples": 20,
    "tests/handover": 4,
    "tests/handover/campaign": 62,
    "tests/handover/checker": 5,
    "tests/handover/collector": 2,
    "tests/handover/driver": 12,
    "tests/handover/generator": 8,
    "tests/handover/model": 4,
    "tests/handover/robot": 1,
    "tests/handover/world": 2,
    "tests/rvmon": 20,
    "tests/rvmon/adapters": 32,
    "tests/rvmon/analysis": 32,
    "tests/rvmon/binding": 15,
    "tests/rvmon/cdv": 62,
    "tests/rvmon/cli": 48,
    "tests/rvmon/clipping": 50,
    "tests/rvmon/core": 50,
    "tests/rvmon/native": 15,
    "tests/rvmon/coverage": 25,
    "tests/rvmon/evidence": 1,
    "tests/rvmon/execute": 20,
    "tests/rvmon/export": 35,
    "tests/rvmon/laws": 70,
    "tests/rvmon/logic": 14,
    "tests/rvmon/live": 15,
    "tests/rvmon/monitor": 80,
    "tests/rvmon/readers": 60,
    "tests/rvmon/report": 12,
    "tests/rvmon/spec": 35,
    "tests/rvmon/testing": 15,
    "tests/rvmon/timed": 45,
    "tests/rvmon/trace": 1,
    "tests/rvmon/verdict": 5,
    "tests/tools": 40,
}
"""What they were measured to take of one core (in `execute`, to wait), and a quarter more. What is
over its budget is shown, and fails nothing: a machine may be busy, or slow."""

_DEPTH = 3


def _folder(path: str) -> str:
    """What a test's seconds count for: the folder of its file, or the package of its doctest."""
    parts = PurePosixPath(path).parent.parts
    return "/".join(parts[:2] if parts[0] == "src" else parts[:_DEPTH])


class Budget:
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
        terminalreporter.line(f"{'folder':<32}{'tests':>8}{'seconds':>9}{'budget':>8}")
        for folder, seconds in self._seconds.most_common():
            budget = BUDGETS.get(folder)
            over = budget is None or seconds > budget
            line = f"{folder:<32}{self._tests[folder]:>8}{seconds:>9.1f}{budget or 'none':>8}"
            terminalreporter.line(line + "  over budget" * over, red=over)
