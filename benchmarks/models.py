"""The model checker: what textbook networks and the handover cost, beside TChecker.

    python -m benchmarks.models cost [--seconds 60] [--repeat 3]
    python -m benchmarks.models tchecker PATH/TO/tck-reach MODEL…

`cost` prints symbolic states visited and stored, seconds of CPU (the least of some searches) and
bytes of memory for each stored state, each network in a process of its own.

`tchecker` searches the same models, edge by edge, by TChecker (`aLU-covreach`), too: a MODEL is a
file of TChecker's, as the scripts of its examples write them. Its memory is that of its whole
process, ours what the search added.
"""

from __future__ import annotations

import re
import resource
import sys
import time
from collections.abc import Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import replace
from multiprocessing import get_context
from pathlib import Path

from benchmarks.process import measured
from benchmarks.program import program

from handover.model import handover_network
from rvmon.models.language.elaborate import asked_on
from rvmon.models.language.load import load_network, loads_network
from rvmon.models.network import Network, Query
from rvmon.models.search.budget import Budget, Statistics
from rvmon.models.search.verify import verify

HERE = Path(__file__).parent
MODELS = HERE.parent / "examples" / "models"
COLLISION = "E<> Station(1).Transm and Station(2).Transm and Bus.Idle"
"""Of CSMA/CD, as TChecker asks it: the model's own query compares clocks."""

SEARCH = ("-a", "aLU-covreach", "-s", "bfs")
"""Of TChecker."""

SIZES = {"fischer": (7, 8, 9, 10), "csma_cd": (7, 8, 9), "train_gate": (5, 6), "fddi": (5, 8, 10)}


def cost(*, repeat: int = 3, seconds: float = 60.0) -> None:
    """Textbook networks and the handover: the best of some searches, which give up in time."""
    print(f"{'query':22} {'visited':>10} {'stored':>10} {'seconds':>9} {'B/state':>8}")
    for name, size in [*((n, s) for n, sizes in SIZES.items() for s in sizes), ("handover", 0)]:
        for query, holds, told, held in _searched(name, size, repeat, seconds):
            label = f"{name} {size or query}"
            shown = f"{held:8.0f}" if size and told.stored > 5_000 else f"{'':8}"
            figures = f"{told.visited:10,} {told.stored:10,} {told.seconds:9.3f} {shown}"
            unknown = "   not decided" if holds is None else ""
            print(f"{label:22} {figures}{unknown}".rstrip(), flush=True)


Search = tuple[str, bool | None, Statistics, float]
"""A query, whether it holds, its cost in seconds of the CPU, bytes for each stored state."""


def _searched(name: str, size: int, repeat: int, seconds: float) -> list[Search]:
    """What the queries of a network of that name and size cost, in a process of its own."""
    with ProcessPoolExecutor(1, get_context("spawn")) as pool:
        return pool.submit(_search, name, size, repeat, seconds).result()


def _search(name: str, size: int, repeat: int, seconds: float) -> list[Search]:
    found = []
    for network, query in _queries(name, size):
        before, times = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss, []
        for _ in range(repeat):
            began = time.process_time()
            outcome = verify(network, query, budget=Budget(seconds=seconds))
            times.append(time.process_time() - began)
        grown = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before
        told = replace(outcome.statistics, seconds=min(times))
        found.append((query.id, outcome.holds, told, 1024 * grown / told.stored))
    return found


def _queries(name: str, size: int) -> list[tuple[Network, Query]]:
    if name == "handover":
        network = handover_network()
        return [(network, query) for query in network.queries]
    if Path(name).is_file():
        network = loads_network(translated(Path(name).read_text("utf-8")), name=Path(name).name)
    elif name == "fddi":
        network = load_network(HERE / "fddi.ta", constants={"N": size})
    else:
        suffix = ".xml" if name == "csma_cd" else ".ta"
        network = load_network(MODELS / f"{name}{suffix}", constants={"N": size})
    if name == "csma_cd":
        return [(network, asked_on(network, COLLISION)[1])]
    return [(network, network.queries[0])]


