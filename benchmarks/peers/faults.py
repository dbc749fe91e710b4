"""The same faults put to rvmon and to other monitors, sample by sample: who says what?

All are asked at each sample whether `x > 0.5` was so within the last second (mstlo, which has no
past: whether it is within the next). Prints a table for each fault: `t: 1` is true at t, 0 false,
`?` not known or not decided, NaN the answer itself; what is in brackets is the monitor's own text.
"""

from __future__ import annotations

import logging
import math
import time
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import groupby
from typing import Any

from benchmarks.peers.adapters import resident_kib
from benchmarks.peers.client import Peer, PeerError
from benchmarks.peers.environment import Environment

import rvmon
from rvmon.adapters.json_objects import JsonObjects
from rvmon.errors import TraceError
from rvmon.live import Driver, SimulatedClock
from rvmon.trace.time import TICKS_PER_SECOND
from rvmon.verdict.attempt import Attempt
from rvmon.verdict.report import Report

Samples = Sequence[tuple[float, Mapping[str, float]]]

PEERS = {
    "rtamt, discrete online": ("rtamt", "Rtamt", "discrete online", "once[0:1](NAME > 0.5)"),
    "rtamt, dense online": ("rtamt", "Rtamt", "dense online", "once[0:1](NAME > 0.5)"),
    "reelay, dense": ("reelay", "Reelay", "dense", "once[0:1]{NAME > 0.5}"),
    "mstlo": ("mstlo-python", "Mstlo", "DelayedQualitative", "F[0, 1](NAME > 0.5)"),
    "SENTIL, online": ("sentil", "Sentil", "discrete", "(once[0,1] (NAME > 0.5))"),
}
"""Of each way to ask a peer: its package, the class that asks it, the kind, and the formula."""

SPEC = """
spec faults
time sampled
DELAY
signal v_x, v_y, v_z : real
event row
requirement R
  upon row
  then once[0 s, 1 s] NAME > 0.5
"""

KEYED = """
spec keyed
event pick(id: int), done(id: int)
requirement R
  upon pick
  then within 1 s done.id == n
  for each n in pick.id
"""

KEYS = 1_000


@dataclass(frozen=True, slots=True)
class Fault:
    """What is wrong with a stream.

    Attributes:
        title: in words.
        samples: seconds and values, as they arrive.
        name: of the signal that is asked for.
    """

    title: str
    samples: Samples
    name: str = "v_x"


def _of_x(*values: tuple[float, float]) -> Samples:
    return [(float(t), {"v_x": float(x)}) for t, x in values]


FAULTS = (
    Fault("NaN in the window", _of_x((0, 1), (1, math.nan), (2, 0), (3, 0), (4, 0))),
    Fault("a signal that never comes", [(float(t), {"v_z": 1.0}) for t in range(3)], "v_y"),
    Fault("time goes back", _of_x((0, 1), (1, 0), (2, 0), (1.5, 1), (3, 0), (4, 0))),
    Fault("two values at one instant", _of_x((0, 0), (1, 1), (1, 0), (2, 0), (3, 0))),
    Fault("a sample comes late", _of_x((0, 0), (1, 0), (2, 0), (1.9, 1), (2.5, 0), (4, 0))),
    Fault("the clock begins anew", _of_x((100, 0), (101, 1), (0, 0), (1, 0), (2, 0))),
)


def answers_of_peer(peer: Peer, kind: str, formula: str, fault: Fault) -> str:
    """What a peer says, in one line."""
    asked = formula.replace("NAME", fault.name)
    try:
        said = peer.ask("feed", formula=asked, kind=kind, samples=fault.samples)["said"]
    except PeerError as error:
        return f"({error})"
    pairs = zip(fault.samples, said, strict=True)
    return _line(found for (t, _), own in pairs for found in _words(t, own))


def _words(t: float, said: Any) -> Iterator[tuple[float, str]]:
    match said:
        case str():
            yield t, f"refused ({(said.partition(': ')[2] or said).strip()})"
        case {"from": low, "to": high}:
            yield t, "1" if low > 0 else "0" if high < 0 else "?"
        case list():
            yield from ((instant, _sign(value)) for instant, value in said)
        case _:
            yield t, _sign(said)


def _line(found: Iterable[tuple[float, str]]) -> str:
    """Instants with what was said at them; a long text stands once for all that have it."""
    groups = ([*own] for _, own in groupby(found, key=lambda one: one[1] if one[1][1:] else one))
    return ", ".join(f"{' '.join(f'{t:g}' for t, _ in own)}: {own[0][1]}" for own in groups)


