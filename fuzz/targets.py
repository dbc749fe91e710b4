"""The fuzz targets: each takes bytes, and raises only if rvmon fails on them.

Bad input must be refused with an `RvmonError`, which a target returns as an answer. Recordings are
judged by columns and by samples, and the results are compared.
"""

from __future__ import annotations

import hashlib
import json
import tempfile
from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import cache, partial
from pathlib import Path

from tests.rvmon.recordings.shop import SHOP

import rvmon
from rvmon.diagnostics import render_full
from rvmon.errors import ModelError, RvmonError, SnapshotError, SpecError
from rvmon.language.formatter import format_text
from rvmon.models.language.load import load_network, loads_network
from rvmon.models.search.budget import Budget
from rvmon.models.search.verify import verify
from rvmon.models.uppaal_xml import network_dot, uppaal_xml
from rvmon.recordings.source import Source
from rvmon.trace.sample import Trace

CORPUS = Path(__file__).with_name("corpus")

ANSWERS: Counter[str] = Counter()
"""The number of inputs by how they ended."""

RECORDED = """
spec recorded
time {time}
signal door : bool
signal speed : real [m/s]  stale after 700 ms
signal parts : int
signal mode : {{idle, working, stopped}}
event pick(id: int, force: real)
event halt
requirement R1
  upon halt
  then within 300 ms speed < 0.1 m/s
requirement R2
  whenever mode == idle
  then within 1 s not door
requirement R3
  upon pick.force > 4.5 or pick.id == 3
  then within 1 s (halt or parts >= 2)
requirement R4
  always once[0 s, 2 s] known(speed)
requirement R5
  upon pick
  then within 500 ms parts > n
  for each n in pick.id
requirement R6
  upon rise(door)
  then for 300 ms parts == v
  let v = parts
"""
"""A specification with values of all types, dropouts, keys and captured values."""

TIMES = ("held", "sampled", "sampled every 100 ms")

ENDS = (".csv", ".jsonl")

SMALL = Budget(states=300, seconds=5.0)
"""The limits of the search for each query of a model."""


@cache
def _folder() -> tempfile.TemporaryDirectory[str]:
    """The folder of inputs that are read as files; it is removed with the process."""
    return tempfile.TemporaryDirectory(prefix="rvmon-fuzz-")


def _file(name: str, data: bytes) -> Path:
    path = Path(_folder().name) / name
    path.write_bytes(data)
    return path


def spec(data: bytes) -> str:
    """A specification: it is refused with findings, or formatted, compiled and run."""
    path = _file("s.rv", data)
    try:
        loaded = rvmon.load(path)
    except SpecError as error:
        if not (render_full(error.diagnostics) or str(error)):
            raise AssertionError("it is refused without a word") from error
        return "refused"
    except RvmonError:
        return "unread"
    text = format_text(data.decode())
    assert format_text(text) == text, "laid out twice is laid out otherwise"
    try:
        monitor = loaded.monitor()
        for t in range(3):
            monitor.step(t, {})
        monitor.finish()
    except RvmonError:
        return "not monitored"
    return "judged"


def binding(data: bytes) -> str:
    """A binding of the recording of a shop."""
    path = _file("b.toml", data)
    try:
        rvmon.loads(SHOP).reading(binding=path)
    except RvmonError:
        return "refused"
    return "read"


def _model(data: bytes, name: str) -> str:
    """A network of timed automata; it is drawn, written as XML, read again, and searched."""
    end = "refused"
    try:
        network = load_network(_file(name, data))
        network_dot(network)
        end = "stopped"
        loads_network(uppaal_xml(network))
        for query in network.queries[:3]:
            verify(network, query, budget=SMALL)
    except ModelError as error:
        if not error.diagnostics:
            raise  # without findings, the user would see no message
        return end
    return "checked"


def _messages(data: bytes, name: str) -> str:
    """A recording of a shop."""
    path = _file(name, data)
    try:
        rvmon.loads(SHOP).evaluate(path, allow_missing=True)
    except RvmonError:
        return "refused"
    except MemoryError:  # an excessive message length; `rvmon run` reports it
        return "too large"
    return "judged"


