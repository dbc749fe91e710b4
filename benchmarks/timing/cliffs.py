"""A hard stream beside its quiet neighbour: how many times as much does a sample cost?"""

from __future__ import annotations

import statistics
from collections.abc import Iterator, Sequence

from benchmarks.output import table
from benchmarks.timing.kinds import Row, Stream, drawn
from benchmarks.timing.workload import SECOND

from rvmon import loads

MILLISECOND = 10**6
HEAD = "signal x, y : real\nevent e\nrequirement R\n  "
KEYED = """event put(id : int), got(id : int)
requirement R
  upon put and put.id == k then within 1000 s (got and got.id == k)
  for each k in put.id
"""
OPEN = f"{HEAD}upon e then within 3600 s x > 11\n"


def _stream(text: str, rows: Sequence[Row], period: int = SECOND, before: int = 0) -> Stream:
    return Stream(loads(text), rows, period, before, keep=100)


def _keys(count: int, live: int) -> Sequence[Row]:
    first: list[Row] = [{"put": {"id": key}} for key in range(live)]
    return first + [{"put": {"id": n + live}, "got": {"id": n}} for n in range(count)]


def _open(count: int, attempts: int) -> Sequence[Row]:
    first: list[Row] = [{"x": 0.0, "y": 0.0, "e": True} for _ in range(attempts)]
    return [*first, *drawn(count)]


FAILING = {
    "a limit": ("always x < 7", "always x < 11"),
    "a response": ("always (x > 5 -> within 3 s y < 1.2)", "always (x > 5 -> within 3 s y < 9)"),
    "for a while": ("always (x > 5 -> for 3 s y < 8.7)", "always (x > 5 -> for 3 s y < 11)"),
}
UNKNOWN = {
    "a response": "always (x > 8 -> within 50 s y < 6)",
    "a window": "always (x > 9.9 -> for 20 s y < 9.9)",
    "the past": "always (x > 9 -> once[0 s, 50 s] y > 9)",
}
TRIGGERED = {
    "within 10 s": "within 10 s x > 9.995",
    "for 10 s": "for 10 s x < 9.999",
    "until, 10 s": "(y < 9.999) until[0 s, 10 s] x > 9.995",
    "nested, 10 s": "within 10 s for 1 s x < 9.99",
}
LATER = {
    "F[2 s, 10 s]": ("F[2 s, 10 s] x > 9.995", "within 10 s x > 9.995"),
    "G[2 s, 10 s]": ("G[2 s, 10 s] x < 9.999", "for 10 s x < 9.999"),
    "until[2 s, 10 s]": ("(y < 9.999) until[2 s, 10 s] x > 9.995", "within 10 s x > 9.995"),
}


def cells(count: int) -> Iterator[tuple[str, Stream, str, Stream, float]]:
    """What is hard, its quiet neighbour, and the most times that it may cost."""
    plain, every, rare = drawn(count), drawn(count, events=1), drawn(count, events=0.02)
    for name, texts in FAILING.items():
        hard, quiet = (_stream(HEAD + text, plain) for text in texts)
        yield f"{name} that fails at 30 % of the rows", hard, "it holds", quiet, 3
    for name, text in UNKNOWN.items():
        hard, quiet = (_stream(HEAD + text, drawn(count, share)) for share in (0.01, 0))
        yield f"{name}, 1 % NaN", hard, "no NaN", quiet, 3
    for name, text in TRIGGERED.items():
        hard, quiet = (_stream(f"{HEAD}upon e then {text}", n, MILLISECOND) for n in (every, rare))
        yield f"{name} at 1 kHz, each sample a trigger", hard, "2 % are", quiet, 3
    for name, texts in LATER.items():
        hard, quiet = (_stream(f"{HEAD}upon e then {o}", every, MILLISECOND) for o in texts)
        yield f"{name}, each sample a trigger", hard, "the window opens at once", quiet, 3
    hard, quiet = (_stream(KEYED, _keys(count, n), MILLISECOND, n) for n in (1_000, 10))
    yield "1,000 keys", hard, "10 keys", quiet, 3
    many = min(5 * count, 100_000)
    hard, quiet = (_stream(OPEN, _open(count, n), MILLISECOND, n) for n in (many, 1))
    yield f"{many:,} attempts open", hard, "one open", quiet, 1.2


def cliffs(*, rows: int = 20_000, repeats: int = 5) -> None:
    """Hard streams beside their quiet neighbours."""
    for line in lines(rows, repeats):
        print(line, flush=True)


def lines(count: int, repeats: int) -> Iterator[str]:
    """The table: medians of passes in turn."""
    head = ("stream", "CPU per sample", "neighbour", "CPU per sample", "ratio", "wanted", "met")
    return table(head, _rows(count, repeats))


def _rows(count: int, repeats: int) -> Iterator[Sequence[str]]:
    for name, hard, near, quiet, most in cells(count):
        both = [(hard.cost(), quiet.cost()) for _ in range(repeats)]
        own, its = (statistics.median(column) for column in zip(*both, strict=True))
        ratio = statistics.median(one / other for one, other in both)
        met = "yes" if ratio <= most else "no"
        figures = f"{ratio:.1f}×", f"≤ {most:g}×", met
        yield name, f"{own:,.0f} ns", near, f"{its:,.0f} ns", *figures