def _sign(value: float | bool) -> str:
    return "NaN" if value != value else str(int(value > 0))


def _ours(fault: Fault, delay: str = "") -> rvmon.Spec:
    return rvmon.loads(SPEC.replace("DELAY", delay).replace("NAME", fault.name))


def stepped(fault: Fault, delay: str = "", settle: str = "now") -> str:
    """What a monitor says that takes the samples as they come."""
    monitor = _ours(fault, delay).monitor(settle=settle)
    refused = []
    for t, row in fault.samples:
        try:
            monitor.step(t, {**row, "row": True})
        except TraceError as error:
            refused.append((t, f"refused ({_at_instant(t, str(error))})"))
    return _told([monitor.finish()], refused)


def _at_instant(t: float, text: str) -> str:
    """A refusal without the instant that stands before it, so that like ones are told once."""
    return text.removeprefix(f"sample at {t:g} s").lstrip(", ")


def watched(fault: Fault) -> str:
    """What `rvmon.live` says, which `rvmon watch` uses."""
    clock, spec = SimulatedClock(), _ours(fault)
    driver = Driver(spec, clock=clock)
    objects = JsonObjects(driver, clock=clock)
    for t, row in fault.samples:
        objects.take({"t": t, **row, "row": True})
        driver.work()
    return _told(driver.close()[""], [])


def _told(reports: Sequence[Report], refused: Sequence[tuple[float, str]]) -> str:
    runs = []
    for report in reports:
        answers = sorted(report.attempts, key=lambda one: one.triggered)
        told = [_line(map(_our_word, answers))]
        told += [f"*{one.name} {one.kind} {one.count}x {one.remark}*" for one in report.health]
        runs.append(", ".join(part.replace(" *", "*") for part in told))
    return "; new run: ".join(runs) + (", " if refused else "") + _line(refused)


def _our_word(attempt: Attempt) -> tuple[float, str]:
    sign = {"P": "1", "F": "0"}.get(attempt.verdict.value, "?")
    return attempt.triggered / TICKS_PER_SECOND, sign


OURS: Mapping[str, Callable[[Fault], str]] = {
    "rvmon": stepped,
    "rvmon, `settle=next`": lambda fault: stepped(fault, settle="next"),
    "rvmon, `max delay 1 s`": lambda fault: stepped(fault, "max delay 1 s"),
    "rvmon watch": watched,
}


def keyed() -> dict[str, float]:
    """CPU seconds and KiB of one requirement `for each` whose keys all get two samples."""
    before, began = resident_kib(), time.process_time()
    monitor = rvmon.loads(KEYED).monitor(keep=100)
    for key in range(KEYS):
        monitor.step_ns(key, {"pick": {"id": key}})
    for key in range(KEYS):
        monitor.step_ns(KEYS + key, {"done": {"id": key}})
    return {"seconds": time.process_time() - began, "kib": resident_kib() - before}


def tables(environment: Environment) -> None:
    logging.disable()  # what `rvmon watch` says of each verdict
    there = {way: one[1:] for way, one in PEERS.items() if one[0] in environment.versions}
    for fault in FAULTS:
        fed = ", ".join(f"{t:g}: {next(iter(row.values())):g}" for t, row in fault.samples)
        print(f"\n**{fault.title}** (fed {fed})\n\n| monitor | says |\n|---|---|")
        for name, ask in OURS.items():
            _print(name, ask(fault))
        for way, (adapter, kind, formula) in there.items():
            with Peer(environment.python, adapter) as peer:
                _print(way, answers_of_peer(peer, kind, formula, fault))
    print(f"\n**{KEYS:,} keys**, two samples each\n\n| monitor | per key |\n|---|---|")
    _print("rvmon, one requirement `for each`", _cost(keyed()))
    for way, (adapter, kind, formula) in there.items():
        with Peer(environment.python, adapter) as peer:
            asked = {"formula": formula.replace("NAME", "v_x"), "kind": kind}
            peer.ask("many", **asked, count=1)  # imports
            _print(f"{way}, a monitor for each", _cost(peer.ask("many", **asked, count=KEYS)))


def _cost(found: Mapping[str, float]) -> str:
    return f"{1e3 * found['seconds'] / KEYS:.2f} ms, {found['kib'] / KEYS:.1f} KiB"


def _print(who: str, text: str) -> None:
    said = text.replace("|", "\\|").replace("\n", " ") or "nothing"
    print(f"| {who} | {said} |")
