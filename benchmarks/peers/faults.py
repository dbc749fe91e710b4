"""The same faults put to rvmon and to other monitors, sample by sample: who says what?

All are asked at each sample whether `x > 0.5` was so within the last second (mstlo, which has no
past: whether it is within the next). Prints a table for each fault: `t: 1` is true at t, 0 false,
`?` not known or not decided, NaN the answer itself; what is in brackets is the monitor's own text.
"""

from __future__ import annotations

import logging
import tomllib
from collections.abc import Iterable, Iterator, Sequence
from itertools import groupby
from pathlib import Path
from typing import Any

import msgspec
from benchmarks.peers.client import Peer, PeerError
from benchmarks.peers.environment import Environment, prepare
from benchmarks.program import table

import rvmon
from rvmon.adapters.json_objects import JsonObjects
from rvmon.errors import TraceError
from rvmon.live import Driver, SimulatedClock
from rvmon.trace.time import TICKS_PER_SECOND
from rvmon.verdicts.report import Report


class Told(msgspec.Struct):
    """What stands in `faults.toml`."""

    spec: str  # ours, with the places DELAY and NAME
    ours: dict[str, tuple[str, str]]  # what it says of delays, and how samples settle
    # of each way to ask a peer: its package, the class that asks it, the kind, and the formula
    peers: dict[str, tuple[str, str, str, str]]
    fault: list[Fault]


class Fault(msgspec.Struct):
    """What is wrong with a stream of x, and the signal that is asked for."""

    title: str
    samples: list[tuple[float, float]]
    asked: str = "v_x"


def _of_peer(peer: Peer, kind: str, formula: str, fault: Fault) -> str:
    samples = [(t, {"v_x": x}) for t, x in fault.samples]
    asked = formula.replace("NAME", fault.asked)
    try:
        said = peer.ask("feed", formula=asked, kind=kind, samples=samples)["said"]
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


def _stepped(spec: rvmon.Spec, fault: Fault, settle: str) -> str:
    """What a monitor says that takes the samples as they come."""
    monitor, refused = spec.monitor(settle=settle), []
    for t, x in fault.samples:
        try:
            monitor.step(t, {"v_x": x, "row": True})
        except TraceError as error:  # without the instant before it, like ones are told once
            why = str(error).removeprefix(f"sample at {t:g} s").lstrip(", ")
            refused.append((t, f"refused ({why})"))
    return _told([monitor.finish()], refused)


def _watched(spec: rvmon.Spec, fault: Fault) -> str:
    """What `rvmon.live` says, which `rvmon watch` uses."""
    clock = SimulatedClock()
    driver = Driver(spec, clock=clock)
    objects = JsonObjects(driver, clock=clock)
    for t, x in fault.samples:
        objects.take({"t": t, "v_x": x, "row": True})
        driver.work()
    return _told(driver.close()[""], [])


def _told(reports: Sequence[Report], refused: Sequence[tuple[float, str]]) -> str:
    signs, runs = {"P": "1", "F": "0"}, []
    for report in reports:
        answers = sorted(report.attempts, key=lambda one: one.triggered)
        told = [
            _line(
                (one.triggered / TICKS_PER_SECOND, signs.get(one.verdict, "?")) for one in answers
            )
        ]
        told += [f"*{one.name} {one.kind} {one.count}x {one.remark}*" for one in report.health]
        runs.append(", ".join(part.replace(" *", "*") for part in told))
    return "; new run: ".join(runs) + (", " if refused else "") + _line(refused)


def _answers(told: Told, fault: Fault, environment: Environment) -> Iterator[tuple[str, str]]:
    text = told.spec.replace("NAME", fault.asked)
    for name, (delay, settle) in told.ours.items():
        yield name, _stepped(rvmon.loads(text.replace("DELAY", delay)), fault, settle)
    yield "rvmon watch", _watched(rvmon.loads(text.replace("DELAY", "")), fault)
    for name, (package, adapter, kind, formula) in told.peers.items():
        if package in environment.versions:
            with Peer(environment.python, adapter) as peer:
                yield name, _of_peer(peer, kind, formula, fault).replace("\n", " ") or "nothing"


def faults() -> None:
    """What each says to a fault."""
    environment = prepare()
    logging.disable()  # what `rvmon watch` says of each verdict
    text = Path(__file__).with_suffix(".toml").read_text("utf-8")
    told = msgspec.convert(tomllib.loads(text), Told)
    for fault in told.fault:
        fed = ", ".join(f"{t:g}: {x:g}" for t, x in fault.samples)
        print(f"\n**{fault.title}** (fed {fed})\n")
        for line in table(["monitor", "says"], _answers(told, fault, environment)):
            print(line, flush=True)
