"""Measuring, without a clock."""

from benchmarks.peers.client import PeerError
from benchmarks.timing.race import Pass, measure
from benchmarks.timing.workload import Workload
from tests.tools.build import p
from tests.tools.common_fragment import UntranslatableError

WORKLOAD = Workload("online", "a workload", "past", (p,), {"p": [True, True, False, True] * 50})


class Fake:
    """A contender that says what it needs."""

    def __init__(self, label: str, per_row: int, calls: list[str], refuses: str = "") -> None:
        self.label = label
        self.per_row = per_row
        self.calls = calls
        self.refuses = refuses
        self.rows = 0

    def prepare(self, workload: Workload, rows: int) -> None:
        assert workload is WORKLOAD
        if self.refuses:
            raise UntranslatableError(self.refuses)
        self.rows = rows

    def run(self) -> Pass:
        self.calls.append(self.label)
        return Pass(self.per_row * self.rows, (2,))


def test_turns() -> None:
    calls: list[str] = []
    contenders = [Fake("a", 10, calls), Fake("b", 20, calls)]
    result = measure(WORKLOAD, contenders, 2, 1.0)
    probes = ["a", "a", "b", "b"]
    assert calls == [*probes, "a", "b", "b", "a"]
    assert [(figure.label, figure.median, figure.rows) for figure in result.figures] == [
        ("a", 10.0, 200),
        ("b", 20.0, 200),
    ]
    assert result.figures[0].violated == (2,)


def test_slow_contender_gets_fewer_rows_and_passes() -> None:
    for per_row, rows in ((10_000_000, 100), (1_000_000_000, 50)):
        calls: list[str] = []
        fast = Fake("b", 10, calls)
        slow, _ = measure(WORKLOAD, [Fake("a", per_row, calls), fast], 5, 1.0).figures
        assert slow.rows == rows
    assert calls.count("a") == 1 + 2


class Dying(Fake):
    """A contender that dies at its third pass."""

    def run(self) -> Pass:
        if self.calls.count(self.label) == 2:
            raise PeerError("its process ended")
        return super().run()


def test_who_refuses_or_dies_is_left_out_with_the_reason() -> None:
    """The others are measured on."""
    calls: list[str] = []
    contenders = [Fake("a", 10, calls, "no past"), Dying("b", 10, calls), Fake("c", 20, calls)]
    result = measure(WORKLOAD, contenders, 3, 1.0)
    assert [figure.label for figure in result.figures] == ["c"]
    assert result.refusals == (("a", "no past"), ("b", "its process ended"))
