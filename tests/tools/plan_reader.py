"""Reads the bytes of a plan by what plan.h declares, and walks all that is in them."""

from __future__ import annotations

import re
import struct
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cache
from itertools import chain
from math import prod
from pathlib import Path
from typing import Any

import rvmon.core

HEADER = Path(rvmon.core.__file__).with_name("plan.h")

_COMMENT = re.compile(r"/\*.*?\*/", re.DOTALL)
_STRUCT = re.compile(r"typedef struct \{(.*?)\} (\w+);", re.DOTALL)
_UNION = re.compile(r"union \{.*?\} (\w+);", re.DOTALL)
_ENUM = re.compile(r"enum \{(.*?)\};", re.DOTALL)
_FIELD = re.compile(r"(\w+) (\w+)(?:\[(\d+)\])?;")
_LETTERS = {"int32_t": "i", "uint32_t": "I", "int64_t": "q", "uint64_t": "Q", "double": "d"}

SECTIONS = {
    "SUBSCRIPTIONS": "subscription",
    "PARTS": "part_plan",
    "SIGNALS": "signal_plan",
    "EVENTS": "event_plan",
    "ATOMS": "atom_plan",
    "NODES": "node_plan",
    "LINKS": "link_plan",
    "JUDGES": "judge_plan",
    "AUTOMATA": "automaton_plan",
    "FORMS": "form_plan",
    "OPERATORS": "operator_plan",
    "WATCHES": "watch_plan",
    "GROUPS": "group_plan",
    "NUMBERS": "number_plan",
    "MARGINS": "margin_plan",
    "MEASURES": "measure_plan",
}
"""What type of C the records of a section have; of the others they are numbers."""


@cache
def _text() -> str:
    text = _COMMENT.sub("", HEADER.read_text(encoding="utf-8"))
    return _UNION.sub(r"int64_t \1;", text)


@cache
def enumerators() -> Mapping[str, int]:
    """The names that plan.h enumerates."""
    found: dict[str, int] = {}
    for body in _ENUM.findall(_text()):
        value = 0
        for entry in filter(None, (part.strip() for part in body.split(","))):
            name, _, given = entry.partition("=")
            value = int(given) if given else value
            found[name.strip()] = value
            value += 1
    return found


@cache
def layouts() -> Mapping[str, tuple[tuple[str, str], ...]]:
    """By type of C, its fields with their formats for `struct`, lists as two numbers."""
    found: dict[str, tuple[tuple[str, str], ...]] = {}
    for body, name in _STRUCT.findall(_text()):
        fields = []
        for kind, own, count in _FIELD.findall(body):
            if kind == "char":
                fields.append((own, f"{count}s"))
            else:
                some = {"list": "2i", "phased": "4i"}.get(kind) or f"{count}{_LETTERS[kind]}"
                fields.append((own, some))
        found[name] = tuple(fields)
    return found


def record(name: str, data: bytes, offset: int) -> dict[str, Any]:
    """The fields of a record, lists and arrays as tuples."""
    made = {}
    for own, form in layouts()[name]:
        values = struct.unpack_from(f"={form}", data, offset)
        made[own] = values[0] if len(values) == 1 else values
        offset += size_of_form(form)
    return made


def size_of_form(form: str) -> int:
    """The size of what a format for `struct` stands for."""
    return struct.calcsize(f"={form}")


def size_of(name: str) -> int:
    """The size of a record."""
    return sum(size_of_form(form) for _, form in layouts()[name])