def tchecker(
    checker: str, models: Sequence[Path], *, repeat: int = 3, seconds: float = 60.0
) -> None:
    """Models of TChecker's, searched by both."""
    print(f"{'model':20} {'stored':>10} {'seconds':>8} {'B/state':>8}   TChecker: the same, times")
    for model in models:
        [(_, _, told, held)] = _searched(str(model), 0, repeat, seconds)
        labels = asked(model.read_text("utf-8"))
        words = [checker, *SEARCH, *(["-l", ",".join(labels)] if labels else [])]
        done = measured([*words, str(model)])
        found = re.search(r"STORED_STATES (\d+)", done.output)
        assert found is not None, done.said
        print(f"{model.stem:20} {told.stored:10,} {told.seconds:8.3f} {held:8.0f}", end="   ")
        their, used = int(found[1]), done.mebibytes * 2**20
        times = done.cpu / max(told.seconds, 1e-3)
        print(f"{their:10,} {done.cpu:8.2f} {used / their:8.0f} {times:6.1f}", flush=True)


def translated(text: str) -> str:
    """A model of TChecker as `.ta` text, with the query that its labels ask.

    A comment `#labels=a:b` names the labels whose states are sought, without it all states are; a
    pair of events that synchronise is a channel.

    Raises:
        ValueError: it has what is not translated.
    """
    head, bodies = list[str](), dict[str, list[str]]()
    rows = [line.split("#")[0].strip() for line in text.splitlines()]
    pairs = [row.split(":")[1:] for row in rows if row.startswith("sync:")]
    if any(len(pair) != 2 or "?" in "".join(pair) for pair in pairs):
        raise ValueError("only pairs of events that synchronise are translated")
    ends: dict[tuple[str, str], list[str]] = {}
    for number, pair in enumerate(pairs):
        head.append(f"chan s{number}")
        for end, sign in zip(pair, "!?", strict=True):
            process, _, event = end.partition("@")
            ends.setdefault((process, event), []).append(f" on s{number}{sign}")
    labels: dict[str, list[str]] = {}
    for row in rows:
        kind, _, rest = row.partition(":")
        fields, attributes = _attributes(rest)
        match kind, fields:
            case "clock", [size, name]:
                head.append(f"clock {name}" + (f"[{size}]" if size != "1" else ""))
            case "int", [size, low, high, initial, name]:
                several = size != "1"
                value = f"{{{', '.join([initial] * int(size))}}}" if several else initial
                suffix = f"[{size}]" if several else ""
                head.append(f"int[{low},{high}] {name}{suffix} = {value}")
            case "process", [name]:
                bodies[name] = []
            case "location", [process, name]:
                kept = "committed " if "committed" in attributes else ""
                condition = attributes.get("invariant")
                bodies[process].append(
                    f"{kept}location l_{name}" + (f" invariant {condition}" if condition else "")
                )
                if "initial" in attributes:
                    bodies[process].append(f"start l_{name}")
                for label in filter(None, attributes.get("labels", "").split(",")):
                    labels.setdefault(label, []).append(f"{process}.l_{name}")
            case "edge", [process, source, target, event]:
                guard, update = attributes.get("provided"), attributes.get("do")
                when = f" when {guard}" if guard else ""
                do = f" do {update.replace(';', ', ')}" if update else ""
                bodies[process] += [
                    f"edge l_{source} -> l_{target}{when}{on}{do}"
                    for on in ends.get((process, event), [""])
                ]
            case "system" | "event" | "sync" | "", _:
                pass
            case _:
                raise ValueError(f"not translated: {row}")
    sought = " and ".join(f"({' or '.join(labels[label])})" for label in asked(text)) or "false"
    automata = [f"automaton {n} {{\n  " + "\n  ".join(b) + "\n}" for n, b in bodies.items()]
    return "\n".join([*head, *automata, f"query: E<> {sought}", ""])


def asked(text: str) -> list[str]:
    """The labels that a model says are sought; without any all states are."""
    found = re.search(r"^#labels=(.*)$", text, re.MULTILINE)
    return found[1].strip().split(":") if found else []


def _attributes(text: str) -> tuple[list[str], dict[str, str]]:
    """The fields of a declaration, and what stands in its braces."""
    fields, _, inside = text.partition("{")
    parts = re.split(r"(?:^|\s:\s)\s*(\w+):", inside.rstrip("}"))
    pairs = zip(parts[1::2], parts[2::2], strict=True)
    return fields.strip().split(":"), {name: value.strip() for name, value in pairs}


if __name__ == "__main__":
    sys.exit(program(__doc__, cost, tchecker))
