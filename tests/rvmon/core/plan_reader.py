"""Decodes the bytes of a plan with the layouts declared in plan.h."""

import re
import struct
from collections.abc import Mapping, Sequence
from functools import cache
from pathlib import Path
from typing import Any

import rvmon.core
from rvmon.core.sections import HEADER as HEAD
from rvmon.core.sections import hash_of

HEADER = Path(rvmon.core.__file__).parent / "native" / "plan" / "plan.h"

_COMMENT = re.compile(r"/\*.*?\*/", re.DOTALL)
_STRUCT = re.compile(r"typedef struct \{(.*?)\} (\w+);", re.DOTALL)
_UNION = re.compile(r"union \{.*?\} (\w+);", re.DOTALL)
_ENUM = re.compile(r"enum \{(.*?)\};", re.DOTALL)
_SECTION = re.compile(r"SECTION\((\w+), \w+, (\w+)\)")
_FIELD = re.compile(r"(\w+) (\w+)(?:\[(\d+)\])?;")
_LETTERS = {"int32_t": "i", "uint32_t": "I", "int64_t": "q", "uint64_t": "Q", "double": "d"}


@cache
def _text() -> str:
    text = _COMMENT.sub("", HEADER.read_text(encoding="utf-8"))
    return _UNION.sub(r"int64_t \1;", text)


@cache
def record_types() -> Mapping[str, str]:
    """C type of the records of each section, in the order of the sections."""
    return dict(_SECTION.findall(_text()))


@cache
def enumerators() -> Mapping[str, int]:
    """Values of all enumerators in plan.h, and of the sections."""
    found = {f"SEC_{name}": number for number, name in enumerate(record_types())}
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
    """Fields of each C type with their `struct` formats; a list is two numbers."""
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
    """The fields of a record; lists and arrays become tuples."""
    made = {}
    for own, form in layouts()[name]:
        values = struct.unpack_from(f"={form}", data, offset)
        made[own] = values[0] if len(values) == 1 else values
        offset += size_of_form(form)
    return made


def size_of_form(form: str) -> int:
    return struct.calcsize(f"={form}")


def size_of(name: str) -> int:
    """Size in bytes of a C type: a record or a number."""
    if name in _LETTERS:
        return size_of_form(_LETTERS[name])
    return sum(size_of_form(form) for _, form in layouts()[name])


def with_numbers(data: bytes, numbers: Mapping[int, int]) -> bytes:
    """A copy of a plan with 32-bit numbers replaced at some offsets, and a matching hash."""
    made = bytearray(data)
    for at, number in numbers.items():
        struct.pack_into("=i", made, at, number)
    struct.pack_into("=Q", made, 24, hash_of(bytes(made[HEAD.size :])))
    return bytes(made)


class Plan:
    """A plan decoded in full.

    Attributes:
        header: fields of the header.
        places: first offset and end of each section, in order.
        records: records of each section that has records.
        numbers: numbers of each section that has plain numbers.
    """

    def __init__(self, data: bytes) -> None:
        self.data = data
        self.header = record("plan_header", data, 0)
        self.names = list(record_types())
        self.places = []
        self.records: dict[str, list[dict[str, Any]]] = {}
        self.numbers: dict[str, Sequence[int]] = {}
        for number, (name, type_) in enumerate(record_types().items()):
            at = size_of("plan_header") + number * size_of("section")
            offset, count = record("section", data, at).values()
            letter = _LETTERS.get(type_)
            size = size_of(type_)
            self.places.append((offset, offset + count * size))
            if letter is not None:
                self.numbers[name] = struct.unpack_from(f"={count}{letter}", data, offset)
            else:
                self.records[name] = [
                    record(type_, data, offset + place * size) for place in range(count)
                ]

    def run(self, section: str, first: int, count: int) -> Sequence[int]:
        """A run of numbers in a section; it must lie within the section."""
        assert first >= 0
        assert count >= 0
        assert first + count <= len(self.numbers[section])
        return self.numbers[section][first : first + count]