class Plan:
    """A plan, of which all is read.

    Attributes:
        header: its fields.
        records: by section, its records.
        numbers: by section of numbers, these.
    """

    def __init__(self, data: bytes) -> None:
        self.data = data
        self.header = record("plan_header", data, 0)
        names = list(enumerators())
        first = names.index("SEC_FIELD_FIRST")
        self.names = [one[4:] for one in names[first : names.index("SECTIONS")]]
        self.places = []
        self.records: dict[str, list[dict[str, Any]]] = {}
        self.numbers: dict[str, Sequence[int]] = {}
        for number, name in enumerate(self.names):
            at = size_of("plan_header") + number * size_of("section")
            offset, count = record("section", data, at).values()
            type_ = SECTIONS.get(name)
            size = (8 if name == "TICKS" else 4) if type_ is None else size_of(type_)
            self.places.append((offset, offset + count * size))
            if type_ is None:
                letter = "q" if name == "TICKS" else "i"
                self.numbers[name] = struct.unpack_from(f"={count}{letter}", data, offset)
            else:
                self.records[name] = [
                    record(type_, data, offset + place * size) for place in range(count)
                ]

    def listed(self, places: tuple[int, int]) -> Sequence[int]:
        """What stands in a list."""
        first, count = places
        assert first >= 0
        assert count >= 0
        assert first + count <= len(self.numbers["LISTS"])
        return self.numbers["LISTS"][first : first + count]

    def own(self, section: str, places: tuple[int, int]) -> list[dict[str, Any]]:
        """The records that are somebody's."""
        first, count = places
        assert first >= 0
        assert count >= 0
        assert first + count <= len(self.records[section])
        return self.records[section][first : first + count]

    def run(self, section: str, first: int, count: int) -> Sequence[int]:
        """Numbers that stand one behind the other."""
        assert first >= 0
        assert count >= 0
        assert first + count <= len(self.numbers[section])
        return self.numbers[section][first : first + count]


def walk(plan: Plan, *, is_whole: bool = True) -> None:
    """Follow every index, and see that it leads to what it should.

    Args:
        plan: as read.
        is_whole: whether no byte of it was changed.
    """
    _walk_bytes(plan, is_whole)
    _walk_names(plan)
    for section, places in (
        ("SIGNALS", "signals"),
        ("EVENTS", "events"),
        ("ATOMS", "atoms"),
        ("NODES", "nodes"),
        ("JUDGES", "judges"),
        ("FORMS", "forms"),
        ("WATCHES", "watches"),
        ("GROUPS", "groups"),
    ):
        _is_partition(plan, section, [part[places] for part in plan.records["PARTS"]])
    _is_partition(plan, "LINKS", [node["links"] for node in plan.records["NODES"]])
    margins = plan.records["MARGINS"]
    operators = [one["operators"] for one in (*plan.records["FORMS"], *margins)]
    _is_partition(plan, "OPERATORS", sorted(operators))
    _is_partition(plan, "MEASURES", [one["measures"] for one in margins])
    assert len(margins) in (0, len(plan.records["JUDGES"]))
    for automaton in plan.records["AUTOMATA"]:
        _walk_automaton(plan, automaton)
    requirements = [_walk_part(plan, part) for part in plan.records["PARTS"]]
    counted = sorted(number for own in requirements for number in own)
    assert counted == list(range(plan.header["requirements"]))


def _within(numbers: Iterable[int], count: int, least: int = 0) -> None:
    for number in numbers:
        assert least <= number < count


def _is_partition(plan: Plan, section: str, ranges: Sequence[tuple[int, int]]) -> None:
    """Each record is somebody's, in their order."""
    end = 0
    for first, count in ranges:
        assert first == end or count == 0
        end += count
    assert end == len(plan.records[section])


def _walk_bytes(plan: Plan, is_whole: bool) -> None:
    header = plan.header
    assert header["magic"] == b"rvmonpl1"
    assert header["order"] == 0x01020304
    assert header["sections"] == len(plan.names) == enumerators()["SECTIONS"]
    assert header["size"] == len(plan.data)
    end = size_of("plan_header") + len(plan.names) * size_of("section")
    for first, behind in plan.places:
        assert first % 8 == 0
        assert end <= first < end + 8
        end = behind
    assert end <= len(plan.data) < end + 8
    hashed = 0xCBF29CE484222325
    for (word,) in struct.iter_unpack("=Q", plan.data[size_of("plan_header") :]):
        hashed = (hashed ^ word) * 0x100000001B3 % (1 << 64)
    assert (header["hash"] == hashed) == is_whole


def _ascends(numbers: Sequence[int], end: int) -> None:
    """They tell where lists begin: from 0 to the end."""
    assert numbers[0] == 0
    assert list(numbers) == sorted(numbers)
    assert numbers[-1] == end