@cache
def _sealed() -> tuple[bytes, Mapping[str, object]]:
    """The kind of a snapshot, and the fields that name its specification and plan."""
    monitor = _recorded(TIMES[0]).monitor()
    monitor.step(0, {"speed": 1.0, "mode": "idle", "door": True, "parts": 1})
    head, _, body = monitor.snapshot().partition(b"\n")
    document = json.loads(body)
    return head.rpartition(b" ")[0], {name: document[name] for name in ("rvmon", "spec", "plan")}


def snapshot(data: bytes) -> str:
    """The content of a snapshot of this version and specification, with a matching checksum."""
    try:
        said = json.loads(data)
    except (ValueError, RecursionError):
        return "no JSON"
    if not isinstance(said, dict):
        return "no document"
    kind, belongs = _sealed()
    body = json.dumps({**belongs, **said}).encode()
    seal = b"%s %s" % (kind, hashlib.sha256(body).hexdigest().encode())
    try:
        monitor = _recorded(TIMES[0]).restore(seal + b"\n" + body)
    except SnapshotError:
        return "refused"
    try:
        monitor.step_ns(10**10, {"halt": True})
    except RvmonError:
        return "restored, refuses a sample"
    monitor.finish()
    return "restored"


@cache
def seeds(name: str) -> Sequence[bytes]:
    """The initial inputs of a target: its corpus, or current snapshots of some runs."""
    if name == "snapshot":
        return [*_runs()]
    return [path.read_bytes() for path in sorted((CORPUS / name).iterdir())]


def _runs() -> Iterator[bytes]:
    """Snapshots without the fields that `snapshot` adds, because those depend on the plan."""
    belongs = _sealed()[1]
    for count in (1, 40):
        monitor = _recorded(TIMES[0]).monitor()
        for t in range(count):
            values = {"speed": t % 7.0, "mode": "idle", "door": t % 3 == 0, "parts": t}
            monitor.step(t / 4, values | ({"halt": True} if t % 11 == 5 else {}))
            if t == 20:
                monitor.lose(["speed"], since=5.1)
        document = json.loads(monitor.snapshot().partition(b"\n")[2])
        yield json.dumps({k: v for k, v in document.items() if k not in belongs}).encode()


@cache
def _recorded(time: str) -> rvmon.Spec:
    return rvmon.loads(RECORDED.format(time=time))


def recording(data: bytes) -> str:
    """A CSV file or JSON lines: columns and samples must give the same results.

    The first byte selects the format and the time model; the rest is the file.
    """
    if not data:
        return "nothing"
    ending, time = ENDS[data[0] % 2], TIMES[data[0] // 2 % 3]
    path = _file(f"r{ending}", data[1:])
    found = [_told(time, path, held=held) for held in (False, True)]
    assert found[0] == found[1], f"columns say\n{found[0]}\nand samples\n{found[1]}"
    return "judged" if found[0] is not None else "refused"


def _told(time: str, path: Path, *, held: bool) -> object:
    """The verdicts on a file: judged by columns, or by samples if `held`."""
    try:
        spec = _recorded(time)
        read = spec.recording(path)
        report = spec.judge(Source(Trace(tuple(read), read.names, read.end) if held else read))
    except RvmonError:
        return None
    attempts: dict[str, list[object]] = {name: [] for name in report.verdicts}
    for one in report.attempts:
        told = (one.number, one.triggered, one.decided, one.verdict, one.decision)
        attempts[one.requirement].append(told)
    return (
        *(report.origin, report.end),
        {name: (verdict, attempts[name]) for name, verdict in report.verdicts.items()},
    )


TARGETS: Mapping[str, Callable[[bytes], str]] = {
    "spec": spec,
    "binding": binding,
    "model_text": partial(_model, name="m.ta"),
    "model_xml": partial(_model, name="m.xml"),
    "bag": partial(_messages, name="r.bag"),
    "mcap": partial(_messages, name="r.mcap"),
    "parquet": partial(_messages, name="r.parquet"),
    "snapshot": snapshot,
    "recording": recording,
}


def run(name: str, data: bytes) -> str:
    """Run a target on an input, and count how it ended."""
    end = TARGETS[name](data)
    ANSWERS[end] += 1
    return end
