"""Decoder of FlatBuffers messages, by the binary schema in an MCAP file."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from struct import Struct
from typing import Any

import msgspec
import numpy as np

from rvmon.trace.schema import Kind

_NUMBERS = {
    number: (Struct(f"<{sign}"), np.dtype(f"<{sign}"))
    for number, sign in enumerate("B?bBhHiIqQfd", 1)
}
"""The layout of a number, by base type."""

_BOOL, _REALS, _STRING, _VECTOR, _TABLE, _ARRAY = 2, (11, 12), 13, 14, 15, 17
"""Base types of `reflection.fbs`; unions are not supported."""

_I32, _U32, _U16 = Struct("<i"), Struct("<I"), Struct("<H")


class _Field(msgspec.Struct, frozen=True):
    """A field of a table, or of a struct."""

    name: str
    base: int  # its base type
    element: int  # the base type of the elements of a vector or array
    index: int  # the type, in the schema's list, of a table or of elements that are tables
    count: int  # the number of elements of an array in a struct
    offset: int  # its offset in a struct, or in the table of offsets
    default: float  # the value of a number that is not sent


class _Type(msgspec.Struct, frozen=True):
    """A table or a struct; `size`: bytes of a struct, 0 for a table."""

    name: str
    fields: tuple[_Field, ...]
    size: int


class FlatBuffers:
    """Decodes messages by a binary schema (`.bfbs`, `flatc --binary --schema`).

    Args:
        schema: the bytes of the schema.
        name: the type of the messages; the root type of the schema if it has no such type.
    """

    def __init__(self, schema: bytes, name: str) -> None:
        packed = _Packed(schema)
        root = packed.follow(0)
        self._types = [packed.type_at(place) for place in packed.tables(root, 0)]
        found = (one for one in self._types if one.name == name)
        self._root = next(found, None) or packed.type_at(packed.follow(packed.slot(root, 12)))
        # kinds of leaf fields, by path
        self.leaves: Mapping[str, Kind] = dict(self._leaves(self._root, "", ()))

    def _leaves(self, of: _Type, prefix: str, above: tuple[str, ...]) -> Iterator[tuple[str, Kind]]:
        for field in of.fields:
            is_several = field.base in (_VECTOR, _ARRAY)
            kind = field.element if is_several else field.base
            path = f"{prefix}{field.name}{'[]' * is_several}"
            if kind == _TABLE and self._types[field.index].name not in above:
                inner = self._types[field.index]
                yield from self._leaves(inner, f"{path}.", (*above, of.name))
            elif kind in _NUMBERS or kind == _STRING:
                real = Kind.REAL if kind in _REALS else Kind.INT
                yield path, {_BOOL: Kind.BOOL, _STRING: Kind.LABEL}.get(kind, real)

    def decode(self, data: bytes) -> Mapping[str, Any]:
        """The fields of a message by name, without those that are not sent and have no default."""
        message = _Packed(data)
        return dict(self._values(message, message.follow(0), self._root))

    def _values(self, packed: _Packed, at: int, of: _Type) -> Iterator[tuple[str, Any]]:
        packed.spend(4)
        for field in of.fields:
            place = at + field.offset if of.size else packed.slot(at, field.offset)
            if place:
                value = self._value(packed, place, field)
            else:
                value = field.default if field.base in _NUMBERS else None
            if value is not None:
                yield field.name, value

    def _value(self, packed: _Packed, at: int, field: _Field) -> Any:
        if field.base in _NUMBERS:
            return packed.number(_NUMBERS[field.base][0], at)
        if field.base == _STRING:
            return packed.text(packed.follow(at))
        if field.base == _TABLE:
            return self._table(packed, at, field.index)
        if field.base == _ARRAY:
            return self._several(packed, at, field.count, field)
        if field.base == _VECTOR:
            start = packed.follow(at)
            return self._several(packed, start + 4, packed.number(_U32, start), field)
        return None

    def _table(self, packed: _Packed, at: int, index: int) -> Mapping[str, Any]:
        of = self._types[index]
        return dict(self._values(packed, at if of.size else packed.follow(at), of))

    def _several(self, packed: _Packed, start: int, count: int, field: _Field) -> Any:
        if field.element in _NUMBERS:
            return np.frombuffer(packed.data, _NUMBERS[field.element][1], count, start)
        size = self._types[field.index].size if field.element == _TABLE else 0
        places = range(start, start + count * (size or 4), size or 4)
        if field.element == _TABLE:
            return [self._table(packed, at, field.index) for at in places]
        if field.element == _STRING:
            return [packed.text(packed.follow(at)) for at in places]
        return None


class _Packed:
    """A buffer, with access to its numbers, texts and tables by offset."""

    def __init__(self, data: bytes) -> None:
        self.data = data
        self._left = 16 * len(data)

    def spend(self, count: int) -> None:
        """Count bytes of texts and tables, which may be shared, but not without limit.

        Raises:
            ValueError: more than 16 times the buffer was read; it may be made to fill the memory.
        """
        self._left -= count
        if self._left < 0:
            raise ValueError("the same is read over and over")

    def number(self, form: Struct, at: int) -> Any:
        """The number at an offset."""
        if at < 0:
            raise ValueError("an offset leads out of it")
        return form.unpack_from(self.data, at)[0]

    def follow(self, at: int) -> int:
        """The position that the offset stored at `at` refers to."""
        return at + int(self.number(_U32, at))

    def slot(self, table: int, offset: int) -> int:
        """The position of a field of a table; 0 if the table does not have it."""
        offsets = table - self.number(_I32, table)
        if offset >= self.number(_U16, offsets):
            return 0
        there = int(self.number(_U16, offsets + offset))
        return table + there if there else 0

    def text(self, at: int) -> str:
        """The text at a position."""
        count = self.number(_U32, at)
        self.spend(4 + count)
        return self.data[at + 4 : at + 4 + count].decode()

    def tables(self, table: int, field: int) -> list[int]:
        """The positions of the tables in a vector, which is field number `field` of a table."""
        at = self.slot(table, 4 + 2 * field)
        start = self.follow(at) if at else 0
        count = self.number(_U32, start) if at else 0
        return [self.follow(start + 4 + 4 * place) for place in range(count)]

    def type_at(self, at: int) -> _Type:
        """The table or struct that a schema describes; see `Object` in `reflection.fbs`."""
        is_struct = self._of(at, 2, _NUMBERS[_BOOL][0], False)
        fields = tuple(self._field_at(place) for place in self.tables(at, 1))
        name = self.text(self.follow(self.slot(at, 4)))
        return _Type(name, fields, self._of(at, 4, _I32, 0) if is_struct else 0)

    def _field_at(self, at: int) -> _Field:
        """The field that a schema describes; see `Field` and `Type` in `reflection.fbs`."""
        of = self.follow(self.slot(at, 6))
        base, element = (self._of(of, number, _NUMBERS[3][0], 0) for number in (0, 1))
        real = self._of(at, 5, _NUMBERS[12][0], 0.0)
        whole = self._of(at, 4, _NUMBERS[9][0], 0)
        default = real if base in _REALS else bool(whole) if base == _BOOL else whole
        return _Field(
            self.text(self.follow(self.slot(at, 4))),
            base,
            element,
            self._of(of, 2, _I32, -1),
            self._of(of, 3, _U16, 0),
            self._of(at, 3, _U16, 0),
            default,
        )

    def _of(self, table: int, field: int, form: Struct, default: Any) -> Any:
        at = self.slot(table, 4 + 2 * field)
        return self.number(form, at) if at else default