def _walk_names(plan: Plan) -> None:
    header = plan.header
    assert len(plan.numbers["FIELD_FIRST"]) == header["events"] + 1
    _ascends(plan.numbers["FIELD_FIRST"], header["fields"])
    first = plan.numbers["SUBSCRIPTION_FIRST"]
    subscriptions = plan.records["SUBSCRIPTIONS"]
    names = header["signals"] + header["events"]
    assert len(first) == names + 1
    _ascends(first, len(subscriptions))
    heard = 0
    for name in range(names):
        for one in subscriptions[first[name] : first[name + 1]]:
            part = plan.records["PARTS"][one["part"]]
            section = "SIGNALS" if name < header["signals"] else "EVENTS"
            own = plan.own(section, part[section.lower()])
            assert own[one["local"]]["name"] == name
            heard += 1
    assert heard == len(plan.records["SIGNALS"]) + len(plan.records["EVENTS"])


@dataclass
class _Part:
    """A part with its records.

    Attributes:
        plan: that it is of.
        fields: its own.
        memories: of each kind, the numbers of those that were met.
    """

    plan: Plan
    fields: dict[str, Any]
    memories: dict[str, list[int]] = field(default_factory=dict)

    def own(self, name: str) -> list[dict[str, Any]]:
        return self.plan.own(name.upper(), self.fields[name])

    def listed(self, places: tuple[int, int], count: int) -> Sequence[int]:
        found = self.plan.listed(places)
        _within(found, count)
        return found

    def phased(self, places: tuple[int, ...], count: int) -> tuple[Sequence[int], Sequence[int]]:
        begin, size, second, rest = places
        first, then = (self.listed(half, count) for half in ((begin, size), (second, rest)))
        for found in (first, then):
            assert len(set(found)) == len(found)
        assert set(then) <= set(first)
        return first, then

    def remember(self, kind: str, number: int) -> None:
        self.memories.setdefault(kind, []).append(number)


def _walk_part(plan: Plan, fields: dict[str, Any]) -> list[int]:
    part = _Part(plan, fields)
    nodes, atoms, judges = (part.own(name) for name in ("nodes", "atoms", "judges"))
    events = part.own("events")
    assert len({id(one) for one in nodes}) == len(nodes)
    for signal in part.own("signals"):
        _walk_signal(part, signal)
    _walk_events(part, events)
    for atom in atoms:
        _walk_atom(part, atom)
    for place, node in enumerate(nodes):
        _walk_node(part, place, node)
    for judge in judges:
        _walk_judge(part, judge)
    for form in part.own("forms"):
        _walk_form(part, form)
    for margin in plan.records["MARGINS"] and plan.own("MARGINS", fields["judges"]):
        _walk_margin(part, margin)
    for kind in ("seen", "edges", "stretches", "timers", "perishable"):
        met = part.memories.get(kind, [])
        assert (len(met), met) == (fields[kind], list(range(len(met))))
    assert fields["births"] == sum(signal["births"] > 0 for signal in part.own("signals"))
    assert fields["undetermined"] == sum(judge["determined"] >= 0 for judge in judges)
    part.listed(fields["stateful"], len(nodes))
    networked = [n for n, judge in enumerate(judges) if judge["automaton"] < 0]
    assert list(plan.listed(fields["networked"])) == networked
    forms = [judges[n]["form"] for n in networked]
    forms += [fields["truths"]] if fields["truths"] >= 0 else []
    assert forms == list(range(fields["forms"][1]))
    assert fields["truths"] == -1 or fields["captured"] == 0
    _walk_groups(part)
    _walk_unit(part)
    assert 0 <= fields["requirements"] <= len(judges)
    return [judge["requirement"] for judge in judges[: fields["requirements"]]]


def _walk_groups(part: _Part) -> None:
    watches, groups = part.own("watches"), part.own("groups")
    items = 0
    looks: list[list[int]] = [[] for _ in watches]
    for number, group in enumerate(groups):
        assert group["first"] == items
        axes = part.plan.listed(group["axes"])
        assert len(axes) % 2 == 0
        bins = [
            range(first, first + count) for first, count in zip(axes[::2], axes[1::2], strict=True)
        ]
        assert all(bins)
        occasion = group["occasion"]
        for watch in chain(*bins) if occasion < 0 else [occasion]:
            looks[watch].append(number)
        items += prod(map(len, bins))
    for watch, own in zip(watches, looks, strict=True):
        assert list(part.listed(watch["groups"], len(groups))) == own
        _within([watch["node"]], part.fields["nodes"][1])
        _within([watch["is_pulse"]], 2)


