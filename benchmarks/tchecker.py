"""Models of TChecker as our text.

A comment `#labels=a:b` in a model names the labels whose states are sought, without it all states
are; a pair of events that synchronise is a channel.
"""

from __future__ import annotations

import re


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
