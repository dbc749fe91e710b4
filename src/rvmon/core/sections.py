"""The byte format of a plan: sections of fixed-size records, and shared lists. See plan.h.

A packed plan is data only, together with the names that its numbers stand for.
"""

from __future__ import annotations

import struct
from array import array
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from enum import IntEnum, auto
from itertools import accumulate

from rvmon.spec.checked.specification import CheckedSpec
from rvmon.trace.schema import Kind


@dataclass(frozen=True, slots=True)
class Packed:
    """A plan as bytes, with the names that its numbers stand for.

    Attributes:
        data: the bytes.
        signals: kind of value by name, in the order of their numbers.
        events: names, numbered after the signals.
        fields: kind of value by (event, field), in the order of their numbers.
        labels: by label, its number in the core.
        ids: the ids of the requirements, by number.
        numbers: by id, the number of the requirement.
    """

    data: bytes
    signals: Mapping[str, Kind]
    events: tuple[str, ...]
    fields: Mapping[tuple[str, str], Kind]
    labels: Mapping[str, int]
    ids: tuple[str, ...]
    numbers: Mapping[str, int]


def packed(spec: CheckedSpec, ids: tuple[str, ...], data: bytes) -> Packed:
    """Restore the names of a packed plan from the specification."""
    return Packed(
        data,
        {name: signal.type.kind for name, signal in spec.signals.items()},
        tuple(spec.events),
        {
            (name, field): type_.kind
            for name, event in spec.events.items()
            for field, type_ in event.fields.items()
        },
        Numbering(spec).labels,
        ids,
        {one: number for number, one in enumerate(ids)},
    )


class Numbering:
    """Numbers everything that a specification declares."""

    def __init__(self, spec: CheckedSpec) -> None:
        self.names = numbered([*spec.signals, *spec.events])
        types = [signal.type for signal in spec.signals.values()]
        for event in spec.events.values():
            types += event.fields.values()
        self.labels = numbered(list(dict.fromkeys(one for type_ in types for one in type_.labels)))


def numbered(names: Sequence[str]) -> dict[str, int]:
    """The index of each name."""
    return {name: number for number, name in enumerate(names)}


MAGIC = b"rvmonpl1"
ORDER = 0x01020304
"""A byte order mark: a reader of the other byte order sees another number."""

HEADER = struct.Struct("=8sIiqQq6i")
_ENTRY = struct.Struct("=2q")
"""The byte offset of a section, and its number of records."""


class Section(IntEnum):
    """The sections of a plan by number."""

    FIELD_FIRST = 0
    SUBSCRIPTION_FIRST = auto()
    SUBSCRIPTIONS = auto()
    PARTS = auto()
    SIGNALS = auto()
    EVENTS = auto()
    ATOMS = auto()
    NODES = auto()
    LINKS = auto()
    JUDGES = auto()
    AUTOMATA = auto()
    FORMS = auto()
    OPERATORS = auto()
    WATCHES = auto()
    GROUPS = auto()
    NUMBERS = auto()
    CODE = auto()
    LISTS = auto()
    INTS = auto()
    TICKS = auto()
    MARGINS = auto()
    MEASURES = auto()


RECORDS = {
    Section.FIELD_FIRST: struct.Struct("=i"),
    Section.SUBSCRIPTION_FIRST: struct.Struct("=i"),
    Section.SUBSCRIPTIONS: struct.Struct("=2i"),
    Section.PARTS: struct.Struct("=53i"),
    Section.SIGNALS: struct.Struct("=q16iq"),
    Section.EVENTS: struct.Struct("=12i"),
    Section.ATOMS: struct.Struct("=d12iq"),
    Section.NODES: struct.Struct("=2q18i"),
    Section.LINKS: struct.Struct("=8i"),
    Section.JUDGES: struct.Struct("=24i"),
    Section.AUTOMATA: struct.Struct("=22i"),
    Section.FORMS: struct.Struct("=q10i"),
    Section.OPERATORS: struct.Struct("=3q10i"),
    Section.WATCHES: struct.Struct("=4i"),
    Section.GROUPS: struct.Struct("=4i"),
    Section.NUMBERS: struct.Struct("=2q"),
    Section.CODE: struct.Struct("=i"),
    Section.LISTS: struct.Struct("=i"),
    Section.INTS: struct.Struct("=i"),
    Section.TICKS: struct.Struct("=q"),
    Section.MARGINS: struct.Struct("=6i"),
    Section.MEASURES: struct.Struct("=d4i"),
}
"""The layout of a record of each section, as its type in plan.h."""

Listed = tuple[int, int]
"""A slice of a section: the index of its first record, and the number of records."""


class Sections:
    """The sections of a plan under construction."""

    def __init__(self) -> None:
        self._bytes = {section: bytearray() for section in Section}
        self._records: dict[tuple[Section, tuple[int, ...]], int] = {}
        self._runs: dict[tuple[Section, bytes], int] = {}

    def count(self, section: Section) -> int:
        """The number of records of a section."""
        return len(self._bytes[section]) // RECORDS[section].size

    def add(self, section: Section, *fields: float) -> int:
        """Add a record; returns its index."""
        data, record = self._bytes[section], RECORDS[section]
        place = len(data) // record.size
        data += record.pack(*fields)
        return place

    def shared(self, section: Section, *fields: int) -> int:
        """The index of a record; equal records are stored once."""
        key = section, fields
        place = self._records.get(key)
        if place is None:
            place = self._records[key] = self.add(section, *fields)
        return place

    def run(self, section: Section, values: Iterable[int]) -> int:
        """The index of a run of numbers; equal runs are stored once."""
        data = array("q" if section is Section.TICKS else "i", values).tobytes()
        if not data:
            return 0
        place = self._runs.get((section, data))
        if place is None:
            place = self._runs[section, data] = self.count(section)
            self._bytes[section] += data
        return place

    def listed(self, places: Sequence[int]) -> Listed:
        """The slice of `LISTS` that holds these indices."""
        return self.run(Section.LISTS, places), len(places)

    def data(self, gap: int, sizes: Sequence[int]) -> bytes:
        """The whole plan as bytes.

        Args:
            gap: ticks between two positions; 0 if only samples are positions.
            sizes: the numbers of signals, events, fields, requirements, and the most captured
                values of an attempt.
        """
        padded = [bytes(data) + bytes(-len(data) % 8) for data in self._bytes.values()]
        begin = HEADER.size + len(padded) * _ENTRY.size
        offsets = accumulate(map(len, padded), initial=begin)
        entries = [
            _ENTRY.pack(offset, self.count(section))
            for section, offset in zip(Section, offsets, strict=False)
        ]
        body = b"".join([*entries, *padded])
        size = HEADER.size + len(body)
        header = HEADER.pack(*(MAGIC, ORDER, len(padded), size, hash_of(body), gap), *sizes, 0)
        return header + body


def hash_of(data: bytes) -> int:
    """FNV-1a over words of 8 bytes: byte by byte it would take as long as all other packing."""
    found = 0xCBF29CE484222325
    for word in array("Q", data):
        found = (found ^ word) * 0x100000001B3 & 0xFFFFFFFFFFFFFFFF
    return found
