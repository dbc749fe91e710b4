"""The byte format of a plan: sections of fixed-size records, and shared lists. See plan.h.

A packed plan is data only, together with the names that its numbers stand for.
"""

from __future__ import annotations

import struct
from array import array
from collections.abc import Iterable, Mapping, Sequence
from enum import IntEnum
from itertools import accumulate

from msgspec import Struct

from rvmon.language.checked.specification import CheckedSpec
from rvmon.trace.schema import Kind


class Packed(Struct, frozen=True):
    """A plan as bytes, with the names that its numbers stand for."""

    data: bytes  # the bytes
    signals: Mapping[str, Kind]  # kind of value by name, in the order of their numbers
    events: tuple[str, ...]  # names, numbered after the signals
    # kind of value by (event, field), in the order of their numbers
    fields: Mapping[tuple[str, str], Kind]
    labels: Mapping[str, int]  # by label, its number in the core
    ids: tuple[str, ...]  # the ids of the requirements, by number
    numbers: Mapping[str, int]  # by id, the number of the requirement


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
        self.labels = numbered(
            list(dict.fromkeys(label for type_ in types for label in type_.labels))
        )


def numbered(names: Sequence[str]) -> dict[str, int]:
    """The index of each name."""
    return {name: number for number, name in enumerate(names)}


MAGIC = b"rvmonpl1"
ORDER = 0x01020304  # a byte order mark: a reader of the other byte order sees another number

HEADER = struct.Struct("=8sIiqQq6i")
_ENTRY = struct.Struct("=2q")  # the byte offset of a section, and its number of records


class Section(IntEnum):
    """The sections of a plan by number, each with the layout of its records as plan.h has it."""

    record: struct.Struct

    def __new__(cls, layout: str) -> Section:
        """The section with the next number."""
        section = int.__new__(cls, number := len(cls.__members__))
        section._value_ = number
        section.record = struct.Struct(f"={layout}")
        return section

    FIELD_FIRST = "i"
    SUBSCRIPTION_FIRST = "i"
    SUBSCRIPTIONS = "2i"
    PARTS = "53i"
    SIGNALS = "q16iq"
    EVENTS = "12i"
    ATOMS = "d12iq"
    NODES = "2q18i"
    LINKS = "8i"
    JUDGES = "26i"
    AUTOMATA = "22i"
    FORMS = "q10i"
    OPERATORS = "3q10i"
    WATCHES = "4i"
    GROUPS = "4i"
    NUMBERS = "2q"
    CODE = "i"
    LISTS = "i"
    INTS = "i"
    TICKS = "q"
    MARGINS = "6i"
    MEASURES = "d4i"


def bits(*flags: object) -> int:
    """Flags as the bits of a number, the first as the lowest."""
    return sum(bool(flag) << place for place, flag in enumerate(flags))


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
        return len(self._bytes[section]) // section.record.size

    def add(self, section: Section, *fields: float) -> int:
        """Add a record; returns its index."""
        place = self.count(section)
        self._bytes[section] += section.record.pack(*fields)
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
        # Each section starts at a multiple of 8, so that the core can read its records in place.
        padded = [bytes(data) + bytes(-len(data) % 8) for data in self._bytes.values()]
        first = HEADER.size + len(padded) * _ENTRY.size
        offsets = accumulate(map(len, padded), initial=first)
        entries = [
            _ENTRY.pack(offset, self.count(section))
            for section, offset in zip(Section, offsets, strict=False)
        ]
        body = b"".join([*entries, *padded])
        size = HEADER.size + len(body)
        header = HEADER.pack(*(MAGIC, ORDER, len(padded), size, hash_of(body), gap), *sizes, 0)
        return header + body


def hash_of(data: bytes) -> int:
    """FNV-1a over words of 8 bytes; byte by byte it would take as long as all the other packing."""
    found = 0xCBF29CE484222325
    for word in array("Q", data):
        found = (found ^ word) * 0x100000001B3 & 0xFFFFFFFFFFFFFFFF
    return found