def _walk_unit(part: _Part) -> None:
    fields, nodes = part.fields, part.own("nodes")
    dead = part.listed(fields["dead_timers"], len(nodes))
    assert all(nodes[place]["timer"] >= 0 for place in dead)
    varying = part.listed(fields["varying"], len(nodes))
    assert set(part.listed(fields["varying_nodes"], len(nodes))) <= set(varying)
    part.listed(fields["varying_atoms"], len(part.own("atoms")))
    lapsed = part.listed(fields["lapsed"], len(nodes))
    assert all(nodes[place]["op"] == enumerators()["NODE_LAPSED"] for place in lapsed)
    captures = part.plan.listed(fields["captures"])
    for number, place in enumerate(captures):
        _walk_program(part, place, captured=fields["each"] + number, capturing=True)
    if fields["captured"] == 0:
        return
    assert fields["captured"] == fields["each"] + len(captures)
    assert fields["captured"] <= part.plan.header["captured"]
    assert part.own("judges")[0]["requirement"] == fields["requirement"]
    for bits in (fields["root_starters"], fields["instance_starters"]):
        assert 0 < bits < 1 << fields["judges"][1]
    if fields["each"]:
        event = part.own("events")[fields["each_event"]]
        assert event["flags"] & enumerators()["EVENT_KEY"]
        assert 0 <= fields["each_field"] < event["fields"]


def _walk_signal(part: _Part, signal: dict[str, Any]) -> None:
    atoms, nodes = part.fields["atoms"][1], part.own("nodes")
    for places in (signal["on_change"], signal["on_update"]):
        part.phased(places, atoms)
    part.listed(signal["needs"], atoms)
    assert 0 <= signal["births"] <= 2
    assert (signal["perishable"] >= 0) == (signal["stale_after"] > 0)
    if signal["perishable"] >= 0:
        part.remember("perishable", signal["perishable"])
    own = part.own("signals").index(signal)
    asked = [
        1 + operand % 2
        for place in part.listed(signal["on_birth"], len(nodes))
        for operand in part.plan.listed(nodes[place]["operands"])
        if operand // 2 == own
    ]
    assert max(asked, default=0) == signal["births"]


def _walk_events(part: _Part, events: Sequence[dict[str, Any]]) -> None:
    field_first = part.plan.numbers["FIELD_FIRST"]
    first = 0
    for event in events:
        part.phased(event["on_occurrence"], part.fields["atoms"][1])
        part.listed(event["needs"], part.fields["atoms"][1])
        number = event["name"] - part.plan.header["signals"]
        assert event["field"] == first
        assert event["fields"] == field_first[number + 1] - field_first[number]
        first += event["fields"]
    assert first == part.fields["fields"]


def _walk_atom(part: _Part, atom: dict[str, Any]) -> None:
    e = enumerators()
    op, signals, events = atom["op"], part.fields["signals"][1], part.fields["events"][1]
    _within([op], e["ATOMS"])
    shown, _ = part.phased(atom["nodes"], part.fields["nodes"][1])
    number = part.own("atoms").index(atom)
    nodes = part.own("nodes")
    assert shown
    assert all(
        nodes[place]["op"] == e["NODE_LEAF"] and nodes[place]["a"] == number for place in shown
    )
    read = part.listed(atom["events"], events)
    assert bool(read) == (op == e["ATOM_PAYLOAD"])
    _within([atom["compare"]], e["CMPS"])
    if op in (e["ATOM_COMPARE"], e["ATOM_PAYLOAD"]):
        for place in (atom["left"], atom["right"]):
            _walk_program(part, place, captured=part.fields["captured"], events=read)
    elif op in (e["ATOM_EVENT"], e["ATOM_KNOWN_EVENT"], e["ATOM_UPDATED_EVENT"]):
        _within([atom["input"]], events)
    elif op != e["ATOM_START"]:
        _within([atom["input"]], signals)
    needed = sum(
        list(part.plan.listed(one["needs"])).count(number)
        for one in (*part.own("signals"), *part.own("events"))
    )
    assert atom["momentary"] == needed + (op == e["ATOM_START"])


