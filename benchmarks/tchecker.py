"""Beside TChecker, in one run: the same models, states, CPU seconds, memory.

    python -m benchmarks.tchecker PATH/TO/tck-reach MODEL…

A MODEL is a file of TChecker's, as the scripts of its examples write them; a comment `#labels=a:b`
names the labels whose states are sought, without it all states are. The same model, edge by edge,
is what rvmon searches: a pair of events that synchronise is a channel. TChecker searches with
`aLU-covreach`; its memory is that of its whole process, ours what the search added.
"""

from __future__ import annotations

import argparse
import re
import resource
import subprocess
import sys
import time
from pathlib import Path

from rvmon.timed.language.load import loads_network
from rvmon.timed.search.meter import Budget
from rvmon.timed.search.verify import verify

_SEARCH = ("-a", "aLU-covreach", "-s", "bfs")


def translated(text: str) -> str:
    """A model of TChecker as `.ta` text, with the query that its labels ask.

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


def _theirs(program: str, model: Path, labels: list[str]) -> tuple[int, float, int]:
    """States stored, CPU seconds, and the most memory in bytes."""
    words = [
        sys.executable,
        "-c",
        _CHILD,
        program,
        *_SEARCH,
        *(["-l", ",".join(labels)] if labels else []),
        str(model),
    ]
    told = subprocess.run(words, check=True, capture_output=True, text=True).stdout
    found = re.search(r"STORED_STATES (\d+)", told)
    assert found is not None, told
    seconds, memory = told.split()[-2:]
    return int(found[1]), float(seconds), int(memory)


_CHILD = (
    "import resource, subprocess, sys; subprocess.run(sys.argv[1:], check=True); "
    "u = resource.getrusage(resource.RUSAGE_CHILDREN); print(u.ru_utime + u.ru_stime, "
    "1024 * u.ru_maxrss)"
)


def _ours(model: Path, limit: float) -> tuple[int, float, int]:
    """As `_theirs`, but for the memory, which is what the search added."""
    network = loads_network(translated(model.read_text("utf-8")), name=model.name)
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    began = time.process_time()
    outcome = verify(network, network.queries[0], budget=Budget(seconds=limit))
    seconds = time.process_time() - began
    grown = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before
    assert outcome.holds is not None, outcome.remark
    return outcome.statistics.stored, seconds, 1024 * grown


def main() -> None:
    """Search, and print a table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("program", help="tck-reach")
    parser.add_argument("models", nargs="+", type=Path, metavar="MODEL")
    parser.add_argument(
        "--seconds", type=float, default=600.0, help="a search gives up after these"
    )
    parser.add_argument("--only", action="store_true", help=argparse.SUPPRESS)
    options = parser.parse_args()
    if options.only:
        print(*_ours(options.models[0], options.seconds))
        return
    print(f"{'model':20} {'stored':>10} {'seconds':>8} {'B/state':>8}   TChecker: the same, times")
    for model in options.models:
        words = [sys.executable, "-m", "benchmarks.tchecker", options.program, str(model), "--only"]
        told = subprocess.run(words, check=True, capture_output=True, text=True).stdout.split()
        stored, seconds, memory = int(told[0]), float(told[1]), int(told[2])
        their, took, used = _theirs(options.program, model, asked(model.read_text("utf-8")))
        print(f"{model.stem:20} {stored:10,} {seconds:8.3f} {memory / stored:8.0f}", end="   ")
        times = took / max(seconds, 1e-3)
        print(f"{their:10,} {took:8.2f} {used / their:8.0f} {times:6.1f}", flush=True)


if __name__ == "__main__":
    main()