def _walk_program(
    part: _Part,
    place: int,
    *,
    captured: int,
    events: Sequence[int] = (),
    capturing: bool = False,
) -> None:
    """Run a program on a stack of which the height alone is known."""
    e = enumerators()
    code, height = part.plan.numbers["CODE"], 0
    unary = {e[f"CODE_{name}"] for name in ("NEG", "ABS", "SQRT")}
    while code[place] != e["CODE_END"]:
        op, argument = code[place] % 256, code[place] // 256
        place += 1
        _within([op], e["CODES"])
        if op >= e["CODE_ADD"]:
            assert argument == 0
            height -= op not in unary
            assert height >= 1
            continue
        height += 1
        assert height < 32
        if op == e["CODE_NUMBER"]:
            _within([part.plan.records["NUMBERS"][argument]["kind"]], 3, 1)
        elif op == e["CODE_CAPTURED"]:
            _within([argument], captured)
        elif op == e["CODE_FIELD"]:
            assert capturing or argument in events
            _within([code[place]], part.own("events")[argument]["fields"])
            place += 1
        else:
            _within([argument], part.fields["signals"][1])
    assert height == 1


def _walk_node(part: _Part, place: int, node: dict[str, Any]) -> None:
    e = enumerators()
    op, nodes = node["op"], part.own("nodes")
    _within([op], e["NODES"])
    if op in (e["NODE_LEAF"], e["NODE_UNBORN"]):
        part.listed(node["operands"], 2 * part.fields["signals"][1])
    else:
        operands = part.listed(node["operands"], place)
        wanted = {
            **dict.fromkeys(range(e["NODE_CONSTANT"], e["NODE_NOT"]), 0),
            **dict.fromkeys((e["NODE_NOT"], *range(e["NODE_SURE"], e["NODE_EVER"])), 1),
            **dict.fromkeys(range(e["NODE_EVER"], e["NODES"]), 2),
        }
        assert len(operands) == wanted.get(op, len(operands))
        assert all(place in part.plan.listed(nodes[one]["parents"][:2]) for one in operands)
    if op == e["NODE_LEAF"]:
        _within([node["a"]], part.fields["atoms"][1])
    if op in (e["NODE_LEAF"], e["NODE_CONSTANT"]):
        _within([node["a" if op == e["NODE_CONSTANT"] else "b"]], 3)
    parents, _ = part.phased(node["parents"], len(nodes))
    assert all(place in part.plan.listed(nodes[one]["operands"]) for one in parents)
    if node["slot"] >= 0:
        kinds = {e["NODE_EDGE"]: "edges", e["NODE_STRETCH"]: "stretches"}
        part.remember(kinds.get(op, "seen"), node["slot"])
    if node["timer"] >= 0:
        part.remember("timers", node["timer"])
    links = part.plan.own("LINKS", node["links"])
    watching = [link for link in links if link["kind"] == e["LINK_WATCH"]]
    watches = part.own("watches")
    assert [link["judge"] for link in watching] == [
        number for number, watch in enumerate(watches) if watch["node"] == place
    ]
    links = links[: len(links) - len(watching)]
    _within((link["judge"] for link in links), part.fields["judges"][1])
    _within((link["kind"] for link in links), 8, 1)
    assert len({link["judge"] for link in links}) == len(links)


def _walk_judge(part: _Part, judge: dict[str, Any]) -> None:
    e, plan = enumerators(), part.plan
    nodes = part.fields["nodes"][1]
    for name in ("trigger", "again", "unborn", "determined", "running", "blurs"):
        _within([judge[name]], nodes, -1)
    _within([judge["owner"]], part.fields["requirements"])
    _within([judge["requirement"]], plan.header["requirements"])
    _within([judge["form"]], part.fields["forms"][1], -1)
    _within(judge["outcomes"], 16)
    assert (judge["automaton"] >= 0) == (judge["form"] < 0)
    part.listed(judge["leaves"], nodes)
    if judge["automaton"] < 0:
        return
    automaton = plan.records["AUTOMATA"][judge["automaton"]]
    assert automaton["clocks"] <= part.fields["clocks"]
    propositions = part.listed(judge["propositions"], nodes)
    if judge["diagram"] >= 0:
        assert automaton["letters"] == 0
        _walk_diagram(plan, judge["diagram"], len(propositions), automaton["classes"])
        return
    own = part.own("judges").index(judge)
    links = [
        link
        for node in part.own("nodes")
        for link in plan.own("LINKS", node["links"])
        if link["judge"] == own and link["kind"] != e["LINK_WATCH"]
    ]
    for reading in ("worse", "better"):
        assert min(min(link[reading]) for link in links) >= 0 if links else True
        assert sum(max(link[reading]) for link in links) < automaton["letters"]
        assert all(link["kind"] & e["LINK_LETTER"] or not any(link[reading]) for link in links)


def _walk_diagram(plan: Plan, place: int, level: int, classes: int) -> None:
    """A decision on one of the first propositions, and on lower ones behind it."""
    if place < 0:
        _within([~place], classes)
        return
    (decided,) = plan.run("INTS", place, 1)
    _within([decided], level)
    *digits, count = plan.run("INTS", place + 1, 7)
    _within(digits, count)
    for child in plan.run("INTS", place + 8, count):
        _walk_diagram(plan, child, decided, classes)


def _walk_automaton(plan: Plan, a: dict[str, Any]) -> None:
    locations, clocks, rows, classes = (a[k] for k in ("locations", "clocks", "rows", "classes"))
    assert clocks >= 1
    assert locations > 2
    _within([a["initial"]], locations)
    _within(plan.run("INTS", a["class_of"], a["letters"]), classes)
    bases = plan.run("INTS", a["bases"], locations)
    widths = plan.run("INTS", a["widths"], locations)
    _within(widths, clocks + 1)
    strides = plan.run("INTS", a["strides"], locations * clocks)
    first = plan.run("INTS", a["cut_first"], locations * clocks + 1)
    _ascends(first, first[-1])
    cuts = plan.run("TICKS", a["cuts"], first[-1])
    end = 0
    for place in range(locations):
        assert bases[place] == end
        last = end
        for clock in range(place * clocks, (place + 1) * clocks):
            own = cuts[first[clock] : first[clock + 1]]
            assert list(own) == sorted(set(own))
            assert not own or clock - place * clocks < widths[place]
            last += strides[clock] * len(own)
        end = last + 1
    assert end == rows
    _within(plan.run("INTS", a["edges"], rows * classes), a["targets_count"])
    _within(plan.run("INTS", a["targets"], a["targets_count"]), locations)
    _within(plan.run("INTS", a["sources"], a["targets_count"] * clocks), clocks, -1)
    _within(plan.run("INTS", a["time_values"], rows), 3)
    clause_first = plan.run("INTS", a["clause_first"], locations + 1)
    _ascends(clause_first, clause_first[-1])
    test_first = plan.run("INTS", a["test_first"], clause_first[-1] + 1)
    _ascends(test_first, test_first[-1])
    tests = plan.run("INTS", a["tests"], 2 * test_first[-1])
    _within(tests[::2], clocks, -1)
    _within(tests[1::2], 2)
    plan.run("TICKS", a["ages"], test_first[-1])


def _walk_margin(part: _Part, margin: dict[str, Any]) -> None:
    e = enumerators()
    measures = part.plan.own("MEASURES", margin["measures"])
    _walk_operators(part, margin["operators"], len(measures))
    _within([margin["looks_back"]], 2)
    for one in measures:
        _within([one["kind"]], e["MEASURES"])
        _within([one["turned"]], 2)
        if one["kind"] == e["MEASURE_CONSTANT"]:
            assert one["node"] == -1
        else:
            _within([one["node"]], part.fields["nodes"][1])
        if one["kind"] == e["MEASURE_DISTANCE"]:
            node = part.own("nodes")[one["node"]]
            assert node["op"] == e["NODE_LEAF"]
            compared = ("ATOM_REAL", "ATOM_COMPARE", "ATOM_PAYLOAD")
            assert part.own("atoms")[node["a"]]["op"] in [e[name] for name in compared]
            assert one["factor"] > 0


def _walk_form(part: _Part, form: dict[str, Any]) -> None:
    _walk_operators(part, form["operators"], form["leaves"])


def _walk_operators(part: _Part, places: tuple[int, int], count: int) -> None:
    e = enumerators()
    operators = part.plan.own("OPERATORS", places)
    assert operators
    leaves = 0
    for place, one in enumerate(operators):
        kind = one["kind"]
        _within([kind], e["OPS"])
        if kind == e["OP_LEAF"]:
            assert one["left"] == leaves
            _within([one["right"]], part.fields["nodes"][1], -1)
            _within(one["values"], 4)
            leaves += 1
        elif kind == e["OP_JUNCTION"]:
            assert len(part.listed(one["operands"], place)) >= 2
        else:
            _within([one["left"]], place)
            if kind in (e["OP_UNTIL"], e["OP_SINCE"]):
                _within([one["right"]], place)
    assert leaves == count
